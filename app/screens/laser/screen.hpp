// PROCESS LASER DATA: the steps from measured files to a map in the unit, as tabs that say how they stand; one can go
// back to any of them.
#pragma once

#include <array>
#include <memory>

#include "app/screens/laser/page.hpp"
#include "app/ui/screen.hpp"

namespace ecs::app {

class LaserScreen final : public Screen {
 public:
  explicit LaserScreen(std::shared_ptr<UnitConnection> unit);

  [[nodiscard]] std::string title() const override { return "FROM FILES TO THE MAP"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override;
  [[nodiscard]] bool typing() const override { return host_->form_.has_value() || page().typing(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;
  [[nodiscard]] std::string unsaved() const override { return host_->controller.unsaved(); }

  [[nodiscard]] LaserController& controller() { return host_->controller; }
  /// Measured files, or one error map; work that is offered is kept for later.
  void open(const std::vector<std::string>& paths, FileKind kind);
  [[nodiscard]] LaserStep step() const { return step_; }

 private:
  [[nodiscard]] LaserPage& page() const { return *pages_[static_cast<std::size_t>(step_)]; }
  [[nodiscard]] int message_rows(const Area& area) const;
  [[nodiscard]] Area body_of(const Area& area) const;
  void draw_tabs(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::string bottom_text() const;
  void draw_bottom(Canvas& canvas, const Area& area) const;
  /// Where the tab of a step begins and what stands in it.
  struct Tab {
    int column = 0;
    std::string name;
  };
  [[nodiscard]] std::array<Tab, kLaserSteps> tabs(int columns) const;
  void click(const Key& key);
  [[nodiscard]] bool on_lying_over(const Key& key);
  [[nodiscard]] bool on_own_key(const Key& key);
  void save();
  void go(int step);

  std::unique_ptr<LaserHost> host_;
  std::array<std::unique_ptr<LaserPage>, kLaserSteps> pages_;
  LaserStep step_ = LaserStep::files;
  bool leaving_ = false;
  mutable Area drawn_;  ///< of the last picture, for clicks
};

}  // namespace ecs::app
