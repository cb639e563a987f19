// The kinematic chain of a machine as a configuration string (thesis 4.3; ISO 10791 notation without the fixed bed),
// and the rigid-body error model as one table of terms (thesis 4.2-4.3, rearranged): adding a term is adding a row.
//   E_observed = Σ sign · component · lever      lever = 1 (none), or coordinate − measurement line + tool offset
// (squareness: the coordinate alone; it tilts the axis's motion, not the tool).
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

/// One row: `component` adds to the tool-point error along `observed`.
struct Term {
  Axis observed = Axis::X;
  Component component = Component::EXX;
  bool has_lever = false;        ///< false: translation, the value itself
  Axis lever = Axis::X;          ///< direction of the lever arm, if has_lever
  bool uses_coordinate = false;  ///< false with has_lever: only the tool offset acts (the coordinate is no lever here)
  std::int8_t sign = 1;

  friend constexpr bool operator==(const Term&, const Term&) = default;
};

/// Which signs, and which rows.
enum class Convention : std::uint8_t {
  iso,         ///< signs of ISO 230-1 and of the exact matrices; every chain
  as_printed,  ///< thesis equations (20)-(28) as printed, ECY·X of XYTZ missing; TXYZ, XTYZ, XYTZ only
};

/// What the translation curves hold.
enum class CurveKind : std::uint8_t {
  carriage,  ///< the carriage's own error δ_a: own-axis levers are separate terms (the physical machine)
  measured,  ///< tool against workpiece along the axis: own-axis levers are already inside (a map from a laser)
};

/// 9 translations, 3 squareness, 9 angles × 2 directions.
inline constexpr std::size_t kMostTerms = 30;

/// Fixed-size list of terms; order is by component, then observed direction (as_printed: as in the thesis).
struct TermTable {
  std::array<Term, kMostTerms> rows{};
  std::size_t count = 0;

  [[nodiscard]] constexpr const Term* begin() const { return rows.data(); }
  [[nodiscard]] constexpr const Term* end() const { return rows.data() + count; }
};

/// The terms of a chain. Nothing if `convention` does not know the chain.
[[nodiscard]] std::optional<TermTable> terms_of(const Chain& chain, Convention convention, CurveKind curves) noexcept;

/// Values of the 21 components at one position; um, um/m for angles and squareness.
using ComponentValues = std::array<double, kComponents>;

/// Where each moving axis's curves were measured: `[b][lever]` is the coordinate of `lever` while b was measured [mm].
using MeasurementLines = PerAxis<Vector3>;

/// Tool-point error along X, Y, Z [um] at `position_mm`, from the values of the components there.
/// @param lines           measurement lines [mm]; all zero: levers count from the machine zero
/// @param tool_offset_mm  from the point at which the curves were measured to the tool point
[[nodiscard]] Vector3 tool_error_um(const TermTable& terms, const ComponentValues& values, const Vector3& position_mm,
                                    const MeasurementLines& lines, const Vector3& tool_offset_mm) noexcept;

/// How far an engineer lets the unit correct (thesis 5.3, "compensation required").
enum class Scope : std::uint8_t {
  linear,      ///< the positioning error of each axis
  planar,      ///< two axes: every term that acts in, and levers over, their plane
  volumetric,  ///< every term of the chain
};

/// The two axes of a planar scope.
struct Plane {
  Axis first = Axis::X;
  Axis second = Axis::Y;
  friend constexpr bool operator==(const Plane&, const Plane&) = default;
};

/// The rows of `terms` that a unit on `chain` corrects in this scope: only directions in which an axis exists.
/// Rows that only a tool offset can lever are kept.
[[nodiscard]] TermTable terms_in_scope(const TermTable& terms, const Chain& chain, Scope scope, Plane plane) noexcept;

struct ComponentSet {
  std::array<bool, kComponents> has{};
  [[nodiscard]] constexpr bool contains(Component c) const { return has[index_of(c)]; }
  friend constexpr bool operator==(const ComponentSet&, const ComponentSet&) = default;
};

/// The components that these terms read: exactly what a map for them must hold (or declare zero).
/// A component that only a tool offset levers counts as needed only with `with_tool_offset`.
[[nodiscard]] ComponentSet components_needed(const TermTable& terms, bool with_tool_offset) noexcept;

}  // namespace ecs
