// Which mixtures of white and correlated noise the scatter of repeats leaves possible. Internal (Eigen).
// Does not live here: where the scatter comes from (noise.cpp).
#pragma once

#include <vector>

#include "model/fit/noise.hpp"

namespace ecs::model {

/// Mean of squares without those beyond twenty times the variance that their median shows; 0 for none.
[[nodiscard]] double robust_mean_square(const std::vector<double>& squares);

/// Shapes of noise on a grid with their likelihoods (restricted maximum likelihood over all passes together).
/// @param deviation    per reading, kNotMeasured where there is none
/// @param information  independent deviations per deviation
[[nodiscard]] std::vector<NoiseShape> likely_shapes(const Observations& data, const std::vector<NoiseGroup>& groups,
                                                    const std::vector<double>& deviation, double information);

}  // namespace ecs::model
