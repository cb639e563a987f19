// One bad run: an offset or a slope that the readings of one run share, or a scatter of its own. Internal to model/
// (Eigen).
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/fit/search.hpp"

namespace ecs::model {

struct RunOffset {
  int run = 0;
  Sense sense = Sense::EX;  ///< of readings along a path that of its first axis
  double gain = 0.0;        ///< fall of χ²
  double score = 0.0;       ///< gain less the price of its coefficients and of the choice among runs
  bool has_slope = false;   ///< beside the offset
};

/// "run 3 lies +4.0 um from the other runs on average: an offset of this run explains …": by lines through the readings
/// of its sense, those of the others and its own; a slope that these do not show well is not stated.
/// @param residual  of the model as given, um or um/m, as `unit` says  @param left_out  outliers
[[nodiscard]] std::string words_for(const RunOffset& of, const Observations& data, const Eigen::VectorXd& residual,
                                    const std::vector<bool>& left_out, std::string_view unit);

/// The best offset of one run in one sense, or offset and slope along the axis, beyond what `space` absorbs; nothing
/// where the other runs disagree among themselves by as much.
/// @param fewest  nothing with fewer runs: with two, one effect is as likely as a run
[[nodiscard]] std::optional<RunOffset> best_run_offset(const Observations& data, const Whitener& whitener,
                                                       const Space& space, std::size_t fewest = 3);

/// A target of one line at which all readings, or those of one approach, are off.
struct TargetOffset {
  double along = 0.0;     ///< where it is along the line
  std::string_view unit;  ///< of `along`
  double score = 0.0;     ///< fall of χ² less the price of one coefficient and of the choice among targets
};
/// The best one beyond what `space` absorbs; nothing where there are too many targets to be compared.
[[nodiscard]] std::optional<TargetOffset> best_target_offset(const Observations& data, const Whitener& whitener,
                                                             const Space& space);

/// A run, or its pass of one line and approach, that stands off the others.
struct OddPass {
  int run = 0;
  double off_um = 0.0;  ///< mean residual less that of the others, um or um/m
};
/// The run of three or more, if any, whose mean lies farther from those of the others than these from each other (where
/// they agree: than the scatter inside runs allows) by chance (Grubbs 1969). @param residual  um or um/m
/// @param left_out  outliers, not counted
[[nodiscard]] std::optional<OddPass> run_apart(const Observations& data, const Eigen::VectorXd& residual,
                                               const std::vector<bool>& left_out);

struct NoisyRun {
  int run = 0;
  double ratio = 1.0;  ///< of its mean absolute residual to that of the other runs, um
  /// Its mean residual less that of all others, um or um/m, where that is more of it than the scatter about the mean.
  std::optional<double> off_um{};
};
/// "run 5 scatters 3 times as much as the others", or "run 5 lies apart from the other runs" where it is shifted.
[[nodiscard]] std::string words_for(const NoisyRun& run);
/// The run of three or more that scatters more than the others, far beyond what chance does; one that is shifted only
/// if it is apart (run_apart). Where none does, the one with a burst in a part of it, or with nearly all outliers.
/// Both residuals must show it: whitening may mistake one run, correlated noise the other.
/// @param whitened  with everything found absorbed  @param residual  um or um/m  @param left_out  outliers
[[nodiscard]] std::optional<NoisyRun> noisy_run(const Observations& data, const Eigen::VectorXd& whitened,
                                                const Eigen::VectorXd& residual, const std::vector<bool>& left_out);

/// Factors between units, and of doubled or halved readings.
inline constexpr double kDegree_rad = std::numbers::pi / 180.0;
inline constexpr std::array kUnitFactors{25.4, 1.0 / 25.4, 1000.0, 0.001,       10.0,
                                         0.1,  2.0,        0.5,    kDegree_rad, 1.0 / kDegree_rad};

/// A run in another unit than the others, or with the wrong sign.
struct ScaledRun {
  int run = 0;
  double factor = 1.0;  ///< its readings are this multiple of the others: -1 or of kUnitFactors
};
/// The run of three or more, if any, that repeats the others as well as these each other once it is divided by such a
/// factor, and that lies at least twice as far from them if only its zero may change.
[[nodiscard]] std::optional<ScaledRun> scaled_run(const Observations& data);
/// "The readings of run 3 are 0.001 times those of the other runs, as in mm instead of um"
[[nodiscard]] std::string words_for(const ScaledRun& run, std::string_view unit);

/// A line in another unit than the others of its quantity along its axis, or with the wrong sign.
struct ScaledLine {
  std::size_t first = 0;   ///< row of its first reading
  std::size_t others = 1;  ///< lines that it is compared with; with one, either may be the wrong one
  double factor = 1.0;     ///< its readings are this multiple of the others: -1 or of kUnitFactors
  double left_um = 0.0;    ///< scatter of its readings about this multiple of the others, um or um/m
};
/// The same as scaled_run of a line among those that share its targets. Such a line looks like an angular error that
/// acts through the distance between the lines. Nothing for rotary axes and paths.
[[nodiscard]] std::optional<ScaledLine> scaled_line(const Observations& data);
/// Whether a reading belongs to it.
[[nodiscard]] bool is_on(const Observations& data, const ScaledLine& line, std::size_t k);
/// Pairs of rows at the same target and approach: one of this line, one of another.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> same_targets(const Observations& data,
                                                                            const ScaledLine& line);
/// "The line of EX along X at Y 100, Z 370 (from run 4) reads 25.4 times as much as the other line at the same targets,
/// as in another unit. One of the two is wrong. Check the file before anything else."
[[nodiscard]] std::string words_for(const ScaledLine& line, const Observations& data);

/// All readings of one sense after a run lie higher or lower than those before it: another zero, or a slip.
struct StepOfRuns {
  int before = 0, after = 0;  ///< the runs beside it, in the order of their times
  double height_um = 0.0;     ///< beside a trend over the runs, um or um/m
  double trend_um = 0.0;      ///< change by the trend from the first run to the last, um or um/m
};
/// The step between two runs, beside a trend in time, if it explains a hundred times better than the offset of any one
/// run does; nothing with fewer than four runs, where a trend and a step fit anything.
/// @param residual  um or um/m  @param left_out  outliers, not counted
[[nodiscard]] std::optional<StepOfRuns> step_of_runs(const Observations& data, const Eigen::VectorXd& residual,
                                                     const std::vector<bool>& left_out);

/// How far the last run drifts from its first reading to its last, um or um/m, by a straight line over the time and
/// beyond what the other runs share in each approach, where that is at least as much as it lies off the other runs: a
/// drift that begins late in the day does so, a run with another zero does not. Nothing of any other run, by chance, or
/// without times.
[[nodiscard]] std::optional<double> drift_of_last_run(const Observations& data, const Eigen::VectorXd& residual,
                                                      int run);

/// The pass of one run, if any, that stands off the other passes of its line and approach: its mean is further from
/// those of the other runs, four or more, than these among themselves and the scatter inside them allow by chance.
/// @param residual  um or um/m  @param left_out  outliers, not counted
[[nodiscard]] std::optional<OddPass> odd_pass(const Observations& data, const Eigen::VectorXd& residual,
                                              const std::vector<bool>& left_out);

/// Passes that lie apart from each other by more than their readings scatter: variance components (Searle 1971, 11.1).
struct ScatterOfPasses {
  double between_um = 0.0, within_um = 0.0;  ///< standard deviations, um or um/m
};
/// Of the line and approach whose passes, three or more, lie furthest apart; nothing where chance or the scatter inside
/// the passes is more of it. @param residual  um or um/m  @param left_out  outliers, not counted
[[nodiscard]] std::optional<ScatterOfPasses> scatter_of_passes(const Observations& data,
                                                               const Eigen::VectorXd& residual,
                                                               const std::vector<bool>& left_out);

/// How the offset of a run explains what an effect of this score does: as well or better, then it is the first thought;
/// not worse by a factor of 100 in evidence, then it is mentioned.
enum class RunBeside : std::uint8_t { as_good, nearly_as_good, worse };
[[nodiscard]] RunBeside run_beside(const RunOffset& run, const EffectInstance& effect, double score);

}  // namespace ecs::model
