// `ecs laser process`: runs left out, slope removed, curve smoothed; what that changed, as numbers, CSV and plot.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/json.hpp"
#include "base/numbers.hpp"
#include "commissioning/measurements/json.hpp"
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
  const std::string& output = text("-o,--output", "CSV of the processed means");
  const std::string& plot = text("--plot", "before and after on the same scale: OUT.svg or OUT.png");
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
  auto readings = laser::processed_readings(set, group, {method_for(arguments, group), arguments.smooth_mm});
  if (!readings) return tl::unexpected(readings.error());
  if (readings->smoothing_fault) return tl::unexpected(*readings->smoothing_fault);
  return Processed{group, std::move(*readings)};
}

std::string_view word_for(laser::Taken taken) {
  if (taken == laser::Taken::noise) return "noise";
  return taken == laser::Taken::signal ? "signal" : "unknown";
}

// --- as text

std::string smoothing_text(const laser::Smoothed& smooth, std::string_view unit) {
  std::string text = fmt::format("  smoothing removed {:.3f} {} rms, at most {:.3f} at {:.6g} mm", smooth.removed_rms,
                                 unit, smooth.removed_peak, smooth.removed_peak_position_mm);
  if (smooth.taken == laser::Taken::noise) return text + ":\n  no more than the repeats explain as noise\n";
  if (smooth.taken == laser::Taken::signal)
    return text + fmt::format(
                      ":\n  more than noise (F {:.1f}, 99 % point {:.1f}): the form of the curve was removed too; "
                      "use a narrower window\n",
                      smooth.F.value_or(0.0), smooth.F_99.value_or(0.0));
  return text + ";\n  without repeats it is unknown whether that is noise\n";
}

std::string processed_text(const Processed& p) {
  const auto unit = laser::unit_of(p.group.sense);
  std::string text = fmt::format("{} ({} along {}), parked at {} mm\n", name_of(curve_of(p.group.sense, p.group.axis)),
                                 name_of(p.group.sense), letter_of(p.group.axis), parked_text(p.group));
  text += fmt::format("  slope removed ({}): {:.3f} {} per m", laser::name_of(p.readings.level.method),
                      p.readings.level.removed.slope_per_m, unit);
  if (const auto& s = p.readings.level.slope_std_error_per_m) text += fmt::format(" +- {:.3f}", *s);
  text += fmt::format("\n  band {:.3f} -> {:.3f} {} ({})\n", p.readings.band_before, p.readings.band, unit,
                      "range of all readings, slope removed");
  if (p.readings.smooth) text += smoothing_text(*p.readings.smooth, unit);
  text += fmt::format("{:>12} {:>14} {:>14} {:>14} {:>14}\n", "target [mm]", "fwd measured", "rev measured",
                      "fwd processed", "rev processed");
  const auto& before = p.readings.before_curve.points;
  for (std::size_t i = 0; i < before.size() && i < p.curve().points.size(); ++i) {
    const laser::CurvePoint& after = p.curve().points[i];
    text += fmt::format("{:>12.4f} {:>14} {:>14} {:>14} {:>14}\n", before[i].position_mm, cell_text(before[i].forward),
                        cell_text(before[i].reverse), cell_text(after.forward), cell_text(after.reverse));
  }
  return text;
}

// --- as JSON

Json smoothing_json(const laser::Smoothed& smooth, double window_mm) {
  return {{"window_mm", window_mm},
          {"removed_rms", number_or_null(smooth.removed_rms)},
          {"removed_peak", number_or_null(smooth.removed_peak)},
          {"removed_peak_position_mm", number_or_null(smooth.removed_peak_position_mm)},
          {"noise_rms", number_or_null(smooth.noise_rms)},
          {"F", number_or_null(smooth.F)},
          {"F_99", number_or_null(smooth.F_99)},
          {"taken", word_for(smooth.taken)}};
}

Json processed_json(const Processed& p, double window_mm) {
  Json object = json_of_line(p.group.axis, p.group.sense, p.group.parked_mm, p.group.compensated);
  const laser::Levelled& level = p.readings.level;
  object["slope"] = {{"method", laser::name_of(level.method)},
                     {"removed_per_m", number_or_null(level.removed.slope_per_m)},
                     {"removed_offset", number_or_null(level.removed.offset)},
                     {"std_error_per_m", number_or_null(level.slope_std_error_per_m)}};
  object["smoothing"] = p.readings.smooth ? smoothing_json(*p.readings.smooth, window_mm) : Json(nullptr);
  object["band_before"] = number_or_null(p.readings.band_before);
  object["band_after"] = number_or_null(p.readings.band);
  object["points"] = Json::array();
  for (const laser::CurvePoint& point : p.curve().points)
    object["points"].push_back({{"position_mm", number_or_null(point.position_mm)},
                                {"forward", number_or_null(point.forward)},
                                {"reverse", number_or_null(point.reverse)},
                                {"forward_count", point.forward_count},
                                {"reverse_count", point.reverse_count}});
  object["notes"] = p.curve().notes;
  return object;
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

Result<std::string> write_files(const std::vector<Processed>& lines, const laser::MeasurementSet& from,
                                const ProcessArguments& arguments) {
  std::string text;
  if (!arguments.output.empty()) {
    const auto written = laser::write_measurement_set(arguments.output, as_set(lines, from, arguments.smooth_mm));
    if (!written) return tl::unexpected(written.error());
    text += fmt::format("means written to {}\n", arguments.output);
  }
  if (!arguments.plot.empty()) {
    if (const auto drawn = write_before_after(lines, arguments); !drawn) return tl::unexpected(drawn.error());
    text += fmt::format("plot written to {}\n", arguments.plot);
  }
  return text;
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
  if (!arguments.plot.empty())
    if (const auto format = plot_format_of(arguments.plot); !format) return tl::unexpected(format.error());
  for (const std::string& output : {arguments.output, arguments.plot})
    if (const auto distinct = check_output_not_input(output, {arguments.file}); !distinct)
      return tl::unexpected(distinct.error());
  const auto exclusions = exclusions_of(arguments.exclude_runs, arguments.exclude_rows);
  if (!exclusions) return tl::unexpected(exclusions.error());
  const auto imported = read_with_notes(context, arguments.file, arguments.import);
  if (!imported) return tl::unexpected(imported.error());
  const laser::Selection selection = laser::selected(imported->set, *exclusions);
  if (const auto fits = all_fit(*exclusions, selection, imported->set, arguments.file); !fits)
    return tl::unexpected(fits.error());
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
  const auto written = write_files(lines, imported->set, arguments);
  if (!written) return tl::unexpected(written.error());
  Json object{{"file", arguments.file}, {"lines", Json::array()}};
  std::string text;
  for (const Processed& line : lines) {
    text += processed_text(line);
    object["lines"].push_back(processed_json(line, arguments.smooth_mm));
  }
  object["readings"] = imported->set.readings.size();
  object["excluded"] = imported->set.readings.size() - selection.chosen.readings.size();
  object["output"] = text_or_null(arguments.output);
  object["plot"] = text_or_null(arguments.plot);
  text +=
      fmt::format("{} of {} readings left out\n", object["excluded"].get<std::size_t>(), imported->set.readings.size());
  return Outcome{text + *written, one_line(object), kDone};
}

}  // namespace

extern const VerbDefinition kLaserProcess = verb<ProcessArguments>(
    "laser process", "slope removal, smoothing and exclusion of runs; before and after",
    "ecs laser process eyx.csv --slope least_squares --smooth 150 --exclude-run 3 --plot eyx.svg", process);

}  // namespace ecs::app
