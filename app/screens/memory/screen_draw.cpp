// How the memory screen looks: above whose memory it is, below what is under the cursor and what happened.
#include <algorithm>

#include <fmt/format.h>

#include "app/screens/memory/screen.hpp"
#include "app/ui/widgets.hpp"
#include "base/json.hpp"

namespace ecs::app {
namespace {

constexpr int kAddressColumns = 8;  ///< "100000  "

/// Column of a byte from the left: a gap after every eight.
int column_of(std::uint32_t in_row) { return kAddressColumns + static_cast<int>(3 * in_row + in_row / 8); }
int characters_at(std::uint32_t per_row) { return column_of(per_row - 1) + (per_row > 8 ? 4 : 3); }
int columns_for(std::uint32_t per_row) { return characters_at(per_row) + static_cast<int>(per_row); }

struct ByteLook {
  std::string digits = "..";
  char32_t character = U' ';
  Tone tone = Tone::faint;
};

/// @param field  under the cursor
ByteLook look_of(std::optional<std::uint8_t> byte, Address address, const std::optional<NamedPlace>& field) {
  ByteLook look;
  if (byte) {
    look.digits = fmt::format("{:02X}", *byte);
    look.character = *byte >= 0x20 && *byte < 0x7F ? *byte : U'.';
    look.tone = Tone::plain;
  }
  if (field && address >= field->first && address - field->first < field->bytes) look.tone = Tone::strong;
  return look;
}

}  // namespace

MemoryRows rows_for(const MemoryRegion& region, Address cursor, int rows, int columns, Address first) {
  MemoryRows out;
  out.rows = std::max(1, rows - 1);
  for (out.per_row = 32; out.per_row > 4 && columns_for(out.per_row) > columns;) out.per_row /= 2;
  const std::uint32_t per_page = out.per_row * static_cast<std::uint32_t>(out.rows);
  const auto row_of = [&](Address at) { return region.first + (at - region.first) / out.per_row * out.per_row; };
  const Address here = row_of(cursor);
  out.first = region.contains(first) ? row_of(first) : here;
  if (here < out.first) out.first = here;
  if (here >= out.first + per_page) out.first = here - per_page + out.per_row;
  const Address last_row = row_of(region.last());
  const Address latest =
      last_row - region.first + out.per_row > per_page ? last_row + out.per_row - per_page : region.first;
  out.first = std::min(out.first, std::max(latest, region.first));
  return out;
}

/// Addresses, bytes and characters; `[45]` is under the cursor, `45*` differs, `..` is not read yet.
void MemoryScreen::draw_rows(Canvas& canvas, const Area& area, const MemoryRegion& region) const {
  if (area.rows < 2) return;
  for (std::uint32_t k = 0; k < rows_.per_row; ++k)
    canvas.text(area, 0, column_of(k), fmt::format("{:02X}", k), Tone::faint);
  const auto field = names_.at(memory_, cursor_);
  const int characters = characters_at(rows_.per_row);
  for (int r = 0; r < std::min(rows_.rows, area.rows - 1); ++r) {
    const Address row = rows_.first + static_cast<Address>(r) * rows_.per_row;
    if (!region.contains(row)) break;
    canvas.text(area, r + 1, 1, fmt::format("{:06X}", row), Tone::faint);
    for (std::uint32_t k = 0; k < rows_.per_row && region.contains(row + k); ++k) {
      const bool differs = other_ && differ_at(memory_, *other_, row + k);
      ByteLook look = look_of(memory_.at(row + k), row + k, field);
      if (differs) look.tone = Tone::warning;
      if (row + k == cursor_) look.tone = Tone::selected;
      canvas.text(area, r + 1, column_of(k), look.digits, look.tone);
      if (differs) canvas.text(area, r + 1, column_of(k) + 2, "*", Tone::warning);
      canvas.put(area.row + r + 1, area.column + characters + static_cast<int>(k), look.character, look.tone);
    }
    if (cursor_ >= row && cursor_ - row < rows_.per_row) {
      const int column = column_of(cursor_ - row);
      canvas.text(area, r + 1, column - 1, "[", Tone::strong);
      canvas.text(area, r + 1, column + 2, "]", Tone::strong);
    }
  }
}

std::optional<Address> byte_at(const Area& area, const MemoryRows& rows, const MemoryRegion& region,
                               CellPosition place) {
  const int r = place.row - area.row - 1;
  if (r < 0 || r >= rows.rows) return std::nullopt;
  for (std::uint32_t k = 0; k < rows.per_row; ++k) {
    const Address address = rows.first + static_cast<Address>(r) * rows.per_row + k;
    const int column = place.column - area.column;
    const bool on_digits = column >= column_of(k) && column < column_of(k) + 2;
    if ((on_digits || column == characters_at(rows.per_row) + static_cast<int>(k)) && region.contains(address))
      return address;
  }
  return std::nullopt;
}

namespace {

/// A list below its heading. @param empty  in its place where there is none
void draw_page(Canvas& canvas, const Area& area, const std::vector<ListRow>& rows, const ListPlace& place,
               const std::string& heading, const std::string& empty) {
  if (rows.empty()) return static_cast<void>(canvas.paragraph(area.below(1).between_margins(), 0, empty));
  canvas.text(area, 0, 2, heading, Tone::faint);
  draw_list(canvas, area.below(1), rows, place);
}

std::string text_of(const DifferenceRow& row) {
  return fmt::format("{}  {} {:>5}  {} | {}", hex_address(row.first), in_columns(row.name, 34), row.bytes, row.a,
                     row.b);
}

std::string text_of(const ByteWrite& write) {
  return fmt::format("{}  {}  {} -> {}{}  {}", write.when, hex_address(write.address), short_hex(write.before, 4),
                     short_hex(write.after, 4), write.taken_back ? "  UNDONE" : "", write.where);
}

}  // namespace

void MemoryScreen::draw(Canvas& canvas, const Area& area) const {
  if (area.rows < 1 || area.columns < 10) return;
  draw_top(canvas, area.top(2));
  const bool low = area.rows < 14;
  const int bottom = bottom_rows(area);
  const int below = (low ? 1 : 3) + bottom;
  const Area body{area.row + 2, area.column, std::max(0, area.rows - 2 - below), area.columns};
  if (placing_) {
    draw_targets(canvas, body);
  } else if (page_ == Page::differences) {
    draw_differences(canvas, body);
  } else if (page_ == Page::written) {
    draw_written(canvas, body);
  } else {
    draw_bytes(canvas, body);
    if (!memory_.regions().empty() && area.rows - below > 2)
      draw_under_cursor(canvas, {area.row + area.rows - below, area.column + 1, below - bottom, area.columns - 2});
  }
  if (prompt_.choosing()) return prompt_.draw(canvas, area.between_margins(), 0);
  if (area.rows > 4) draw_bottom(canvas, {area.row + area.rows - bottom, area.column + 1, bottom, area.columns - 2});
  draw_question(canvas, area, asking_);
}

/// Two, or what the message needs.
int MemoryScreen::bottom_rows(const Area& area) const {
  if (typing() || !working_on().empty()) return 2;
  return std::max(2, rows_of_message(message_, area.columns - 2, area.rows / 3));
}

/// @param whole  with the names of the pages that are not shown
std::string MemoryScreen::tabs_text(bool whole) const {
  const char* titles[] = {"bytes", "differences", "written"};
  std::string tabs;
  for (int p = 0; p < 3; ++p) {
    const bool here = static_cast<int>(page_) == p;
    const std::string name = here || whole ? fmt::format("{} {}", p + 1, titles[p]) : fmt::format("{}", p + 1);
    tabs += here ? "[" + name + "]" : " " + name + " ";
  }
  return tabs;
}

void MemoryScreen::draw_top(Canvas& canvas, const Area& area) const {
  const Area text = area.between_margins();
  std::string tabs = tabs_text(true);
  if (width_of(source()) + width_of(tabs) + 1 > text.columns) tabs = tabs_text(false);
  const bool room = text.columns >= 60;
  canvas.text({text.row, text.column, 1, room ? text.columns - width_of(tabs) - 1 : text.columns}, 0, 0, source(),
              Tone::strong);
  if (room) canvas.text_right(text, 0, tabs, Tone::faint);
  const MemoryRegion* region = memory_.region_of(cursor_);
  if (region == nullptr) return;
  const std::string content = names_.content_of(*region);
  const char* may = region->writable ? "writable" : "PROTECTED";
  const Tone tone = region->writable ? Tone::faint : Tone::warning;
  const std::string range =
      fmt::format("{:06X}-{:06X}{}{}", region->first, region->last(), content.empty() ? "" : ", ", content);
  if (!room) {
    canvas.text(text, 1, 0, fmt::format("{}, {} {}", region->name, may, range), tone);
    return;
  }
  canvas.text({text.row, text.column, text.rows, text.columns - 10}, 1, 0, fmt::format("{} {}", region->name, range));
  canvas.text_right(text, 1, may, tone);
}

void MemoryScreen::draw_bytes(Canvas& canvas, const Area& area) const {
  const MemoryRegion* region = memory_.region_of(cursor_);
  if (region == nullptr) {
    canvas.paragraph(area.below(1).between_margins(), 0,
                     "The unit's memory is shown as soon as a unit answers (LINK shows why it does not). Press o to "
                     "open a dump written by `ecs memory dump` or by s.");
    return;
  }
  rows_ = rows_for(*region, cursor_, area.rows, area.columns, rows_.first);
  rows_area_ = area;
  draw_rows(canvas, area, *region);
}

void MemoryScreen::draw_under_cursor(Canvas& canvas, const Area& area) const {
  const auto place = names_.at(memory_, cursor_);
  int row = 0;
  int c = canvas.text(area, row, 0, hex_address(cursor_) + "  ", Tone::faint);
  if (place) {
    const std::string value = place->value.empty() ? "" : " = " + place->value;
    if (c + width_of(place->name) + width_of(value) > area.columns) {
      canvas.paragraph(area.top(1), 0, hex_address(cursor_) + "  " + place->name + value);
    } else {
      c += canvas.text(area, row, c, place->name, Tone::strong);
      canvas.text(area, row, c, value);
    }
    const auto more = fmt::format("byte {} of {}", cursor_ - place->first + 1, place->bytes);
    if (area.rows > 1) canvas.text_right(area, 1, more, Tone::faint);
  } else {
    canvas.text(area, row, c, "no name for this address", Tone::faint);
  }
  if (area.rows > 1) canvas.text(area, ++row, 0, numbers_at(memory_, cursor_), Tone::faint);
  if (area.rows > 2 && other_) {
    std::string text = differences_.empty() ? fmt::format("no difference from {} in the bytes read", compared_file())
                                            : fmt::format("{} place{} differ{} from {}", differences_.size(),
                                                          differences_.size() == 1 ? "" : "s",
                                                          differences_.size() == 1 ? "s" : "", compared_file());
    canvas.text(area, ++row, 0, text, differences_.empty() ? Tone::good : Tone::warning);
  }
}

void MemoryScreen::draw_differences(Canvas& canvas, const Area& area) const {
  std::vector<ListRow> rows;
  for (const DifferenceRow& row : differences_) rows.push_back({text_of(row)});
  draw_page(canvas, area, rows, difference_,
            fmt::format("{:<8}  {:<34} {:>5}  here | {}", "address", "name", "bytes", compared_file()),
            other_ ? fmt::format("No difference from {} in the bytes read. On the page of the bytes, press a to read a "
                                 "whole region or s to read all memory.",
                                 compared_file())
                   : "No comparison yet: press c to choose a dump file to compare with.");
}

void MemoryScreen::draw_written(Canvas& canvas, const Area& area) const {
  std::vector<ListRow> rows;
  for (const ByteWrite& write : written_)
    rows.push_back({text_of(write), write.taken_back ? Tone::faint : Tone::plain});
  draw_page(canvas, area, rows, write_, "time      address   before -> after  where",
            "No bytes written yet. On the page of the bytes, press w to write at the cursor, after a confirmation, and "
            "u to restore the old bytes.");
}

/// The row under the cursor whole: in the list it may be cut.
std::string MemoryScreen::selected_row() const {
  const auto at = [](const ListPlace& place, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(place.selected, 0, static_cast<int>(count) - 1));
  };
  if (page_ == Page::differences) {
    const auto& rows = differences_;
    if (!other_ || rows.empty()) return {};
    const DifferenceRow& row = rows[at(difference_, rows.size())];
    return fmt::format("{} {}: here {}, in {} {}", hex_address(row.first), row.name, row.a, compared_file(), row.b);
  }
  const auto& writes = written_;
  return writes.empty() ? std::string() : text_of(writes[at(write_, writes.size())]);
}

void MemoryScreen::draw_targets(Canvas& canvas, const Area& area) const {
  std::vector<ListRow> rows;
  for (const Target& target : targets()) rows.push_back({target.text, Tone::plain});
  if (rows.empty()) {
    canvas.paragraph(area.between_margins(), 0, "no such memory or name");
    return;
  }
  draw_list(canvas, area, rows, target_);
}

void MemoryScreen::draw_bottom(Canvas& canvas, const Area& area) const {
  if (prompt_.active()) return prompt_.draw(canvas, area, 1);
  if (placing_) {
    canvas.text(area, 0, 0, "go to:", Tone::strong);
    text_.draw(canvas, area, 0, kPlaceColumn, std::max(1, area.columns - kPlaceColumn), true);
    const bool refused = !refused_place_.empty();
    canvas.text(
        area, 1, 0,
        refused ? refused_place_ : "hexadecimal address, or part of a name; up and down choose, Enter goes there",
        refused ? Tone::bad : Tone::faint);
    return;
  }
  const std::string working = working_on();
  if (!working.empty()) {
    draw_progress(canvas, area, 0, working, part(), seconds_left());
    if (message_.is_problem() && !message_.text().empty())
      draw_message(canvas, area.below(1), message_);
    else
      canvas.text(area, 1, 0, "Esc cancels", Tone::faint);
    return;
  }
  if (!message_.text().empty())
    draw_message(canvas, area, message_);
  else if (page_ != Page::bytes)
    canvas.paragraph(area, 0, selected_row(), Tone::faint);
}

}  // namespace ecs::app
