// SET AXIS POSITION: the axes with what the unit shows for them, live; a position is typed, asked for, set.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/position_controller.hpp"

namespace ecs::app {

class PositionScreen final : public Screen {
 public:
  explicit PositionScreen(std::shared_ptr<UnitConnection> controller) : controller_(std::move(controller)) {}

  [[nodiscard]] std::string title() const override { return "SET AXIS POSITION"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] bool typing() const override { return prompt_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  [[nodiscard]] Axis chosen() const;
  void type();

  PositionController controller_;
  ListPlace place_;
  Prompt prompt_;
  Asking asking_;
};

}  // namespace ecs::app
