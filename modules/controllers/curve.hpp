// A component as a control holds it: points joined by straight lines, both approaches on the same positions, few
// enough to fit. Does not live here: the files of the controls (linuxcnc.hpp and others), what is left over
// (residual.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "laser/map/error_map.hpp"

namespace ecs::controllers {

/// Compensation of one component, um (um/m for rotations); linear between, the end values hold beyond the ends.
struct ControlCurve {
  std::vector<double> position_mm;  ///< strictly ascending, machine coordinates of the moving axis
  std::vector<double> forward;      ///< as many
  std::vector<double> reverse;      ///< as many
  friend bool operator==(const ControlCurve&, const ControlCurve&) = default;
};

[[nodiscard]] double value_at(const ControlCurve& curve, Approach approach, double position_mm);
/// Mean of both approaches.
[[nodiscard]] double mean_at(const ControlCurve& curve, double position_mm);

/// Both tables of a component on all their positions. Nothing if the map lacks the component or one of its approaches.
[[nodiscard]] std::optional<ControlCurve> curve_of(const laser::ErrorMap& map, Component component);

/// The curve sampled at other positions.
[[nodiscard]] ControlCurve resampled(const ControlCurve& curve, std::vector<double> position_mm);

/// At most `most` points of the curve, both ends among them, chosen so that the lines between them miss the others by
/// as little as any choice does (curves above 5000 points: nearly as little). @pre most >= 2
[[nodiscard]] ControlCurve thinned(const ControlCurve& curve, std::size_t most);

/// An even grid.
struct EvenGrid {
  double first_mm = 0.0;  ///< a whole number of nanometres
  double step_mm = 0.0;   ///< above 0; a whole number of nanometres
  std::size_t points = 0;
  [[nodiscard]] std::vector<double> positions() const;
};
/// The even grid of at most `most` points that follows the curve best: the curve's own where that is even and fits,
/// else the best of those that divide it and of the finest. It reaches both ends. @pre most >= 2, two points in the
/// curve
[[nodiscard]] EvenGrid even_grid(const ControlCurve& curve, std::size_t most);

/// Largest difference between a curve as a control joins it and what the unit puts out for the same component of the
/// map, either approach. @param map  holds the component for both approaches
[[nodiscard]] double deviation_from_unit(const ControlCurve& written, const laser::ErrorMap& map, Component component,
                                         Interpolation interpolation);

/// Largest value of either side, by size.
[[nodiscard]] double largest_in(const ControlCurve& curve);
/// Largest difference of the two approaches.
[[nodiscard]] double largest_reversal(const ControlCurve& curve);

/// Both approaches as their mean.
[[nodiscard]] ControlCurve mean_of(const ControlCurve& curve);

/// The curve as a file holds it; of points that fall together there the first. @param place, value  as written there
template <class Place, class Value>
[[nodiscard]] ControlCurve as_in_file(const ControlCurve& curve, Place place, Value value) {
  ControlCurve out;
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
    const double at = place(curve.position_mm[i]);
    if (!out.position_mm.empty() && at <= out.position_mm.back()) continue;
    out.position_mm.push_back(at);
    out.forward.push_back(value(curve.forward[i]));
    out.reverse.push_back(value(curve.reverse[i]));
  }
  return out;
}

/// With so many digits; no sign before a zero.
[[nodiscard]] std::string fixed_text(double value, int digits);

}  // namespace ecs::controllers
