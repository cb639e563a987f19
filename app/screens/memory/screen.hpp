// MEMORY ACCESS: bytes with their names, finding, comparing, writing with a question and the way back. The memory is a
// unit's, read page by page as it is needed, or a dump's.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/screens/files/keyed_screen.hpp"
#include "app/ui/cells.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/memory/bytes.hpp"
#include "commissioning/memory/compare.hpp"
#include "commissioning/memory/names.hpp"
#include "commissioning/session/task_runner.hpp"

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

/// The byte at a place of the canvas; nothing: there is none.
[[nodiscard]] std::optional<Address> byte_at(const Area& area, const MemoryRows& rows, const MemoryRegion& region,
                                             CellPosition place);

class MemoryScreen final : public KeyedScreen {
 public:
  explicit MemoryScreen(std::shared_ptr<UnitConnection> unit);
  MemoryScreen(const MemoryScreen&) = delete;
  MemoryScreen& operator=(const MemoryScreen&) = delete;

  [[nodiscard]] std::string title() const override { return "MEMORY"; }
  void draw(Canvas& canvas, const Area& area) const override;
  [[nodiscard]] std::string help() const override;
  [[nodiscard]] CellPosition cursor(const Area& area) const override;
  /// A dump, or a memory image; empty or "unit": the unit.
  void open(const std::string& path);

 private:
  static constexpr int kPlaceColumn = 7;  ///< of what is typed behind "go to:"
  enum class Page { bytes, differences, written };
  struct Target {
    Address address = 0;
    std::string text;
  };
  struct Search {
    std::vector<std::uint8_t> pattern;
    std::string typed;
    Address from = 0;
    Address at = 0;  ///< how far it is read
  };

  // --- keys
  void on_other_key(const Key& key) override;
  [[nodiscard]] bool edits() const override { return placing_; }
  void on_edit_key(const Key& key) override;
  [[nodiscard]] Step leave() override;
  void on_list_key(const Key& key);
  void on_move_key(const Key& key);
  void to_named(bool forward);
  void begin_placing();
  [[nodiscard]] std::vector<Target> targets() const;
  void choose_dump();
  void choose_comparison();
  /// @param take  says why it refuses them
  void ask_for_bytes(const std::string& label, std::function<std::string(const std::string&)> take);
  void ask_to_write_here();
  void ask_to_save(DumpScope scope);

  // --- the picture
  [[nodiscard]] std::string tabs_text(bool whole) const;
  void draw_top(Canvas& canvas, const Area& area) const;
  void draw_bytes(Canvas& canvas, const Area& area) const;
  void draw_rows(Canvas& canvas, const Area& area, const MemoryRegion& region) const;
  void draw_under_cursor(Canvas& canvas, const Area& area) const;
  void draw_differences(Canvas& canvas, const Area& area) const;
  void draw_written(Canvas& canvas, const Area& area) const;
  void draw_targets(Canvas& canvas, const Area& area) const;
  [[nodiscard]] int bottom_rows(const Area& area) const;
  [[nodiscard]] std::string selected_row() const;
  void draw_bottom(Canvas& canvas, const Area& area) const;

  // --- where
  /// Of what this is: "unit MCM-0107", "file unit.ecsdump".
  [[nodiscard]] std::string source() const;
  [[nodiscard]] bool is_file() const { return !file_.empty(); }
  /// To the nearest address that exists.
  void go(Address address);
  /// This many bytes on; from the end of a region into the next.
  void move(long long bytes);

  // --- reading
  [[nodiscard]] bool look() override;
  [[nodiscard]] bool follow_unit();
  void start_needed(const Stretch& shown);
  [[nodiscard]] Stretch needed(const Stretch& shown) const;
  void read(const Stretch& stretch);
  void landed(const Stretch& stretch, const Result<std::vector<std::uint8_t>>& bytes);
  void read_again();
  void read_region();
  void decode_again();

  // --- finding and comparing
  [[nodiscard]] std::string seek(const std::string& typed);
  void seek_on();
  void begin_search(Address from);
  void step_search();
  void compare_with(const std::string& path);
  void compare_again();
  /// Without its folder.
  [[nodiscard]] std::string compared_file() const;
  void to_next_difference();

  // --- writing: proposed, asked, then done or left
  /// Whether the byte under the cursor may be written; says why not.
  [[nodiscard]] bool lets_write();
  [[nodiscard]] std::string propose(const std::string& typed);
  void propose_undo();
  void ask_to_write(ByteWrite write, bool undo);
  void write(const ByteWrite& write, bool undo);
  void landed_write(const ByteWrite& write, bool undo, const Result<void>& done);

  // --- files
  void show_dump(const std::string& path, const MemoryDump& dump);
  void save(const std::string& path, DumpScope scope);

  // --- long work
  /// Ends what runs for a task in front, unless there is one already; says so.
  [[nodiscard]] bool gives_way();
  /// Empty: nothing that is worth telling.
  [[nodiscard]] std::string working_on() const;
  [[nodiscard]] double part() const;
  [[nodiscard]] double seconds_left() const;  ///< negative: unknown
  void cancel();

  std::shared_ptr<UnitConnection> unit_;
  MemoryBytes memory_;
  MemoryNames names_;
  std::string file_;           ///< empty: the unit
  std::string file_detail_;    ///< whose dump it is and when it was taken
  std::string serial_number_;  ///< of the unit shown; empty: none yet
  std::string written_in_;     ///< serial number of the unit that was written into
  std::chrono::steady_clock::time_point opened_at_{};
  Address cursor_ = kBankA.first;
  std::string refused_place_;      ///< why the place typed is none, until another key
  bool opened_at_active_ = false;  ///< the cursor went to the active bank when it became known

  std::optional<Address> filling_;  ///< a region that is read whole
  std::optional<Search> search_;    ///< under way
  std::optional<Search> sought_;    ///< last
  std::optional<MemoryBytes> other_;
  MemoryNames other_names_;
  std::string other_file_;
  std::vector<DifferenceRow> differences_;
  std::vector<ByteWrite> written_;

  Page page_ = Page::bytes;
  bool placing_ = false;  ///< where to go is typed
  TextLine text_;
  ListPlace target_;
  ListPlace difference_;
  ListPlace write_;
  mutable MemoryRows rows_;
  mutable Area rows_area_;

  double part_begun_ = 0.0;
  std::chrono::steady_clock::time_point begun_{};
  std::chrono::steady_clock::time_point not_before_{};  ///< the next try after a failed read
  bool read_failed_ = false;
  TaskRunner pages_;
  TaskRunner task_;  ///< the work in front
};

}  // namespace ecs::app
