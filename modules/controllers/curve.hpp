// A component as a control holds it: points joined by straight lines, both approaches on the same positions, few
// enough to fit. What is left of a machine's error once a control adds what it adds: along the measurement lines and
// over the volume. Does not live here: the files of the controls (format.hpp), where the error is known from (a map, or
// a model).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "laser/map/error_map.hpp"
#include "modules/controllers/tables.hpp"

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

/// With this many digits; no sign before a zero.
[[nodiscard]] std::string fixed_text(double value, int digits);

/// Largest and root mean square of |residual| along X, Y, Z and of the vector, um.
struct ResidualSize {
  std::array<double, kAxes + 1> largest_um{};
  std::array<double, kAxes + 1> rms_um{};
};

/// One set of places, the error there, and what is left with each way of compensating.
struct ResidualRow {
  std::string where;  ///< "line of X", "volume"
  std::size_t places = 0;
  ResidualSize before;   ///< not compensated
  ResidualSize unit;     ///< the whole map in our unit, as its parameters tell it to
  ResidualSize control;  ///< only the exported tables, in the control
};

using commissioning::ErrorsAt;

/// The error that a map says the machine has: minus its compensation, every term of the chain, straight lines between
/// its points. What the map does not hold counts as zero.
[[nodiscard]] ErrorsAt errors_of_map(const ExportSource& source);

/// Places along the line of each axis (201 by each approach, the others parked) and over the volume (11 or 21 on each
/// axis, all axes forward, then all reverse). Every residual is counted from the reference point, mean of both
/// approaches: a constant shift of the machine is in every work offset.
/// @param lines  from which the control levers rotations
[[nodiscard]] Result<std::vector<ResidualRow>> residuals(const ExportSource& source, const ControllerTables& control,
                                                         const MeasurementLines& lines, const ErrorsAt& errors);

}  // namespace ecs::controllers
