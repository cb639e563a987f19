// Everything that the choice needs is in the Gram matrices of the runs: a fit to any runs, and its squares left on any
// other, are sums over them.
#include "modules/standards/thermal_law.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "laser/findings.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Choice = std::vector<Index>;

constexpr std::size_t kLeastRuns = 4, kLeastReadings = 10;
/// Time constants tried: from two intervals to half a run, by equal factors.
constexpr int kLags = 6;
constexpr double kLeastLag_intervals = 2.0, kLongestLagShare = 0.5;
/// A further column must lower the error of runs left out by this share, or it is chance; more columns than this are
/// not told apart by a dozen runs. Choices.
constexpr double kLeastFall = 0.1;
constexpr std::size_t kMostTerms = 8;
/// Temperatures beyond those of the other runs by more than this share of their range are extrapolation.
constexpr double kBeyondShare = 0.05;

struct Pool {
  std::vector<ThermalTerm> terms;  ///< of each column but the last, which is the displacement
  std::vector<MatrixXd> gram;      ///< of each run
  std::vector<double> count;       ///< readings of each run
};

/// Least squares by the sums over the runs for which `uses` is true.
VectorXd sizes_of(const Pool& pool, const Choice& chosen, const std::vector<bool>& uses) {
  const auto n = static_cast<Index>(chosen.size()), y = static_cast<Index>(pool.terms.size());
  MatrixXd gram = MatrixXd::Zero(n, n);
  VectorXd with_y = VectorXd::Zero(n);
  for (std::size_t r = 0; r < pool.gram.size(); ++r) {
    if (!uses[r]) continue;
    for (Index i = 0; i < n; ++i) {
      with_y[i] += pool.gram[r](chosen[static_cast<std::size_t>(i)], y);
      for (Index j = 0; j < n; ++j)
        gram(i, j) += pool.gram[r](chosen[static_cast<std::size_t>(i)], chosen[static_cast<std::size_t>(j)]);
    }
  }
  return PivotedQr(gram).solve(with_y);
}

/// Squares left in run r.
double squares_left(const Pool& pool, const Choice& chosen, const VectorXd& sizes, std::size_t r) {
  const auto n = static_cast<Index>(chosen.size()), y = static_cast<Index>(pool.terms.size());
  double squares = pool.gram[r](y, y);
  for (Index i = 0; i < n; ++i) {
    const Index column = chosen[static_cast<std::size_t>(i)];
    squares -= 2.0 * sizes[i] * pool.gram[r](column, y);
    for (Index j = 0; j < n; ++j)
      squares += sizes[i] * sizes[j] * pool.gram[r](column, chosen[static_cast<std::size_t>(j)]);
  }
  return std::max(squares, 0.0);
}

/// Mean square of the runs `of`, each predicted from the others of them.
double left_out_square(const Pool& pool, const Choice& chosen, const std::vector<bool>& of) {
  double squares = 0.0, count = 0.0;
  for (std::size_t r = 0; r < of.size(); ++r) {
    if (!of[r]) continue;
    std::vector<bool> others = of;
    others[r] = false;
    squares += squares_left(pool, chosen, sizes_of(pool, chosen, others), r);
    count += pool.count[r];
  }
  return squares / count;
}

/// The column that lowers the error of the runs `of` most, with their mean square then.
std::pair<Index, double> next_column(const Pool& pool, Choice chosen, const std::vector<bool>& of) {
  std::pair<Index, double> best{-1, 1e300};
  for (Index column = 0; column < static_cast<Index>(pool.terms.size()); ++column) {
    if (std::ranges::find(chosen, column) != chosen.end()) continue;
    chosen.push_back(column);
    if (const double square = left_out_square(pool, chosen, of); square < best.second) best = {column, square};
    chosen.pop_back();
  }
  return best;
}

/// Columns chosen by the runs `of` alone, one after the other; two at once where one alone is not enough, because
/// sensors of opposite signs help together only.
Choice chosen_by(const Pool& pool, const std::vector<bool>& of) {
  constexpr double kEnough = (1.0 - kLeastFall) * (1.0 - kLeastFall);
  Choice chosen;
  double last = 1e300;
  while (chosen.size() < kMostTerms) {
    Choice longer = chosen;
    double square = 1e300;
    for (int more = 0; more < 2 && (more == 0 || square > kEnough * last); ++more) {
      const auto [column, then] = next_column(pool, longer, of);
      if (column < 0) break;
      longer.push_back(column);
      square = then;
    }
    if (longer.size() == chosen.size() || square > kEnough * last) break;
    chosen = std::move(longer);
    last = square;
  }
  return chosen;
}

/// @param fixed  the columns; empty: they are chosen, for each run by the others
ThermalLaw law_of(const Pool& pool, const Choice& fixed) {
  const std::size_t runs = pool.gram.size();
  const std::vector<bool> all(runs, true);
  const double count = std::accumulate(pool.count.begin(), pool.count.end(), 0.0);
  const auto choice = [&](const std::vector<bool>& of) { return fixed.empty() ? chosen_by(pool, of) : fixed; };
  ThermalLaw law;
  const Choice chosen = choice(all);
  const VectorXd sizes = sizes_of(pool, chosen, all);
  double inside = 0.0, outside = 0.0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    law.terms.push_back(pool.terms[static_cast<std::size_t>(chosen[i])]);
    law.terms.back().um_per_degC = sizes[static_cast<Index>(i)];
  }
  for (std::size_t r = 0; r < runs; ++r) {
    std::vector<bool> others = all;
    others[r] = false;
    const Choice by_others = choice(others);
    const double squares = squares_left(pool, by_others, sizes_of(pool, by_others, others), r);
    inside += squares_left(pool, chosen, sizes, r);
    outside += squares;
    law.run_rms_um.push_back(std::sqrt(squares / pool.count[r]));
  }
  law.rms_um = std::sqrt(inside / count);
  law.left_out_rms_um = std::sqrt(outside / count);
  return law;
}

using Run = std::vector<const Reading*>;  ///< in the order of their times

/// The columns of a run: each sensor, then its lags, sensor by sensor; the displacement last. From its first reading.
MatrixXd columns_of(const Run& run, const std::vector<std::string>& sensors, const std::vector<double>& lags_s) {
  const auto per_sensor = static_cast<Index>(1 + lags_s.size());
  MatrixXd columns(static_cast<Index>(run.size()), per_sensor * static_cast<Index>(sensors.size()) + 1);
  for (Index k = 0; k < columns.rows(); ++k) {
    const Reading& reading = *run[static_cast<std::size_t>(k)];
    const double step_s = k == 0 ? 0.0 : *reading.time_s - *run[static_cast<std::size_t>(k - 1)]->time_s;
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      const Index first = per_sensor * static_cast<Index>(s);
      columns(k, first) = reading.sensors_degC.at(sensors[s]) - run.front()->sensors_degC.at(sensors[s]);
      for (std::size_t l = 0; l < lags_s.size(); ++l) {
        const Index column = first + 1 + static_cast<Index>(l);
        const double before = k == 0 ? 0.0 : columns(k - 1, column);
        columns(k, column) = before - std::expm1(-step_s / lags_s[l]) * (columns(k, first) - before);
      }
    }
    columns(k, columns.cols() - 1) = reading.error - run.front()->error;
  }
  return columns;
}

Pool pool_of(const std::vector<Run>& runs, const std::vector<std::string>& sensors, const std::vector<double>& lags_s,
             RunZero zero) {
  Pool pool;
  for (const std::string& sensor : sensors) {
    pool.terms.push_back({sensor});
    for (const double lag_s : lags_s) pool.terms.push_back({sensor, lag_s});
  }
  for (const Run& run : runs) {
    MatrixXd columns = columns_of(run, sensors, lags_s);
    if (zero == RunZero::of_run) columns.rowwise() -= columns.colwise().mean().eval();
    pool.gram.push_back(columns.transpose() * columns);
    pool.count.push_back(static_cast<double>(run.size()));
  }
  return pool;
}

/// The middle one of the times from reading to reading, and of the times of runs.
std::vector<double> lags_for(const std::vector<Run>& runs) {
  std::vector<double> steps, lengths;
  for (const Run& run : runs) {
    lengths.push_back(*run.back()->time_s - *run.front()->time_s);
    for (std::size_t k = 1; k < run.size(); ++k) steps.push_back(*run[k]->time_s - *run[k - 1]->time_s);
  }
  std::ranges::sort(steps);
  std::ranges::sort(lengths);
  const double least = kLeastLag_intervals * steps[steps.size() / 2];
  const double most = std::max(least, kLongestLagShare * lengths[lengths.size() / 2]);
  std::vector<double> lags;
  for (int i = 0; i < kLags; ++i) lags.push_back(least * std::pow(most / least, i / (kLags - 1.0)));
  return lags;
}

/// "t_ambient_degC +1.8": how far a run leaves the temperatures of the others, one sensor after the other.
std::vector<std::string> beyond_others(const std::vector<Run>& runs, std::size_t own,
                                       const std::vector<std::string>& sensors) {
  std::vector<std::string> beyond;
  for (const std::string& sensor : sensors) {
    double least = 1e300, most = -1e300, own_least = 1e300, own_most = -1e300;
    for (std::size_t r = 0; r < runs.size(); ++r)
      for (const Reading* reading : runs[r]) {
        const double degC = reading->sensors_degC.at(sensor);
        double& low = r == own ? own_least : least;
        double& high = r == own ? own_most : most;
        low = std::min(low, degC);
        high = std::max(high, degC);
      }
    const double allowed = kBeyondShare * (most - least);
    if (own_most > most + allowed) beyond.push_back(fmt::format("{} {:+.1f}", sensor, own_most - most));
    if (own_least < least - allowed) beyond.push_back(fmt::format("{} {:+.1f}", sensor, own_least - least));
  }
  return beyond;
}

std::vector<Run> runs_in(const MeasurementSet& set, const std::vector<std::string>& sensors, Findings& findings) {
  std::map<int, Run> by_number;
  for (const Reading& reading : set.readings) {
    if (!reading.time_s) findings.add(reading.line, 0, kTimeIsNeeded);
    for (const std::string& sensor : sensors)
      if (!reading.sensors_degC.contains(sensor)) findings.add(reading.line, 0, "{}: expected a temperature", sensor);
    if (!findings.empty()) return {};
    by_number[reading.run].push_back(&reading);
  }
  std::vector<Run> runs;
  for (auto& [number, run] : by_number) {
    std::ranges::stable_sort(run, {}, [](const Reading* reading) { return *reading->time_s; });
    if (run.size() < kLeastReadings)
      findings.add(0, 0, "run {}: expected {} readings or more, found {}", number, kLeastReadings, run.size());
    runs.push_back(std::move(run));
  }
  if (runs.size() < kLeastRuns)
    findings.add(0, 0, "expected {} runs or more, to predict each by the others, found {}", kLeastRuns, runs.size());
  return runs;
}

}  // namespace

Result<ThermalTest> thermal_test_of(const MeasurementSet& set) {
  Findings findings(set.source);
  ThermalTest test{.file = set.source, .sensors = sensor_names_of(set)};
  if (test.sensors.empty()) findings.add(0, 0, "expected a column t_..._degC of a temperature, found none");
  if (groups_of(set).size() != 1)
    findings.add(0, 0, "expected one sense at one place, found {} lines", groups_of(set).size());
  const std::vector<Run> runs = runs_in(set, test.sensors, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  for (std::size_t r = 0; r < runs.size(); ++r)
    test.runs.push_back({runs[r].front()->run, runs[r].size(), beyond_others(runs, r, test.sensors)});
  Choice every(test.sensors.size());
  std::iota(every.begin(), every.end(), Index{0});
  const std::vector<double> lags_s = lags_for(runs);
  const Pool plain = pool_of(runs, test.sensors, {}, RunZero::first_reading);
  test.plain = law_of(plain, every);
  test.plain_shape = law_of(pool_of(runs, test.sensors, {}, RunZero::of_run), every);
  test.lagged = law_of(pool_of(runs, test.sensors, lags_s, RunZero::first_reading), {});
  test.lagged_shape = law_of(pool_of(runs, test.sensors, lags_s, RunZero::of_run), {});
  double squares = 0.0, count = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    squares += plain.gram[r](static_cast<Index>(plain.terms.size()), static_cast<Index>(plain.terms.size()));
    count += plain.count[r];
  }
  test.raw_rms_um = std::sqrt(squares / count);
  return test;
}

}  // namespace ecs::laser
