#include "commissioning/models/dense_curve.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "commissioning/models/lines.hpp"
#include "commissioning/models/view.hpp"
#include "model/data/motions.hpp"

namespace ecs::commissioning {
namespace {

using model::EffectFit;
using model::Observations;

/// Periods that a panel of some 400 dots can show: eight dots each.
constexpr double kMostPeriods = 50.0;
/// Points of a curve: one a picture's column at least, twelve in the shortest period, and no more than a file may hold.
constexpr double kLeastPlaces = 400.0, kPlacesAPeriod = 12.0, kMostPlaces = 4000.0;
/// Predictions for one curve at the utmost: a tenth of a second.
constexpr double kMostPredictions = 60'000.0;

std::optional<double> period_of(const EffectFit& fit) {
  if (!fit.effect.traits().periodic) return std::nullopt;
  const std::string searched(fit.effect.definition().searched_parameter());
  for (const model::ParameterEstimate& one : fit.parameters)
    if (one.name == searched && one.value > 0.0) return one.value;
  return std::nullopt;
}

std::map<double, std::vector<std::size_t>> rows_by_target(const LineReadings& line) {
  std::map<double, std::vector<std::size_t>> targets;
  for (const std::size_t k : line.rows) targets[line.data.position_mm[k][index_of(line.axis)]].push_back(k);
  return targets;
}

/// One prediction and its part of a point of the curve.
struct Share {
  std::size_t row = 0;
  std::size_t place = 0;
  double weight = 1.0;
};

std::optional<std::vector<double>> predicted_at(const LineReadings& line, const std::vector<EffectFit>& effects,
                                                const std::vector<Share>& shares,
                                                const std::vector<double>& places_mm) {
  std::vector<std::size_t> rows;
  for (const Share& share : shares) rows.push_back(share.row);
  Observations at = without_paths(subset(line.data, rows));
  for (std::size_t i = 0; i < shares.size(); ++i) at.position_mm[i][index_of(line.axis)] = places_mm[shares[i].place];
  model::Model model;
  for (const EffectFit& one : effects) model.effects.push_back(one.effect);
  auto values = model::predicted(model, at);
  if (!values) return std::nullopt;
  return std::move(*values);
}

/// The sum of the shares of each place; empty where the model cannot be evaluated.
std::vector<PlotPoint> summed(const LineReadings& line, const std::vector<EffectFit>& effects,
                              std::vector<Share> shares, const std::vector<double>& places_mm) {
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.row < b.row; });
  const auto values = predicted_at(line, effects, shares, places_mm);
  if (!values) return {};
  std::vector<PlotPoint> points;
  for (const double place_mm : places_mm) points.push_back({place_mm, 0.0});
  for (std::size_t i = 0; i < shares.size(); ++i) points[shares[i].place].y += shares[i].weight * (*values)[i];
  return points;
}

bool acts_on(const model::EffectInstance& effect, const Observations& data, std::size_t k) {
  if (effect.sense != data.sense[k] || data.on_path(k)) return false;
  if (effect.approach == model::ApproachMode::both) return true;
  return data.axis[k] == effect.axis && data.approach[k] == (effect.approach == model::ApproachMode::forward ? 1 : -1);
}

}  // namespace

bool can_be_seen(const LineReadings& line, const std::vector<EffectFit>& effects) {
  const auto targets = rows_by_target(line);
  if (targets.empty()) return true;
  const double width = targets.rbegin()->first - targets.begin()->first;
  return std::none_of(effects.begin(), effects.end(), [&](const EffectFit& effect) {
    const auto period = period_of(effect);
    return period && effect.effect.axis == line.axis && width > kMostPeriods * *period;
  });
}

std::vector<double> dense_places(const LineReadings& line, const std::vector<EffectFit>& effects) {
  std::vector<double> targets;
  for (const auto& [target_mm, rows] : rows_by_target(line)) targets.push_back(target_mm);
  if (targets.size() < 2) return targets;
  const double width = targets.back() - targets.front();
  double step = width / kLeastPlaces;
  for (const EffectFit& effect : effects)
    if (const auto period = period_of(effect); period && effect.effect.axis == line.axis)
      step = std::min(step, *period / kPlacesAPeriod);
  const double rows_a_place = 2.0 * static_cast<double>(line.rows.size()) / static_cast<double>(targets.size());
  step = std::max({step, width / kMostPlaces, width * rows_a_place / kMostPredictions});
  std::vector<double> places;
  for (std::size_t i = 0; i + 1 < targets.size(); ++i) {
    const double gap = targets[i + 1] - targets[i];
    const auto parts = static_cast<std::size_t>(std::ceil(gap / step));
    for (std::size_t j = 0; j < parts; ++j)
      places.push_back(targets[i] + gap * static_cast<double>(j) / static_cast<double>(parts));
  }
  places.push_back(targets.back());
  return places;
}

std::vector<PlotPoint> dense_curve(const LineReadings& line, const std::vector<EffectFit>& effects,
                                   const std::vector<double>& places_mm) {
  const auto targets = rows_by_target(line);
  std::vector<Share> shares;
  const auto add = [&](const std::vector<std::size_t>& rows, std::size_t place, double weight) {
    if (weight <= 0.0) return;
    for (const std::size_t row : rows) shares.push_back({row, place, weight / static_cast<double>(rows.size())});
  };
  for (std::size_t i = 0; i < places_mm.size(); ++i) {
    auto above = targets.lower_bound(places_mm[i]);
    if (above == targets.end()) --above;
    if (above == targets.begin() || above->first == places_mm[i]) {
      add(above->second, i, 1.0);
      continue;
    }
    const auto below = std::prev(above);
    const double part = (places_mm[i] - below->first) / (above->first - below->first);
    add(below->second, i, 1.0 - part);
    add(above->second, i, part);
  }
  return summed(line, effects, std::move(shares), places_mm);
}

std::vector<std::size_t> folding_effects(const model::Fit& fit, std::size_t first) {
  std::vector<std::size_t> numbers;
  for (std::size_t e = first; e < fit.effects.size(); ++e)
    if (period_of(fit.effects[e]) && fit.effects[e].effect.axis && fit.effects[e].readings > 0) numbers.push_back(e);
  return numbers;
}

PlotPanel folded_panel(const model::Fit& fit, const Observations& data, std::size_t effect) {
  const EffectFit& wave = fit.effects[effect];
  const double period_mm = *period_of(wave);
  const Axis axis = *wave.effect.axis;
  PlotPanel panel{
      fmt::format("{}: folded over its period of {} {}", place_text(wave.effect), few_digits(period_mm, 4),
                  data.position_unit()),
      fmt::format("{} position from the datum, modulo the period [{}]", data.letter(axis), data.position_unit()),
      wave.effect.sense && is_rotation(*wave.effect.sense) ? "error [µm/m]" : "error [µm]",
      {}};
  LineReadings acting{data, axis, {}};
  for (const int approach : {1, -1, 0}) {
    PlotSeries readings{
        approach == 0 ? "the rest" : fmt::format("the rest, {}", direction_text(approach)), reading_mark(approach), {}};
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (data.approach[k] != approach || !acts_on(wave.effect, data, k)) continue;
      acting.rows.push_back(k);
      const double p_mm = data.p_mm(k, axis);
      readings.points.push_back(
          {p_mm - period_mm * std::floor(p_mm / period_mm), fit.residual[k] + wave.contribution[k]});
    }
    if (!readings.points.empty()) panel.series.push_back(std::move(readings));
  }
  if (acting.rows.empty()) return panel;
  constexpr std::size_t kPoints = 120;
  std::vector<double> places;
  std::vector<Share> shares;
  for (std::size_t i = 0; i <= kPoints; ++i) {
    places.push_back(data.datum_mm[index_of(axis)] + period_mm * static_cast<double>(i) / kPoints);
    shares.push_back({acting.rows.front(), i, 1.0});
  }
  PlotSeries curve{"the effect", Mark::both, summed(acting, {wave}, std::move(shares), places)};
  for (PlotPoint& point : curve.points) point.x -= data.datum_mm[index_of(axis)];
  if (!curve.points.empty()) panel.series.push_back(std::move(curve));
  return panel;
}

}  // namespace ecs::commissioning
