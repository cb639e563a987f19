// RECORD DATUM SEQUENCE: which axis, ten seconds with what the unit sees meanwhile, then the graph opens.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/datum_record_controller.hpp"

namespace ecs::app {

class DatumRecordScreen final : public Screen {
 public:
  explicit DatumRecordScreen(std::shared_ptr<UnitConnection> controller) : controller_(std::move(controller)) {}

  [[nodiscard]] std::string title() const override { return "RECORD DATUM SEQUENCE"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] std::unique_ptr<Screen> opens_by_itself() override;

 private:
  [[nodiscard]] Axis chosen() const;
  DatumRecordController controller_;
  ListPlace place_;
  Asking asking_;
};

}  // namespace ecs::app
