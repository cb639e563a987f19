// Restricted maximum likelihood (Patterson and Thompson 1971) on a grid of mixtures, by the innovations of a Kalman
// filter (Schweppe 1965), squares winsorised (Huber 1964); levels of small groups drawn together where Bartlett's test
// (1937) finds them equal (empirical Bayes: Efron and Morris 1973).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What takes longer is no turbulence: readings where there is no time, else seconds (about three correlation times of
/// the slowest shape).
constexpr double kReadings = 20.0, kSlow_s = 200.0;
/// Correlation times tried, in readings where there is no time, else in seconds: air in a workshop moves in seconds to
/// a minute; steps of less than two cost little likelihood between them.
constexpr std::array kTimes_readings{1.0, 2.0, 4.0};
constexpr std::array kTimes_s{4.0, 8.0, 15.0, 25.0, 40.0, 60.0};
/// Shorter ones follow in steps of two down to the interval between readings, for filters and vibration correlate what
/// is read faster, and in half such steps beside the likeliest where this many readings are within it; but not below
/// this [s], which is faster than any display: finer steps of a file are rounding.
constexpr double kResolved = 4.0, kShortest_s = 1e-3;
/// Shares of the correlated part tried: an even grid, closer to 1, where the likelihood changes fastest.
constexpr std::array kShares{0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 0.97};
/// A square counts as at most this many variances (4.5 sigmas): beyond, it is an outlier and says nothing of the noise.
constexpr double kMostSquareOfNoise = 20.0;
/// Polynomial of a pass: at most of this degree, and at most one order for this many readings.
constexpr Index kMostDegree = 5, kReadingsAnOrder = 6;
/// Smallest time between ends and pivot of a polynomial: no division by 0, no ln of 0.
constexpr double kLeastWidth = 1e-9, kLeastPivot = 1e-12;
/// Degrees of freedom of a pass, and of a group, below which their own level is not believed. A choice.
constexpr double kFewestPassFreedom = 4.0, kFewestGroupFreedom = 6.0;
/// Readings of a set whose passes are judged: they know a level to half a percent and a share to a few; more cost time.
constexpr std::size_t kMostJudged = 20'000;
/// Deviations of a group below which its scatter limits nothing.
constexpr std::size_t kFewestDeviationsOfGroup = 4;
/// Standard deviations beyond which a statistic is no chance.
constexpr double kThreeSigma = 3.0;
/// Passes below which a median of their low orders says nothing; the ratio is kept within a thousandth and a thousand.
constexpr std::size_t kFewestPasses = 3;
constexpr double kLeastRatio = 1e-3, kGreatestRatio = 1e3;
/// Weight in nats, a reading, of the square by which a shape claims more than the scatter there is. A choice: the
/// scatter is known to a few per cent itself, so that a small excess costs little and a double one everything.
constexpr double kPriceOfExcess = 0.1;

/// Readings of one pass in order, with the time of each, and its low polynomial in time.
struct Pass {
  std::size_t group = 0;
  std::vector<std::size_t> rows;
  std::vector<double> time;  ///< s, or readings
  MatrixXd columns;          ///< orders of the polynomial, then the deviations
};

/// Chebyshev polynomials of the time of a pass and the deviations: what a pass as a whole does need not be noise.
void set_columns(Pass& pass, const std::vector<double>& deviation, double slow) {
  const auto n = static_cast<Index>(pass.rows.size());
  const double first = pass.time.front(), last = pass.time.back(), width = std::max(last - first, kLeastWidth);
  const auto by_length = static_cast<Index>(width / slow);
  const Index least = slow > kReadings ? 1 : 0;  // a line at least, where there is time
  const Index degree = last > first ? std::min({kMostDegree, n / kReadingsAnOrder, least + by_length}) : 0;
  pass.columns.resize(n, degree + 2);
  for (Index i = 0; i < n; ++i) {
    const double u = 2.0 * (pass.time[static_cast<std::size_t>(i)] - first) / width - 1.0;
    pass.columns(i, 0) = 1.0;
    if (degree > 0) pass.columns(i, 1) = u;
    for (Index j = 2; j <= degree; ++j) pass.columns(i, j) = 2.0 * u * pass.columns(i, j - 1) - pass.columns(i, j - 2);
    pass.columns(i, degree + 1) = deviation[pass.rows[static_cast<std::size_t>(i)]];
  }
}

/// Takes out readings of a group until `most` are left or little more: passes evenly spread over it, of each a stretch
/// in its middle where one is longer. Every odd one, so that both directions stay.
void keep_evenly(std::map<std::size_t, Pass>& passes, std::size_t most) {
  std::size_t readings = 0;
  for (const auto& each : passes) readings += each.second.rows.size();
  if (readings <= most) return;
  const std::size_t stride = readings / most | 1U;
  if (passes.size() >= stride) {
    std::size_t number = 0;
    std::erase_if(passes, [&](const auto&) { return number++ % stride != 0; });
  }
  const std::size_t each_most = most / passes.size() + 1;
  for (auto& each : passes) {
    Pass& pass = each.second;
    if (pass.rows.size() <= each_most) continue;
    const auto from = static_cast<std::ptrdiff_t>((pass.rows.size() - each_most) / 2);
    const auto to = from + static_cast<std::ptrdiff_t>(each_most);
    pass.rows = std::vector<std::size_t>(pass.rows.begin() + from, pass.rows.begin() + to);
    pass.time = std::vector<double>(pass.time.begin() + from, pass.time.begin() + to);
  }
}

std::vector<Pass> usable_passes(const Observations& data, const std::vector<NoiseGroup>& groups,
                                const std::vector<double>& deviation, double slow) {
  const std::vector<std::size_t> number = passes_of(data);
  std::vector<Pass> passes;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::map<std::size_t, Pass> of_group;
    for (const std::size_t k : groups[g].rows) {
      if (std::isnan(deviation[k]) || (!data.time_s.empty() && std::isnan(data.time_s[k]))) continue;
      Pass& pass = of_group[number[k]];
      pass.group = g;
      pass.time.push_back(data.time_s.empty() ? static_cast<double>(pass.rows.size()) : data.time_s[k]);
      pass.rows.push_back(k);
    }
    if (data.size() > kMostJudged)
      keep_evenly(of_group, std::max<std::size_t>(groups[g].rows.size() * kMostJudged / data.size(), 1));
    for (auto& each : of_group) {
      set_columns(each.second, deviation, slow);
      passes.push_back(std::move(each.second));
    }
  }
  return passes;
}

/// Median time from one reading of a pass to the next [s]; kBeyondAll where there is no time.
double interval_between(const std::vector<Pass>& passes, bool has_time) {
  std::vector<double> intervals;
  for (const Pass& pass : passes)
    for (std::size_t i = 1; has_time && i < pass.time.size(); ++i)
      if (pass.time[i] > pass.time[i - 1]) intervals.push_back(pass.time[i] - pass.time[i - 1]);
  return intervals.empty() ? kBeyondAll : std::max(upper_median(std::move(intervals)), kShortest_s);
}

/// Correlation times tried: s, or readings.
std::vector<double> times_tried(bool has_time, double interval_s) {
  if (!has_time) return {kTimes_readings.begin(), kTimes_readings.end()};
  std::vector<double> times(kTimes_s.begin(), kTimes_s.end());
  double time = 0.5 * kTimes_s.front();
  while (time >= interval_s) {
    times.push_back(time);
    time *= 0.5;
  }
  return times;
}

/// A pass made independent under one shape of noise, the polynomial taken off: the residuals left, ln of the
/// determinants, degrees of freedom.
struct PassFit {
  VectorXd residual;
  VectorXd low;  ///< what the polynomial took, in units of the noise: one number per order
  double ln_determinant = 0.0;
  double freedom = 0.0;
};
/// What a process of this correlation time remembers at each reading of the one before.
std::vector<double> memories_of(const Pass& pass, double time) {
  std::vector<double> memories(pass.time.size(), 0.0);
  for (std::size_t i = 1; i < memories.size(); ++i) memories[i] = std::exp((pass.time[i - 1] - pass.time[i]) / time);
  return memories;
}

/// @tparam kColumns  of the pass: a row is worked on at once
template <int kColumns>
PassFit fitted_columns(const Pass& pass, double share, const std::vector<double>& memories) {
  using Row = Eigen::Matrix<double, 1, kColumns>;
  Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor> columns = pass.columns;
  const Index n = columns.rows(), orders = kColumns - 1;
  PassFit fit;
  double variance = share;
  Row state = Row::Zero();
  for (Index i = 0; i < n; ++i) {
    const double memory = memories[static_cast<std::size_t>(i)];
    variance = memory * memory * (variance - share) + share;
    state *= memory;
    const double innovation = variance + 1.0 - share, gain = variance / innovation;
    const Row fresh = columns.row(i) - state;
    state += gain * fresh;
    variance *= 1.0 - gain;
    columns.row(i) = fresh / std::sqrt(innovation);
    fit.ln_determinant += std::log(innovation);
  }
  fit.low.resize(orders);
  for (Index j = 0; j < orders; ++j) {  // modified Gram-Schmidt (Golub and Van Loan 2013, 5.2.8)
    const double length = columns.col(j).norm();
    fit.ln_determinant += 2.0 * std::log(std::max(length, kLeastPivot));
    if (length > kLeastPivot) columns.col(j) /= length;
    for (Index m = j + 1; m <= orders; ++m) {
      const double part = columns.col(j).dot(columns.col(m));
      columns.col(m) -= part * columns.col(j);
      if (m == orders) fit.low(j) = part;
    }
  }
  fit.residual = columns.col(orders);
  fit.freedom = static_cast<double>(n - orders);
  return fit;
}

PassFit fitted_pass(const Pass& pass, double share, const std::vector<double>& memories) {
  static_assert(kMostDegree == 5);
  constexpr std::array kFits{fitted_columns<2>, fitted_columns<3>, fitted_columns<4>,
                             fitted_columns<5>, fitted_columns<6>, fitted_columns<7>};
  return kFits[static_cast<std::size_t>(pass.columns.cols() - 2)](pass, share, memories);
}

/// The passes without the few that scatter far more than the others of their group: something happened there.
std::vector<Pass> quiet_passes(std::vector<Pass> passes, std::size_t groups) {
  // a choice: a pass of 2.5 times the median level is no chance; where a fifth of them are so, that is the noise
  constexpr double kFar = 2.5, kMostShare = 0.2;
  std::vector<std::vector<double>> squares(groups);
  std::vector<double> square(passes.size(), kNotMeasured), limit(passes.size(), 0.0);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const PassFit fit = fitted_pass(passes[i], 0.0, memories_of(passes[i], 1.0));
    if (fit.freedom < kFewestPassFreedom) continue;
    square[i] = fit.residual.squaredNorm() / fit.freedom;
    limit[i] = kFar * (1.0 + kThreeSigma * std::sqrt(2.0 / fit.freedom));
    squares[passes[i].group].push_back(square[i]);
  }
  std::vector<Pass> quiet;
  for (std::size_t g = 0; g < groups; ++g) {
    auto& all = squares[g];
    std::vector<std::size_t> mine, loud;
    for (std::size_t i = 0; i < passes.size(); ++i)
      if (passes[i].group == g) mine.push_back(i);
    if (!all.empty()) {
      const double middle = upper_median(std::move(all));
      for (const std::size_t i : mine)
        if (square[i] > limit[i] * middle) loud.push_back(i);
    }
    if (static_cast<double>(loud.size()) > kMostShare * static_cast<double>(mine.size())) loud.clear();
    for (const std::size_t i : mine)
      if (std::ranges::find(loud, i) == loud.end()) quiet.push_back(std::move(passes[i]));
  }
  return quiet;
}

/// How well the low orders of the passes agree with a shape of noise, in nats below the best. More than the shape
/// predicts may be structure, at a price; less cannot be.
double agreement_of_low_orders(const std::vector<Pass>& passes, const std::vector<PassFit>& fits,
                               const std::vector<double>& variance) {
  constexpr double kPriceOfStructure = 5.0;  // nats: odds of 150 to 1 against structure that imitates noise
  constexpr double kEfficiency = 0.4;        // of a median of squares against their mean (0.37 for χ² of one degree)
  std::map<std::pair<std::size_t, Index>, std::vector<double>> squares;
  for (std::size_t i = 0; i < passes.size(); ++i)
    for (Index j = 0; j < fits[i].low.size(); ++j)
      if (variance[passes[i].group] > 0.0)
        squares[{passes[i].group, j}].push_back(fits[i].low(j) * fits[i].low(j) / variance[passes[i].group]);
  double both = 0.0, less = 0.0;
  for (auto& [key, list] : squares) {
    if (list.size() < kFewestPasses) continue;
    const double ratio = std::clamp(upper_median(list) / kMedianChi2, kLeastRatio, kGreatestRatio);
    const double nats = 0.5 * kEfficiency * static_cast<double>(list.size()) * (std::log(ratio) + 1.0 - ratio);
    both += nats;
    if (ratio < 1.0) less += nats;
  }
  return std::max(both, less - kPriceOfStructure);
}

/// Evidence of a shape against white noise, pass by pass; a pass that speaks for it far louder than the others tells of
/// some event in it.
double evidence_of(std::vector<double> nats, const std::vector<double>& nats_white) {
  // a choice: six median deviations are four sigmas; below two nats no pass is loud
  constexpr double kLoud = 6.0, kLeast = 2.0;
  for (std::size_t i = 0; i < nats.size(); ++i) nats[i] -= nats_white[i];
  if (nats.empty()) return 0.0;
  const double middle = upper_median(nats);
  std::vector<double> away;
  for (const double n : nats) away.push_back(std::abs(n - middle));
  const double most = std::max(kLeast, middle + kLoud * upper_median(std::move(away)));
  double sum = 0.0;
  for (const double n : nats) sum += std::min(n, most);
  return sum;
}

/// Levels of groups with few readings drawn towards the level of all groups of their kind (kind_of()):
/// strongly where the groups agree as equal noises do (Bartlett's test), a little where they do not.
void shrink_levels(const Observations& data, const std::vector<NoiseGroup>& groups, const std::vector<double>& freedom,
                   double information, std::vector<double>& variance) {
  constexpr double kAgreeing = 40.0, kDiffering = 4.0;  // degrees of freedom that the common level counts for: a choice
  for (const ReadingKind kind : kReadingKinds) {
    double all = 0.0, sum = 0.0, logs = 0.0, count = 0.0;
    const auto counts = [&](std::size_t g) {
      return kind_of(data, groups[g].rows.front()) == kind && freedom[g] >= 1.0 && variance[g] > 0.0;
    };
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (!counts(g)) continue;
      const double f = freedom[g] * information;
      all += f;
      sum += f * variance[g];
      logs += f * std::log(variance[g]);
      count += 1.0;
    }
    if (count < 2.0) continue;
    const double common = sum / all;
    const double bartlett = all * std::log(common) - logs;
    const bool agree = bartlett < count - 1.0 + kThreeSigma * std::sqrt(2.0 * (count - 1.0));
    const double prior = agree ? kAgreeing : kDiffering;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const double f = freedom[g] * information;
      if (counts(g)) variance[g] = (f * variance[g] + prior * common) / (f + prior);
    }
  }
}

}  // namespace

double robust_mean_square(const std::vector<double>& squares) {
  if (squares.empty()) return 0.0;
  const double limit = kMostSquareOfNoise * upper_median(squares) / kMedianChi2;
  double sum = 0.0, count = 0.0;
  for (const double s : squares)
    if (s <= limit || limit <= 0.0) {
      sum += s;
      count += 1.0;
    }
  return sum / std::max(count, 1.0);
}

std::vector<NoiseShape> likely_shapes(const Observations& data, const std::vector<NoiseGroup>& groups,
                                      const std::vector<double>& deviation, double information) {
  const double slow = data.time_s.empty() ? kReadings : kSlow_s;
  const std::vector<Pass> passes = quiet_passes(usable_passes(data, groups, deviation, slow), groups.size());
  std::vector<NoiseShape> shapes{{0.0, 1.0, 0.0, {}}};
  const double interval_s = interval_between(passes, !data.time_s.empty());
  for (const double time : times_tried(!data.time_s.empty(), interval_s))
    for (const double share : kShares) shapes.push_back({share, time, 0.0, {}});
  double most = -kBeyondAll;
  std::vector<double> scatter;
  for (const NoiseGroup& group : groups) {
    std::vector<double> squares;
    for (const std::size_t k : group.rows)
      if (!std::isnan(deviation[k])) squares.push_back(deviation[k] * deviation[k]);
    scatter.push_back(squares.size() < kFewestDeviationsOfGroup ? kNotMeasured : robust_mean_square(squares));
  }
  const double judged = std::min(1.0, static_cast<double>(kMostJudged) / static_cast<double>(data.size()));
  std::vector<double> nats_white;
  std::vector<std::vector<double>> memories(
      passes.size());  // of the shape before: shapes of one time follow each other
  double time_of_memories = kNotMeasured;
  const auto weigh = [&](NoiseShape& shape) {
    for (std::size_t i = 0; i < passes.size() && shape.time != time_of_memories; ++i)
      memories[i] = memories_of(passes[i], shape.time);
    time_of_memories = shape.time;
    std::vector<std::vector<double>> squares(groups.size());
    std::vector<double> freedom(groups.size(), 0.0), count(groups.size(), 0.0), level(groups.size(), 0.0);
    std::vector<PassFit> fits;
    for (std::size_t i = 0; i < passes.size(); ++i) {
      const Pass& pass = passes[i];
      fits.push_back(fitted_pass(pass, shape.share, memories[i]));
      for (const double r : fits.back().residual) squares[pass.group].push_back(r * r);
      freedom[pass.group] += fits.back().freedom;
      count[pass.group] += static_cast<double>(fits.back().residual.size());
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
      shape.variance.push_back(kNotMeasured);
      if (freedom[g] < 1.0) continue;
      level[g] = robust_mean_square(squares[g]) * count[g] / freedom[g];
      if (freedom[g] >= kFewestGroupFreedom) shape.variance[g] = level[g];
    }
    std::vector<double> nats;
    for (std::size_t i = 0; i < passes.size(); ++i) {
      const double at = std::max(level[passes[i].group], kLeastDivisor);
      double sum = 0.0;
      for (const double r : fits[i].residual) sum += std::min(r * r / at, kMostSquareOfNoise);
      nats.push_back(-0.5 * (fits[i].ln_determinant + fits[i].freedom * std::log(at) + sum));
    }
    if (shape.share == 0.0) nats_white = nats;
    shape.weight = evidence_of(nats, nats_white) + agreement_of_low_orders(passes, fits, level);
    const auto pooled = [&](const auto& is_alike) {
      double sum = 0.0, all_freedom = 0.0;
      for (std::size_t g = 0; g < groups.size(); ++g) {
        if (freedom[g] < 1.0 || !is_alike(groups[g])) continue;
        sum += level[g] * freedom[g];
        all_freedom += freedom[g];
      }
      return all_freedom > 0.0 ? sum / all_freedom : kNotMeasured;
    };
    for (std::size_t g = 0; g < groups.size(); ++g) {
      double& variance = shape.variance[g];
      const auto kind = [&](const NoiseGroup& group) { return kind_of(data, group.rows.front()); };
      const auto is_of_kind = [&](const NoiseGroup& other) { return kind(other) == kind(groups[g]); };
      const auto is_of_unit = [&](const NoiseGroup& other) {
        return is_rotation(other.sense) == is_rotation(groups[g].sense);
      };
      if (std::isnan(variance)) variance = pooled(is_of_kind);
      if (std::isnan(variance)) variance = pooled(is_of_unit);
    }
    shrink_levels(data, groups, freedom, information, shape.variance);
    shape.weight *= information;
    // the scatter of the deviations themselves holds all of the noise: more than that is not possible
    double claimed = 0.0, there = 0.0, rows = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (std::isnan(shape.variance[g]) || std::isnan(scatter[g])) continue;
      const double n = static_cast<double>(groups[g].rows.size());
      claimed += n * shape.variance[g];
      there += n * scatter[g];
      rows += n;
    }
    if (there > 0.0 && claimed > there)
      shape.weight -= kPriceOfExcess * rows * judged * information * std::pow(claimed / there - 1.0, 2);
    most = std::max(most, shape.weight);
  };
  for (NoiseShape& shape : shapes) weigh(shape);
  const NoiseShape best =
      *std::ranges::max_element(shapes, [](const NoiseShape& a, const NoiseShape& b) { return a.weight < b.weight; });
  if (best.share > 0.0 && best.time < kTimes_s.front() && best.time >= kResolved * interval_s)
    for (const double time : {best.time / std::numbers::sqrt2, best.time * std::numbers::sqrt2})
      for (const double share : kShares) weigh(shapes.emplace_back(NoiseShape{share, time, 0.0, {}}));
  double sum = 0.0;
  for (NoiseShape& shape : shapes) {
    // white noise is one shape, the correlated ones are many: each half of the belief beforehand
    const double belief = shape.share == 0.0 ? 1.0 : 1.0 / static_cast<double>(shapes.size() - 1);
    shape.weight = belief * std::exp(shape.weight - most);
    sum += shape.weight;
  }
  for (NoiseShape& shape : shapes) shape.weight /= sum;
  return shapes;
}

}  // namespace ecs::model
