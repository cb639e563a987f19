// Standard deviations by profile likelihood, where the curvature at the best value misleads. Internal to model/
// (Eigen).
#pragma once

#include <optional>

#include "model/fit/assembly.hpp"
#include "model/fit/core.hpp"

namespace ecs::model {

struct ProfileSigma {
  double searched = 0.0;  ///< of the searched parameter
  Eigen::VectorXd sizes;  ///< of the slot's fitted columns
};

/// A third of the longer way on which χ² rises by 9, all else fitted again (other searched parameters linearly); of the
/// sizes a third of what they change on it. Nothing for periods (their peaks are listed one by one), user formulas,
/// places, and more readings than a profile is worth.
/// @param sigma  by the curvature, where the search for the way begins
[[nodiscard]] std::optional<ProfileSigma> profile_sigma(const Assembly& assembly, const Regressors& regressors,
                                                        const CoreFit& core, std::size_t slot, double sigma);

}  // namespace ecs::model
