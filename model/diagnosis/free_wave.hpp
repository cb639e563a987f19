// A wave whose phase is another in every pass: no effect of the library, and no noise. Internal to model/ (Eigen).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "model/data/observations.hpp"

namespace ecs::model {

struct FreeWave {
  double period_mm = 0.0;
  double minus_log_p = 0.0;  ///< base 10, for having been sought among all frequencies
};
/// The strongest wave along the moving axis whose phase and size differ from pass to pass; nothing where noise shows
/// one as strong in one of a million sets.
/// @param residual  whitened, with everything found absorbed  @param left_out  outliers, not counted
[[nodiscard]] std::optional<FreeWave> free_wave(const Observations& data, const Eigen::VectorXd& residual,
                                                const std::vector<bool>& left_out);

}  // namespace ecs::model
