// The columns of a table that no format describes, over the steps of PROCESS LASER DATA: its first rows, a role and a
// unit under each column, what no column says, and what would be read. Does not live here: what the columns mean
// (commissioning/measurements/mapped_table.hpp).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/measurements/mapped_table.hpp"

namespace ecs::app {

class MappingForm {
 public:
  using Take = std::function<void(const MappedTable&)>;
  /// @param accept  when the mapping is accepted, which reads something
  /// @param others  when all other import options are wanted
  MappingForm(MappedTable table, Take accept, Take others);

  /// Begins at the position of the other axes.
  void go_to_parked();

  void draw(Canvas& canvas, const Area& area) const;
  [[nodiscard]] CellPosition cursor(const Area& area) const;
  /// @return false: the form is done, accepted or cancelled
  [[nodiscard]] bool on_key(const Key& key);
  [[nodiscard]] std::vector<KeyHelp> keys() const;

 private:
  struct Layout {
    Area inside, table, settings, preview, help;
    int first_rows = 0;
  };
  [[nodiscard]] Layout layout(const Area& area) const;
  [[nodiscard]] int width_of_column(std::size_t column) const;
  void scroll_to_cursor(int columns) const;
  void draw_table(Canvas& canvas, const Layout& at) const;
  void draw_settings(Canvas& canvas, const Layout& at) const;
  void draw_preview(Canvas& canvas, const Layout& at) const;
  [[nodiscard]] std::string help() const;
  /// The setting under the cursor. @pre the cursor is not in the table
  [[nodiscard]] MappingSetting setting() const;
  [[nodiscard]] bool in_table() const { return line_ <= kUnitLine; }
  void on_table_key(const Key& key);
  void on_setting_key(const Key& key);

  static constexpr int kRoleLine = 0, kUnitLine = 1;  ///< the settings follow

  MappedTable table_;
  Take accept_, others_;
  std::size_t column_ = 0;
  mutable std::size_t first_ = 0;  ///< column at the left edge
  int line_ = kRoleLine;
  TextLine parked_;
  bool refused_ = false;
};

}  // namespace ecs::app
