// A shift of mean in one block: the mean-shift outlier model (Cook and Weisberg 1982, 2.2) with a run in place of a
// reading, priced by Schwarz's criterion (1978); scatter compared by mean absolute deviations (Levene 1960; Brown and
// Forsythe 1974), the variances of which need not be the same (Welch 1947).
#include "model/diagnosis/bad_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "model/effects/definition.hpp"

namespace ecs::model {
namespace {

constexpr std::size_t kFewestRuns = 3;
/// 2 ln 100: an effect that explains a run better by this is more than the run (docs/physics.md, limits of effects).
constexpr double kBetterByHundred = 9.21;
/// A run scatters more than the others where its mean absolute residual is larger by this factor, and by so many
/// standard deviations of the difference: 3e-6 of runs on one side. Fewer readings a run tell nothing of its scatter.
constexpr double kNoisier = 1.5, kFarSigmas = 4.5, kFewestInRun = 8.0;
/// Runs beyond which there is no single bad one to look for.
constexpr std::size_t kMostRunsCompared = 60;

}  // namespace

std::optional<RunOffset> best_run_offset(const Observations& data, const Whitener& whitener, const Space& space) {
  std::map<Sense, std::set<int>> runs_of;
  for (std::size_t k = 0; k < data.size(); ++k) runs_of[data.sense[k]].insert(data.run[k]);
  std::optional<RunOffset> best;
  const double coefficient = std::log(static_cast<double>(data.size()));
  for (const auto& [sense, runs] : runs_of) {
    if (runs.size() < kFewestRuns || runs.size() > kMostRunsCompared) continue;
    const double choice = 2.0 * std::log(static_cast<double>(runs.size() * runs_of.size()));
    for (const int run : runs) {
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), 2);
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.run[k] == run && data.sense[k] == sense)
          columns.row(static_cast<Eigen::Index>(k)) << 1.0, data.p_mm(k, data.axis[k]);
      for (const Eigen::Index count : {1, 2}) {
        Space more = space;
        absorb(more, whitener(Eigen::MatrixXd(columns.leftCols(count))));
        const double gain = space.chi2() - more.chi2();
        const double score = gain - choice - static_cast<double>(count) * coefficient;
        if (!best || score > best->score) best = RunOffset{run, sense, gain, score};
      }
    }
  }
  return best;
}

namespace {

/// By run: ratio of its mean absolute residual to that of the others, where it is larger by more than chance.
std::map<int, double> noisy_runs(const Observations& data, const Eigen::VectorXd& residual,
                                 const std::vector<bool>& left_out) {
  struct Sums {
    double count = 0.0, sum = 0.0, squares = 0.0;
    [[nodiscard]] double mean() const { return sum / count; }
    [[nodiscard]] double variance_of_mean() const {
      return std::max(0.0, squares / count - mean() * mean()) / std::max(1.0, count - 1.0);
    }
  };
  std::map<int, Sums> runs;
  Sums all;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k]) continue;
    const double size = std::abs(residual(static_cast<Eigen::Index>(k)));
    for (Sums* sums : {&runs[data.run[k]], &all}) {
      sums->count += 1.0;
      sums->sum += size;
      sums->squares += size * size;
    }
  }
  std::map<int, double> noisy;
  if (runs.size() < kFewestRuns) return noisy;
  for (const auto& [run, sums] : runs) {
    const Sums rest{all.count - sums.count, all.sum - sums.sum, all.squares - sums.squares};
    if (sums.count < kFewestInRun || rest.count < kFewestInRun || rest.sum <= 0.0) continue;
    const double ratio = sums.mean() / rest.mean();
    const double sigmas = (sums.mean() - rest.mean()) / std::sqrt(sums.variance_of_mean() + rest.variance_of_mean());
    if (ratio > kNoisier && sigmas > kFarSigmas) noisy[run] = ratio;
  }
  return noisy;
}

}  // namespace

std::optional<NoisyRun> noisy_run(const Observations& data, const Eigen::VectorXd& whitened,
                                  const Eigen::VectorXd& residual, const std::vector<bool>& left_out) {
  const std::map<int, double> by_raw = noisy_runs(data, residual, left_out);
  std::optional<NoisyRun> worst;
  for (const auto& [run, ratio] : noisy_runs(data, whitened, left_out))
    if (by_raw.contains(run) && (!worst || ratio > worst->ratio)) worst = NoisyRun{run, ratio};
  return worst;
}

RunBeside run_beside(const RunOffset& run, const EffectInstance& effect, double score) {
  // people set feed and load run by run: that these coincide with runs is no fault
  const EffectDefinition& definition = effect.definition();
  const bool by_hand = definition.has_need(Need::feed) || definition.has_need(Need::load);
  if (by_hand || definition.place == Place::map || run.score <= 0.0) return RunBeside::worse;
  if (run.score >= score) return RunBeside::as_good;
  return run.score + kBetterByHundred >= score ? RunBeside::nearly_as_good : RunBeside::worse;
}

}  // namespace ecs::model
