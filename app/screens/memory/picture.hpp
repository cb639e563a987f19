// Memory as rows of bytes with their characters: where each byte stands, how it is marked.
#pragma once

#include "app/ui/cells.hpp"
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

}  // namespace ecs::app
