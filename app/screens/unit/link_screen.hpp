// LINK: the setting as a form with the ports there are, the doctor at work, the counts of the line.
#pragma once

#include <memory>
#include <optional>

#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/controller.hpp"

namespace ecs::app {

class LinkScreen final : public Screen {
 public:
  explicit LinkScreen(std::shared_ptr<UnitConnection> unit) : unit_(unit), controller_(std::move(unit)) {}

  [[nodiscard]] std::string title() const override { return "LINK"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override { return controller_.advance(); }
  [[nodiscard]] bool typing() const override { return editing_; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  enum class Page { setting, doctor, statistics };
  void to_page(Page page);
  void on_setting_key(const Key& key);
  void on_edit_key(const Key& key);
  void take_port();
  [[nodiscard]] std::vector<LinkField> fields() const { return controller_.form().fields(controller_.port_names()); }

  void draw_top(Canvas& canvas, const Area& area) const;
  [[nodiscard]] std::string help_here() const;
  void draw_setting(Canvas& canvas, const Area& area) const;
  void draw_ports(Canvas& canvas, const Area& area) const;
  void draw_doctor(Canvas& canvas, const Area& area) const;
  void draw_statistics(Canvas& canvas, const Area& area) const;

  std::shared_ptr<UnitConnection> unit_;
  LinkController controller_;
  Page page_ = Page::setting;
  ListPlace row_;              ///< of the fields, then of the ports
  mutable int first_row_ = 0;  ///< of the fields on the canvas
  bool editing_ = false;
  TextLine text_;
  ScrollPlace scroll_;
  std::optional<UnitConnection::Watching> watching_;  ///< while the statistics are shown
};

}  // namespace ecs::app
