// The decay lengths of reversal spikes where the readings want them, between the lengths that the search tries.
// Does not live here: which spikes there are (diagnosis.cpp), their columns (faults.hpp). Internal to model/ (Eigen).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Dense>

#include "model/circle/faults.hpp"

namespace ecs::model {

/// Columns of spike `which` for a decay: the spike of 1 um and its derivative by the logarithm of the decay.
using SpikeColumns = std::function<Eigen::MatrixXd(std::size_t which, double decay_mm)>;

/// The decays with the least squares of what is left, beside other columns of any size: Gauss-Newton on the logarithms
/// of all decays at once. What the readings put at a limit stays there.
/// @param start_mm  one decay for each spike, within the limits
[[nodiscard]] std::vector<double> best_decays(const Eigen::VectorXd& deviation, const Eigen::MatrixXd& others,
                                              const SpikeColumns& columns, std::vector<double> start_mm,
                                              const DecayLimits& limits);

}  // namespace ecs::model
