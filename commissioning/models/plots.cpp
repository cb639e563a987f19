#include "commissioning/models/plots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/data/motions.hpp"
#include "model/effects/definition.hpp"

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

namespace {

using model::Fit;
using model::Observations;
using Values = std::vector<double>;

constexpr std::size_t kMostLines = 3;

/// The lines on which the mean square of `weight_of` is largest.
std::vector<MeasuredLine> lines_worth_showing(const Observations& data, const Values& weight_of) {
  std::vector<std::pair<double, MeasuredLine>> weighed;
  for (MeasuredLine& line : measured_lines(data)) {
    double sum = 0.0;
    for (const std::size_t k : line.rows) sum += weight_of[k] * weight_of[k];
    weighed.emplace_back(sum / static_cast<double>(line.rows.size()), std::move(line));
  }
  std::stable_sort(weighed.begin(), weighed.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<MeasuredLine> list;
  for (std::size_t k = 0; k < std::min(kMostLines, weighed.size()); ++k) list.push_back(std::move(weighed[k].second));
  return list;
}

std::string_view unit_label(Sense sense) { return is_rotation(sense) ? "µm/m" : "µm"; }

/// What stands in a panel: values over an abscissa, for the rows of one approach.
struct Drawn {
  const Observations& data;
  const std::vector<std::size_t>& rows;
  const Values& x;
};

PlotSeries readings(const Drawn& drawn, const Values& y, int approach, const std::string& name) {
  PlotSeries series{name, reading_mark(approach), {}};
  for (const std::size_t k : drawn.rows)
    if (drawn.data.approach[k] == approach && std::isfinite(drawn.x[k])) series.points.push_back({drawn.x[k], y[k]});
  return series;
}

/// Means over rows of equal abscissa, in its order.
PlotSeries curve(const Drawn& drawn, const Values& y, int approach, const std::string& name) {
  std::map<double, std::pair<double, double>> sums;
  for (const std::size_t k : drawn.rows) {
    if (drawn.data.approach[k] != approach || !std::isfinite(drawn.x[k])) continue;
    sums[drawn.x[k]].first += y[k];
    sums[drawn.x[k]].second += 1.0;
  }
  PlotSeries series{name, line_mark(approach), {}};
  for (const auto& [x, sum] : sums) series.points.push_back({x, sum.first / sum.second});
  return series;
}

void take(PlotPanel& panel, PlotSeries series) {
  if (!series.points.empty()) panel.series.push_back(std::move(series));
}

constexpr std::array<int, 3> kApproaches{1, -1, 0};

std::string with_direction(const std::string& name, int approach) {
  return approach == 0 ? name : fmt::format("{}, {}", name, direction_text(approach));
}

void add_readings(PlotPanel& panel, const Drawn& drawn, const Values& y, const std::string& name) {
  for (const int approach : kApproaches) take(panel, readings(drawn, y, approach, with_direction(name, approach)));
}

LineReadings readings_of(const Drawn& drawn, Axis axis, int approach) {
  LineReadings line{drawn.data, axis, {}};
  for (const std::size_t k : drawn.rows)
    if (drawn.data.approach[k] == approach) line.rows.push_back(k);
  return line;
}

Mark value_mark(int approach) {
  return approach == 0 ? Mark::value : approach > 0 ? Mark::forward_value : Mark::reverse_value;
}

/// Means of the targets, not joined: a line would show waves that are none.
PlotSeries at_targets(const Drawn& drawn, const Values& y, int approach, const std::string& name) {
  PlotSeries series = curve(drawn, y, approach, name + " at the targets");
  series.mark = value_mark(approach);
  return series;
}

/// At one place the model differs between readings (by their run, time, load or temperature) by more than twice the
/// rms of the residual: one curve would lie beside the readings.
bool differs_at_a_place(const Drawn& drawn, const Fit& fit, int approach) {
  std::map<double, std::pair<double, double>> extents;
  double squares = 0.0, most = 0.0, count = 0.0;
  for (const std::size_t k : drawn.rows) {
    if (drawn.data.approach[k] != approach || !std::isfinite(drawn.x[k])) continue;
    squares += fit.residual[k] * fit.residual[k];
    count += 1.0;
    const auto [at, is_new] = extents.try_emplace(drawn.x[k], fit.predicted[k], fit.predicted[k]);
    auto& [least, greatest] = at->second;
    least = std::min(least, fit.predicted[k]);
    greatest = std::max(greatest, fit.predicted[k]);
    most = std::max(most, greatest - least);
  }
  return most > 2.0 * std::sqrt(squares / std::max(count, 1.0));
}

PlotSeries at_readings(const Drawn& drawn, const Values& y, int approach, const std::string& name) {
  PlotSeries series = readings(drawn, y, approach, name + " at each reading");
  series.mark = value_mark(approach);
  return series;
}

/// The model of a fit along a line, also between its targets; at the targets alone where its waves are too many to see,
/// at each reading where it differs between readings of one place.
PlotSeries model_curve(const Drawn& drawn, const Fit& fit, Axis axis, int approach, const std::string& name) {
  const LineReadings line = readings_of(drawn, axis, approach);
  if (!line.rows.empty() && drawn.data.on_path(line.rows.front())) return curve(drawn, fit.predicted, approach, name);
  if (differs_at_a_place(drawn, fit, approach)) return at_readings(drawn, fit.predicted, approach, name);
  if (!can_be_seen(line, fit.effects)) return at_targets(drawn, fit.predicted, approach, name);
  PlotSeries series{name, line_mark(approach), dense_curve(line, fit.effects, dense_places(line, fit.effects))};
  return series.points.empty() ? curve(drawn, fit.predicted, approach, name) : series;
}

/// A panel for the terminal: short names. @param model  null: means of the points as lines
PlotPanel panel_of(const Observations& data, const MeasuredLine& line, const ShownReadings& shown, const Values& points,
                   const Fit* model, const std::string& title) {
  std::vector<std::size_t> rows;
  for (const std::size_t k : line.rows)
    if (!shown.run || data.run[k] == *shown.run) rows.push_back(k);
  const Values x = places_along(data, line.axis);
  const Drawn drawn{data, rows, x};
  PlotPanel panel{
      title,
      line.path.empty() ? fmt::format("{} {}", data.letter(line.axis), data.position_unit()) : label_along(data, line),
      is_rotation(line.sense) ? "um/m" : "um",
      {}};
  for (const int approach : kApproaches) {
    const bool means = shown.means && !shown.run;
    PlotSeries dots = means ? curve(drawn, points, approach, "") : readings(drawn, points, approach, "");
    dots.mark = reading_mark(approach);
    take(panel, std::move(dots));
  }
  for (const int approach : kApproaches) {
    const std::string name = approach == 0 ? "any" : std::string(direction_text(approach));
    take(panel, model != nullptr ? model_curve(drawn, *model, line.axis, approach, name)
                                 : curve(drawn, points, approach, name));
  }
  return panel;
}

/// A column that is no position; empty where the data have none of that name.
Values column_named(const Observations& data, const std::string& name) {
  if (name == "run") return {data.run.begin(), data.run.end()};
  const std::map<std::string, const model::Column*> columns{
      {"time_s", &data.time_s},
      {"feed_mm_min", &data.feed_mm_min},
      {"load_kg", &data.load_kg},
      {"travel_since_reversal_mm", &data.travel_since_reversal_mm},
      {"pressure_hPa", &data.pressure_hPa},
      {"humidity_pct", &data.humidity_pct}};
  if (const auto found = columns.find(name); found != columns.end()) return *found->second;
  if (const auto sensor = data.sensors_degC.find(name); sensor != data.sensors_degC.end()) return sensor->second;
  if (const auto extra = data.extras.find(name); extra != data.extras.end()) return extra->second;
  return {};
}

/// The quantity of such a column as a label of a picture: "time [s]" of "time_s", "spindle temperature [°C]" of
/// "t_spindle_degC".
std::string quantity_label(const std::string& column) {
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"_degC", "°C"}, {"_mm_min", "mm/min"}, {"_um_per_m", "µm/m"}, {"_um", "µm"}, {"_mm", "mm"},
      {"_s", "s"},     {"_kg", "kg"},         {"_hPa", "hPa"},       {"_pct", "%"}};
  std::string name = column, unit;
  for (const auto& [ending, shown] : kUnits)
    if (unit.empty() && column.size() > ending.size() && column.ends_with(ending)) {
      name.resize(column.size() - ending.size());
      unit = fmt::format(" [{}]", shown);
    }
  if (column.ends_with("_degC") && name.starts_with("t_")) name = name.substr(2) + " temperature";
  std::replace(name.begin(), name.end(), '_', ' ');
  return name + unit;
}

/// What named effects take out of the residual, per reading.
struct Explained {
  Values um;
  std::string effects;
  Fit after;  ///< with them
};

/// What the named effects explain along a line, also between its targets.
PlotSeries explained_curve(const Drawn& drawn, const Fit& before, const Explained& explained, Axis axis, int approach,
                           const std::string& name) {
  const LineReadings line = readings_of(drawn, axis, approach);
  if (!line.rows.empty() && drawn.data.on_path(line.rows.front())) return curve(drawn, explained.um, approach, name);
  if (!can_be_seen(line, explained.after.effects)) return at_targets(drawn, explained.um, approach, name);
  const Values places = dense_places(line, explained.after.effects);
  PlotSeries series{name, line_mark(approach), dense_curve(line, explained.after.effects, places)};
  const auto without = dense_curve(line, before.effects, places);
  if (series.points.empty() || without.empty()) return curve(drawn, explained.um, approach, name);
  for (std::size_t i = 0; i < without.size(); ++i) series.points[i].y -= without[i].y;
  return series;
}

/// The line panels of a figure: readings against model, residual with what explains it.
PlotFigure figure_of_lines(const Fit& fit, const Observations& data, const Explained* explained,
                           const std::string& title) {
  PlotFigure figure{title, {}, 2, false};
  if (const std::size_t all = measured_lines(data).size(); all > kMostLines)
    figure.title += fmt::format(": the {} of {} lines with the largest error", kMostLines, all);
  for (const MeasuredLine& line : lines_worth_showing(data, explained != nullptr ? explained->um : fit.residual)) {
    const Values x = places_along(data, line.axis);
    const Drawn drawn{data, line.rows, x};
    PlotPanel measured{title_of(line), label_along(data, line), fmt::format("error [{}]", unit_label(line.sense)), {}};
    add_readings(measured, drawn, data.reading, "measured");
    for (const int approach : kApproaches)
      take(measured, model_curve(drawn, fit, line.axis, approach, with_direction("model", approach)));
    PlotPanel left{title_of(line) + ": residual of the model",
                   label_along(data, line),
                   fmt::format("residual [{}]", unit_label(line.sense)),
                   {}};
    add_readings(left, drawn, fit.residual, "residual");
    for (const int approach : kApproaches)
      if (explained != nullptr)
        take(left, explained_curve(drawn, fit, *explained, line.axis, approach, with_direction("explained", approach)));
    figure.panels.push_back(std::move(measured));
    figure.panels.push_back(std::move(left));
  }
  return figure;
}

/// Panels of the periodic effects, from number `first` on, each over its period: at most two.
void add_folded(PlotFigure& figure, const Fit& fit, const Observations& data, std::size_t first) {
  constexpr std::size_t kMostFolded = 2;
  std::vector<std::size_t> effects = folding_effects(fit, first);
  effects.resize(std::min(effects.size(), kMostFolded));
  for (const std::size_t effect : effects)
    if (PlotPanel panel = folded_panel(fit, data, effect); !panel.series.empty())
      figure.panels.push_back(std::move(panel));
}

/// Panels over the variables, other than positions, on which the residual depends most: at most two.
void add_variables(PlotFigure& figure, const Fit& fit, const Observations& data, const model::Diagnosis& diagnosis) {
  constexpr double kWorthShowing = 0.1;
  std::size_t added = 0;
  std::map<std::string, std::vector<std::size_t>> rows_by_sense;
  for (const MeasuredLine& line : measured_lines(data)) {
    auto& rows = rows_by_sense[line.path.empty() ? std::string(name_of(line.sense)) : line.path];
    rows.insert(rows.end(), line.rows.begin(), line.rows.end());
  }
  for (const model::Dependence& one : diagnosis.where) {
    const Values x = column_named(data, one.variable);
    if (x.empty() || one.strength < kWorthShowing || added == 2) continue;
    const std::string label = quantity_label(one.variable);
    for (const auto& [sense, rows] : rows_by_sense) {
      PlotPanel panel{fmt::format("{}: residual against {}", sense, label),
                      label,
                      fmt::format("residual [{}]", unit_label(data.sense[rows.front()])),
                      {}};
      add_readings(panel, {data, rows, x}, fit.residual, "residual");
      if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
    }
    ++added;
  }
}

std::string_view verdict_title(const model::Diagnosis& diagnosis) {
  const bool reserved = diagnosis.verdict == model::Verdict::adequate && !diagnosis.reservation.empty();
  return reserved ? "these data show no missing effect" : title_of(diagnosis.verdict);
}

/// Refits with the named effects; nothing where none is named.
Result<std::optional<Explained>> explained_by(const model::Model& model, const Observations& data, const Fit& before,
                                              const model::Diagnosis& diagnosis, const model::FitOptions& options) {
  model::Model with = model;
  std::vector<std::string> names;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    model::EffectInstance effect = candidate.effect;
    const std::string searched(effect.definition().searched_parameter());
    if (const auto value = effect.fitted.find(searched); value != effect.fitted.end())
      effect.parameters[searched] = value->second;
    with.effects.push_back(std::move(effect));
    names.push_back(place_text(candidate.effect));
  }
  if (names.empty()) return std::optional<Explained>();
  ECS_TRY(after, model::fit(with, data, options));
  Explained explained{{}, fmt::format("{}", fmt::join(names, " + ")), after};
  for (std::size_t k = 0; k < data.size(); ++k) explained.um.push_back(after.predicted[k] - before.predicted[k]);
  return std::optional(std::move(explained));
}

}  // namespace

PlotPanel measured_panel(const Observations& data, const Fit& fit, const MeasuredLine& line,
                         const ShownReadings& shown) {
  std::string which = shown.means ? "means" : "all readings";
  if (shown.run) which = fmt::format("run {}", *shown.run);
  return panel_of(data, line, shown, data.reading, &fit,
                  fmt::format("{}, {}: measured (symbols), model (lines)", title_of(line), which));
}

PlotPanel residual_panel(const Observations& data, const Fit& fit, const MeasuredLine& line,
                         const ShownReadings& shown) {
  return panel_of(data, line, shown, fit.residual, nullptr, "residual");
}

std::vector<PlotPanel> residual_panels_of_variables(const Observations& data, const Fit& fit,
                                                    const MeasuredLine& line) {
  std::vector<PlotPanel> panels;
  for (const std::size_t effect : folding_effects(fit, 0)) {
    PlotPanel folded = folded_panel(fit, data, effect);
    if (folded.series.empty()) continue;  // no line shows it, only circles or diagonals
    panels.push_back(std::move(folded));
    panels.back().x_label = data.position_unit();
    panels.back().y_label = is_rotation(line.sense) ? "µm/m" : "µm";
  }
  std::vector<std::string> variables{"run", "time_s", "load_kg", "feed_mm_min", "travel_since_reversal_mm"};
  for (const auto& sensor : data.sensors_degC) variables.push_back(sensor.first);
  for (const std::string& variable : variables) {
    const Values x = column_named(data, variable);
    if (x.size() != data.size()) continue;
    const auto differs = [&](std::size_t k) { return std::isfinite(x[k]) && x[k] != x[line.rows.front()]; };
    if (std::none_of(line.rows.begin(), line.rows.end(), differs)) continue;
    const Drawn drawn{data, line.rows, x};
    const std::string label = quantity_label(variable);
    PlotPanel panel{fmt::format("residual against {}", label), label, is_rotation(line.sense) ? "µm/m" : "µm", {}};
    for (const int approach : kApproaches) take(panel, readings(drawn, fit.residual, approach, ""));
    for (const int approach : kApproaches)
      if (variable == "run")
        take(panel, curve(drawn, fit.residual, approach,
                          approach == 0 ? "any" : fmt::format("mean, {}", direction_text(approach))));
    panels.push_back(std::move(panel));
  }
  return panels;
}

PlotFigure fit_figure(const Fit& fit, const Observations& data, const std::string& title) {
  PlotFigure figure = figure_of_lines(fit, data, nullptr, title);
  add_folded(figure, fit, data, 0);
  return figure;
}

std::string plot_unit(std::string_view unit) {
  std::string text(unit);
  for (std::size_t at = text.find("um"); at != std::string::npos; at = text.find("um", at)) text.replace(at, 2, "µm");
  return text;
}

Result<PlotFigure> diagnosis_figure(const model::Model& model, const Observations& data,
                                    const model::Diagnosis& diagnosis, bool plain) {
  const model::FitOptions options{plain};
  ECS_TRY(fit, model::fit(model, data, options));
  ECS_TRY(explained, explained_by(model, data, fit, diagnosis, options));
  std::string title =
      fmt::format("{}: rms {:.2f} {}, noise {:.2f} {}", verdict_title(diagnosis), diagnosis.rms_um,
                  plot_unit(diagnosis.noise.unit), diagnosis.noise.noise_um, plot_unit(diagnosis.noise.unit));
  if (explained) title += fmt::format("; explained by {}", explained->effects);
  PlotFigure figure = figure_of_lines(fit, data, explained ? &*explained : nullptr, title);
  if (explained) add_folded(figure, explained->after, data, fit.effects.size());
  add_variables(figure, fit, data, diagnosis);
  return figure;
}

PlotFigure ladder_figure(const std::vector<model::LadderStep>& history, const std::string& title) {
  PlotPanel panel{"", "", "error [µm]", {}};
  PlotSeries rms{"rms", Mark::bar, {}}, held_out{"held-out rms", Mark::both, {}},
      noise{"noise of one reading", Mark::level, {}};
  double x = 0.0;
  if (!history.empty() && !history.front().effect.empty()) {
    panel.x_names.emplace_back("before");
    rms.points.push_back({x, history.front().rms_before_um});
    noise.points.push_back({x++, history.front().noise_um});
  }
  for (const model::LadderStep& step : history) {
    panel.x_names.push_back(step.effect.empty() ? "start" : "+ " + step.effect);
    rms.points.push_back({x, step.rms_um});
    noise.points.push_back({x, step.noise_um});
    if (step.held_out_rms_um) held_out.points.push_back({x, *step.held_out_rms_um});
    x += 1.0;
  }
  for (PlotSeries* series : {&rms, &noise, &held_out}) take(panel, std::move(*series));
  return {title, {std::move(panel)}, 1, false};
}

}  // namespace ecs::commissioning
