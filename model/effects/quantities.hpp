// What effects take from a reading: sensors, air, levers, known components, the map that was active; and helpers for
// the values at which they try their searched parameter. Does not live here: what effects make of them (one file each).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/effects/definition.hpp"

namespace ecs::model {

inline constexpr double kReference_degC = 20.0;

/// Temperature of a sensor in reading k [degC]; kNotMeasured where there is none.
[[nodiscard]] double sensor_degC(const Observations& data, std::string_view column, std::size_t k);
/// Temperature that an effect follows, or the difference of its two sensors, late by its lag [degC].
[[nodiscard]] double acting_degC(const ReadingAt& at);
/// The same for every reading. @param lag_s  time constant; 0: at once
[[nodiscard]] std::vector<double> late_degC(const Observations& data, const EffectInstance& effect, double lag_s);
/// What the noise of its sensors leaves unknown of it, as a standard deviation [degC]; empty: nothing.
[[nodiscard]] std::vector<double> unknown_degC(const Observations& data, const EffectInstance& effect, double lag_s);
/// The temperature from which effects of a sensor count, that of the origin [degC].
[[nodiscard]] double reference_degC(const Observations& data, std::string_view column);

/// Speed of the moving axis at the moment of reading k, negative in reverse [mm/min, deg/min]; kNotMeasured where the
/// cell lacks.
[[nodiscard]] double speed_per_min(const Observations& data, std::size_t k);

/// How far the reading channel moves while the axis moves by 1, in readings of a scan; 1 where it is not known.
[[nodiscard]] double reading_slope(const Observations& data, std::size_t k);

/// Refractive index of the air in reading k less that of the air of the origin (20 degC, 1013.25 hPa, 50 %) [1e-6];
/// kNotMeasured where a cell lacks.
[[nodiscard]] double air_deviation_ppm(const Observations& data, std::size_t k);

/// Value of a `[[known]]` component [um, um/m]; kNotMeasured where it is not known.
[[nodiscard]] double known_value(const Observations& data, Component code, double position_mm);

/// Σ sign · lever [m] of the component in reading k; 0 where it does not act.
[[nodiscard]] double lever_m(const Observations& data, std::size_t k, Component code);

/// True where the axis is the one being moved, of readings through a chain any, and its approach is known.
[[nodiscard]] bool is_own_motion(const Observations& data, std::size_t k, Axis axis);

/// The map's compensation in reading k, um (um/m for rotations), of the tables chosen by `effect` (axis, code; all if
/// it names none), with the moving axis shifted by `shift_mm` and the approach taken `as_approach`.
[[nodiscard]] double map_compensation(const Observations& data, std::size_t k, const EffectInstance& effect,
                                      double shift_mm, int as_approach);
/// The same as the unit applied it.
[[nodiscard]] double map_compensation(const ReadingAt& at);

/// Column `reversed`: 1 for an artefact as it was first, -1 turned over (reversed = 1); kNotMeasured where the cell
/// lacks.
[[nodiscard]] double side_of_artefact(const Observations& data, std::size_t k);
[[nodiscard]] double side_of_artefact(const ReadingAt& at);

/// Column `set_up`: 1 or absent where the optics are as in the first readings; another number after they were aligned
/// and reset again.
[[nodiscard]] bool first_set_up(const Observations& data, std::size_t k);

/// `count` values from least to greatest, each by the same factor above the one before.
[[nodiscard]] std::vector<double> logarithmic(double least, double greatest, std::size_t count);

/// The different positions of an axis in the readings on which an effect acts, from the datum, ascending [mm].
[[nodiscard]] std::vector<double> acting_positions(const Observations& data, const Acting& acting, Axis axis);

/// Least and greatest of these positions [mm]; 1e300 and -1e300 without readings.
[[nodiscard]] std::pair<double, double> acting_range(const Observations& data, const Acting& acting, Axis axis);

/// Least value above 0 and greatest value of a column in the readings on which an effect acts; both 0 if none is above.
[[nodiscard]] std::pair<double, double> extent_of(const Column& column, const Acting& acting);

/// Where a time constant is sought: from a fiftieth of the time measured to all of it. Shorter, the start takes less
/// than one of the readings of a session; longer, an exponential is a straight line.
[[nodiscard]] SearchDefinition time_constants();

/// The parameter of effects that follow their sensors late.
inline constexpr std::string_view kLag = "lag_s";
[[nodiscard]] ParameterDefinition lag_parameter();
/// Each of these effects of sensors at once; behind it the same with a lag to be found, if its temperature changes
/// while it is measured.
[[nodiscard]] std::vector<EffectInstance> at_once_and_late(const Site& site,
                                                           const std::vector<EffectInstance>& effects);
/// Its fitted period, place or time constant; nothing where it has none.
[[nodiscard]] std::optional<double> searched_value(const EffectInstance& effect);
/// Its searched parameter is to be found: the instance does not hold it.
[[nodiscard]] bool is_searched(const EffectInstance& effect);
/// A model file says nothing of a parameter with this value.
[[nodiscard]] bool is_left_out(const EffectInstance& effect, std::string_view parameter, double value);
/// Gives the optional parameters that it does not have the values that a model file without them means.
void hold_optional(EffectInstance& effect);

/// The values at which an instance is tried: the one that it holds, else those of its definition; 0 where it has no
/// searched parameter.
[[nodiscard]] TriedValues tried_values(const Observations& data, const EffectInstance& effect, const Acting& acting,
                                       const SearchExtent& extent);

}  // namespace ecs::model
