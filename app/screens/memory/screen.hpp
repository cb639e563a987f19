// Memory as rows of bytes with their characters: where each byte stands, how it is marked.
// MEMORY ACCESS: bytes with their names, finding, comparing, writing with a question and the way back.
#pragma once

#include <memory>

#include "app/screens/files/prompt.hpp"
#include "app/ui/cells.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/memory/controller.hpp"

namespace ecs::app {

/// How many bytes stand in a row, how many rows there are, and with which row the picture begins.
struct MemoryRows {
  std::uint32_t per_row = 16;
  int rows = 0;
  Address first = 0;
  [[nodiscard]] Stretch shown() const { return {first, per_row * static_cast<std::uint32_t>(std::max(0, rows))}; }
};
/// 32 where they fit, else 16, 8 or 4; the cursor's row is among those shown.
/// @param first  of the picture before
[[nodiscard]] MemoryRows rows_for(const MemoryRegion& region, Address cursor, int rows, int columns, Address first);

/// Addresses, bytes and characters; `[45]` is under the cursor, `45*` differs, `..` is not read yet.
void draw_memory(Canvas& canvas, const Area& area, const MemoryController& controller, const MemoryRows& rows);
/// The byte at a place of the canvas; nothing: there is none.
[[nodiscard]] std::optional<Address> byte_at(const Area& area, const MemoryRows& rows, const MemoryRegion& region,
                                             CellPosition place);

class MemoryScreen final : public Screen {
 public:
  explicit MemoryScreen(std::shared_ptr<UnitConnection> unit) : controller_(std::move(unit)) {}

  [[nodiscard]] std::string title() const override { return "MEMORY"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] Step on_key(const Key& key) override;
  [[nodiscard]] std::vector<KeyHelp> keys() const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] bool advance() override {
    const bool looked = files_.advance();
    return controller_.advance(rows_.shown()) || looked;
  }
  [[nodiscard]] bool typing() const override { return typing_ != Typing::nothing || files_.active(); }
  /// A dump, or a memory image.
  void open(const std::string& path) { controller_.open(path); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override;

 private:
  enum class Page { bytes, differences, written };
  enum class Typing { nothing, place, sought, bytes, file_to_save };
  struct Target {
    Address address = 0;
    std::string text;
  };

  void choose_dump();
  void choose_comparison();
  void begin_typing(Typing what, const std::string& text = {});
  void typed();
  void on_typing_key(const Key& key);
  void on_list_key(const Key& key);
  [[nodiscard]] bool on_move_key(const Key& key);
  [[nodiscard]] std::vector<KeyRow> key_table();
  void to_named(bool forward);
  [[nodiscard]] std::vector<Target> targets() const;
  [[nodiscard]] std::string prompt() const;
  [[nodiscard]] std::string hint() const;

  [[nodiscard]] std::string tabs_text(bool whole) const;
  void draw_top(Canvas& canvas, const Area& area) const;
  void draw_bytes(Canvas& canvas, const Area& area) const;
  void draw_under_cursor(Canvas& canvas, const Area& area) const;
  void draw_differences(Canvas& canvas, const Area& area) const;
  void draw_written(Canvas& canvas, const Area& area) const;
  void draw_targets(Canvas& canvas, const Area& area) const;
  [[nodiscard]] int bottom_rows(const Area& area) const;
  [[nodiscard]] std::string selected_row() const;
  void draw_bottom(Canvas& canvas, const Area& area) const;

  MemoryController controller_;
  Page page_ = Page::bytes;
  Typing typing_ = Typing::nothing;
  TextLine text_;
  Prompt files_;
  std::string choices_;  ///< files that the typed path may become
  DumpScope scope_ = DumpScope::all;
  ListPlace target_;
  ListPlace difference_;
  ListPlace write_;
  mutable MemoryRows rows_;
  mutable Area rows_area_;
  std::vector<KeyRow> keys_ = key_table();
};

}  // namespace ecs::app
