// Helpers for the values at which effects try their searched parameter.
#pragma once

#include <utility>
#include <vector>

#include "model/effects/definition.hpp"

namespace ecs::model {

/// `count` values from least to greatest, each by the same factor above the one before.
[[nodiscard]] std::vector<double> logarithmic(double least, double greatest, std::size_t count);

/// The different positions of an axis in the readings on which an effect acts, from the datum, ascending [mm].
[[nodiscard]] std::vector<double> acting_positions(const Observations& data, const Acting& acting, Axis axis);

/// Least and greatest of these positions [mm]; 1e300 and -1e300 without readings.
[[nodiscard]] std::pair<double, double> acting_range(const Observations& data, const Acting& acting, Axis axis);

/// Least value above 0 and greatest value of a column in the readings on which an effect acts; both 0 if none is above.
[[nodiscard]] std::pair<double, double> extent_of(const Column& column, const Acting& acting);

/// The values at which an instance is tried: the one that it holds, else those of its definition; 0 where it has no
/// searched parameter.
[[nodiscard]] TriedValues tried_values(const Observations& data, const EffectInstance& effect, const Acting& acting,
                                       const SearchExtent& extent);

}  // namespace ecs::model
