// The kinematic chain of a machine as a configuration string (thesis 4.3; ISO 10791 notation without the fixed bed).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/axis.hpp"

namespace ecs {

/// Letters after `T` carry the tool, letters before it the workpiece, both read from the base outward:
/// "TXYZ" moving column mill, "XYTZ" machining centre with compound table, "TX" one axis, "XTYZ" with X unused a lathe.
struct Chain {
  PerAxis<std::int8_t> order{-1, -1, -1};  ///< place on its side, counted from the base; -1: the axis does not exist
  PerAxis<bool> carries_workpiece{};       ///< true: a letter before the T

  [[nodiscard]] constexpr bool has(Axis a) const { return order[index_of(a)] >= 0; }
  [[nodiscard]] constexpr std::size_t axis_count() const {
    std::size_t count = 0;
    for (const Axis a : kAllAxes) count += has(a) ? 1u : 0u;
    return count;
  }
  friend constexpr bool operator==(const Chain&, const Chain&) = default;
};

/// Exactly one T, each of X Y Z at most once, at least one of them, nothing else; otherwise nothing.
[[nodiscard]] constexpr std::optional<Chain> chain_of(std::string_view configuration) {
  Chain chain;
  bool tool_side = false;
  std::int8_t place = 0;
  for (const char letter : configuration) {
    if (letter == 'T') {
      if (tool_side) return std::nullopt;
      tool_side = true;
      place = 0;
      continue;
    }
    const auto axis = axis_of(letter);
    if (!axis || chain.has(*axis)) return std::nullopt;
    chain.order[index_of(*axis)] = place++;
    chain.carries_workpiece[index_of(*axis)] = !tool_side;
  }
  if (!tool_side || chain.axis_count() == 0) return std::nullopt;
  return chain;
}

/// The chain without the axes that a machine does not have (a lathe as XTYZ without X).
[[nodiscard]] constexpr Chain restricted_to(Chain chain, const PerAxis<bool>& present) {
  for (const Axis a : kAllAxes)
    if (!present[index_of(a)]) chain.order[index_of(a)] = -1;
  for (const Axis a : kAllAxes)
    if (!chain.has(a)) chain.carries_workpiece[index_of(a)] = false;
  return chain;
}

/// True where the position of `lever` is part of the lever arm L_b of axis `b` (rigid-body model, docs/physics.md):
/// tool-side b: tool-side axes after b; workpiece-side b: all tool-side axes, workpiece-side axes from the base up to
/// b, and b itself.
[[nodiscard]] constexpr bool is_lever(const Chain& chain, Axis b, Axis lever) {
  if (!chain.has(b) || !chain.has(lever)) return false;
  const auto place_b = chain.order[index_of(b)];
  const auto place_l = chain.order[index_of(lever)];
  const bool lever_on_workpiece = chain.carries_workpiece[index_of(lever)];
  if (!chain.carries_workpiece[index_of(b)]) return !lever_on_workpiece && place_l > place_b;
  return !lever_on_workpiece || place_l <= place_b;
}

}  // namespace ecs
