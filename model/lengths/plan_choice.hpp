// Which paths at which set-ups: the fewest minutes for a wanted mean variance of the error vector over the volume.
// Paths are added by what they take off it for a minute (greedy A-optimal design: V. V. Fedorov, Theory of Optimal
// Experiments, 1972; G. L. Nemhauser, L. A. Wolsey, M. L. Fisher, Math. Programming 14 (1978) 265), looked at lazily
// (M. Minoux 1978); those not needed are taken out, and those worth least are exchanged (Fedorov 1972). Does not live
// here: the candidates (plan_paths.hpp), which stations to try together (plan_lengths.cpp).
#pragma once

#include <vector>

#include "model/lengths/observation.hpp"
#include "model/lengths/plan_paths.hpp"

namespace ecs::model {

/// A set-up with one tool.
struct PlanStand {
  std::size_t set_up = 0, tool = 0;
  const std::vector<PlanPath>* paths = nullptr;
};

/// What is planned for.
struct PlanTask {
  const LengthTest& head;  ///< set-ups and tools; no readings
  const MachineCurves& curves;
  const LengthPlanSettings& settings;
  Eigen::MatrixXd weight;        ///< of the machine's unknowns: mean square = trace(weight · covariance) [um²]
  double mean_square_um2 = 0.0;  ///< wanted
};

/// How often each path of each stand is taken.
struct PlanChoice {
  std::vector<PlanStand> stands;
  std::vector<std::vector<int>> used;  ///< by stand and path
  double minutes = 0.0;
  double set_up_minutes = 0.0;  ///< of these
  double mean_square_um2 = 0.0;
  bool reached = false;
  Eigen::MatrixXd covariance;  ///< of the machine's unknowns
};

inline constexpr int kMostPathRuns = 3;
inline constexpr Eigen::Index kStandColumns = 5;  ///< of a stand: three of the station, zero, scale

/// Whitened rows of a path over the machine's unknowns, then those of the stand.
[[nodiscard]] Eigen::MatrixXd rows_of_path(const PlanTask& task, const PlanStand& stand, const PlanPath& path);
/// Of what belongs to a stand, before anything is measured: 1/variance.
[[nodiscard]] Eigen::VectorXd stand_precision(const PlanTask& task);
/// Of every unknown of the machine before anything is measured, as good as nothing: 1/variance.
[[nodiscard]] double machine_precision();
/// Of set-ups with one tool each or several.
[[nodiscard]] double set_up_minutes(const PlanTask& task, const std::vector<PlanStand>& stands);

/// The fewest minutes at these stations: the first stand of each is opened, other tools where they are worth theirs.
[[nodiscard]] PlanChoice chosen_paths(const PlanTask& task, const std::vector<PlanStand>& stands);

}  // namespace ecs::model
