// The tools of a machine as the unit keeps them (thesis 9.4): a number and an offset for each, and which is selected,
// in a record of battery-backed memory. Does not live here: what an offset does (tick.hpp), who selects (docs/unit.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/bytes.hpp"
#include "core/parameters.hpp"

namespace ecs {

inline constexpr std::size_t kMostTools = 64;
inline constexpr std::uint16_t kGreatestToolNumber = 9999;

struct Tool {
  std::uint16_t number = 0;  ///< 1 … kGreatestToolNumber; 0: the place is free
  Vector3 offset_mm{};       ///< from the point where the curves were measured to the tool point
  friend bool operator==(const Tool&, const Tool&) = default;
};

struct ToolTable {
  std::uint32_t sequence = 0;
  std::uint16_t selected = 0;  ///< 0: none, the tool offset of the parameters acts
  std::array<Tool, kMostTools> tools{};
  friend bool operator==(const ToolTable&, const ToolTable&) = default;
};

/// Null: no tool has this number. @pre number > 0
[[nodiscard]] const Tool* tool_of(const ToolTable& table, std::uint16_t number) noexcept;
/// Puts the tool into the table, in place of one with its number. @return false: every place is taken
bool put_tool(ToolTable& table, const Tool& tool) noexcept;
/// @return false: no tool has this number. @pre number > 0
bool remove_tool(ToolTable& table, std::uint16_t number) noexcept;

/// Finite, and no further than the parameters allow; `parameters` without a range allow no tool.
[[nodiscard]] bool in_range(const Vector3& offset_mm, const UnitParameters& parameters) noexcept;

inline constexpr std::uint32_t kStoredToolBytes = 32;
inline constexpr std::uint32_t kToolTableBytes = 16 + kMostTools * kStoredToolBytes + 16;  ///< of one slot of two
/// The newer sound slot; nothing: neither is. @param region  two slots
[[nodiscard]] std::optional<ToolTable> stored_tools(ByteView region) noexcept;
/// The slot (0 or 1) to overwrite next.
[[nodiscard]] std::uint32_t next_tool_slot(ByteView region) noexcept;
/// @pre slot.size() == kToolTableBytes
void encode_tools(const ToolTable& table, Bytes slot) noexcept;

}  // namespace ecs
