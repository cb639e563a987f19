// TEST DATUM ROUTINE: the axes with the stage in which each stands, live; what failed and what to do next.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/datum_test_controller.hpp"

namespace ecs::app {

class DatumTestScreen final : public Screen {
 public:
  explicit DatumTestScreen(std::shared_ptr<UnitConnection> controller) : controller_(std::move(controller)) {}

  [[nodiscard]] std::string title() const override { return "TEST DATUM ROUTINE"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }

 private:
  void draw_rows(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::string call() const;
  DatumTestController controller_;
  ListPlace place_;
  Asking asking_;
};

}  // namespace ecs::app
