#include "core/tools.hpp"

#include <algorithm>
#include <cmath>

#include <zlib.h>

namespace ecs {
namespace {

constexpr std::uint32_t kToolMagic = 0x544F4F4C;  // "TOOL"
constexpr std::uint32_t kToolsAt = 16, kTableCheckAt = kToolsAt + kMostTools * kStoredToolBytes;
static_assert(kTableCheckAt + 4 <= kToolTableBytes);
constexpr double kFurthestTool_mm = 1e6;

std::uint32_t crc_of_table(ByteView slot) noexcept {
  return static_cast<std::uint32_t>(::crc32_z(0, slot.data(), kTableCheckAt));
}

std::optional<ToolTable> table_in(ByteView slot) noexcept {
  if (load_big<std::uint32_t>(slot, 0) != kToolMagic ||
      load_big<std::uint32_t>(slot, kTableCheckAt) != crc_of_table(slot))
    return std::nullopt;
  ToolTable table{load_big<std::uint32_t>(slot, 4), load_big<std::uint16_t>(slot, 8), {}};
  for (std::size_t k = 0; k < kMostTools; ++k) {
    const std::size_t at = kToolsAt + k * kStoredToolBytes;
    Tool& tool = table.tools[k];
    tool.number = load_big<std::uint16_t>(slot, at);
    for (std::size_t a = 0; a < kAxes; ++a) {
      tool.offset_mm[a] = load_double(slot, at + 8 + 8 * a);
      if (!(std::abs(tool.offset_mm[a]) <= kFurthestTool_mm)) return std::nullopt;
    }
  }
  return table;
}

template <class Table>
auto* place_of(Table& table, std::uint16_t number) noexcept {
  const auto found =
      std::find_if(table.tools.begin(), table.tools.end(), [&](const Tool& tool) { return tool.number == number; });
  return found == table.tools.end() ? nullptr : &*found;
}

}  // namespace

const Tool* tool_of(const ToolTable& table, std::uint16_t number) noexcept { return place_of(table, number); }

bool put_tool(ToolTable& table, const Tool& tool) noexcept {
  Tool* place = place_of(table, tool.number);
  if (place == nullptr) place = place_of(table, 0);
  if (place != nullptr) *place = tool;
  return place != nullptr;
}

bool remove_tool(ToolTable& table, std::uint16_t number) noexcept {
  Tool* const place = place_of(table, number);
  if (place != nullptr) *place = {};
  return place != nullptr;
}

bool in_range(const Vector3& offset_mm, const UnitParameters& parameters) noexcept {
  for (std::size_t a = 0; a < kAxes; ++a)
    if (!(std::abs(offset_mm[a]) <= parameters.tool_range_mm[a])) return false;
  return true;
}

std::optional<ToolTable> stored_tools(ByteView region) noexcept { return newest_record(region, table_in); }
std::uint32_t next_tool_slot(ByteView region) noexcept { return next_slot(region, table_in); }

void encode_tools(const ToolTable& table, Bytes slot) noexcept {
  std::fill(slot.begin(), slot.end(), std::uint8_t{0});
  store_big(slot, 0, kToolMagic);
  store_big(slot, 4, table.sequence);
  store_big(slot, 8, table.selected);
  for (std::size_t k = 0; k < kMostTools; ++k) {
    const std::size_t at = kToolsAt + k * kStoredToolBytes;
    store_big(slot, at, table.tools[k].number);
    for (std::size_t a = 0; a < kAxes; ++a) store_double(slot, at + 8 + 8 * a, table.tools[k].offset_mm[a]);
  }
  store_big(slot, kTableCheckAt, crc_of_table(slot));
}

}  // namespace ecs
