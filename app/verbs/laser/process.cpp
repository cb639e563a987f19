// What changes measured curves. `ecs laser process`: runs left out, slope removed, curve smoothed; what that changed,
// as numbers, CSV and plot. `prepare`: one measured line as a file of its own, without what is left out. `normalise`:
// errors referred to 20 degC by a coefficient, and back. `air`: the index of air.

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/plot/curves.hpp"
#include "laser/analysis/normalise.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/map/recipe.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::app {
namespace {

struct ProcessRequest {
  std::string file, slope, output, plot;
  double smooth_mm = 0.0;
  std::vector<std::string> exclude_runs, exclude_rows;
  ImportArguments import;
  static Fields<ProcessRequest> fields() {
    using R = ProcessRequest;
    return {{"FILE", &R::file, "measurement file", Need::required},
            {"--slope", &R::slope, "slope to remove; default: least_squares for straightness, none for the others",
             Words{"none", "end_points", "least_squares"}},
            {"--smooth", &R::smooth_mm, "window of the smoothing by local quadratics [mm]; 0: no smoothing",
             Range{0.0, 1e6}},
            {"--exclude-run", &R::exclude_runs, "runs to exclude: 3 or 3,5"},
            {"--exclude-row", &R::exclude_rows, "data rows to exclude, counted from 1"},
            {"-o,--output", &R::output, "CSV file for the processed means", Is::output},
            {"--plot", &R::plot, "plot before and after on the same scale: OUT.svg or OUT.png", Is::output},
            &R::import};
  }
};

/// One measurement line, processed.
struct Processed {
  laser::Group group;
  laser::ProcessedReadings readings;
  [[nodiscard]] const laser::Curve& curve() const { return readings.curve(); }
};

laser::SlopeMethod method_for(const ProcessRequest& request, const laser::Group& group) {
  const auto chosen = laser::slope_method_named(request.slope);
  return chosen ? *chosen : laser::default_slope(curve_of(group.sense, group.axis));
}

Result<Processed> processed(const laser::MeasurementSet& set, const laser::Group& group,
                            const ProcessRequest& request) {
  ECS_TRY(readings, laser::processed_readings(set, group, {method_for(request, group), request.smooth_mm}));
  if (readings.smoothing_fault) return tl::unexpected(*readings.smoothing_fault);
  return Processed{group, std::move(readings)};
}

// --- as text and JSON

std::string_view word_for(laser::Taken taken) {
  if (taken == laser::Taken::noise) return "noise";
  return taken == laser::Taken::signal ? "signal" : "unknown";
}

std::string taken_text(const laser::Smoothed& smooth) {
  if (smooth.taken == laser::Taken::noise) return ":\n  no more than the noise of the repeats\n";
  if (smooth.taken == laser::Taken::signal)
    return fmt::format(
        ":\n  more than noise (F {:.1f}, 99 % point {:.1f}): the shape of the curve was removed too. Use a narrower "
        "window\n",
        smooth.F.value_or(0.0), smooth.F_99.value_or(0.0));
  return ".\n  Without repeats it is unknown whether that is noise\n";
}

Cell smoothing_cell(const laser::Smoothed& smooth, double window_mm, std::string_view unit) {
  return record_cell(
      "  smoothing removed {removed_rms} {unit} rms, at most {removed_peak} at {removed_peak_position_mm} mm{taken}",
      "window_mm"_is(window_mm), "removed_rms"_is(smooth.removed_rms, 3), "removed_peak"_is(smooth.removed_peak, 3),
      "removed_peak_position_mm"_is(smooth.removed_peak_position_mm,
                                    fmt::format("{:.6g}", smooth.removed_peak_position_mm)),
      "noise_rms"_is(smooth.noise_rms), "F"_is(smooth.F), "F_99"_is(smooth.F_99),
      "taken"_is(word_for(smooth.taken), taken_text(smooth)), "unit"_shown(unit));
}

Cell slope_cell(const laser::Levelled& level, std::string_view unit) {
  const auto& error = level.slope_std_error_per_m;
  return record_cell(level.method == laser::SlopeMethod::none
                         ? "  no straight line removed\n"
                         : "  straight line removed ({method}): slope {removed_per_m}{std_error_per_m} {unit}\n",
                     "method"_is(laser::name_of(level.method)), "removed_per_m"_is(level.removed.slope_per_m, 3),
                     "removed_offset"_is(level.removed.offset),
                     "std_error_per_m"_is(error, error ? fmt::format(" +- {:.3f} (k = 1)", *error) : ""),
                     "unit"_shown(unit == "um" ? "um/m" : fmt::format("{} per m", unit)));
}

Cell mean_cell(const std::optional<double>& mean) { return {number_or_null(mean), cell_text(mean)}; }

Cell point_cell(const laser::CurvePoint& before, const laser::CurvePoint& after) {
  return record_cell("{position_mm:>12} {forward_before:>14} {reverse_before:>14} {forward:>14} {reverse:>14}\n",
                     "position_mm"_is(after.position_mm, 4), "forward"_is(mean_cell(after.forward)),
                     "reverse"_is(mean_cell(after.reverse)), "forward_count"_is(after.forward_count),
                     "reverse_count"_is(after.reverse_count), "forward_before"_shown(cell_text(before.forward)),
                     "reverse_before"_shown(cell_text(before.reverse)));
}

/// Processing keeps the targets, so that both curves have the same points.
Cell points_cell(const laser::Curve& before, const laser::Curve& after) {
  Cell points{Json::array(),
              fmt::format("  mean of the readings at each target, as measured and as processed\n"
                          "{:>12} {:>14} {:>14} {:>14} {:>14}\n",
                          "target [mm]", "fwd measured", "rev measured", "fwd processed", "rev processed")};
  for (std::size_t i = 0; i < after.points.size(); ++i) points.add(point_cell(before.points[i], after.points[i]));
  return points;
}

Cell processed_cell(const Processed& p, double window_mm) {
  const auto unit = laser::unit_of(p.group.sense);
  AnswerFields fields = measured_line_fields(p.group);
  append(fields, "slope"_is(slope_cell(p.readings.level, unit)),
         "smoothing"_is(p.readings.smooth ? smoothing_cell(*p.readings.smooth, window_mm, unit) : null_cell()),
         "band_before"_is(p.readings.band_before, 3), "band_after"_is(p.readings.band, 3),
         "points"_is(points_cell(p.readings.before_curve, p.curve())), "notes"_is(p.curve().notes, ""));
  return record_cell(
      "{component} ({measured}), parked at {parked_mm} mm\n{slope}  band {band_before} -> {band_after} "
      "{unit} (range of all readings, before and after)\n{smoothing}{points}",
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

/// The processed means as a measurement file, what was done in its metadata.
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

Result<void> write_before_after(const std::vector<Processed>& lines, const ProcessRequest& request) {
  if (lines.size() != 1)
    return problem(ProblemKind::usage, "--plot: expected one measurement line in {}, found {}: split the file",
                   request.file, lines.size());
  const Processed& p = lines.front();
  const Component component = curve_of(p.group.sense, p.group.axis);
  PlotFigure figure{fmt::format("{}  {}", name_of(component), laser::description_of(component)), {}, 1, true};
  figure.panels.push_back(panel_of(p.readings.before, p.readings.before_curve, "as measured"));
  figure.panels.push_back(panel_of(p.readings.after, p.curve(), "processed"));
  return write_plot(request.plot, figure);
}

Result<void> write_files(const std::vector<Processed>& lines, const laser::MeasurementSet& from,
                         const ProcessRequest& request) {
  if (!request.output.empty())
    if (auto written = laser::write_measurement_set(request.output, as_set(lines, from, request.smooth_mm)); !written)
      return written;
  return request.plot.empty() ? Result<void>() : write_before_after(lines, request);
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
                                    ? fmt::format("--exclude-run {}: there is no such run; existing: {}",
                                                  *exclusions[i].run, fmt::join(runs, ", "))
                                    : fmt::format("--exclude-row {}: there is no such data row; the last one is {}",
                                                  exclusions[i].row.value_or(0), last_row);
    problems.push_back({ProblemKind::refused, message, file, 0, 0, {}});
  }
  if (problems.empty()) return {};
  return tl::unexpected(folded(std::move(problems)));
}

Result<Outcome> process(VerbContext& context, const ProcessRequest& request) {
  if (!request.plot.empty()) ECS_DO(plot_format_of(request.plot));
  for (const std::string& output : {request.output, request.plot})
    ECS_DO(check_output_not_input(output, {request.file}));
  ECS_TRY(exclusions, exclusions_of(request.exclude_runs, request.exclude_rows));
  ECS_TRY(imported, read_with_notes(context.console, request.file, request.import));
  const laser::Selection selection = laser::selected(imported.set, exclusions);
  ECS_DO(all_fit(exclusions, selection, imported.set, request.file));
  std::vector<Processed> lines;
  for (const laser::Group& group : laser::groups_of(selection.chosen)) {
    auto line = processed(selection.chosen, group, request);
    if (!line) {
      Problem why = line.error();
      if (why.file.empty()) why.file = request.file;
      return tl::unexpected(why);
    }
    lines.push_back(std::move(*line));
  }
  if (lines.empty()) return problem(ProblemKind::refused, "{}: every reading is excluded", request.file);
  ECS_DO(write_files(lines, imported.set, request));
  const std::size_t readings = imported.set.readings.size();
  return outcome_of(record_cell(
      "{lines}{excluded} of {readings} readings excluded\n{output}{plot}", "file"_is(request.file),
      "lines"_is(list_cell(lines, [&](const Processed& line) { return processed_cell(line, request.smooth_mm); })),
      "readings"_is(readings), "excluded"_is(readings - selection.chosen.readings.size()),
      "output"_is(written_cell("means", request.output)), "plot"_is(written_cell("plot", request.plot))));
}

Result<Outcome> prepare(VerbContext&, const commissioning::PrepareRequest& request) {
  ECS_DO(check_output_not_input(request.output, request.files));
  ECS_TRY(set, commissioning::prepared_line(request));
  ECS_DO(laser::write_measurement_set(request.output, set));
  AnswerFields fields = described("output"_is(request.output), "count"_shown(set.readings.size()));
  append(fields, set_fields(set));
  return outcome_of(record_cell("{lines}{count} readings written to {output}", fields));
}

struct NormaliseRequest {
  std::string file, output;
  std::optional<double> coefficient, instrument, material_degC;
  std::string sensor = "t_material_degC";
  double fixed_mm = 0.0;
  bool back = false;
  ImportArguments import;
  static Fields<NormaliseRequest> fields() {
    using R = NormaliseRequest;
    return {
        {"FILE", &R::file, "measurement file", Need::required},
        {"--coefficient", &R::coefficient,
         "expansion coefficient [um/(m degC)]; 0 removes the material correction that the instrument applied"},
        {"--instrument", &R::instrument,
         "coefficient that the instrument has already applied; read from the file if not given (Renishaw Exp coeff)"},
        {"--material-sensor", &R::sensor, "column with the material temperature"},
        {"--material", &R::material_degC, "one material temperature for all readings [degC]"},
        {"--fixed", &R::fixed_mm, "fixed point of the expansion [mm]"},
        {"--back", &R::back, "undo the normalisation exactly"},
        {"-o,--output", &R::output, "CSV file to write", Is::output},
        &R::import};
  }
};

constexpr const char* kNotSaved = "not saved: give -o OUT.csv to save it\n";

Result<void> written(const std::string& output, const laser::MeasurementSet& set) {
  if (output.empty()) return {};
  return laser::write_measurement_set(output, set);
}

Result<Outcome> taken_back(const NormaliseRequest& request, const laser::MeasurementSet& set) {
  ECS_TRY(back, laser::denormalised(set));
  ECS_DO(written(request.output, back));
  return outcome_of(record_cell(
      "{readings} readings restored to their values before normalisation to 20 degC\n{output}", "file"_is(request.file),
      "readings"_is(back.readings.size()),
      "output"_is(request.output.empty() ? null_cell(kNotSaved)
                                         : Cell{request.output, fmt::format("written to {}\n", request.output)})));
}

Result<Outcome> normalise(VerbContext& context, const NormaliseRequest& request) {
  if (request.back == request.coefficient.has_value())
    return problem(ProblemKind::usage,
                   "expected --coefficient C [um/(m degC)], where 0 removes the material correction that the "
                   "instrument applied, or "
                   "--back to undo an earlier `ecs laser normalise`");
  ECS_DO(check_output_not_input(request.output, {request.file}));
  ECS_TRY(imported, read_with_notes(context.console, request.file, request.import));
  if (request.back) return taken_back(request, imported.set);
  laser::Normalisation how;
  how.coefficient_um_per_m_degC = *request.coefficient;
  how.instrument_um_per_m_degC = request.instrument;
  how.material_degC = request.material_degC;
  how.sensor = request.sensor;
  how.fixed_mm = request.fixed_mm;
  const auto done = laser::normalised(imported.set, how);
  if (!done) {
    Problem why = done.error();
    why.file = request.file;
    return tl::unexpected(why);
  }
  ECS_DO(written(request.output, done->set));
  return outcome_of(record_cell(
      how.coefficient_um_per_m_degC == 0.0
          ? "correction of the instrument removed from {changed} of {readings} readings, which changed by up to "
            "{largest_um} um\n{notes}{output}"
          : "{changed} of {readings} readings normalised to 20 degC, changed by up to {largest_um} um\n{notes}{output}",
      "file"_is(request.file), "coefficient_um_per_m_degC"_is(how.coefficient_um_per_m_degC),
      "instrument_um_per_m_degC"_is(done->instrument_um_per_m_degC), "least_degC"_is(done->least_degC),
      "most_degC"_is(done->most_degC), "fixed_mm"_is(how.fixed_mm), "changed"_is(done->changed),
      "readings"_is(done->set.readings.size()), "largest_um"_is(done->largest_um, 3),
      "per_coefficient_um"_is(done->per_coefficient_um), "notes"_is(lines_cell(done->notes, "  ")),
      "output"_is(request.output.empty()
                      ? null_cell(kNotSaved)
                      : Cell{request.output,
                             fmt::format("written to {}; --back undoes the normalisation\n", request.output)})));
}

struct AirRequest {
  double temperature_degC = laser::BeamAir{}.temperature_degC, pressure_hPa = laser::BeamAir{}.pressure_hPa,
         humidity_pct = laser::BeamAir{}.humidity_pct, co2_ppm = laser::BeamAir{}.co2_ppm,
         wavelength_nm = laser::kRedHeNe_nm;
  static Fields<AirRequest> fields() {
    using R = AirRequest;
    return {{"--temperature", &R::temperature_degC, "air temperature [degC]"},
            {"--pressure", &R::pressure_hPa, "air pressure [hPa]"},
            {"--humidity", &R::humidity_pct, "relative humidity [%]"},
            {"--co2", &R::co2_ppm, "carbon dioxide [ppm]"},
            {"--wavelength", &R::wavelength_nm, "vacuum wavelength [nm]"}};
  }
};

/// No workshop has it: the highest town is at 500 hPa.
std::string unusual_pressure_text(double hPa) {
  constexpr double kLeast_hPa = 500.0, kMost_hPa = 1100.0;
  if (hPa >= kLeast_hPa && hPa <= kMost_hPa) return "";
  return fmt::format(
      "warning: {:g} hPa is outside {:g} to {:g} hPa, the usual air pressure: is it in another unit (1 kPa = 10 "
      "hPa)?\n",
      hPa, kLeast_hPa, kMost_hPa);
}

Result<Outcome> air(VerbContext&, const AirRequest& request) {
  const laser::BeamAir beam{request.temperature_degC, request.pressure_hPa, request.humidity_pct, request.co2_ppm};
  const auto ciddor = laser::refractive_index(beam, request.wavelength_nm);
  if (!ciddor) return tl::unexpected(Problem{ProblemKind::usage, ciddor.error().message, {}, 0, 0, {}});
  const auto edlen = laser::refractive_index(beam, request.wavelength_nm, laser::AirEquation::modified_edlen);
  const auto standard = laser::refractive_index({}, request.wavelength_nm);
  if (!edlen || !standard) return tl::unexpected(edlen ? standard.error() : edlen.error());
  const double against_standard_um_per_m = (*ciddor / *standard - 1.0) * 1e6;
  return outcome_of(
      record_cell("refractive index    {ciddor} (Ciddor)   {modified_edlen} (modified Edlen)\nwavelength in air   "
                  "{wavelength_in_air_nm} nm\nan instrument set to 20 degC, 1013.25 hPa, 50 % reads "
                  "{against_standard_um_per_m} um per metre too {much}\n{unusual}",
                  "ciddor"_is(*ciddor, 9), "modified_edlen"_is(*edlen, 9),
                  "wavelength_in_air_nm"_is(request.wavelength_nm / *ciddor, 6),
                  "against_standard_um_per_m"_is(against_standard_um_per_m,
                                                 fmt::format("{:.3f}", std::abs(against_standard_um_per_m))),
                  "much"_shown(against_standard_um_per_m < 0.0 ? "little" : "much"),
                  "unusual"_shown(unusual_pressure_text(request.pressure_hPa))));
}

}  // namespace

extern const std::vector<Action> kLaserProcessing{
    action("laser process", "remove slope, smooth and exclude runs; shows before and after",
           "ecs laser process eyx.csv --slope least_squares --smooth 150 --exclude-run 3 --plot eyx.svg", process,
           {.logged = Logged::when_written, .kind = "processing"}),
    action(
        "laser prepare", "write a measured line as a file of its own: joined, corrected, without the excluded readings",
        "ecs laser prepare EXX.csv --line \"EX along X at Y -1400, Z 0\" --leave-out-run 3=vibration -o exx_line.csv",
        prepare, {.logged = Logged::when_written, .kind = "processing"}),
    action("laser normalise", "normalise positioning errors to 20 degC with an expansion coefficient, or undo it",
           "ecs laser normalise exx.csv --coefficient 11.7 -o exx20.csv\n  ecs laser normalise exx20.csv --back -o "
           "exx.csv",
           normalise, {.logged = Logged::when_written, .kind = "processing"}),
    action("laser air", "compute the refractive index of air by Ciddor and modified Edlen",
           "ecs laser air --temperature 21.3 --pressure 992.4 --humidity 42", air)};

}  // namespace ecs::app
