// Offsets of runs in a two-way layout: reading = place + run + scatter, fitted by least squares in turns (backfitting;
// A. Buja, T. Hastie, R. Tibshirani, Ann. Statist. 17 (1989) 453), which is exact where every run has every place.
#include "laser/analysis/run_drift.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ecs::laser {
namespace {

constexpr double kSignificant = 4.5;  ///< sigma; with ten degrees of freedom one case in a thousand by chance
constexpr std::size_t kLeastRuns = 3;
constexpr std::size_t kLeastFreedom = 10;
constexpr int kMostTurns = 100;
constexpr double kNoMore = 1e-6;  ///< rounding

/// One reading with the place (target and approach) and the run that it belongs to, as indices.
struct PlacedReading {
  std::size_t place = 0;
  std::size_t run = 0;
  double error = 0.0;
};

struct Layout {
  std::vector<PlacedReading> readings;
  std::vector<int> runs;  ///< their numbers, ascending
  std::size_t places = 0;
};

Layout layout_of(const MeasurementSet& set, const Group& group) {
  const double tolerance_mm = target_tolerance_mm(set, group);
  std::vector<std::size_t> order = group.readings;
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return target_of(set.readings[a]) < target_of(set.readings[b]); });
  Layout layout;
  std::map<int, std::size_t> runs;
  for (const std::size_t i : order) runs.emplace(set.readings[i].run, 0);
  for (auto& [number, index] : runs) {
    index = layout.runs.size();
    layout.runs.push_back(number);
  }
  std::map<Approach, std::size_t> here;
  std::optional<double> first_mm;
  for (const std::size_t i : order) {
    const Reading& reading = set.readings[i];
    if (!first_mm || target_of(reading) - *first_mm > tolerance_mm) {
      here.clear();
      first_mm = target_of(reading);
    }
    const auto [at, is_new] = here.try_emplace(reading.approach, layout.places);
    if (is_new) ++layout.places;
    layout.readings.push_back({at->second, runs.at(reading.run), reading.error});
  }
  return layout;
}

/// Means of what is left of the readings, by an index of each.
std::vector<double> means_by(const Layout& layout, std::size_t count, std::size_t PlacedReading::*index,
                             const std::vector<double>& taken, std::size_t PlacedReading::*taken_index) {
  std::vector<double> sums(count, 0.0), numbers(count, 0.0);
  for (const PlacedReading& reading : layout.readings) {
    sums[reading.*index] += reading.error - taken[reading.*taken_index];
    numbers[reading.*index] += 1.0;
  }
  for (std::size_t i = 0; i < count; ++i) sums[i] /= std::max(1.0, numbers[i]);
  return sums;
}

struct Fitted {
  std::vector<double> places;
  std::vector<double> runs;
};

Fitted fitted(const Layout& layout) {
  Fitted fit{std::vector<double>(layout.places, 0.0), std::vector<double>(layout.runs.size(), 0.0)};
  for (int turn = 0; turn < kMostTurns; ++turn) {
    fit.places = means_by(layout, layout.places, &PlacedReading::place, fit.runs, &PlacedReading::run);
    auto runs = means_by(layout, layout.runs.size(), &PlacedReading::run, fit.places, &PlacedReading::place);
    double change = 0.0;
    for (std::size_t i = 0; i < runs.size(); ++i) change = std::max(change, std::abs(runs[i] - fit.runs[i]));
    fit.runs = std::move(runs);
    if (change < 1e-9) break;
  }
  double mean = 0.0;
  for (const double run : fit.runs) mean += run / static_cast<double>(fit.runs.size());
  for (double& run : fit.runs) run -= mean;
  for (double& place : fit.places) place += mean;
  return fit;
}

/// The straight line through the offsets over the order of the runs.
void set_slope(RunDrift& drift) {
  const auto count = static_cast<double>(drift.runs.size());
  const double middle = (count - 1.0) / 2.0;
  double weighted = 0.0, squares = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < drift.runs.size(); ++i) {
    const double at = static_cast<double>(i) - middle;
    weighted += at * drift.runs[i].offset;
    squares += at * at;
    variance += at * at * drift.runs[i].sigma * drift.runs[i].sigma;
  }
  drift.per_run = weighted / squares;
  drift.per_run_sigma = std::sqrt(variance) / squares;
  drift.first_to_last = drift.per_run * (count - 1.0);
  drift.drifts = std::abs(drift.per_run) > std::max(kNoMore, kSignificant * drift.per_run_sigma);
}

/// Runs off the median of all, or off the line where they drift.
void set_apart(RunDrift& drift) {
  const double middle = (static_cast<double>(drift.runs.size()) - 1.0) / 2.0;
  std::vector<double> left;
  for (std::size_t i = 0; i < drift.runs.size(); ++i)
    left.push_back(drift.runs[i].offset - (drift.drifts ? drift.per_run * (static_cast<double>(i) - middle) : 0.0));
  const double usual = median_of(left);
  for (std::size_t i = 0; i < left.size(); ++i)
    if (std::abs(left[i] - usual) > std::max(kNoMore, kSignificant * std::sqrt(2.0) * drift.runs[i].sigma))
      drift.apart.push_back(drift.runs[i].run);
}

}  // namespace

std::optional<RunDrift> run_drift_of(const MeasurementSet& set, const Group& group) {
  const Layout layout = layout_of(set, group);
  const std::size_t unknowns = layout.places + layout.runs.size() - 1;
  if (layout.runs.size() < kLeastRuns || layout.readings.size() < unknowns + kLeastFreedom) return std::nullopt;
  const Fitted fit = fitted(layout);
  RunDrift drift;
  for (std::size_t i = 0; i < layout.runs.size(); ++i) drift.runs.push_back({layout.runs[i], fit.runs[i], 0.0, 0});
  double squares = 0.0;
  for (const PlacedReading& reading : layout.readings) {
    const double left = reading.error - fit.places[reading.place] - fit.runs[reading.run];
    squares += left * left;
    ++drift.runs[reading.run].readings;
  }
  const double scatter = std::sqrt(squares / static_cast<double>(layout.readings.size() - unknowns));
  for (RunOffset& run : drift.runs) run.sigma = scatter / std::sqrt(static_cast<double>(run.readings));
  set_slope(drift);
  set_apart(drift);
  return drift;
}

}  // namespace ecs::laser
