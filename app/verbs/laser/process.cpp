// `ecs laser process`: runs left out, slope removed, curve smoothed; what that changed, as numbers, CSV and plot.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/numbers.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/map/recipe.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::app {
namespace {

struct ProcessArguments : VerbArguments {
  const std::string& file = text("FILE", "measurement file", Need::required);
  const std::string& slope = choice("--slope", {"none", "end_points", "least_squares"},
                                    "slope to remove; least_squares for straightness, else none");
  const double& smooth_mm =
      number("--smooth", "window of the local quadratic [mm]; 0: none", 0.0, Need::optional, 0.0, 1e6);
  const std::vector<std::string>& exclude_runs = texts("--exclude-run", "runs to leave out: 3 or 3,5");
  const std::vector<std::string>& exclude_rows = texts("--exclude-row", "data rows to leave out, from 1");
  const std::string& output = output_file("-o,--output", "CSV of the processed means");
  const std::string& plot = output_file("--plot", "before and after on the same scale: OUT.svg or OUT.png");
  ImportOptions import{*this};
};

/// One measurement line, processed.
struct Processed {
  laser::Group group;
  laser::ProcessedReadings readings;
  [[nodiscard]] const laser::Curve& curve() const { return readings.curve(); }
};

laser::SlopeMethod method_for(const ProcessArguments& arguments, const laser::Group& group) {
  const auto chosen = laser::slope_method_named(arguments.slope);
  return chosen ? *chosen : laser::default_slope(curve_of(group.sense, group.axis));
}

Result<Processed> processed(const laser::MeasurementSet& set, const laser::Group& group,
                            const ProcessArguments& arguments) {
  ECS_TRY(readings, laser::processed_readings(set, group, {method_for(arguments, group), arguments.smooth_mm}));
  if (readings.smoothing_fault) return tl::unexpected(*readings.smoothing_fault);
  return Processed{group, std::move(readings)};
}

// --- as text and JSON

std::string_view word_for(laser::Taken taken) {
  if (taken == laser::Taken::noise) return "noise";
  return taken == laser::Taken::signal ? "signal" : "unknown";
}

std::string taken_text(const laser::Smoothed& smooth) {
  if (smooth.taken == laser::Taken::noise) return ":\n  no more than the repeats explain as noise\n";
  if (smooth.taken == laser::Taken::signal)
    return fmt::format(
        ":\n  more than noise (F {:.1f}, 99 % point {:.1f}): the form of the curve was removed too; use a narrower "
        "window\n",
        smooth.F.value_or(0.0), smooth.F_99.value_or(0.0));
  return ";\n  without repeats it is unknown whether that is noise\n";
}

Cell smoothing_cell(const laser::Smoothed& smooth, double window_mm, std::string_view unit) {
  return record_cell(
      "  smoothing removed {removed_rms} {unit} rms, at most {removed_peak} at {removed_peak_position_mm} mm{taken}",
      {{"window_mm", {window_mm, {}}},
       {"removed_rms", number_cell(smooth.removed_rms, 3)},
       {"removed_peak", number_cell(smooth.removed_peak, 3)},
       {"removed_peak_position_mm",
        {number_or_null(smooth.removed_peak_position_mm), fmt::format("{:.6g}", smooth.removed_peak_position_mm)}},
       {"noise_rms", {number_or_null(smooth.noise_rms), {}}},
       {"F", {number_or_null(smooth.F), {}}},
       {"F_99", {number_or_null(smooth.F_99), {}}},
       {"taken", {word_for(smooth.taken), taken_text(smooth)}},
       {"unit", shown_cell(std::string(unit))}});
}

Cell slope_cell(const laser::Levelled& level, std::string_view unit) {
  const auto& error = level.slope_std_error_per_m;
  return record_cell("  slope removed ({method}): {removed_per_m} {unit} per m{std_error_per_m}\n",
                     {{"method", word_cell(laser::name_of(level.method))},
                      {"removed_per_m", number_cell(level.removed.slope_per_m, 3)},
                      {"removed_offset", {number_or_null(level.removed.offset), {}}},
                      {"std_error_per_m", {number_or_null(error), error ? fmt::format(" +- {:.3f}", *error) : ""}},
                      {"unit", shown_cell(std::string(unit))}});
}

Cell mean_cell(const std::optional<double>& mean) { return {number_or_null(mean), cell_text(mean)}; }

Cell point_cell(const laser::CurvePoint& before, const laser::CurvePoint& after) {
  return record_cell("{position_mm:>12} {forward_before:>14} {reverse_before:>14} {forward:>14} {reverse:>14}\n",
                     {{"position_mm", number_cell(after.position_mm, 4)},
                      {"forward", mean_cell(after.forward)},
                      {"reverse", mean_cell(after.reverse)},
                      {"forward_count", count_cell(static_cast<std::size_t>(after.forward_count))},
                      {"reverse_count", count_cell(static_cast<std::size_t>(after.reverse_count))},
                      {"forward_before", shown_cell(cell_text(before.forward))},
                      {"reverse_before", shown_cell(cell_text(before.reverse))}});
}

/// Processing keeps the targets, so that both curves have the same points.
Cell points_cell(const laser::Curve& before, const laser::Curve& after) {
  Cell points{Json::array(), fmt::format("{:>12} {:>14} {:>14} {:>14} {:>14}\n", "target [mm]", "fwd measured",
                                         "rev measured", "fwd processed", "rev processed")};
  for (std::size_t i = 0; i < after.points.size(); ++i) points.add(point_cell(before.points[i], after.points[i]));
  return points;
}

Cell processed_cell(const Processed& p, double window_mm) {
  const auto unit = laser::unit_of(p.group.sense);
  AnswerFields fields = measured_line_fields(p.group);
  append(fields, {{"slope", slope_cell(p.readings.level, unit)},
                  {"smoothing", p.readings.smooth ? smoothing_cell(*p.readings.smooth, window_mm, unit) : null_cell()},
                  {"band_before", number_cell(p.readings.band_before, 3)},
                  {"band_after", number_cell(p.readings.band, 3)},
                  {"points", points_cell(p.readings.before_curve, p.curve())},
                  {"notes", {p.curve().notes, {}}}});
  return record_cell(
      "{component} ({sense} along {axis}), parked at {parked_mm} mm\n{slope}  band {band_before} -> {band_after} "
      "{unit} (range of all readings, slope removed)\n{smoothing}{points}",
      fields);
}

// --- as files

laser::Reading reading_at(const Processed& p, double position_mm, double value, Approach approach, int count) {
  laser::Reading reading;
  reading.axis = p.group.axis;
  reading.sense = p.group.sense;
  reading.position_mm = p.group.parked_mm;
  reading.position_mm[index_of(reading.axis)] = position_mm;
  reading.error = value;
  reading.approach = p.curve().approach_known ? approach : Approach::unknown;
  reading.compensated = p.group.compensated;
  reading.extras["readings_averaged"] = count;
  return reading;
}

/// The processed means as a measurement set, what was done in its metadata.
laser::MeasurementSet as_set(const std::vector<Processed>& lines, const laser::MeasurementSet& from, double window_mm) {
  laser::MeasurementSet set;
  set.metadata = from.metadata;
  for (const Processed& p : lines) {
    const auto name = name_of(curve_of(p.group.sense, p.group.axis));
    set.metadata.push_back(
        {"processing",
         fmt::format("{} means; slope {:.4f} {} per m removed by {}", name, p.readings.level.removed.slope_per_m,
                     laser::unit_of(p.group.sense), laser::name_of(p.readings.level.method))});
    if (p.readings.smooth)
      set.metadata.push_back(
          {"processing", fmt::format("{} smoothed by a local quadratic over {} mm", name, window_mm)});
    for (const laser::CurvePoint& point : p.curve().points) {
      if (point.forward)
        set.readings.push_back(
            reading_at(p, point.position_mm, *point.forward, Approach::forward, point.forward_count));
      if (point.reverse && p.curve().approach_known)
        set.readings.push_back(
            reading_at(p, point.position_mm, *point.reverse, Approach::reverse, point.reverse_count));
    }
  }
  return set;
}

Result<void> write_before_after(const std::vector<Processed>& lines, const ProcessArguments& arguments) {
  if (lines.size() != 1)
    return problem(ProblemKind::usage, fmt::format("--plot: expected one measurement line in {}, found {}: split the "
                                                   "file",
                                                   arguments.file, lines.size()));
  const Processed& p = lines.front();
  const Component component = curve_of(p.group.sense, p.group.axis);
  PlotFigure figure{fmt::format("{}  {}", name_of(component), laser::description_of(component)), {}, 1, true};
  figure.panels.push_back(panel_of(p.readings.before, p.readings.before_curve, "as measured"));
  figure.panels.push_back(panel_of(p.readings.after, p.curve(), "processed"));
  return write_plot(arguments.plot, figure);
}

Result<void> write_files(const std::vector<Processed>& lines, const laser::MeasurementSet& from,
                         const ProcessArguments& arguments) {
  if (!arguments.output.empty())
    if (auto written = laser::write_measurement_set(arguments.output, as_set(lines, from, arguments.smooth_mm));
        !written)
      return written;
  return arguments.plot.empty() ? Result<void>() : write_before_after(lines, arguments);
}

/// An exclusion that matches no reading is probably a typing error.
Result<void> all_fit(const std::vector<laser::Exclusion>& exclusions, const laser::Selection& selection,
                     const laser::MeasurementSet& set, const std::string& file) {
  std::set<int> runs;
  int last_row = 0;
  for (const laser::Reading& reading : set.readings) {
    runs.insert(reading.run);
    last_row = std::max(last_row, reading.row);
  }
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < exclusions.size(); ++i) {
    if (selection.left_out[i] > 0) continue;
    const std::string message = exclusions[i].run
                                    ? fmt::format("--exclude-run {}: there is no such run; there are {}",
                                                  *exclusions[i].run, fmt::join(runs, ", "))
                                    : fmt::format("--exclude-row {}: there is no such data row; the last one is {}",
                                                  exclusions[i].row.value_or(0), last_row);
    problems.push_back({ProblemKind::refused, message, file, 0, 0, {}});
  }
  if (problems.empty()) return {};
  return tl::unexpected(folded(std::move(problems)));
}

Result<Outcome> process(VerbContext& context, const ProcessArguments& arguments) {
  if (!arguments.plot.empty()) ECS_DO(plot_format_of(arguments.plot));
  for (const std::string& output : {arguments.output, arguments.plot})
    ECS_DO(check_output_not_input(output, {arguments.file}));
  ECS_TRY(exclusions, exclusions_of(arguments.exclude_runs, arguments.exclude_rows));
  ECS_TRY(imported, read_with_notes(context, arguments.file, arguments.import));
  const laser::Selection selection = laser::selected(imported.set, exclusions);
  ECS_DO(all_fit(exclusions, selection, imported.set, arguments.file));
  std::vector<Processed> lines;
  for (const laser::Group& group : laser::groups_of(selection.chosen)) {
    auto line = processed(selection.chosen, group, arguments);
    if (!line) {
      Problem why = line.error();
      if (why.file.empty()) why.file = arguments.file;
      return tl::unexpected(why);
    }
    lines.push_back(std::move(*line));
  }
  if (lines.empty()) return problem(ProblemKind::refused, fmt::format("{}: no reading is left", arguments.file));
  ECS_DO(write_files(lines, imported.set, arguments));
  const std::size_t readings = imported.set.readings.size();
  return outcome_of(record_cell(
      "{lines}{excluded} of {readings} readings left out\n{output}{plot}",
      {{"file", word_cell(arguments.file)},
       {"lines", list_cell(lines, [&](const Processed& line) { return processed_cell(line, arguments.smooth_mm); })},
       {"readings", count_cell(readings)},
       {"excluded", count_cell(readings - selection.chosen.readings.size())},
       {"output", written_cell("means", arguments.output)},
       {"plot", written_cell("plot", arguments.plot)}}));
}

}  // namespace

extern const VerbDefinition kLaserProcess = verb<ProcessArguments>(
    "laser process", "slope removal, smoothing and exclusion of runs; before and after",
    "ecs laser process eyx.csv --slope least_squares --smooth 150 --exclude-run 3 --plot eyx.svg", process);

}  // namespace ecs::app
