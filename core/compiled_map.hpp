// The working form of a map: made once when a map becomes active, so that the tick is a straight run through memory.
// Storage is fixed (about 2.7 MB): the owner puts it on the heap or in static memory before the first tick.
#pragma once

#include <array>
#include <cstdint>

#include "core/address_map.hpp"
#include "core/fault.hpp"
#include "core/memory_image.hpp"

namespace ecs {

/// One table for one approach. compensation = cells[i].value + cells[i].slope · place, where
/// place = clamp(position · scale + offset, 0, last) and i = ⌊place⌋: the end values hold beyond the ends.
struct Lookup {
  std::uint32_t first_cell = 0;
  std::uint32_t first_value = 0;  ///< index of value 0 in the image, for the address pointers
};
struct Cell {
  double value = 0.0;
  double slope = 0.0;
};

/// How the rotations of one moving axis act on the tool: E += w ∘ (ε × L), with L = gain · position + constant [m].
struct AngularAction {
  Vector3 lever_gain{};
  Vector3 lever_constant_m{};
  /// Weights of EB·L_Z, EC·L_Y in X; EC·L_X, EA·L_Z in Y; EA·L_Y, EB·L_X in Z. Sign and angular scale are inside.
  std::array<double, 6> weight{};
};

/// One axis as the tick needs it.
struct AxisWorking {
  bool present = false;
  double mm_per_count = 0.001;
  double deadband_mm = 0.0;
  double counts_per_um = 0.0;  ///< D/A counts per um of compensation, polarity inside; 0: axis absent
  double limit_counts = 0.0;
  double slew_counts = 0.0;  ///< per tick
};

/// Index of an approach in per-approach tables.
[[nodiscard]] constexpr std::size_t side_of(Approach approach) noexcept {
  return approach == Approach::forward ? 1 : 0;
}

struct CompiledMap {
  static constexpr std::size_t kSides = 2;
  static constexpr std::size_t kCells = kMostValues + 1;  ///< cell 0 is zero: components without a table point to it

  // [axis][side][sense]: six curves of one axis side by side
  template <class T>
  using PerCurve = std::array<std::array<std::array<T, 6>, kSides>, kAxes>;
  PerCurve<double> place_per_mm{};
  PerCurve<double> place_offset{};
  PerCurve<double> last_place{};
  PerCurve<Lookup> lookup{};
  PerAxis<AngularAction> angular{};
  PerAxis<Vector3> squareness_um_per_mm{};  ///< [observed][lever]
  PerAxis<Vector3> translation_weight{};    ///< [observed][moving]: 1 where the scope uses the curve, else 0
  PerAxis<AxisWorking> axes{};
  double period_s = 0.001;
  std::array<Cell, kCells> cells{};
};

struct CompileVerdict {
  Fault fault = Fault::none;           ///< none, bad_parameters or map_not_for_parameters
  Component missing = Component::EXX;  ///< the first component that is needed and not there
};

/// Builds the working form of a sound image (check_image found no fault) with the parameters it carries.
/// Refuses a map that lacks a component the scope and chain need and that is not declared zero; squareness comes from
/// the parameters. On refusal `map` must not be used.
[[nodiscard]] CompileVerdict compile(const ImageView& image, CompiledMap& map) noexcept;

}  // namespace ecs
