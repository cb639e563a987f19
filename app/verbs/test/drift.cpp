// `ecs test drift`: drift at one place over time, by ISO 230-3.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "laser/standards/warm_up.hpp"

namespace ecs::app {
namespace {

struct DriftArguments : VerbArguments {
  const std::string& file = text("FILE", "readings at one place over time (time_s)", Need::required);
  const double& window_h =
      number("--window", "length of the windows: that of a measurement [h]", 1.0, Need::optional, 1e-3, 1e3);
  const std::string& plot = output_file("--plot", "drift and temperatures over time: OUT.svg or OUT.png");
  ImportOptions import{*this};
};

Cell drift_sense_cell(const laser::Drift& drift) {
  return record_cell("  {sense:<4} {range:>9} {window_range:>9} {from:>9} {last_window_range:>9} {unit}\n",
                     {{"sense", word_cell(name_of(drift.sense))},
                      {"hours", {number_or_null(drift.hours), {}}},
                      {"range", number_cell(drift.range, 2)},
                      {"window_range", number_cell(drift.window_range, 2)},
                      {"window_from_h", {number_or_null(drift.window_from_h), {}}},
                      {"from", shown_cell(fmt::format("{:.2f} h", drift.window_from_h))},
                      {"last_window_range", number_cell(drift.last_window_range, 2)},
                      {"unit", word_cell(laser::unit_of(drift.sense))}});
}

PlotFigure drift_figure(const laser::DriftTest& test) {
  PlotPanel drifts{"drift from the first reading", "time [h]", "drift [um, um/m]", {}};
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

Result<Outcome> drift(VerbContext& context, const DriftArguments& arguments) {
  ECS_TRY(imported, read_with_notes(context, arguments.file, arguments.import));
  laser::MeasurementSet set = imported.set;
  set.source = arguments.file;
  ECS_TRY(test, laser::drift_test_of(set, arguments.window_h));
  if (!arguments.plot.empty()) ECS_DO(write_plot(arguments.plot, drift_figure(test)));
  const std::string heading = fmt::format("  {:<4} {:>9} {:>9} {:>9} {:>9}\n", "", "whole",
                                          fmt::format("in {:g} h", arguments.window_h), "from", "last");
  return outcome_of(record_cell("{file}: {shown} h\n{senses}{plot}",
                                {{"file", word_cell(arguments.file)},
                                 {"window_h", {number_or_null(arguments.window_h), {}}},
                                 {"shown", shown_cell(number_cell(test.senses.front().hours, 2).text)},
                                 {"senses", list_cell(test.senses, drift_sense_cell, heading)},
                                 {"plot", written_cell("plot", arguments.plot)}}));
}

}  // namespace

extern const VerbDefinition kTestDrift =
    verb<DriftArguments>("test drift", "ISO 230-3: drift at one place, whole and within the time of a measurement",
                         "ecs test drift etve.csv --window 1 --plot etve.svg", drift);

}  // namespace ecs::app
