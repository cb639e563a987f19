// `ecs test drift` and `warm-up`: drift at one place over time, distortion by a moving linear axis (ISO 230-3).
// `ecs test flatness`: the heights of a surface from the eight lines of a union jack (ISO 230-1).

#include <cmath>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "commissioning/measurements/files.hpp"
#include "laser/map/csv.hpp"
#include "modules/standards/plate.hpp"
#include "modules/standards/warm_up.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

struct DriftRequest {
  std::string file, plot;
  double window_h = 1.0;
  ImportArguments import;
  static Fields<DriftRequest> fields() {
    using R = DriftRequest;
    return {{"FILE", &R::file, "file of readings at one position over time, with the column time_s", Need::required},
            {"--window", &R::window_h, "length of the windows, equal to the duration of a measurement [h]",
             Range{1e-3, 1e3}},
            {"--plot", &R::plot, "plot of drift and temperatures over time: OUT.svg or OUT.png", Is::output},
            &R::import};
  }
};

Cell drift_sense_cell(const laser::Drift& drift) {
  return record_cell("  {sense:<4} {range:>9} {window_range:>9} {from:>9} {last_window_range:>9} {unit}\n",
                     "sense"_is(name_of(drift.sense)), "hours"_is(drift.hours), "range"_is(drift.range, 2),
                     "window_range"_is(drift.window_range, 2), "window_from_h"_is(drift.window_from_h),
                     "from"_shown(fmt::format("{:.2f} h", drift.window_from_h)),
                     "last_window_range"_is(drift.last_window_range, 2), "unit"_is(laser::unit_of(drift.sense)));
}

PlotFigure drift_figure(const laser::DriftTest& test) {
  PlotPanel drifts{"drift from the first reading", "time [h]", "drift [µm, µm/m]", {}};
  constexpr Mark kMarks[] = {Mark::forward, Mark::reverse, Mark::both};
  for (std::size_t i = 0; i < test.senses.size(); ++i) {
    const laser::Drift& drift = test.senses[i];
    PlotSeries series{fmt::format("{}, range {:.2f}", name_of(drift.sense), drift.range), kMarks[i % 3], {}};
    for (std::size_t k = 0; k < drift.value.size(); ++k) series.points.push_back({drift.time_h[k], drift.value[k]});
    drifts.series.push_back(std::move(series));
  }
  PlotFigure figure{"Drift over time (ISO 230-3)", {std::move(drifts)}, 1, false};
  PlotPanel temperatures{"temperatures", "time [h]", "temperature [degC]", {}};
  for (std::size_t i = 0; i < test.sensors.size(); ++i) {
    PlotSeries series{test.sensors[i].name, kMarks[i % 3], {}};
    for (std::size_t k = 0; k < test.sensors[i].degC.size(); ++k)
      series.points.push_back({test.sensors[i].time_h[k], test.sensors[i].degC[k]});
    temperatures.series.push_back(std::move(series));
  }
  if (!temperatures.series.empty()) figure.panels.push_back(std::move(temperatures));
  return figure;
}

Result<Outcome> drift(VerbContext& context, const DriftRequest& request) {
  ECS_TRY(imported, read_with_notes(context.console, request.file, request.import));
  if (imported.set.readings.empty()) return problem_at(request.file, 0, 0, "expected readings, found none");
  ECS_TRY(test, laser::drift_test_of(imported.set, request.window_h));
  if (!request.plot.empty()) ECS_DO(write_plot(request.plot, drift_figure(test)));
  const std::string window = fmt::format("{:g} h", request.window_h);
  const std::string heading = fmt::format("  {:<4} {:>9} {:>9} {:>9} {:>9}\n", "", "whole", "largest", "from", "last") +
                              fmt::format("  {:<4} {:>9} {:>9} {:>9} {:>9}\n", "", "test", "in " + window, "", window);
  return outcome_of(record_cell(
      "{file}: {shown} h; range of the whole test, largest range in a window, where that begins, range of the last "
      "window\n"
      "{senses}{plot}",
      "file"_is(request.file), "window_h"_is(request.window_h), "shown"_shown(test.senses.front().hours, 2),
      "senses"_is(list_cell(test.senses, drift_sense_cell, heading)), "plot"_is(written_cell("plot", request.plot))));
}

struct FlatnessRequest {
  std::string file, output, plot, map, params;
  double closure_um = laser::kLargestClosure_um;
  static Fields<FlatnessRequest> fields() {
    using R = FlatnessRequest;
    return {
        {"FILE", &R::file, "file of readings of the eight lines: line,station_mm,reading", Need::required},
        {"--closure-um", &R::closure_um, "largest closure error at the centre [um]", Range{0.0, 1e6}},
        {"--map", &R::map, "also compare with the form that this error map predicts for a cut without compensation"},
        {"--params", &R::params, "parameters of the map"},
        {"-o,--output", &R::output, "CSV file for the heights", Is::output},
        {"--plot", &R::plot, "oblique view of the lines: OUT.svg or OUT.png", Is::output}};
  }
};

/// One line after the other.
Cell heights_cell(const laser::Flatness& flatness) {
  Cell lines{Json::array(), {}};
  for (std::size_t i = 0; i < laser::kPlateLines; ++i) {
    Json stations = Json::array();
    std::string text = fmt::format("  {:<6}", laser::kPlateLineNames[i]);
    for (const laser::PlateStation& station : flatness.stations) {
      if (station.line != i) continue;
      stations.push_back(
          object_of("x_mm"_is(station.x_mm), "y_mm"_is(station.y_mm), "height_um"_is(station.height_um)));
      text += fmt::format("{:>5.1f}", station.height_um);
    }
    lines.add({{{"line", laser::kPlateLineNames[i]}, {"stations", std::move(stations)}}, text + "\n"});
  }
  return lines;
}

std::string heights_csv(const laser::Flatness& flatness) {
  std::string text = "line,station,x_mm,y_mm,height_um\n";
  for (const laser::PlateStation& station : flatness.stations)
    text += fmt::format("{},{},{:.4f},{:.4f},{:.4f}\n", laser::kPlateLineNames[station.line], station.step,
                        station.x_mm, station.y_mm, station.height_um);
  return text;
}

/// Figure 7.23 of the thesis: the plate from the south, its far side higher in the picture.
PlotFigure oblique_view(const laser::Flatness& flatness) {
  constexpr double kDepth_x = 0.35;  ///< of the picture's width for the whole depth
  constexpr double kDepth_y = 1.2;   ///< of the greatest height
  const double highest_um = std::max(flatness.moody_um, 1e-6);
  const auto at = [&](double x_mm, double y_mm, double height_um) {
    return PlotPoint{x_mm + kDepth_x * flatness.width_mm * y_mm / flatness.depth_mm,
                     height_um + kDepth_y * highest_um * y_mm / flatness.depth_mm};
  };
  const double w = flatness.width_mm, d = flatness.depth_mm;
  PlotPanel panel{fmt::format("flatness {:.2f} µm (minimum zone)", flatness.minimum_zone_um),
                  "along the plate [mm], shifted to the right with its depth",
                  "height [µm], raised with the depth",
                  {}};
  panel.series.push_back(
      {"plane of the lowest station", Mark::level, {at(0, 0, 0), at(w, 0, 0), at(w, d, 0), at(0, d, 0), at(0, 0, 0)}});
  for (std::size_t i = 0; i < laser::kPlateLines; ++i) {
    PlotSeries series{i == 0 ? "measured lines" : "", Mark::both, {}};
    for (const laser::PlateStation& station : flatness.stations)
      if (station.line == i) series.points.push_back(at(station.x_mm, station.y_mm, station.height_um));
    panel.series.push_back(std::move(series));
  }
  return {"Flatness (ISO 230-1)", {std::move(panel)}, 1, true};
}

Cell closure_cell(const laser::Flatness& flatness, double largest_um) {
  const bool holds = std::abs(flatness.closure_um[0]) <= largest_um && std::abs(flatness.closure_um[1]) <= largest_um;
  return record_cell("closure error at the centre: E-W {E_W} um, N-S {N_S} um; limit {largest} um: {holds}\n",
                     "E_W"_is(flatness.closure_um[0], 3), "N_S"_is(flatness.closure_um[1], 3), "largest"_is(largest_um),
                     "holds"_is(holds, "met", "exceeded, measure the lines again"));
}

Result<Cell> prediction_cell(const FlatnessRequest& request, const laser::PlateReadings& readings,
                             const laser::Flatness& measured) {
  if (request.map.empty() != request.params.empty())
    return problem(ProblemKind::usage, "expected --map and --params together");
  if (request.map.empty()) return Cell{Json(nullptr), {}};
  ECS_TRY(map, laser::read_map_csv(request.map));
  ECS_TRY(parameters, params::read_parameters(request.params));
  ECS_TRY(form, laser::predicted_form(readings, measured, map, parameters.parameters));
  return record_cell(
      "{map} predicts {least_squares_um} um between planes parallel to the least-squares plane; measured less "
      "predicted height: {difference_rms_um} um rms, at most {difference_most_um} um\n",
      "map"_is(request.map), "least_squares_um"_is(form.least_squares_um, 3),
      "difference_rms_um"_is(form.difference_rms_um, 3), "difference_most_um"_is(form.difference_most_um, 3));
}

Result<Outcome> flatness(VerbContext&, const FlatnessRequest& request) {
  ECS_TRY(text, read_file_of(FileKind::surface, request.file));
  ECS_TRY(readings, laser::parse_plate_readings(text, request.file));
  const laser::Flatness flatness = laser::flatness_of(readings);
  ECS_TRY(prediction, prediction_cell(request, readings, flatness));
  if (!request.plot.empty()) ECS_DO(write_plot(request.plot, oblique_view(flatness)));
  if (!request.output.empty()) ECS_DO(write_file(request.output, heights_csv(flatness)));
  const Cell closure = closure_cell(flatness, request.closure_um);
  const Cell answer = record_cell(
      "{file}: {width_mm} x {depth_mm} mm between the corner stations, {heights} heights\n"
      "  {flatness_um:>9} um  flatness: minimum zone, the two closest parallel planes\n"
      "  {least_squares_um:>9} um  planes parallel to the least-squares plane\n"
      "  {moody_um:>9} um  planes parallel to both diagonals (Moody 1955)\n"
      "{closure}{prediction}heights above the lowest station [um], along each line from its first "
      "station:\n{lines}{output}{plot}",
      "file"_is(request.file), "width_mm"_is(flatness.width_mm), "depth_mm"_is(flatness.depth_mm),
      "heights"_is(flatness.stations.size()), "flatness_um"_is(flatness.minimum_zone_um, 3),
      "least_squares_um"_is(flatness.least_squares_um, 3), "moody_um"_is(flatness.moody_um, 3), "closure"_is(closure),
      "prediction"_is(prediction), "lines"_is(heights_cell(flatness)),
      "output"_is(written_cell("heights", request.output)), "plot"_is(written_cell("plot", request.plot)));
  return outcome_of(answer, closure.json["holds"] == true ? kDone : kDoesNotHold);
}

struct WarmUpRequest {
  std::string file, plot;
  double window_h = 1.0;
  ImportArguments import;
  static Fields<WarmUpRequest> fields() {
    using R = WarmUpRequest;
    return {
        {"FILE", &R::file, "file of readings at both ends of a moving axis, with the column time_s", Need::required},
        {"--window", &R::window_h, "length of the periods at the start and end of the test that are compared [h]",
         Range{1e-3, 1e3}},
        {"--plot", &R::plot, "plot of every curve over time: OUT.svg or OUT.png", Is::output},
        &R::import};
  }
};

std::string_view side_word(Approach approach) {
  return approach == Approach::forward ? "forward" : approach == Approach::reverse ? "reverse" : "";
}

std::string settling_in_words(const laser::WarmUpCurve& curve) {
  if (!curve.settling) return curve.settled ? "settled" : "not settled";
  const laser::Settling& s = *curve.settling;
  return fmt::format("{}; fitted: change {:+.2f} (u {:.2f}), time constant {:.2f} h (u {:.2f}), {:.0f} % still to come",
                     curve.settled ? "settled" : "not settled", s.change, s.change_uncertainty, s.time_constant_h,
                     s.time_constant_uncertainty_h, 100.0 * s.to_come);
}

Cell settling_cell(const std::optional<laser::Settling>& settling) {
  if (!settling) return null_cell();
  return record_cell("", "change"_is(settling->change), "change_uncertainty"_is(settling->change_uncertainty),
                     "time_constant_h"_is(settling->time_constant_h),
                     "time_constant_uncertainty_h"_is(settling->time_constant_uncertainty_h),
                     "to_come"_is(settling->to_come));
}

AnswerFields curve_fields(const laser::WarmUpCurve& curve) {
  return described("sense"_is(name_of(curve.sense)),
                   "position_mm"_is(curve.position_mm, fmt::format("{:g}", curve.position_mm)),
                   "approach"_is(static_cast<int>(curve.approach)), "side"_shown(side_word(curve.approach)),
                   "range"_is(curve.range, 2), "first_range"_is(curve.first_range, 2),
                   "last_range"_is(curve.last_range, 2), "settled"_is(curve.settled),
                   "settling"_is(settling_cell(curve.settling)), "words"_shown(settling_in_words(curve)));
}

Cell warm_up_curve_cell(const laser::WarmUpCurve& curve) {
  return record_cell("  {sense} {position_mm:>9} {side:<8} {range:>8} {first_range:>8} {last_range:>8}  {words}\n",
                     curve_fields(curve));
}

Cell warm_up_difference_cell(const laser::WarmUpDifference& difference) {
  AnswerFields fields = curve_fields(difference.curve);
  const std::string per_m =
      difference.range_um_per_m > 0.0 ? fmt::format(" ({:.2f} um/m)", difference.range_um_per_m) : std::string();
  const std::string_view side = side_word(difference.curve.approach);
  append(fields, "on_side"_shown(fmt::format("{}{}", side.empty() ? "" : " ", side)),
         "to_mm"_is(difference.to_mm, fmt::format("{:g}", difference.to_mm)),
         "range_um_per_m"_is(difference.range_um_per_m), "per_m"_shown(per_m));
  return record_cell(
      "  {sense} at {to_mm} mm minus {sense} at {position_mm} mm{on_side}: range {range}{per_m}; {words}\n", fields);
}

PlotFigure warm_up_figure(const laser::WarmUpTest& test) {
  PlotFigure figure{fmt::format("Axis {} moves (ISO 230-3)", letter_of(test.axis)), {}, 1, false};
  for (const laser::WarmUpCurve& curve : test.curves) {
    const std::string title = fmt::format("{} from the first reading", name_of(curve.sense));
    if (figure.panels.empty() || figure.panels.back().title != title)
      figure.panels.push_back(
          {title, "time [h]", fmt::format("{} [{}]", name_of(curve.sense), laser::unit_of(curve.sense)), {}});
    PlotSeries series{fmt::format("{:g} mm {}", curve.position_mm, side_word(curve.approach)),
                      curve.approach == Approach::reverse ? Mark::reverse : Mark::forward,
                      {}};
    for (std::size_t k = 0; k < curve.value.size(); ++k) series.points.push_back({curve.time_h[k], curve.value[k]});
    figure.panels.back().series.push_back(std::move(series));
  }
  return figure;
}

Result<Outcome> warm_up(VerbContext& context, const WarmUpRequest& request) {
  ECS_TRY(imported, read_with_notes(context.console, request.file, request.import));
  ECS_TRY(test, laser::warm_up_test_of(imported.set, request.window_h));
  if (!request.plot.empty()) ECS_DO(write_plot(request.plot, warm_up_figure(test)));
  const std::string heading = fmt::format("  {:<2} {:>9} {:<8} {:>8} {:>8} {:>8}\n", "", "mm", "", "whole",
                                          fmt::format("first {:g} h", request.window_h), "last");
  return outcome_of(record_cell(
      "{file}: axis {axis} moves for {shown} h; ranges in um, of rotations in um/m\n"
      "settled: last range at most {share} % of the first\n"
      "{curves}{differences}{plot}",
      "file"_is(request.file), "axis"_is(std::string(1, letter_of(test.axis))), "window_h"_is(request.window_h),
      "hours"_is(test.hours), "shown"_shown(test.hours, 2), "share"_shown(100.0 * laser::kSettledShare, 0),
      "curves"_is(list_cell(test.curves, warm_up_curve_cell, heading)),
      "differences"_is(list_cell(test.differences, warm_up_difference_cell)),
      "plot"_is(written_cell("plot", request.plot))));
}

}  // namespace

extern const std::vector<Action> kTestsOverTime{
    action("test drift", "ISO 230-3: drift at one position, over the whole test and during one measurement",
           "ecs test drift etve.csv --window 1 --plot etve.svg", drift, {.logged = Logged::always, .kind = "test"}),
    action("test flatness", "ISO 230-1: flatness from level or mirror readings along the eight lines of a union jack",
           "ecs test flatness plate.csv --plot plate.svg", flatness, {.logged = Logged::always, .kind = "test"}),
    action("test warm-up", "ISO 230-3: distortion at both ends of an axis that warms up as it moves",
           "ecs test warm-up warm_up.csv --window 1 --plot warm_up.svg", warm_up,
           {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
