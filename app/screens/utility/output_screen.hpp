// OUTPUT COMPENSATION VALUE: axis, value, relay shown big, what moved beside it; steps, everything off on one key.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/output_controller.hpp"

namespace ecs::app {

class OutputScreen final : public Screen {
 public:
  explicit OutputScreen(std::shared_ptr<UnitConnection> controller) : controller_(std::move(controller)) {}

  [[nodiscard]] std::string title() const override { return "OUTPUT COMPENSATION VALUE"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] bool typing() const override { return prompt_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  [[nodiscard]] Step leave();
  void on_command(const Key& key);
  void type_value();
  void type_measured();
  void toggle_relay();
  void choose_next(int by);

  OutputController controller_;
  Prompt prompt_;
  Asking asking_;
  std::string proposal_;  ///< from the last measurement
};

}  // namespace ecs::app
