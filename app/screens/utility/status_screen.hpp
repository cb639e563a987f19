// DISPLAY ECS STATUS: state with the fault in plain words, address pointers, axes; live or from a file.
#pragma once

#include "app/screens/utility/parts.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/utility/status_controller.hpp"

namespace ecs::app {

class StatusScreen final : public Screen {
 public:
  explicit StatusScreen(std::shared_ptr<UnitConnection> controller) : controller_(std::move(controller)) {}

  [[nodiscard]] std::string title() const override { return "DISPLAY ECS STATUS"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] bool typing() const override { return prompt_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  enum class Page { state, pointers, axes, memory };
  [[nodiscard]] int pages() const;
  [[nodiscard]] Page page() const;  ///< that can be shown now
  void draw_source(Canvas& canvas, const Area& area) const;
  void draw_tabs(Canvas& canvas, const Area& area) const;
  void draw_state(Canvas& canvas, const Area& area) const;
  void on_command(const Key& key);
  void ask_save();

  StatusController controller_;
  Page page_ = Page::state;
  ScrollPlace scroll_;
  Prompt prompt_;
  Asking asking_;
};

}  // namespace ecs::app
