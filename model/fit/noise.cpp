// Pure error from repeats (Draper and Smith 1998, 2.1), else from what smooth columns or both directions leave: white
// noise plus one correlated over seconds (first order Gauss-Markov process: Uhlenbeck and Ornstein 1930). Does not live
// here: the mixture (noise_shapes.cpp), replicates of it and whitening (noise_process.cpp).
#include "model/fit/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/fit/core.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Feeds [mm/min] and loads [kg] closer than this are one condition: rounding in a file.
constexpr double kSameCondition = 1e-3;
/// Both approaches are used where at least one place in three, and ten of them, has both: a choice; fewer pairs give a
/// worse estimate than all deviations do.
constexpr std::size_t kPlacesAPair = 3, kFewestPairs = 10;
/// Mean squares that differ by half are no difference of runs, nor by two standard deviations of the ratio of two mean
/// squares of n, 2/√n each: turbulence at the end of a pass both approaches share.
constexpr double kRatioOfRuns = 1.5, kTwoSigmaOfRatio = 4.0;
/// Repeats that judge the noise: eight deviations know it to a quarter (1/√(2·8)), and they must be half of the
/// readings.
constexpr std::size_t kFewestDeviations = 8;
/// Neighbours show the noise of a kind from this many readings on: twice as many as of repeats, since a smooth curve
/// takes up to half of them.
constexpr std::size_t kFewestOfKind = 2 * kFewestDeviations;
/// No step is finer than half of a digit of a tenth of a nanometre [um]; less is rounding of files and of the
/// arithmetic.
constexpr double kFinestStep_um = 0.5e-4;
/// A reading is a multiple of the step where it is off by at most this share of the step.
constexpr double kOffStep = 1e-3;
/// Readings that show a step: fewer are multiples of some number by chance (of five whole numbers, one set in 28 has a
/// common divisor, 1 - 1/zeta(5); a single one is a multiple of itself).
constexpr std::size_t kFewestOfStep = 5;
/// A step of the readings q makes noise of q/√12 = 0.29 q; a little less, so that it is no more than a floor.
constexpr double kFloorOfStep = 0.25;
/// No noise is smaller than this share of what is left, nor than this [um]: readings made by arithmetic have none.
constexpr double kFloorOfResidual = 2e-3, kFloor_um = 1e-9;
/// Part of the variance that stays white: the whitener divides by it.
constexpr double kLeastWhite = 0.02;
/// Independent deviations per reading: a choice; fewer would take the likelihood for nothing.
constexpr double kLeastInformation = 0.05;
/// Turbulence is correlated over up to a minute [s], the longest time tried: there it may be any longer one; noise is
/// at most three times what neighbours scatter (docs/statistics.md, "Noise"); variance of a second difference of
/// independent readings: 1 + 4 + 1.
constexpr double kTurbulence_s = 60.0, kMostOfScatter = 3.0, kSquaresOfSecond = 6.0;
/// Level at which the least of three estimates counts, and a difference of runs: two tests at it keep the choice below
/// the usual 0.05 by far, for few readings scatter less by chance.
constexpr double kRareByChance = 0.01;

double rounded(double value, double step) { return std::isnan(value) ? -kBeyondAll : std::round(value / step) * step; }
std::array<double, kAxes> rounded(const Vector3& p) {
  return {rounded(p[0], kSamePlace_mm), rounded(p[1], kSamePlace_mm), rounded(p[2], kSamePlace_mm)};
}

/// Deviations from the weighted mean of the repeats, by the relative size of their noise, widened for the mean that was
/// taken off; NaN where there is no repeat.
std::vector<double> deviations_from_repeats(const Repeats& repeats, const Eigen::VectorXd& residual,
                                            const std::vector<bool>& left_out, const NoiseModel& noise) {
  const std::size_t n = repeats.node_of.size();
  std::vector<double> sum(repeats.nodes, 0.0), weights(repeats.nodes, 0.0), count(repeats.nodes, 0.0);
  const auto weight_of = [&](std::size_t k) { return 1.0 / (noise.relative_of(k) * noise.relative_of(k)); };
  for (std::size_t k = 0; k < n; ++k) {
    if (left_out[k]) continue;
    sum[repeats.node_of[k]] += weight_of(k) * residual(static_cast<Eigen::Index>(k));
    weights[repeats.node_of[k]] += weight_of(k);
    count[repeats.node_of[k]] += 1.0;
  }
  std::vector<double> deviation(n, kNotMeasured);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t node = repeats.node_of[k];
    if (left_out[k] || count[node] < 2.0) continue;
    const double others = weights[node] - weight_of(k);
    deviation[k] = (residual(static_cast<Eigen::Index>(k)) - sum[node] / weights[node]) / noise.relative_of(k) *
                   std::sqrt(weights[node] / others);
  }
  return deviation;
}

/// Half the difference of both approaches at a place in a run, so that what the run has in common drops out, at the
/// rows of the forward passes; and half the sum. Empty where too few places have both.
struct Halves {
  std::vector<double> difference, sum;
  double freedom = 0.0;  ///< of either: what the runs of a place have in common was taken off
};
Halves halves_of(const Observations& data, const std::vector<double>& deviation) {
  using Key = std::tuple<Channel, Axis, int, std::array<double, kAxes>>;
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::map<Key, std::pair<std::size_t, std::size_t>> places;
  std::size_t complete = 0, usable = 0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (std::isnan(deviation[k]) || data.approach[k] == 0) continue;
    ++usable;
    const Key key{data.channel(k), data.axis[k], data.run[k], rounded(data.place_of(k))};
    auto& place = places.try_emplace(key, kNone, kNone).first->second;
    std::size_t& side = data.approach[k] > 0 ? place.first : place.second;
    if (side != kNone) continue;
    side = k;
    if (place.first != kNone && place.second != kNone) ++complete;
  }
  Halves halves;
  if (complete * kPlacesAPair < usable || complete < kFewestPairs) return halves;
  halves.difference.assign(data.size(), kNotMeasured);
  std::set<std::tuple<Channel, Axis, std::array<double, kAxes>>> of_all_runs;
  for (const auto& each : places) {
    const auto [forward, reverse] = each.second;
    if (forward == kNone || reverse == kNone) continue;
    of_all_runs.emplace(std::get<0>(each.first), std::get<1>(each.first), std::get<3>(each.first));
    halves.difference[forward] = (deviation[forward] - deviation[reverse]) / std::numbers::sqrt2;
    halves.sum.push_back((deviation[forward] + deviation[reverse]) / std::numbers::sqrt2);
  }
  halves.freedom = static_cast<double>(halves.sum.size()) - static_cast<double>(of_all_runs.size());
  return halves;
}

/// True where runs differ in a way that both approaches share, beyond what noise does (F test: what outliers are left
/// out of it take from the freedom is little).
bool runs_differ(const Halves& halves) {
  std::vector<double> d, s;
  for (const double v : halves.difference)
    if (!std::isnan(v)) d.push_back(v * v);
  for (const double v : halves.sum) s.push_back(v * v);
  const double ratio = robust_mean_square(s) / std::max(robust_mean_square(d), kFloor_um * kFloor_um);
  return halves.freedom >= 1.0 && ratio > kRatioOfRuns + kTwoSigmaOfRatio / std::sqrt(static_cast<double>(s.size())) &&
         ln_f_tail(ratio, halves.freedom, halves.freedom) < std::log(kRareByChance);
}

/// Enough of them to judge the noise by. @param of_poses  neighbours of a pose say nothing of it: any repeats are
/// better
bool many(const std::vector<double>& deviation, bool of_poses) {
  const auto there =
      static_cast<std::size_t>(std::ranges::count_if(deviation, [](double d) { return !std::isnan(d); }));
  return there >= kFewestDeviations && (of_poses || there * 2 >= deviation.size());
}

/// True for the readings of a kind of which there are enough, but too few were repeated.
std::vector<bool> in_kinds_not_repeated(const Observations& data, const std::vector<double>& deviation, bool of_poses) {
  std::map<ReadingKind, std::vector<double>> of_kind;
  for (std::size_t k = 0; k < data.size(); ++k) of_kind[kind_of(data, k)].push_back(deviation[k]);
  std::map<ReadingKind, bool> not_repeated;
  for (const auto& [kind, alike] : of_kind)
    not_repeated[kind] = alike.size() >= kFewestOfKind && !many(alike, of_poses);
  std::vector<bool> readings;
  for (std::size_t k = 0; k < data.size(); ++k) readings.push_back(not_repeated.at(kind_of(data, k)));
  return readings;
}

/// Where the runs of a group differ as no noise does, only what the approaches of a run do not share is kept.
/// @return degrees of freedom that are lost by it
double without_strange_runs(const Observations& data, const NoiseGroup& group, const Repeats& repeats,
                            std::vector<double>& deviation) {
  std::vector<double> own(data.size(), kNotMeasured);
  for (const std::size_t k : group.rows) own[k] = deviation[k];
  const Halves halves = halves_of(data, own);
  if (halves.sum.empty() || !runs_differ(halves)) return 0.0;
  std::set<std::size_t> nodes;
  double readings = 0.0;
  for (const std::size_t k : group.rows) {
    if (!std::isnan(own[k])) {
      nodes.insert(repeats.node_of[k]);
      readings += 1.0;
    }
    deviation[k] = halves.difference[k];
  }
  return readings - static_cast<double>(nodes.size()) - halves.freedom;
}

/// Readings and columns that have nothing to do with the others: a column acts on readings of one sense, as a rule.
struct SmoothBlock {
  std::vector<Eigen::Index> rows, columns;
};
std::vector<SmoothBlock> blocks_of(const Observations& data, const Eigen::MatrixXd& smooth,
                                   const std::vector<bool>& left_out) {
  std::map<Channel, SmoothBlock> blocks;
  SmoothBlock all;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k]) {
      all.rows.push_back(static_cast<Eigen::Index>(k));
      blocks[data.channel(k)].rows.push_back(all.rows.back());
    }
  bool mixed = false;
  for (Eigen::Index j = 0; j < smooth.cols(); ++j) {
    all.columns.push_back(j);
    std::set<Channel> acts_on;
    for (const Eigen::Index k : all.rows)
      if (smooth(k, j) != 0.0) acts_on.insert(data.channel(static_cast<std::size_t>(k)));
    mixed = mixed || acts_on.size() > 1;
    if (!acts_on.empty()) blocks[*acts_on.begin()].columns.push_back(j);
  }
  if (mixed) return {std::move(all)};
  std::vector<SmoothBlock> list;
  for (auto& each : blocks) list.push_back(std::move(each.second));
  return list;
}

/// Deviations and how many of them are independent.
struct Deviations {
  std::vector<double> of;
  double freedom = 0.0;
};

/// Deviations from what the smooth columns can produce.
Deviations deviations_from_smooth(const Observations& data, const Eigen::VectorXd& residual,
                                  const Eigen::MatrixXd& smooth, const std::vector<bool>& left_out,
                                  const NoiseModel& noise) {
  std::vector<double> deviation(data.size(), kNotMeasured);
  double kept = 0.0, rank = 0.0;
  for (const SmoothBlock& block : blocks_of(data, smooth, left_out)) {
    kept += static_cast<double>(block.rows.size());
    Eigen::VectorXd weight(std::ssize(block.rows));
    for (Eigen::Index i = 0; i < weight.size(); ++i)
      weight(i) = 1.0 / noise.relative_of(static_cast<std::size_t>(block.rows[static_cast<std::size_t>(i)]));
    Eigen::VectorXd y = residual(block.rows).cwiseProduct(weight);
    if (!block.columns.empty()) {
      const Eigen::MatrixXd columns = weight.asDiagonal() * smooth(block.rows, block.columns);
      const PivotedQr qr(columns);
      y -= columns * qr.solve(y);
      rank += static_cast<double>(qr.rank());
    }
    for (std::size_t i = 0; i < block.rows.size(); ++i)
      deviation[static_cast<std::size_t>(block.rows[i])] = y(static_cast<Eigen::Index>(i));
  }
  const double freedom = std::max(1.0, kept - rank);
  for (double& each : deviation) each *= std::sqrt(kept / freedom);
  return {std::move(deviation), freedom};
}

/// What the directions do not share (or share) at the places of a pass there and back, less its mean and a straight
/// line along it (lost motion, a drift), at the rows of the forward readings: an error of the place drops out of
/// differences, one that turns its sign with the direction out of sums, whatever its shape.
/// @param basis  orthonormal, of what was fitted: its part of the deviations is gone from the residual
Deviations deviations_of_directions(const Observations& data, const Eigen::VectorXd& residual,
                                    const std::vector<bool>& left_out, bool shared, const Eigen::MatrixXd& basis,
                                    const NoiseModel& noise) {
  using Place = std::pair<std::array<double, kAxes>, std::array<double, kAxes>>;
  struct Both {
    std::optional<std::size_t> forward, reverse;
  };
  std::map<std::tuple<Channel, Axis, int>, std::map<Place, Both>> lines;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k] || data.approach[k] == 0) continue;
    Both& both =
        lines[{data.channel(k), data.axis[k], data.run[k]}][{rounded(data.place_of(k)), rounded(data.parked_of(k))}];
    (data.approach[k] > 0 ? both.forward : both.reverse) = k;
  }
  Deviations deviations{std::vector<double>(data.size(), kNotMeasured)};
  Eigen::MatrixXd all(residual.size(), basis.cols() + 1);
  all << residual, basis;
  double places_seen = 0.0;
  for (const auto& [line, places] : lines) {
    std::vector<Eigen::Index> forward, reverse;
    for (const auto& [place, both] : places)
      if (both.forward && both.reverse) {
        forward.push_back(static_cast<Eigen::Index>(*both.forward));
        reverse.push_back(static_cast<Eigen::Index>(*both.reverse));
      }
    const auto n = static_cast<Eigen::Index>(forward.size());
    if (n < 3) continue;
    Eigen::MatrixXd straight = Eigen::MatrixXd::Ones(n, 2);
    for (Eigen::Index i = 0; i < n; ++i)
      straight(i, 1) = data.along_of(static_cast<std::size_t>(forward[static_cast<std::size_t>(i)]));
    Eigen::MatrixXd half =
        (all(forward, Eigen::all) + (shared ? 1.0 : -1.0) * all(reverse, Eigen::all)) / std::numbers::sqrt2;
    const PivotedQr line_of(straight);
    for (Eigen::Index j = 0; j < half.cols(); ++j) {
      const Eigen::VectorXd y = half.col(j);
      half.col(j) -= straight * line_of.solve(y);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto f = static_cast<std::size_t>(forward[static_cast<std::size_t>(i)]);
      const auto r = static_cast<std::size_t>(reverse[static_cast<std::size_t>(i)]);
      deviations.of[f] = half(i, 0) * (std::numbers::sqrt2 / std::hypot(noise.relative_of(f), noise.relative_of(r)));
    }
    deviations.freedom += static_cast<double>(n - 2) - half.rightCols(basis.cols()).squaredNorm();
    places_seen += static_cast<double>(n);
  }
  if (deviations.freedom < 1.0) return {};
  for (double& each : deviations.of) each *= std::sqrt(places_seen / deviations.freedom);
  return deviations;
}

/// Whether the first scatter less than the others do by more than chance: the others have more in them than noise.
bool scatter_less(const Deviations& some, const Deviations& others) {
  const auto mean_square = [](const Deviations& deviations) {
    double sum = 0.0, count = 0.0;
    for (const double d : deviations.of)
      if (!std::isnan(d)) {
        sum += d * d;
        count += 1.0;
      }
    return sum / std::max(count, 1.0);
  };
  if (some.freedom <= 0.0) return false;
  const double ratio = mean_square(others) / std::max(mean_square(some), kFloor_um * kFloor_um);
  return ln_f_tail(ratio, others.freedom, some.freedom) < std::log(kRareByChance);
}

/// Step of the readings: the greatest number of which all are multiples, by Euclid's algorithm; 0 if there is none of
/// use.
double resolution_of(const Observations& data, const NoiseGroup& group) {
  if (group.rows.size() < kFewestOfStep) return 0.0;
  std::vector<double> values;
  for (const std::size_t k : group.rows) values.push_back(data.reading[k] + data.of_map_in(k));
  std::ranges::sort(values);
  std::vector<double> multiples;  // the small ones first: a file rounds them all, and a large one tells the step best
  for (std::size_t i = 1; i < values.size(); ++i) multiples.push_back(values[i] - values[i - 1]);
  for (const double value : values) multiples.push_back(std::abs(value));
  std::ranges::sort(multiples);
  double step = 0.0;
  for (const double multiple : multiples) {
    double divisor = multiple, rest = step;
    while (rest > kFinestStep_um) divisor = std::exchange(rest, std::abs(divisor - std::round(divisor / rest) * rest));
    if (divisor > kFinestStep_um) step = divisor == step ? multiple / std::round(multiple / step) : divisor;
  }
  const auto is_multiple = [&](double v) { return std::abs(v / step - std::round(v / step)) <= kOffStep; };
  return step > kFinestStep_um && std::ranges::all_of(values, is_multiple) ? step : 0.0;
}

/// Mean square of the deviations of a group, or else of all groups in its unit: where no pass has enough of them for a
/// shape. Empty if no reading of the unit has a deviation.
std::optional<double> scatter_of(const NoiseModel& noise, const NoiseGroup& group,
                                 const std::vector<double>& deviation) {
  std::vector<double> own, alike;
  for (const NoiseGroup& each : noise.groups)
    for (const std::size_t k : each.rows)
      if (!std::isnan(deviation[k]) && is_rotation(each.sense) == is_rotation(group.sense)) {
        alike.push_back(deviation[k]);
        if (&each == &group) own.push_back(deviation[k]);
      }
  const std::vector<double>& known = own.size() < kFewestDeviations ? alike : own;
  if (known.empty()) return std::nullopt;
  const double rms = rms_of(known);
  return rms * rms;
}

std::vector<NoiseGroup> groups_of(const Observations& data) {
  std::map<std::pair<Channel, Axis>, NoiseGroup> groups;
  for (std::size_t k = 0; k < data.size(); ++k) {
    NoiseGroup& group = groups[{data.channel(k), data.axis[k]}];
    if (group.rows.empty()) group.path = data.path_name(k);
    group.sense = data.sense[k];
    group.axis = data.axis[k];
    group.rows.push_back(k);
  }
  std::vector<NoiseGroup> list;
  for (auto& each : groups) list.push_back(std::move(each.second));
  return list;
}

}  // namespace

ReadingKind kind_of(const Observations& data, std::size_t k) {
  if (data.on_path(k)) return ReadingKind::path;
  if (is_rotation(data.sense[k])) return ReadingKind::angle;
  return !data.rotary && direction_of(data.sense[k]) == data.axis[k] ? ReadingKind::position : ReadingKind::across;
}

double NoiseGroup::sigma() const { return std::sqrt(white * white + correlated * correlated); }

std::vector<double> NoiseModel::sigma_by_row(std::size_t n) const {
  std::vector<double> sigma(n, 1.0);
  for (const NoiseGroup& group : groups)
    for (const std::size_t k : group.rows) sigma[k] = group.sigma() * relative_of(k);
  return sigma;
}

namespace {

/// What makes a place besides the position: where the linear axes stood, or at which angles the rotary ones did. Of a
/// ball that the axes follow its pose says that: the numbers of ball and tool are enough.
std::array<double, kAxes> beside_position(const Observations& data, std::size_t k) {
  if (!data.through_chain.empty())
    return {static_cast<double>(data.through_chain[k].ball), static_cast<double>(data.through_chain[k].tool)};
  if (!data.place_mm.empty()) return rounded(data.place_mm[k]);
  return data.pose_deg.empty() ? std::array<double, kAxes>{} : rounded(data.pose_deg[k]);
}

/// The conditions that vary in these readings: "feeds or loads".
std::string varied_conditions(const Observations& data) {
  const auto varies = [](const std::vector<double>& column) {
    return std::ranges::any_of(column, [&](double value) {
      return rounded(value, kSameCondition) != rounded(column.front(), kSameCondition);
    });
  };
  const auto set_up = data.extras.find("set_up");
  std::vector<std::string_view> names;
  if (varies(data.feed_mm_min)) names.emplace_back("feeds");
  if (varies(data.load_kg)) names.emplace_back("loads");
  if (set_up != data.extras.end() && varies(set_up->second)) names.emplace_back("set-ups");
  return fmt::format("{}", fmt::join(names, " or "));
}

Repeats numbered(const Observations& data, bool conditions) {
  using Places = std::array<double, kAxes>;
  using Key = std::tuple<Channel, Axis, int, Places, double, double, double, bool, Places>;
  std::map<Key, std::size_t> nodes;
  const auto set_up = data.extras.find("set_up");
  Repeats repeats;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const bool of_pose = !data.through_chain.empty() && data.approach[k] == 0;  // whichever axis came last
    const Key key{data.channel(k),
                  of_pose ? Axis::X : data.axis[k],
                  data.approach[k],
                  rounded(data.place_of(k)),
                  conditions ? rounded(cell(data.feed_mm_min, k), kSameCondition) : 0.0,
                  conditions ? rounded(cell(data.load_kg, k), kSameCondition) : 0.0,
                  conditions && set_up != data.extras.end() ? rounded(set_up->second[k], kSameCondition) : 0.0,
                  data.compensated[k],
                  beside_position(data, k)};
    repeats.node_of.push_back(nodes.try_emplace(key, nodes.size()).first->second);
  }
  repeats.nodes = nodes.size();
  return repeats;
}

}  // namespace

Repeats repeats_of(const Observations& data) { return numbered(data, true); }
Repeats places_of(const Observations& data) { return numbered(data, false); }

std::vector<std::size_t> passes_of(const Observations& data) {
  using Key = std::tuple<Channel, Axis, int, int, Vector3>;
  std::map<Key, std::size_t> numbers;
  std::vector<std::size_t> pass;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const Key key{data.channel(k), data.axis[k], data.run[k], data.approach[k], data.parked_of(k)};
    pass.push_back(numbers.try_emplace(key, numbers.size()).first->second);
  }
  return pass;
}

std::vector<double> relative_uncertainty(const Observations& data) {
  const auto column = data.extras.find(kUncertaintyColumn);
  if (column == data.extras.end()) return {};
  std::vector<double> relative(data.size(), 1.0);
  for (const NoiseGroup& group : groups_of(data)) {
    std::vector<double> stated;
    for (const std::size_t k : group.rows)
      if (cell(column->second, k) > 0.0) stated.push_back(column->second[k]);
    if (stated.empty()) continue;
    const double mean = rms_of(stated);
    for (const std::size_t k : group.rows)
      if (column->second[k] > 0.0) relative[k] = column->second[k] / mean;
  }
  return relative;
}

std::optional<StatedUncertainty> stated_uncertainty(const Observations& data, std::span<const double> residual,
                                                    double noise_um) {
  const auto column = data.extras.find(kUncertaintyColumn);
  if (column == data.extras.end()) return std::nullopt;
  std::vector<double> stated, ratios;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double uncertainty = column->second[k];
    if (!(uncertainty > 0.0)) continue;
    stated.push_back(uncertainty);
    ratios.push_back(residual[k] / uncertainty);
  }
  if (stated.empty()) return std::nullopt;
  return StatedUncertainty{rms_of(stated), rms_of(ratios), noise_um / rms_of(stated)};
}

std::string words_for(const std::optional<StatedUncertainty>& stated, std::string_view unit) {
  if (!stated) return {};
  return fmt::format(
      "the file states a standard uncertainty of {:.3g} {} (rms) for a reading ({}): the residual is {:.2g} times the "
      "stated uncertainties, and the noise of one reading {:.2g} times. Readings are weighted by them, and the size of "
      "the noise comes from the readings",
      stated->um, unit, kUncertaintyColumn, stated->of_residual, stated->of_noise);
}

NoiseModel plain_noise(const Observations& data, double sigma_um) {
  NoiseModel noise;
  noise.groups = groups_of(data);
  noise.has_time = !data.time_s.empty();
  noise.pure.unit = data.reading_unit();
  for (NoiseGroup& group : noise.groups) group.white = sigma_um;
  noise.shapes = {{0.0, 1.0, 1.0, std::vector<double>(noise.groups.size(), sigma_um * sigma_um)}};
  return noise;
}

NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual, const Eigen::MatrixXd& smooth,
                    const std::vector<bool>& left_out) {
  return noise_of(
      data, residual, [&]() -> const Eigen::MatrixXd& { return smooth; }, left_out);
}

NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual, const std::vector<bool>& left_out,
                    const Eigen::MatrixXd& absorbed) {
  std::optional<Eigen::MatrixXd> smooth;
  return noise_of(
      data, residual,
      [&]() -> const Eigen::MatrixXd& {
        if (!smooth) smooth = smooth_columns(data);
        return *smooth;
      },
      left_out, absorbed);
}

NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual, const SmoothColumns& smooth,
                    const std::vector<bool>& left_out, const Eigen::MatrixXd& absorbed) {
  NoiseModel noise;
  noise.groups = groups_of(data);
  noise.relative = relative_uncertainty(data);
  noise.has_time = !data.time_s.empty();
  Repeats repeats = repeats_of(data);
  std::vector<double> deviation = deviations_from_repeats(repeats, residual, left_out, noise);
  noise.pure.unit = data.reading_unit();
  const bool of_poses = !data.through_chain.empty();
  noise.pure.from_repeats = many(deviation, of_poses);
  bool from_places = noise.pure.from_repeats;
  if (!from_places) {
    repeats = places_of(data);
    deviation = deviations_from_repeats(repeats, residual, left_out, noise);
    from_places = many(deviation, of_poses);
  }
  const double size = std::max<double>(1.0, static_cast<double>(residual.size()));
  std::optional<Eigen::MatrixXd> basis;
  // the least of three estimates: smooth columns, differences of both directions, sums of them
  const auto with_directions = [&](Deviations least, const std::vector<bool>& out) {
    if (!basis) basis = absorbed.cols() > 0 ? PivotedQr(absorbed).basis() : Eigen::MatrixXd(residual.size(), 0);
    for (const bool shared : {false, true}) {
      Deviations directions = deviations_of_directions(data, residual, out, shared, *basis, noise);
      if (!scatter_less(directions, least)) continue;
      least = std::move(directions);
      noise.pure.differ_in.clear();
    }
    return least;
  };
  const auto of_neighbours = [&](const std::vector<bool>& out) {
    return deviations_from_smooth(data, residual, absorbed.cols() > 0 ? beside(smooth(), absorbed) : smooth(), out,
                                  noise);
  };
  double lost = 0.0;  // degrees of freedom of deviations that are not used
  if (from_places) {
    const std::vector<bool> not_repeated = in_kinds_not_repeated(data, deviation, of_poses);
    for (const NoiseGroup& group : noise.groups) lost += without_strange_runs(data, group, repeats, deviation);
    noise.pure.in_part = std::ranges::find(not_repeated, true) != not_repeated.end();
    for (NoiseGroup& group : noise.groups)
      group.of_neighbours = std::ranges::all_of(group.rows, [&](std::size_t k) { return not_repeated[k]; });
    if (noise.pure.in_part) {
      std::vector<bool> others = left_out;
      for (std::size_t k = 0; k < data.size(); ++k) others[k] = left_out[k] || !not_repeated[k];
      const Deviations of_part = with_directions(of_neighbours(others), others);
      for (std::size_t k = 0; k < data.size(); ++k)
        if (not_repeated[k]) deviation[k] = of_part.of[k];
    }
    std::set<std::size_t> nodes;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (!left_out[k]) nodes.insert(repeats.node_of[k]);
    noise.pure.dof = std::max(size - static_cast<double>(nodes.size()) - lost, 1.0);
  }
  if (!noise.pure.from_repeats) {
    if (from_places && !noise.pure.in_part) noise.pure.differ_in = varied_conditions(data);
    Deviations least = with_directions(
        from_places ? Deviations{std::move(deviation), noise.pure.dof} : of_neighbours(left_out), left_out);
    deviation = std::move(least.of);
    noise.pure.dof = least.freedom;
  }

  noise.shapes =
      likely_shapes(data, noise.groups, deviation, std::clamp((noise.pure.dof + lost) / size, kLeastInformation, 1.0));
  const NoiseShape& best = *std::ranges::max_element(
      noise.shapes, [](const NoiseShape& x, const NoiseShape& y) { return x.weight < y.weight; });
  std::vector<double> sigmas(data.size());
  for (std::size_t g = 0; g < noise.groups.size(); ++g) {
    NoiseGroup& group = noise.groups[g];
    double group_square = 0.0;
    for (const std::size_t k : group.rows) {
      const double r = residual(static_cast<Eigen::Index>(k)) / noise.relative_of(k);
      group_square += r * r;
    }
    group_square /= static_cast<double>(group.rows.size());
    const std::optional<double> scatter = scatter_of(noise, group, deviation);
    const double of_step = kFloorOfStep * resolution_of(data, group);
    const double floor = std::max({of_step, kFloorOfResidual * std::sqrt(group_square), kFloor_um});
    for (NoiseShape& shape : noise.shapes) {
      if (std::isnan(shape.variance[g])) shape.variance[g] = scatter.value_or(group_square);
      if (&shape == &best && shape.variance[g] < of_step * of_step) noise.pure.is_of_step = true;
      shape.variance[g] = std::max(shape.variance[g], floor * floor);
    }
    group.white = std::sqrt(std::max(1.0 - best.share, kLeastWhite) * best.variance[g]);
    group.correlated = std::sqrt(best.share * best.variance[g]);
    group.time = best.time;
    for (const std::size_t k : group.rows) sigmas[k] = group.sigma();
  }
  noise.pure.noise_um = rms_of(sigmas);
  noise.pure.by_unit = rms_by_unit(data, sigmas);
  return noise;
}

bool wanders(const Observations& data, const NoiseModel& noise, const Eigen::VectorXd& residual,
             const std::vector<bool>& left_out) {
  const std::vector<std::size_t> pass = passes_of(data);
  const auto of_row = [&](std::size_t k) { return residual(static_cast<Eigen::Index>(k)) / noise.relative_of(k); };
  for (const NoiseGroup& group : noise.groups) {
    if (noise.has_time && group.correlated > group.white && group.time < kTurbulence_s) continue;
    std::map<std::size_t, std::vector<std::size_t>> passes;
    for (const std::size_t k : group.rows)
      if (!left_out[k]) passes[pass[k]].push_back(k);
    std::vector<double> squares;
    for (const auto& [number, rows] : passes)
      for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
        const auto at = [&of_row, &rows = rows](std::size_t j) { return of_row(rows[j]); };
        const double second = at(i - 1) - 2.0 * at(i) + at(i + 1);
        squares.push_back(second * second / kSquaresOfSecond);
      }
    if (squares.size() < kFewestDeviations) continue;
    const double scatter = std::max({std::sqrt(upper_median(std::move(squares)) / kMedianChi2),
                                     kFloorOfStep * resolution_of(data, group), kFloor_um});
    double sum = 0.0, count = 0.0;
    for (const auto& [number, rows] : passes)
      for (const std::size_t k : rows) {
        sum += of_row(k) * of_row(k);
        count += 1.0;
      }
    if (std::min(group.sigma(), std::sqrt(sum / count)) > kMostOfScatter * scatter) return true;
  }
  return false;
}

}  // namespace ecs::model
