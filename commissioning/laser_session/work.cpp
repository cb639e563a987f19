#include "commissioning/laser_session/work.hpp"

#include <fmt/format.h>

#include "commissioning/plot/curves.hpp"
#include "laser/analysis/pipeline.hpp"

namespace ecs::commissioning {
namespace {

std::string y_label_of(Sense sense) { return fmt::format("error [{}]", is_rotation(sense) ? "µm/m" : "µm"); }

/// Names short enough for the legend of a curve beside a list.
PlotPanel screen_panel(const laser::MeasurementSet& readings, const laser::Curve& curve, const std::string& title) {
  PlotPanel panel = panel_of(readings, curve, title);
  panel.x_label = fmt::format("{} [mm]", letter_of(curve.axis));
  for (PlotSeries& series : panel.series) {
    if (series.mark == Mark::forward_reading) series.name = "fwd runs";
    if (series.mark == Mark::reverse_reading) series.name = "rev runs";
    if (series.mark == Mark::forward) series.name = "forward";
    if (series.mark == Mark::reverse) series.name = "reverse";
  }
  return panel;
}

/// One, or two for a rotation from parallel lines.
using ResultsBehind = std::vector<const LaserLineResult*>;

/// From one line what is done to its readings, from two to the rotation that they show, which has none.
Result<laser::ProcessedReadings> steps_of(const ResultsBehind& lines, const laser::CurveSteps& steps) {
  if (lines.size() == 1) return laser::processed_readings(lines.front()->chosen, lines.front()->group, steps);
  ECS_TRY(rotation, laser::rotation_from(*lines[0]->curve, *lines[1]->curve));
  ECS_TRY(processed, laser::processed(rotation, steps));
  laser::ProcessedReadings out{std::move(processed), {}, std::move(rotation), {}, 0.0, 0.0};
  out.band_before = laser::band_of(out.before_curve);
  out.band = laser::band_of(out.level.curve);
  return out;
}

}  // namespace

bool left_out(const LaserLineChoice& choice, const laser::MeasurementSet& set, std::size_t reading) {
  return choice.readings.contains(reading) || choice.runs.contains(set.readings[reading].run);
}

std::size_t count_left_out(const LaserLineChoice& choice, const laser::MeasurementSet& set) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < set.readings.size(); ++i) count += left_out(choice, set, i) ? 1U : 0U;
  return count;
}

LaserLineResult line_result(const LaserLine& line, const LaserLineChoice& choice) {
  LaserLineResult result;
  result.choice = choice;
  result.chosen = *line.set;
  result.chosen.readings.clear();
  for (const std::size_t i : line.group.readings) {
    const laser::Reading& reading = line.set->readings[i];
    if (left_out(choice, *line.set, i))
      result.left_out.push_back({laser::target_mm(reading), reading.error});
    else
      result.chosen.readings.push_back(reading);
  }
  const std::string title = name_of_line(line) + ", " + line.place;
  result.panel = {title, fmt::format("{} [mm]", letter_of(line.group.axis)), y_label_of(line.group.sense), {}};
  const auto groups = laser::groups_of(result.chosen);
  if (groups.empty()) {
    result.problem = "every reading is excluded";
    return result;
  }
  result.group = groups.front();
  auto curve = laser::averaged(result.chosen, result.group);
  auto iso = laser::iso230_of(result.chosen, result.group);
  if (!curve || !iso) {
    result.problem = to_text(curve ? iso.error() : curve.error());
    return result;
  }
  result.panel = screen_panel(result.chosen, *curve, title);
  result.curve = std::move(*curve);
  result.iso = std::move(*iso);
  return result;
}

namespace {

LaserCurve curve_for(const LaserWork& work, Component component, std::vector<std::size_t> lines) {
  const laser::ComponentRecipe choice = laser::settings_of(work.choices.recipe, component);
  LaserCurve out;
  out.component = component;
  out.recommended = laser::default_slope(component);
  out.slope = choice.slope.value_or(out.recommended);
  ResultsBehind results;
  for (const std::size_t line : lines) {
    results.push_back(&work.results[line]);
    if (!results.back()->curve) out.problem = results.back()->problem;
    out.left_out_of_lines += results.back()->left_out.size();
  }
  out.lines = std::move(lines);
  if (!out.problem.empty()) return out;
  if (results.size() == 1) out.left_out = results.front()->left_out;
  auto steps = steps_of(results, {out.slope, choice.smoothing_mm});
  if (!steps) {
    out.problem = to_text(steps.error());
    return out;
  }
  out.removed_per_m = steps->level.removed.slope_per_m;
  out.band_before = steps->band_before;
  out.band_after = steps->smooth ? laser::band_of(steps->smooth->curve) : steps->band;
  if (steps->smoothing_fault) out.problem = "smoothing: " + to_text(*steps->smoothing_fault);
  out.unchanged = out.slope == laser::SlopeMethod::none && !steps->smooth;
  out.before = screen_panel(steps->before, steps->before_curve, out.unchanged ? "before and after" : "before");
  out.after = screen_panel(steps->after, steps->curve(), "after");
  out.smoothed = std::move(steps->smooth);
  return out;
}

/// Of the components of the map, or of every line where no parameters say which they are.
std::vector<LaserCurve> curves_of(const LaserWork& work) {
  std::vector<LaserCurve> curves;
  for (const laser::ComponentRecipe& one : work.map.suggested.recipe.components)
    if (auto lines = lines_behind(one, work.lines); !lines.empty())
      curves.push_back(curve_for(work, one.component, std::move(lines)));
  if (work.map.parameters) return curves;
  for (std::size_t k = 0; k < work.lines.size(); ++k) curves.push_back(curve_for(work, work.lines[k].component, {k}));
  return curves;
}

/// Files that did not change are not read again.
std::vector<LaserFile> read_files(const LaserChoices& choices, const LaserWork* before, JobControl& control) {
  std::vector<LaserFile> files;
  for (const LaserFileChoice& choice : choices.files) {
    if (control.cancelled) break;
    const LaserFile* known = before == nullptr ? nullptr : file_read(before->files, choice);
    const bool current = known != nullptr && known->stamp == stamp_of(choice.path);
    files.push_back(current ? *known : read_laser_file(choice));
    files.back().choice = choice;
    control.part = static_cast<double>(files.size()) / static_cast<double>(choices.files.size());
  }
  return files;
}

}  // namespace

LaserWorkPtr worked_out(const LaserChoices& choices, const LaserWorkPtr& before, JobControl& control) {
  auto work = std::make_shared<LaserWork>();
  work->choices = choices;
  work->files = read_files(choices, before.get(), control);
  work->lines = laser_lines(work->files);
  for (const LaserLine& line : work->lines) work->results.push_back(line_result(line, choice_for_line(choices, line)));
  work->map = laser_map(choices, work->lines);
  work->curves = curves_of(*work);
  return work;
}

std::string mismatch_of(const params::ParametersFile& file, const std::vector<LaserLine>& lines) {
  const UnitParameters& p = file.parameters;
  for (const LaserLine& line : lines) {
    if (!p.axis_present[index_of(line.group.axis)])
      return fmt::format("{} was measured, but the parameters ({}) have no axis {}.", name_of(line.component),
                         configuration_of(p), letter_of(line.group.axis));
    const laser::MeasuredMachine at_hand{file.identity.machine, file.identity.serial_number};
    if (const auto other = other_machine(measured_machine(line.set->metadata), at_hand, "the parameters are of"))
      return fmt::format("{} was {}.", name_of(line.component), *other);
  }
  return {};
}

}  // namespace ecs::commissioning
