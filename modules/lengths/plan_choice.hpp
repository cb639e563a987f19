// The paths among which a plan of lengths chooses: lines through the volume, circles and arcs of a ball bar, and where
// the instrument may stand. Which paths at which set-ups: the fewest minutes for a wanted mean variance of the error
// vector over the volume. Paths are added by what they take off it for a minute (greedy A-optimal design: V. V.
// Fedorov, Theory of Optimal Experiments, 1972; G. L. Nemhauser, L. A. Wolsey, M. L. Fisher, Math. Programming 14
// (1978) 265), looked at lazily (M. Minoux 1978); those not needed are taken out, and those worth least are exchanged
// (Fedorov 1972). Which set-ups, each whole: lines of an interferometer, balls of a ball bar, stations of a tracker to
// try together. Does not live here: which stations to try together (plan_lengths.cpp).
#pragma once

#include <vector>

#include "modules/lengths/curves.hpp"
#include "modules/lengths/plan_lengths.hpp"

namespace ecs::model {

/// One path of the tool, there and back.
struct PlanPath {
  std::vector<LengthReading> readings;  ///< of which set-up and tool: the stand's
  double minutes = 0.0;
  bool in_bundle = false;  ///< of the first paths at a new set-up
};

/// Edges of the volume, lines through the middle of its faces and its own, diagonals of faces and body, skew lines.
[[nodiscard]] std::vector<PlanPath> plan_lines(const MachineCurves& curves, const LengthPlanSettings& settings);

/// About the ball of a ball bar, by a tool without offset: circles about the vertical and arcs over it, each there and
/// back, that lie within the travel; the ball's post keeps the tool above `settings.bar_lowest_deg`.
[[nodiscard]] std::vector<PlanPath> plan_arcs(const MachineCurves& curves, const LengthPlanSettings& settings,
                                              const Vector3& centre_mm);

/// Stations as given, else around and below the volume; of a ball bar, centres within it, for a tool without offset.
[[nodiscard]] std::vector<Vector3> plan_stations(const LengthMachine& machine, const LengthPlanSettings& settings);

[[nodiscard]] double distance_mm(const Vector3& a, const Vector3& b);

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

/// What all paths of a stand, each once in a run, tell of the machine; its last column is the length of a ball bar.
class StandInformation {
 public:
  StandInformation(const PlanTask& task, const PlanStand& stand);
  /// Of this many runs; what belongs to the stand eliminated.
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
