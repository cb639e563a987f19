#include "app/screens/memory/picture.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr int kAddressColumns = 8;  ///< "100000  "

/// Column of a byte from the left: a gap after every eight.
int column_of(std::uint32_t in_row) { return kAddressColumns + static_cast<int>(3 * in_row + in_row / 8); }
int characters_at(std::uint32_t per_row) { return column_of(per_row - 1) + (per_row > 8 ? 4 : 3); }
int columns_for(std::uint32_t per_row) { return characters_at(per_row) + static_cast<int>(per_row); }

void draw_heading(Canvas& canvas, const Area& area, std::uint32_t per_row) {
  for (std::uint32_t k = 0; k < per_row; ++k) canvas.text(area, 0, column_of(k), fmt::format("{:02X}", k), Tone::faint);
}

struct ByteLook {
  std::string digits = "..";
  char32_t character = U' ';
  Tone tone = Tone::faint;
};

ByteLook look_of(const MemoryController& controller, Address address, const std::optional<NamedPlace>& field) {
  ByteLook look;
  const auto byte = controller.memory().at(address);
  if (byte) {
    look.digits = fmt::format("{:02X}", *byte);
    look.character = *byte >= 0x20 && *byte < 0x7F ? *byte : U'.';
    look.tone = Tone::plain;
  }
  if (field && address >= field->first && address - field->first < field->bytes) look.tone = Tone::strong;
  if (controller.differs(address)) look.tone = Tone::warning;
  if (address == controller.cursor()) look.tone = Tone::selected;
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

void draw_memory(Canvas& canvas, const Area& area, const MemoryController& controller, const MemoryRows& rows) {
  const MemoryRegion* region = controller.memory().region_of(controller.cursor());
  if (region == nullptr || area.rows < 2) return;
  draw_heading(canvas, area, rows.per_row);
  const auto field = controller.names().at(controller.memory(), controller.cursor());
  const int characters = characters_at(rows.per_row);
  for (int r = 0; r < std::min(rows.rows, area.rows - 1); ++r) {
    const Address row = rows.first + static_cast<Address>(r) * rows.per_row;
    if (!region->contains(row)) break;
    canvas.text(area, r + 1, 1, fmt::format("{:06X}", row), Tone::faint);
    for (std::uint32_t k = 0; k < rows.per_row && region->contains(row + k); ++k) {
      const ByteLook look = look_of(controller, row + k, field);
      canvas.text(area, r + 1, column_of(k), look.digits, look.tone);
      if (controller.differs(row + k)) canvas.text(area, r + 1, column_of(k) + 2, "*", Tone::warning);
      canvas.put(area.row + r + 1, area.column + characters + static_cast<int>(k), look.character, look.tone);
    }
    if (controller.cursor() >= row && controller.cursor() - row < rows.per_row) {
      const int column = column_of(controller.cursor() - row);
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

}  // namespace ecs::app
