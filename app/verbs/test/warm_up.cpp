// `ecs test warm-up`: distortion by a moving linear axis, by ISO 230-3.
#include "laser/standards/warm_up.hpp"

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"

namespace ecs::app {
namespace {

struct WarmUpArguments : VerbArguments {
  const std::string& file = text("FILE", "readings at both ends of an axis that moves (time_s)", Need::required);
  const double& window_h =
      number("--window", "length of the first and the last part that are compared [h]", 1.0, Need::optional, 1e-3, 1e3);
  const std::string& plot = output_file("--plot", "every curve over time: OUT.svg or OUT.png");
  ImportOptions import{*this};
};

std::string_view side_of(Approach approach) {
  return approach == Approach::forward ? "forward" : approach == Approach::reverse ? "reverse" : "";
}

std::string settling_in_words(const laser::WarmUpCurve& curve) {
  if (!curve.settling) return curve.settled ? "settled" : "not settled";
  const laser::Settling& s = *curve.settling;
  return fmt::format("{}; {:+.2f} (u {:.2f}) with {:.2f} h (u {:.2f}), {:.0f} % still to come",
                     curve.settled ? "settled" : "not settled", s.change, s.change_uncertainty, s.time_constant_h,
                     s.time_constant_uncertainty_h, 100.0 * s.to_come);
}

Cell settling_cell(const std::optional<laser::Settling>& settling) {
  if (!settling) return null_cell();
  return record_cell("", {{"change", {number_or_null(settling->change), {}}},
                          {"change_uncertainty", {number_or_null(settling->change_uncertainty), {}}},
                          {"time_constant_h", {number_or_null(settling->time_constant_h), {}}},
                          {"time_constant_uncertainty_h", {number_or_null(settling->time_constant_uncertainty_h), {}}},
                          {"to_come", {number_or_null(settling->to_come), {}}}});
}

AnswerFields curve_fields(const laser::WarmUpCurve& curve) {
  return {{"sense", word_cell(name_of(curve.sense))},
          {"position_mm", {number_or_null(curve.position_mm), fmt::format("{:g}", curve.position_mm)}},
          {"approach", integer_cell(static_cast<int>(curve.approach))},
          {"side", shown_cell(std::string(side_of(curve.approach)))},
          {"range", number_cell(curve.range, 2)},
          {"first_range", number_cell(curve.first_range, 2)},
          {"last_range", number_cell(curve.last_range, 2)},
          {"settled", {curve.settled, {}}},
          {"settling", settling_cell(curve.settling)},
          {"words", shown_cell(settling_in_words(curve))}};
}

Cell warm_up_curve_cell(const laser::WarmUpCurve& curve) {
  return record_cell("  {sense} {position_mm:>9} {side:<8} {range:>8} {first_range:>8} {last_range:>8}  {words}\n",
                     curve_fields(curve));
}

Cell warm_up_difference_cell(const laser::WarmUpDifference& difference) {
  AnswerFields fields = curve_fields(difference.curve);
  const std::string per_m =
      difference.range_um_per_m > 0.0 ? fmt::format(", {:.2f} um/m", difference.range_um_per_m) : std::string();
  append(fields, {{"to_mm", {number_or_null(difference.to_mm), fmt::format("{:g}", difference.to_mm)}},
                  {"range_um_per_m", {number_or_null(difference.range_um_per_m), {}}},
                  {"per_m", shown_cell(per_m)}});
  return record_cell("  {sense} at {to_mm} less that at {position_mm} mm {side}: range {range}{per_m}; {words}\n",
                     fields);
}

PlotFigure warm_up_figure(const laser::WarmUpTest& test) {
  PlotFigure figure{fmt::format("Axis {} moves (ISO 230-3)", letter_of(test.axis)), {}, 1, false};
  for (const laser::WarmUpCurve& curve : test.curves) {
    const std::string title = fmt::format("{} from the first reading", name_of(curve.sense));
    if (figure.panels.empty() || figure.panels.back().title != title)
      figure.panels.push_back(
          {title, "time [h]", fmt::format("{} [{}]", name_of(curve.sense), laser::unit_of(curve.sense)), {}});
    PlotSeries series{fmt::format("{:g} mm {}", curve.position_mm, side_of(curve.approach)),
                      curve.approach == Approach::reverse ? Mark::reverse : Mark::forward,
                      {}};
    for (std::size_t k = 0; k < curve.value.size(); ++k) series.points.push_back({curve.time_h[k], curve.value[k]});
    figure.panels.back().series.push_back(std::move(series));
  }
  return figure;
}

Result<Outcome> warm_up(VerbContext& context, const WarmUpArguments& arguments) {
  ECS_TRY(imported, read_with_notes(context, arguments.file, arguments.import));
  laser::MeasurementSet set = imported.set;
  set.source = arguments.file;
  ECS_TRY(test, laser::warm_up_test_of(set, arguments.window_h));
  if (!arguments.plot.empty()) ECS_DO(write_plot(arguments.plot, warm_up_figure(test)));
  const std::string heading = fmt::format("  {:<2} {:>9} {:<8} {:>8} {:>8} {:>8}\n", "", "mm", "", "whole",
                                          fmt::format("first {:g} h", arguments.window_h), "last");
  return outcome_of(
      record_cell("{file}: axis {axis} moves for {shown} h; ranges in um, of rotations in um/m\n"
                  "{curves}{differences}{plot}",
                  {{"file", word_cell(arguments.file)},
                   {"axis", word_cell(std::string(1, letter_of(test.axis)))},
                   {"window_h", {number_or_null(arguments.window_h), {}}},
                   {"hours", {number_or_null(test.hours), {}}},
                   {"shown", shown_cell(number_cell(test.hours, 2).text)},
                   {"curves", list_cell(test.curves, warm_up_curve_cell, heading)},
                   {"differences", list_cell(test.differences, warm_up_difference_cell)},
                   {"plot", written_cell("plot", arguments.plot)}}));
}

}  // namespace

extern const VerbDefinition kTestWarmUp =
    verb<WarmUpArguments>("test warm-up", "ISO 230-3: distortion at both ends of an axis that warms itself by moving",
                          "ecs test warm-up warm_up.csv --window 1 --plot warm_up.svg", warm_up);

}  // namespace ecs::app
