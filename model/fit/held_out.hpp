// Cross-validation: what columns predict in readings that they were not fitted to. Internal to model/ (Eigen).
// Does not live here: which columns (model/diagnosis/).
#pragma once

#include <Eigen/Core>

#include "model/fit/noise.hpp"

namespace ecs::model {

/// Number of the part (0 … parts − 1) of each reading: whole runs where there are three or more (of a line with fewer,
/// targets), else blocks of neighbouring readings.
struct Parts {
  std::vector<std::size_t> of;
  std::size_t count = 0;
  bool by_run = false;
};
[[nodiscard]] Parts parts_of(const Observations& data);

/// Every fifth target of a line together, so that a prediction has to bridge places it has not seen.
[[nodiscard]] Parts parts_by_target(const Observations& data);
/// Whether every line has enough targets to leave a fifth of them out and bridge them.
[[nodiscard]] bool has_targets_to_leave_out(const Observations& data);

/// Share of what is above noise that columns predict in rows which they were not fitted to, each row weighed by how
/// well the other parts can predict it at all; at most 1, below 0 where they predict worse than nothing. All whitened.
/// @param columns (readings × columns)  @param target  readings, fitted by the columns
/// @param before  the rows without the columns
[[nodiscard]] double cross_validated_part(const Parts& parts, const Eigen::MatrixXd& columns,
                                          const Eigen::VectorXd& target, const Eigen::VectorXd& before);

/// √(mean r²) [unit of the target] over all readings but the outliers, each predicted from the fit to the other parts.
/// @param columns  (readings × columns), not whitened
[[nodiscard]] double held_out_rms(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                  const Parts& parts, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target);

/// Chance that an effect which is not there predicts a slow drift within so many runs that it was not fitted to. The
/// sizes follow from the other runs; a run counts as predicted where its deviations from its own mean, for every
/// channel, become smaller. A drift of one run knows nothing of the others, so either sign of the prediction is as
/// likely (two-sided sign test). 1 where no run shows the effect.
/// @param columns  that the model may take freely  @param effect  one column; both (readings × columns), not whitened
[[nodiscard]] double chance_of_predicted_runs(const Observations& data, const NoiseModel& noise,
                                              const std::vector<bool>& left_out, const Eigen::MatrixXd& columns,
                                              const Eigen::VectorXd& effect, const Eigen::VectorXd& target);

/// Least squares in the whitened space; of columns that depend on each other the sizes of least norm.
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& white, const Eigen::VectorXd& target);
/// The same; columns that correlate beyond 0.995 share a size too, so that they do not cancel each other.
[[nodiscard]] Eigen::VectorXd smallest_sizes(const Eigen::MatrixXd& white, const Eigen::VectorXd& target);

}  // namespace ecs::model
