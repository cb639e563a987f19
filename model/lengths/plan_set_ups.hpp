// Which set-ups, each whole: lines of an interferometer, balls of a ball bar, stations of a tracker to try together.
// Does not live here: single paths of a tracker (plan_choice.hpp).
#pragma once

#include <vector>

#include "model/lengths/plan_choice.hpp"

namespace ecs::model {

/// What all paths of a stand, each once in a run, tell of the machine; its last column is the length of a ball bar.
class StandInformation {
 public:
  StandInformation(const PlanTask& task, const PlanStand& stand);
  /// Of so many runs; what belongs to the stand eliminated.
  [[nodiscard]] Eigen::MatrixXd of_runs(int runs) const;
  [[nodiscard]] double minutes() const { return minutes_; }  ///< of a run, without the set-up

 private:
  Eigen::MatrixXd a_run_;  ///< zero eliminated
  double scale_precision_ = 0.0;
  double minutes_ = 0.0;
};

/// Information before anything is measured: of the machine, and the length of a ball bar. `free`: orthonormal
/// directions that no length shows, which are to count as known.
[[nodiscard]] Eigen::MatrixXd first_information(const PlanTask& task, const Eigen::MatrixXd& free);
/// Directions that are not determined by all of these together.
[[nodiscard]] Eigen::MatrixXd directions_left_free(const Eigen::MatrixXd& information, const Eigen::MatrixXd& first);
[[nodiscard]] double mean_square_of(const PlanTask& task, const Eigen::MatrixXd& information);

/// The fewest minutes, set-up by set-up. @param free  as in first_information
[[nodiscard]] PlanChoice chosen_set_ups(const PlanTask& task, const std::vector<PlanStand>& stands,
                                        const std::vector<StandInformation>& known, const Eigen::MatrixXd& free);

}  // namespace ecs::model
