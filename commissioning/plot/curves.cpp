#include "commissioning/plot/curves.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/axis.hpp"

namespace ecs::commissioning {
namespace {

std::string x_label_of(Axis axis) { return fmt::format("{} position [mm]", letter_of(axis)); }
std::string_view plot_unit_of(Sense sense) { return is_rotation(sense) ? "µm/m" : "µm"; }

PlotSeries readings_of(const laser::MeasurementSet& set, const laser::Curve& curve, Approach approach) {
  PlotSeries series{"", Mark::reading, {}};
  if (approach == Approach::forward) series = {"forward, each run", Mark::forward_reading, {}};
  if (approach == Approach::reverse) series = {"reverse, each run", Mark::reverse_reading, {}};
  if (approach == Approach::unknown) series.name = "readings";
  for (const laser::Reading& reading : set.readings)
    if (reading.axis == curve.axis && reading.sense == curve.sense && reading.approach == approach)
      series.points.push_back({laser::target_of(reading), reading.error});
  return series;
}

void add_unless_empty(PlotPanel& panel, PlotSeries series) {
  if (!series.points.empty()) panel.series.push_back(std::move(series));
}

std::string_view words_of(Approach approach) {
  if (approach == Approach::unknown) return "both approaches";
  return approach == Approach::forward ? "forward" : "reverse";
}

Mark mark_of(Approach approach) {
  if (approach == Approach::unknown) return Mark::both;
  return approach == Approach::forward ? Mark::forward : Mark::reverse;
}

PlotSeries series_of(const laser::MapTable& table) {
  PlotSeries series{std::string(words_of(table.approach)), mark_of(table.approach), {}};
  for (std::size_t i = 0; i < table.position_mm.size(); ++i)
    series.points.push_back({table.position_mm[i], table.compensation[i]});
  return series;
}

PlotPanel panel_for(Component component) {
  return {fmt::format("{}  {}", name_of(component), laser::description_of(component)),
          x_label_of(moving_axis(component)),
          fmt::format("compensation [{}]", plot_unit_of(sense_of(component))),
          {}};
}

}  // namespace

PlotSeries mean_series(const laser::Curve& curve, Approach approach) {
  const bool forward = approach != Approach::reverse;
  PlotSeries series{forward ? "forward, mean" : "reverse, mean", forward ? Mark::forward : Mark::reverse, {}};
  if (!curve.approach_known) series = {"mean", Mark::both, {}};
  for (const laser::CurvePoint& point : curve.points)
    if (const auto& value = forward ? point.forward : point.reverse)
      series.points.push_back({point.position_mm, *value});
  return series;
}

PlotSeries spread_series(const laser::MeasurementSet& set) {
  PlotSeries series{"all readings", Mark::spread, {}};
  const auto groups = laser::groups_of(set);
  if (groups.empty()) return series;
  for (const auto& target : laser::targets_of(set, groups.front(), laser::target_tolerance_mm(set, groups.front()))) {
    PlotRange range;
    for (const auto* readings : {&target.forward, &target.reverse})
      for (const double reading : *readings) range.take(reading);
    if (range.empty())
      for (const double reading : target.undirected) range.take(reading);
    if (range.empty()) continue;
    series.points.push_back({target.position_mm, range.from});
    series.points.push_back({target.position_mm, range.to});
  }
  return series;
}

PlotPanel panel_of(const laser::MeasurementSet& set, const laser::Curve& curve, const std::string& title) {
  PlotPanel panel{title, x_label_of(curve.axis), fmt::format("error [{}]", plot_unit_of(curve.sense)), {}};
  const auto approaches =
      curve.approach_known ? std::vector{Approach::forward, Approach::reverse} : std::vector{Approach::unknown};
  for (const Approach approach : approaches) add_unless_empty(panel, readings_of(set, curve, approach));
  add_unless_empty(panel, mean_series(curve, Approach::forward));
  if (curve.approach_known) add_unless_empty(panel, mean_series(curve, Approach::reverse));
  return panel;
}

PlotFigure figure_of(const laser::ErrorMap& map, std::optional<Component> only, const std::string& title) {
  PlotFigure figure{title, {}, 1, false};
  Component shown = Component::C0Y;
  for (const laser::MapTable& table : map.tables) {
    if (only && table.component != *only) continue;
    if (figure.panels.empty() || table.component != shown) figure.panels.push_back(panel_for(table.component));
    shown = table.component;
    figure.panels.back().series.push_back(series_of(table));
  }
  if (figure.panels.size() > 1) figure.columns = 2;
  return figure;
}

}  // namespace ecs::commissioning
