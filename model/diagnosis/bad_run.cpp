// A shift of mean in one block: the mean-shift outlier model (Cook and Weisberg 1982, 2.2) with a run in place of a
// reading, priced by Schwarz's criterion (1978).
#include "model/diagnosis/bad_run.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "model/effects/definition.hpp"

namespace ecs::model {
namespace {

constexpr std::size_t kFewestRuns = 3;
/// 2 ln 100: an effect that explains a run better by this is more than the run (docs/physics.md, limits of effects).
constexpr double kBetterByHundred = 9.21;
/// Runs beyond which there is no single bad one to look for.
constexpr std::size_t kMostRunsCompared = 60;

}  // namespace

std::optional<RunOffset> best_run_offset(const Observations& data, const Whitener& whitener, const Space& space) {
  const std::set<int> runs(data.run.begin(), data.run.end());
  const std::set<Sense> senses(data.sense.begin(), data.sense.end());
  if (runs.size() < kFewestRuns || runs.size() > kMostRunsCompared) return std::nullopt;
  std::optional<RunOffset> best;
  const double price =
      std::log(static_cast<double>(data.size())) + 2.0 * std::log(static_cast<double>(runs.size() * senses.size()));
  for (const Sense sense : senses)
    for (const int run : runs) {
      Eigen::MatrixXd column = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), 1);
      for (std::size_t k = 0; k < data.size(); ++k)
        if (data.run[k] == run && data.sense[k] == sense) column(static_cast<Eigen::Index>(k), 0) = 1.0;
      Space more = space;
      absorb(more, whitener(column));
      const double gain = space.chi2() - more.chi2();
      if (!best || gain > best->gain) best = RunOffset{run, sense, gain, gain - price};
    }
  return best;
}

bool run_comes_first(const RunOffset& run, const EffectInstance& effect, double score) {
  // people set feed and load run by run: that these coincide with runs is no fault
  const EffectDefinition& definition = effect.definition();
  if (definition.has_need(Need::feed) || definition.has_need(Need::load) || definition.place == Place::map)
    return false;
  return run.score > 0.0 && run.score + kBetterByHundred >= score;
}

}  // namespace ecs::model
