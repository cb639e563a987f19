// A shift of mean in one block: the mean-shift outlier model (Cook and Weisberg 1982, 2.2) with a run in place of a
// reading, priced by Schwarz's criterion (1978), apart from the others by Grubbs's test (1969); scatter compared by
// roots of absolute deviations (Levene 1960; of normal noise they are nearly normal: Hawkins 1981), passes by Welch's
// t (1947).
#include "model/diagnosis/bad_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "model/effects/definition.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

constexpr std::size_t kFewestRuns = 3;
/// 2 ln 100: an effect that explains a run better by this is more than the run (docs/model.md, "When no cause").
constexpr double kBetterByHundred = 9.21;
/// A run scatters more than the others where it does so by this factor, and the mean root of its absolute residuals is
/// larger by this many standard deviations of the difference: 3e-6 of runs of independent normal noise. Fewer readings
/// tell nothing of scatter.
constexpr double kNoisier = 1.5, kFarSigmas = 4.5, kFewestInRun = 8.0;
/// Passes of a line and approach from which one can be odd, readings in each, and the chance at which it is: one in
/// a million, since it denies that noise explains everything.
constexpr std::size_t kFewestPasses = 5, kFewestInPass = 4;
/// That show by how much they scatter: two say too little.
constexpr std::size_t kFewestThatScatter = 3;
constexpr double kOddChance = 1e-6;
/// Means of passes vary no more than readings inside them where the ratio of variances is below this: then these count.
constexpr double kSameScatter = 3.0;
/// A run is apart from others that disagree where chance puts it so far from them once in a hundred sets.
constexpr double kApartChance = 0.01;
/// Runs beyond which there is no single bad one to look for.
constexpr std::size_t kMostRunsCompared = 60;
/// Passes differ where chance does it once in a thousand lines, and where they do so more than readings inside them; so
/// often chance puts so many outliers into one run.
constexpr double kDifferChance = 1e-3;

struct Pass {
  int run = 0;
  std::vector<double> values;
  double mean = 0.0, squares = 0.0;  ///< Σ(value − mean)²
};
using Passes = std::map<std::size_t, Pass>;

/// Of each line and approach with so many of them.
std::vector<Passes> passes_of_lines(const Observations& data, const Eigen::VectorXd& residual,
                                    const std::vector<bool>& left_out, std::size_t fewest) {
  std::map<std::tuple<Channel, Axis, int>, Passes> lines;
  const std::vector<std::size_t> number = passes_of(data);
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k]) continue;
    Pass& pass = lines[{data.channel(k), data.axis[k], data.approach[k]}][number[k]];
    pass.run = data.run[k];
    pass.values.push_back(residual(static_cast<Eigen::Index>(k)));
  }
  std::vector<Passes> enough;
  for (auto& [line, passes] : lines) {
    std::erase_if(passes, [](const auto& each) { return each.second.values.size() < kFewestInPass; });
    if (passes.size() < fewest) continue;
    for (auto& [number_of_pass, pass] : passes) {
      for (const double v : pass.values) pass.mean += v / static_cast<double>(pass.values.size());
      for (const double v : pass.values) pass.squares += (v - pass.mean) * (v - pass.mean);
    }
    enough.push_back(std::move(passes));
  }
  return enough;
}

/// Offset of one run of a channel, and slope along its axis.
Eigen::MatrixXd columns_of_run(const Observations& data, Channel channel, int run) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), 2);
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.run[k] == run && data.channel(k) == channel)
      columns.row(static_cast<Eigen::Index>(k)) << 1.0, data.along_of(k);
  return columns;
}

double gain_of(const Space& space, const Eigen::MatrixXd& white) {
  Space more = space;
  absorb(more, white);
  return space.chi2() - more.chi2();
}

/// Whether the other runs agree, or this one is further from them than they are from each other (Grubbs 1969): where
/// each run has a zero of its own, the one that is furthest off is no bad run.
/// @param count  columns of the run that explain `gain`
bool is_apart(const Observations& data, const Whitener& whitener, const Space& space, Channel channel,
              const std::set<int>& runs, int run, Eigen::Index count, double gain) {
  Space beside = space;
  absorb(beside, whitener(Eigen::MatrixXd(columns_of_run(data, channel, run).leftCols(count))));
  const double left = beside.chi2();
  const Eigen::Index taken = beside.q.cols();
  for (const int other : runs)
    if (other != run) absorb(beside, whitener(Eigen::MatrixXd(columns_of_run(data, channel, other).leftCols(1))));
  // what the model and other effects take of the differences between runs shows no agreement
  const auto freedom = static_cast<double>(count), others = static_cast<double>(beside.q.cols() - taken);
  if (others < 1.0) return false;
  const double between = left - beside.chi2();
  if (ln_chi2_tail(between, others) > std::log(kOddChance)) return true;
  return ln_f_tail(gain / freedom / (between / others), freedom, others) + std::log(static_cast<double>(runs.size())) <
         std::log(kApartChance);
}

}  // namespace

std::optional<RunOffset> best_run_offset(const Observations& data, const Whitener& whitener, const Space& space,
                                         std::size_t fewest) {
  std::map<Channel, std::set<int>> runs_of;
  std::map<Channel, Sense> sense_of;
  for (std::size_t k = 0; k < data.size(); ++k) {
    runs_of[data.channel(k)].insert(data.run[k]);
    sense_of.try_emplace(data.channel(k), data.sense[k]);
  }
  std::optional<RunOffset> best;
  Channel channel_of_best = 0;
  const double coefficient = std::log(static_cast<double>(data.size()));
  for (const auto& [channel, runs] : runs_of) {
    if (runs.size() < fewest || runs.size() > kMostRunsCompared) continue;
    const double choice = 2.0 * std::log(static_cast<double>(runs.size() * runs_of.size()));
    for (const int run : runs) {
      const Eigen::MatrixXd columns = columns_of_run(data, channel, run);
      for (const Eigen::Index count : {1, 2}) {
        const double gain = gain_of(space, whitener(Eigen::MatrixXd(columns.leftCols(count))));
        const double score = gain - choice - static_cast<double>(count) * coefficient;
        if (best && score <= best->score) continue;
        best = RunOffset{run, sense_of.at(channel), gain, score, count == 2};
        channel_of_best = channel;
      }
    }
  }
  if (best && best->score > 0.0 && runs_of.at(channel_of_best).size() > 2 &&
      !is_apart(data, whitener, space, channel_of_best, runs_of.at(channel_of_best), best->run, best->has_slope ? 2 : 1,
                best->gain))
    return std::nullopt;
  return best;
}

std::string words_for(const RunOffset& of, const Observations& data, const Eigen::VectorXd& residual,
                      const std::vector<bool>& left_out, std::string_view unit) {
  constexpr double kFreedom = 4.0, kShown = 3.0;  // standard deviations
  std::vector<std::size_t> rows;
  std::vector<double> own_mm;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.sense[k] != of.sense || left_out[k]) continue;
    rows.push_back(k);
    if (data.run[k] == of.run) own_mm.push_back(data.along_of(k));
  }
  const Eigen::Map<const Eigen::VectorXd> places(own_mm.data(), static_cast<Eigen::Index>(own_mm.size()));
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(rows.size()), 4);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double along = data.along_of(rows[i]) - places.mean(), own = data.run[rows[i]] == of.run ? 1.0 : 0.0;
    columns.row(static_cast<Eigen::Index>(i)) << 1.0, along, own, own * along;
  }
  const Eigen::VectorXd y = residual(rows), sizes = least_squares(columns, y), slope = columns.col(3);
  const Eigen::MatrixXd others = columns.leftCols(3);
  const double variance =
      (y - columns * sizes).squaredNorm() / std::max(1.0, static_cast<double>(rows.size()) - kFreedom);
  const double seen = (slope - others * least_squares(others, slope)).squaredNorm();
  const std::string_view name =
      std::set(data.run.begin(), data.run.end()).size() > 2 ? "the other runs" : "the other run";
  const std::string changes = of.has_slope && sizes(3) * sizes(3) * seen > kShown * kShown * variance
                                  ? fmt::format("changes by {:+.3g} {} along its line compared with {}, and ",
                                                sizes(3) * (places.maxCoeff() - places.minCoeff()), unit, name)
                                  : "";
  return fmt::format("run {} {}lies {:+.3g} {} from {} on average: {} of this run {} as much as any effect does",
                     of.run, changes, sizes(2), unit, changes.empty() ? name : "them",
                     of.has_slope ? "an offset and a slope" : "an offset", of.has_slope ? "explain" : "explains");
}

std::optional<TargetOffset> best_target_offset(const Observations& data, const Whitener& whitener, const Space& space) {
  constexpr std::size_t kMostTargets = 400;
  using Target = std::tuple<Channel, Axis, long long>;
  std::map<Target, std::vector<std::size_t>> targets;
  for (std::size_t k = 0; k < data.size(); ++k)
    targets[{data.channel(k), data.axis[k], std::llround(data.along_of(k) / kSamePlace_mm)}].push_back(k);
  if (targets.size() > kMostTargets) return std::nullopt;
  constexpr int kBoth = 0;
  const double price =
      std::log(static_cast<double>(data.size())) + 2.0 * std::log(3.0 * static_cast<double>(targets.size()));
  std::optional<TargetOffset> best;
  for (const auto& [target, rows] : targets)
    for (const int approach : {kBoth, 1, -1}) {
      Eigen::VectorXd column = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.size()));
      for (const std::size_t k : rows)
        if (approach == kBoth || data.approach[k] == approach) column(static_cast<Eigen::Index>(k)) = 1.0;
      const double score = gain_of(space, whitener(Eigen::MatrixXd(column))) - price;
      if (!best || score > best->score)
        best = TargetOffset{data.along_of(rows.front()), data.unit_along(rows.front()), score};
    }
  return best;
}

namespace {

/// Of the residuals of a run.
struct Sums {
  double count = 0.0, sum = 0.0, squares = 0.0;
  double sizes = 0.0, roots = 0.0;  ///< of absolute values, and of their roots
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double inside() const { return squares - sum * mean(); }  ///< squares about the mean
  [[nodiscard]] double mean_size() const { return sizes / count; }
  [[nodiscard]] double mean_root() const { return roots / count; }
  void add(double r) { *this = plus({1.0, r, r * r, std::abs(r), std::sqrt(std::abs(r))}); }
  [[nodiscard]] Sums plus(const Sums& o, double times = 1.0) const {
    return {count + times * o.count, sum + times * o.sum, squares + times * o.squares, sizes + times * o.sizes,
            roots + times * o.roots};
  }
  [[nodiscard]] Sums without(const Sums& o) const { return plus(o, -1.0); }
};
struct SumsOfRuns {
  std::map<int, Sums> runs;
  Sums all;
};
/// Of the readings for which that holds.
template <class Counts>
SumsOfRuns sums_of_runs(const Observations& data, const Eigen::VectorXd& residual, Counts counts) {
  SumsOfRuns sums;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (counts(k)) sums.runs[data.run[k]].add(residual(static_cast<Eigen::Index>(k)));
  for (const auto& [run, of_run] : sums.runs) sums.all = sums.all.plus(of_run);
  return sums;
}
SumsOfRuns sums_of_kept(const Observations& data, const Eigen::VectorXd& residual, const std::vector<bool>& left_out) {
  return sums_of_runs(data, residual, [&](std::size_t k) { return !left_out[k]; });
}
SumsOfRuns sums_of_all(const Observations& data, const Eigen::VectorXd& residual) {
  return sums_of_runs(data, residual, [](std::size_t) { return true; });
}

/// How many times as much a run scatters as the others.
NoisyRun noisy(int run, const Sums& sums, const Sums& all) {
  return {run, sums.mean_size() / std::max(all.without(sums).mean_size(), kLeastDivisor)};
}

/// By run: ratio of its mean absolute residual to that of the others, where it is larger by more than chance.
std::map<int, double> noisy_runs(const Observations& data, const Eigen::VectorXd& residual,
                                 const std::vector<bool>& left_out) {
  const auto [runs, all] = sums_of_kept(data, residual, left_out);
  std::map<int, double> noisy;
  if (runs.size() < kFewestRuns) return noisy;
  for (const auto& [run, sums] : runs) {
    const Sums rest = all.without(sums);
    if (sums.count < kFewestInRun || rest.count < kFewestInRun || rest.sizes <= 0.0) continue;
    const double inside = all.sizes - sums.roots * sums.mean_root() - rest.roots * rest.mean_root();
    const double variance = inside / (all.count - 2.0) * (1.0 / sums.count + 1.0 / rest.count);
    const double ratio = sums.mean_size() / rest.mean_size(), off = sums.mean_root() - rest.mean_root();
    if (ratio > kNoisier && off > kFarSigmas * std::sqrt(variance)) noisy[run] = ratio;
  }
  return noisy;
}

}  // namespace

std::optional<OddPass> run_apart(const Observations& data, const Eigen::VectorXd& residual,
                                 const std::vector<bool>& left_out) {
  const auto [runs, all] = sums_of_kept(data, residual, left_out);
  if (runs.size() < kFewestRuns) return std::nullopt;
  double inside = 0.0;
  for (const auto& [run, sums] : runs) inside += sums.inside();
  const double number = static_cast<double>(runs.size()), freedom = all.count - number, others = number - 2.0;
  if (freedom < 1.0) return std::nullopt;
  std::optional<OddPass> apart;
  double least = std::log(kApartChance / number);
  for (const auto& [run, sums] : runs) {
    const Sums rest = all.without(sums);
    const double off = sums.mean() - rest.mean(), between = rest.inside() - (inside - sums.inside());
    const double gain = off * off * sums.count * rest.count / all.count;
    const double scatter = std::max(inside / freedom, kLeastDivisor);
    const bool differ = ln_f_tail(between / others / scatter, others, freedom) < std::log(kOddChance);
    const double chance = differ ? ln_f_tail(gain / (between / others), 1.0, others)
                                 : ln_f_tail(gain / ((between + inside) / (others + freedom)), 1.0, others + freedom);
    if (chance >= least) continue;
    least = chance;
    apart = {run, off};
  }
  return apart;
}

namespace {

/// The run that has more of the outliers than chance puts into one: a burst, which heavy tails of noise are not.
/// Binomial tail by that of F.
std::optional<NoisyRun> run_of_outliers(const Observations& data, const Eigen::VectorXd& residual,
                                        const std::vector<bool>& left_out) {
  const auto [runs, all] = sums_of_all(data, residual);
  const auto [outliers, all_outliers] = sums_of_runs(data, residual, [&](std::size_t k) { return left_out[k]; });
  if (runs.size() < kFewestRuns || outliers.empty()) return std::nullopt;
  int most = 0;
  double of_most = 0.0, share_of_most = 0.0;
  for (const auto& [run, sums] : outliers)
    if (const double share = sums.count / runs.at(run).count; share > share_of_most) {
      most = run;
      of_most = sums.count;
      share_of_most = share;
    }
  const double share = runs.at(most).count / all.count, others = all_outliers.count - of_most + 1.0;
  const double ln_chance = ln_f_tail((1.0 - share) * of_most / (share * others), 2.0 * others, 2.0 * of_most);
  if (ln_chance + std::log(static_cast<double>(runs.size())) >= std::log(kDifferChance)) return std::nullopt;
  return noisy(most, runs.at(most), all);
}

/// Median size of deviations, as a standard deviation.
double spread(std::vector<double> deviations) {
  for (double& one : deviations) one = std::abs(one);
  return kSigmaPerMad * upper_median(std::move(deviations));
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

/// Whether each reading is far from the median of its repeats, three at least, in robust standard deviations of its
/// kind.
std::vector<bool> far_from_repeats(const Observations& data, const Repeats& repeats, const Eigen::VectorXd& residual) {
  constexpr double kFar = 4.0;
  std::vector<std::vector<double>> values(repeats.nodes);
  for (std::size_t k = 0; k < data.size(); ++k)
    values[repeats.node_of[k]].push_back(residual(static_cast<Eigen::Index>(k)));
  std::vector<double> middle(repeats.nodes, kNotMeasured);
  for (std::size_t node = 0; node < repeats.nodes; ++node)
    if (values[node].size() >= kFewestRuns) middle[node] = median(std::move(values[node]));
  std::map<std::pair<Channel, Axis>, std::vector<double>> deviations;
  std::vector<double> off(data.size(), 0.0);
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (std::isnan(middle[repeats.node_of[k]])) continue;
    off[k] = residual(static_cast<Eigen::Index>(k)) - middle[repeats.node_of[k]];
    if (off[k] != 0.0) deviations[{data.channel(k), data.axis[k]}].push_back(off[k]);  // but the median itself
  }
  std::map<std::pair<Channel, Axis>, double> scales;
  for (const auto& [kind, values_of] : deviations) scales[kind] = spread(values_of);
  std::vector<bool> far(data.size(), false);
  for (std::size_t k = 0; k < data.size(); ++k)
    far[k] = off[k] != 0.0 && std::abs(off[k]) > kFar * scales[{data.channel(k), data.axis[k]}];
  return far;
}

/// The run of a burst: most readings of a short part of one pass are far from those of the other runs at their places,
/// and most of that run are not. Readings with heavy tails are far one by one.
std::optional<NoisyRun> run_of_burst(const Observations& data, const Eigen::VectorXd& whitened,
                                     const Eigen::VectorXd& residual, const std::vector<bool>& left_out) {
  // four of six in a row: two in a million if one in fifty is far
  constexpr std::ptrdiff_t kInARow = 6, kOfThese = 4;
  const Repeats repeats = repeats_of(data);
  const std::vector<bool> far_as_it_is = far_from_repeats(data, repeats, residual);
  const std::vector<bool> far_white = far_from_repeats(data, repeats, whitened);
  const auto [runs, all] = sums_of_all(data, residual);
  if (runs.size() < kFewestRuns) return std::nullopt;
  std::map<int, double> number_of_far;
  std::set<int> with_burst;
  std::map<std::size_t, std::vector<bool>> passes;
  const std::vector<std::size_t> number = passes_of(data);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const bool far = far_as_it_is[k] && (left_out[k] || far_white[k]);
    std::vector<bool>& pass = passes[number[k]];
    pass.push_back(far);
    number_of_far[data.run[k]] += far ? 1.0 : 0.0;
    if (std::count(pass.end() - std::min(kInARow, std::ssize(pass)), pass.end(), true) >= kOfThese)
      with_burst.insert(data.run[k]);
  }
  for (const int run : with_burst)
    if (2.0 * number_of_far.at(run) < runs.at(run).count) return noisy(run, runs.at(run), all);
  return std::nullopt;
}

}  // namespace

std::optional<NoisyRun> noisy_run(const Observations& data, const Eigen::VectorXd& whitened,
                                  const Eigen::VectorXd& residual, const std::vector<bool>& left_out) {
  const std::map<int, double> by_raw = noisy_runs(data, residual, left_out);
  std::optional<NoisyRun> worst;
  double most = 0.0;
  for (const auto& [run, ratio] : noisy_runs(data, whitened, left_out)) {
    if (!by_raw.contains(run) || ratio <= most) continue;
    most = ratio;
    worst = NoisyRun{run, by_raw.at(run)};
  }
  if (!worst) {
    if (const auto burst = run_of_burst(data, whitened, residual, left_out)) return burst;
    return run_of_outliers(data, residual, left_out);
  }
  const Sums own = sums_of_kept(data, residual, left_out).runs.at(worst->run);
  if (2.0 * own.sum * own.sum <= own.count * own.squares) return worst;
  const auto apart = run_apart(data, residual, left_out);
  if (!apart || apart->run != worst->run) return std::nullopt;
  worst->off_um = apart->off_um;
  return worst;
}

std::string words_for(const NoisyRun& run) {
  if (run.off_um) return fmt::format("run {} lies apart from the other runs", run.run);
  return fmt::format("run {} scatters {:.2g} times as much as the others", run.run, run.ratio);
}

namespace {

/// Readings of a place by their group: a run, or a line.
using ByGroup = std::map<int, std::vector<double>>;
/// By place.
template <class Place>
using Places = std::map<Place, ByGroup>;

/// A group beside the medians of the others, at the places of which these have two readings or more.
struct GroupBesideOthers {
  std::vector<double> own, others;
  std::vector<double> among_others;  ///< each reading of the others less the median of the rest of these
};
template <class Place>
GroupBesideOthers beside_others(const Places<Place>& places, int group) {
  GroupBesideOthers beside;
  for (const auto& [place, by_group] : places) {
    const auto own = by_group.find(group);
    if (own == by_group.end()) continue;
    std::vector<double> others;
    for (const auto& [other, readings] : by_group)
      if (other != group) others.insert(others.end(), readings.begin(), readings.end());
    if (others.size() + 1 < kFewestRuns) continue;
    beside.own.push_back(median(own->second));
    beside.others.push_back(median(others));
    for (std::size_t i = 0; i < others.size(); ++i) {
      std::vector<double> rest = others;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      beside.among_others.push_back(others[i] - median(std::move(rest)));
    }
  }
  return beside;
}

struct ScaledGroup {
  int group = 0;
  double factor = 1.0, left = 0.0;
};
/// The group, if any, that repeats the others as well as these each other once it is divided by a factor between units
/// or by -1, and that lies at least twice as far from them if only its zero may change.
template <class Place>
std::optional<ScaledGroup> scaled_group(const Places<Place>& places, const std::set<int>& groups) {
  /// As the others among themselves, with room for chance; a zero alone explains less where it leaves this much more;
  /// and the others must show an error larger than what is left by this, or a run divided by 1000 is as good as 0.
  constexpr double kAsTheOthers = 1.6, kBetterThanZero = 2.0, kShown = 3.0;
  std::optional<ScaledGroup> best;
  double least = 1.0 / kBetterThanZero;
  for (const int group : groups) {
    const GroupBesideOthers beside = beside_others(places, group);
    if (static_cast<double>(beside.own.size()) < kFewestInRun) continue;
    const auto deviations = [&](double factor, double zero) {
      std::vector<double> of;
      for (std::size_t i = 0; i < beside.own.size(); ++i)
        of.push_back(beside.own[i] / factor - beside.others[i] - zero);
      return of;
    };
    const double of_zero = spread(deviations(1.0, upper_median(deviations(1.0, 0.0))));
    const double usual =
        std::min(std::max(kAsTheOthers * spread(beside.among_others), kLeastDivisor), spread(beside.others) / kShown);
    const auto consider = [&](double factor) {
      const double left = spread(deviations(factor, 0.0));
      if (left > usual || left >= least * of_zero) return;
      least = left / of_zero;
      best = {group, factor, left * std::abs(factor)};
    };
    consider(-1.0);
    for (const double factor : kUnitFactors) consider(factor);
  }
  return best;
}

using Line = std::tuple<Channel, Axis, int>;
Line line_of(const Observations& data, std::size_t k) { return {data.channel(k), data.axis[k], data.line[k]}; }

/// The same on all lines of a quantity along an axis.
using Target = std::tuple<Channel, Axis, int, long long>;
Target target_of(const Observations& data, std::size_t k) {
  return {data.channel(k), data.axis[k], data.approach[k], std::llround(data.along_of(k) / kSamePlace_mm)};
}

std::string_view why_scaled(double factor, std::string_view unit) {
  return factor == -1.0                    ? ", as with the wrong sign"
         : factor == 0.001 && unit == "um" ? ", as in mm instead of um"
                                           : ", as in another unit";
}

}  // namespace

std::optional<ScaledRun> scaled_run(const Observations& data) {
  const Repeats repeats = repeats_of(data);
  Places<std::size_t> places;
  std::set<int> runs;
  for (std::size_t k = 0; k < data.size(); ++k) {
    places[repeats.node_of[k]][data.run[k]].push_back(data.reading[k] + data.of_map_in(k));
    runs.insert(data.run[k]);
  }
  if (runs.size() < kFewestRuns || runs.size() > kMostRunsCompared) return std::nullopt;
  const auto scaled = scaled_group(places, runs);
  return scaled ? std::optional(ScaledRun{scaled->group, scaled->factor}) : std::nullopt;
}

std::optional<ScaledLine> scaled_line(const Observations& data) {
  if (data.line.empty() || data.rotary || !data.paths.empty()) return std::nullopt;
  std::map<Line, std::size_t> first_of;
  for (std::size_t k = 0; k < data.size(); ++k) first_of.try_emplace(line_of(data, k), k);
  if (first_of.size() < 2 || first_of.size() > kMostRunsCompared) return std::nullopt;
  Places<Target> places;
  std::set<int> groups;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const int group = static_cast<int>(first_of.at(line_of(data, k)));
    groups.insert(group);
    places[target_of(data, k)][group].push_back(data.reading[k] + data.of_map_in(k));
  }
  const auto scaled = scaled_group(places, groups);
  if (!scaled) return std::nullopt;
  ScaledLine found{static_cast<std::size_t>(scaled->group), 0, scaled->factor, scaled->left};
  for (const auto& [line, first] : first_of)
    if (first != found.first && data.channel(first) == data.channel(found.first) &&
        data.axis[first] == data.axis[found.first])
      ++found.others;
  return found;
}

bool is_on(const Observations& data, const ScaledLine& line, std::size_t k) {
  return line_of(data, k) == line_of(data, line.first);
}

std::vector<std::pair<std::size_t, std::size_t>> same_targets(const Observations& data, const ScaledLine& line) {
  std::map<Target, std::size_t> of_others;
  const Line own = line_of(data, line.first);
  for (std::size_t k = 0; k < data.size(); ++k)
    if (line_of(data, k) != own) of_others.try_emplace(target_of(data, k), k);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (line_of(data, k) == own)
      if (const auto other = of_others.find(target_of(data, k)); other != of_others.end())
        pairs.emplace_back(k, other->second);
  return pairs;
}

std::string words_for(const ScaledRun& run, std::string_view unit) {
  return fmt::format("The readings of run {} are {:.4g} times those of the other runs{}", run.run, run.factor,
                     why_scaled(run.factor, unit));
}

std::string words_for(const ScaledLine& line, const Observations& data) {
  std::string where;
  for (const Axis a : {Axis::X, Axis::Y, Axis::Z})
    if (a != data.axis[line.first])
      where += fmt::format("{}{} {:.5g}", where.empty() ? " at " : ", ", letter_of(a),
                           data.position_mm[line.first][index_of(a)]);
  if (const auto set_up = data.extras.find("set_up"); set_up != data.extras.end())
    where += fmt::format(", set-up {:.5g}", set_up->second[line.first]);
  return fmt::format(
      "The line of {} along {}{} (from run {}) reads {:.4g} times as much as the other line{} at the same targets{}.{} "
      "Check the file before anything else.",
      name_of(data.sense[line.first]), letter_of(data.axis[line.first]), where, data.run[line.first], line.factor,
      line.others > 1 ? "s" : "", why_scaled(line.factor, data.reading_unit()),
      line.others > 1 ? "" : " One of the two is wrong.");
}

std::optional<StepOfRuns> step_of_runs(const Observations& data, const Eigen::VectorXd& residual,
                                       const std::vector<bool>& left_out) {
  constexpr std::size_t kFewestRunsOfStep = 4;
  struct Run {
    int number = 0;
    double readings = 0.0, time = 0.0, place = 0.0, mean = 0.0, squares = 0.0;
  };
  std::map<Channel, std::map<int, Run>> channels;
  const bool in_time = std::ranges::none_of(data.time_s, [](double t) { return std::isnan(t); });
  const bool restarts = in_time && !std::ranges::is_sorted(data.time_s);  // clocks with times in common, rows in order
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k]) continue;
    Run& run = channels[data.channel(k)][data.run[k]];
    const double r = residual(static_cast<Eigen::Index>(k)), t = data.time_s.empty() ? data.run[k] : data.time_s[k];
    run.number = data.run[k];
    run.readings += 1.0;
    run.time += std::isnan(t) ? 0.0 : t;
    run.place += static_cast<double>(k);
    run.mean += r;
    run.squares += r * r;
  }
  std::optional<StepOfRuns> best;
  double most = kBetterByHundred;
  for (auto& [channel, by_number] : channels) {
    std::vector<Run> runs;
    double inside = 0.0, readings = 0.0;
    for (auto& [number, run] : by_number) {
      run.time /= run.readings;
      run.place /= run.readings;
      run.mean /= run.readings;
      inside += run.squares - run.readings * run.mean * run.mean;
      readings += run.readings;
      runs.push_back(run);
    }
    const auto count = static_cast<Eigen::Index>(runs.size());
    if (runs.size() < kFewestRunsOfStep || runs.size() > kMostRunsCompared) continue;
    if (restarts)
      for (Run& run : runs) run.time = run.place;
    std::ranges::stable_sort(runs, [](const Run& a, const Run& b) { return a.time < b.time; });
    // means of the runs, each as heavy as its readings, beside a level and a trend
    Eigen::VectorXd weight(count), target(count);
    Eigen::MatrixXd trend(count, 2), indicator = Eigen::MatrixXd::Identity(count, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Run& run = runs[static_cast<std::size_t>(i)];
      weight(i) = std::sqrt(run.readings);
      target(i) = weight(i) * run.mean;
      trend.row(i) << weight(i), weight(i) * run.time;
    }
    Space space;
    space.y = target;
    space.q.resize(count, 0);
    absorb(space, trend);
    const auto left_with = [&](const Eigen::VectorXd& column) {
      Space more = space;
      absorb(more, Eigen::MatrixXd(weight.cwiseProduct(column)));
      return more.chi2();
    };
    double one_run = space.chi2(), step = space.chi2();
    Eigen::Index at = 0;
    for (Eigen::Index i = 0; i < count; ++i) one_run = std::min(one_run, left_with(indicator.col(i)));
    for (Eigen::Index i = 1; i < count; ++i)
      if (const double left = left_with(indicator.rightCols(count - i).rowwise().sum()); left < step) {
        step = left;
        at = i;
      }
    constexpr double kFitted = 3.0;  // level, trend, step
    const double variance = std::max({step / (static_cast<double>(count) - kFitted),
                                      inside / std::max(1.0, readings - static_cast<double>(count)), kLeastDivisor});
    const double better = (one_run - step) / variance;
    if (at == 0 || better <= most) continue;
    most = better;
    Eigen::MatrixXd columns(count, 3);
    columns << trend, weight.cwiseProduct(indicator.rightCols(count - at).rowwise().sum());
    const Eigen::VectorXd sizes = least_squares(columns, target);
    best = StepOfRuns{runs[static_cast<std::size_t>(at) - 1].number, runs[static_cast<std::size_t>(at)].number,
                      sizes(2), sizes(1) * (runs.back().time - runs.front().time)};
  }
  return best;
}

std::optional<double> drift_of_last_run(const Observations& data, const Eigen::VectorXd& residual, int run) {
  constexpr double kOfLine = 2.0;                                                 // level and drift
  std::map<std::tuple<Channel, Axis, int>, std::pair<double, double>> of_others;  // sum and count of each approach
  for (std::size_t k = 0; k < data.time_s.size(); ++k) {
    if (data.run[k] == run) continue;
    auto& [sum, number] = of_others[{data.channel(k), data.axis[k], data.approach[k]}];
    sum += residual(static_cast<Eigen::Index>(k));
    ++number;
  }
  // what the other runs share, a reversal within each run too, is no event in this one
  const auto off_others = [&](std::size_t k) {
    const auto found = of_others.find({data.channel(k), data.axis[k], data.approach[k]});
    const double shared = found == of_others.end() ? 0.0 : found->second.first / found->second.second;
    return residual(static_cast<Eigen::Index>(k)) - shared;
  };
  double count = 0.0, time = 0.0, off_um = 0.0;
  double first_s = kBeyondAll, last_s = -kBeyondAll, last_of_others_s = -kBeyondAll;
  for (std::size_t k = 0; k < data.time_s.size(); ++k) {
    const double t = data.time_s[k];
    if (std::isnan(t)) return std::nullopt;
    if (data.run[k] != run) {
      last_of_others_s = std::max(last_of_others_s, t);
      continue;
    }
    ++count;
    time += t;
    off_um += off_others(k);
    first_s = std::min(first_s, t);
    last_s = std::max(last_s, t);
  }
  if (count < kFewestInRun || of_others.empty() || first_s <= last_of_others_s || last_s <= first_s)
    return std::nullopt;
  time /= count;
  off_um /= count;
  double of_time = 0.0, product = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.run[k] != run) continue;
    const double t = data.time_s[k] - time, r = off_others(k) - off_um;
    of_time += t * t;
    product += t * r;
    squares += r * r;
  }
  const double drift_um = product / of_time * (last_s - first_s);
  const double explained = product * product / of_time, freedom = count - kOfLine;
  const double F = explained / std::max((squares - explained) / freedom, kLeastDivisor);
  if (ln_f_tail(F, 1.0, freedom) > std::log(kOddChance) || drift_um * off_um < off_um * off_um) return std::nullopt;
  return drift_um;
}

std::optional<OddPass> odd_pass(const Observations& data, const Eigen::VectorXd& residual,
                                const std::vector<bool>& left_out) {
  std::optional<OddPass> oddest;
  double least = std::log(kOddChance);
  for (const Passes& passes : passes_of_lines(data, residual, left_out, kFewestPasses)) {
    for (const auto& each : passes) {  // against the others: Welch's t, their scatter pooled where it is the same
      const Pass& one = each.second;
      const double others = static_cast<double>(passes.size() - 1);
      double mean = 0.0, between = 0.0, squares = 0.0, freedom = 0.0, readings = 0.0;
      for (const auto& other : passes)
        if (other.first != each.first) mean += other.second.mean / others;
      for (const auto& other : passes) {
        if (other.first == each.first) continue;
        between += (other.second.mean - mean) * (other.second.mean - mean) / (others - 1.0);
        squares += other.second.squares;
        readings += static_cast<double>(other.second.values.size());
      }
      freedom = readings - others;
      const double inside = squares / freedom * others / readings;  // of the mean of a pass
      const bool same = between < kSameScatter * inside;
      const double variance = std::max(between, inside) * (1.0 + 1.0 / others);
      const double off = one.mean - mean;
      const double ln_p = ln_f_tail(off * off / std::max(variance, kLeastDivisor), 1.0, same ? freedom : others - 1.0) +
                          std::log(static_cast<double>(passes.size()));
      if (ln_p >= least) continue;
      least = ln_p;
      oddest = OddPass{one.run, off};
    }
  }
  return oddest;
}

RunBeside run_beside(const RunOffset& run, const EffectInstance& effect, double score) {
  if (effect.definition().is_set_by_hand() || run.score <= 0.0) return RunBeside::worse;
  if (run.score >= score) return RunBeside::as_good;
  return run.score + kBetterByHundred >= score ? RunBeside::nearly_as_good : RunBeside::worse;
}

std::optional<ScatterOfPasses> scatter_of_passes(const Observations& data, const Eigen::VectorXd& residual,
                                                 const std::vector<bool>& left_out) {
  std::optional<ScatterOfPasses> widest;
  for (const Passes& passes : passes_of_lines(data, residual, left_out, kFewestThatScatter)) {
    double readings = 0.0, sum = 0.0, counts_squared = 0.0, inside = 0.0, between = 0.0;
    for (const auto& [number, pass] : passes) {
      const double count = static_cast<double>(pass.values.size());
      readings += count;
      counts_squared += count * count;
      sum += count * pass.mean;
      inside += pass.squares;
    }
    for (const auto& [number, pass] : passes)
      between += static_cast<double>(pass.values.size()) * (pass.mean - sum / readings) * (pass.mean - sum / readings);
    const double others = static_cast<double>(passes.size()) - 1.0, freedom = readings - others - 1.0;
    const double within = std::max(inside / freedom, kLeastDivisor), F = between / others / within;
    const double of_a_pass =
        (readings - counts_squared / readings) / others;  // readings, as if all had the same number
    const double variance = (between / others - within) / of_a_pass;
    if (variance <= within || ln_f_tail(F, others, freedom) > std::log(kDifferChance)) continue;
    if (!widest || variance > widest->between_um * widest->between_um)
      widest = ScatterOfPasses{std::sqrt(variance), std::sqrt(within)};
  }
  return widest;
}

}  // namespace ecs::model
