// `ecs laser stats`: accuracy and repeatability by ISO 230-2 of every measurement line in the files; files of one line
// are its runs. Many lines are summed up in few rows.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/session/commands.hpp"
#include "laser/analysis/growth.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/analysis/pipeline.hpp"
#include "laser/analysis/run_drift.hpp"
#include "laser/analysis/turn.hpp"
#include "laser/standards/iso230_uncertainty.hpp"

namespace ecs::app {

/// One measurement line of the answer.
struct LineStatistics {
  laser::Iso230 iso;
  laser::Group group;
  std::vector<std::string> files;
  std::size_t outliers = 0;
  bool drifts = false;   ///< or a run is apart from the others
  double largest = 0.0;  ///< the reading farthest from 0, um or um/m
};

/// Up to this many lines are shown whole.
inline constexpr std::size_t kMostWholeLines = 6;

namespace {

/// Rows of the table of the worst lines, all components together; at least one each.
constexpr std::size_t kWorstLines = 20;
constexpr std::size_t kMostNotes = 8;

using Lines = std::vector<const LineStatistics*>;

std::string value_text(const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

std::string component_text(const LineStatistics& line) {
  return laser::curve_name(line.iso.sense, line.iso.axis, line.iso.rotary);
}

auto badness(const LineStatistics& line) {
  return std::tuple(line.iso.A.value_or(-1.0), line.iso.range, std::abs(line.largest));
}

/// In the order of their first line.
std::vector<Lines> by_component(const std::vector<LineStatistics>& lines) {
  std::vector<Lines> components;
  for (const LineStatistics& line : lines) {
    const auto same = std::find_if(components.begin(), components.end(), [&](const Lines& of) {
      return component_text(*of.front()) == component_text(line);
    });
    (same == components.end() ? components.emplace_back() : *same).push_back(&line);
  }
  return components;
}

std::string component_row(const Lines& of) {
  std::size_t readings = 0, outliers = 0, drifting = 0;
  double largest = 0.0, range = 0.0;
  std::optional<double> accuracy;
  for (const LineStatistics* line : of) {
    readings += line->group.readings.size();
    outliers += line->outliers;
    drifting += line->drifts ? 1 : 0;
    if (std::abs(line->largest) > std::abs(largest)) largest = line->largest;
    range = std::max(range, line->iso.range);
    if (line->iso.A) accuracy = std::max(accuracy.value_or(0.0), *line->iso.A);
  }
  return fmt::format("{:<5} {:<5} {:>6} {:>9} {:>11.3f} {:>10.3f} {:>9} {:>9} {:>9}\n", component_text(*of.front()),
                     laser::unit_of(of.front()->iso.sense), of.size(), readings, largest, range, value_text(accuracy),
                     outliers, drifting);
}

std::string line_row(const LineStatistics& line, bool with_file) {
  std::string text =
      fmt::format("{:<5} {:<18} {:>7} {:>9.3f} {:>9.3f} {:>8} {:>8} {:>8}", component_text(line),
                  commissioning::parked_text(line.group), line.iso.targets.size(), line.largest, line.iso.range,
                  value_text(line.iso.A), value_text(line.iso.R), value_text(line.iso.B));
  if (with_file) text += fmt::format("  {}", fmt::join(line.files, " + "));
  return text + "\n";
}

std::string worst_rows(std::vector<Lines> components) {
  const std::size_t most = std::max<std::size_t>(1, kWorstLines / components.size());
  std::string rows;
  for (Lines& of : components) {
    const bool one_file =
        std::all_of(of.begin(), of.end(), [&](const auto* line) { return line->files == of.front()->files; });
    std::stable_sort(of.begin(), of.end(), [](const auto* a, const auto* b) { return badness(*a) > badness(*b); });
    for (std::size_t i = 0; i < std::min(most, of.size()); ++i) rows += line_row(*of[i], !one_file);
  }
  return rows;
}

std::string note_rows(const std::vector<LineStatistics>& lines) {
  std::map<std::string, std::size_t> counts;
  for (const LineStatistics& line : lines)
    for (const std::string& note : line.iso.notes) ++counts[note];
  std::vector<std::pair<std::string, std::size_t>> notes(counts.begin(), counts.end());
  std::stable_sort(notes.begin(), notes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostNotes, notes.size()); ++i)
    text += fmt::format("note on {} of {} lines: {}\n", notes[i].second, lines.size(), notes[i].first);
  if (notes.size() > kMostNotes) text += fmt::format("and {} more kinds of notes\n", notes.size() - kMostNotes);
  return text;
}

/// A row for each component, then the worst lines (by A; without A by range, then by the largest reading), then the
/// notes with the number of lines that have them. @param lines  at least one
std::string summary_text(const std::vector<LineStatistics>& lines) {
  const auto components = by_component(lines);
  std::string text = fmt::format("{:<5} {:<5} {:>6} {:>9} {:>11} {:>10} {:>9} {:>9} {:>9}\n", "", "unit", "lines",
                                 "readings", "largest", "max range", "max A", "outliers", "drifting");
  for (const Lines& of : components) text += component_row(of);
  text += fmt::format("\nthe worst:\n{:<5} {:<18} {:>7} {:>9} {:>9} {:>8} {:>8} {:>8}\n", "", "parked [mm]", "targets",
                      "largest", "range", "A", "R", "B");
  text += worst_rows(components) + "largest: the reading with the largest absolute value\n";
  text += "\n" + note_rows(lines);
  return text +
         fmt::format("{} measurement lines: --all shows every quantity of each, --json writes them for programs\n",
                     lines.size());
}

constexpr double kMostUncertain = 1e6;

/// Whether anything that contributes was given.
bool contributes(const laser::Iso230Conditions& c) {
  return c.instrument_um_per_m > 0.0 || c.instrument_um > 0.0 || c.misalignment_mm > 0.0 || c.environment_um > 0.0 ||
         c.temperature_range_degC > 0.0 || (c.expansion_range_um_per_m_degC > 0.0 && c.off_20_degC != 0.0);
}

/// Below a heading of their own.
Fields<laser::Iso230Conditions> uncertainty_fields() {
  using C = laser::Iso230Conditions;
  constexpr Range kSize{0.0, kMostUncertain}, kSigned{-kMostUncertain, kMostUncertain};
  return Fields<C>{
      {"--instrument-um-per-m", &C::instrument_um_per_m,
       "expanded uncertainty of the instrument, length-proportional part", kSize},
      {"--instrument-um", &C::instrument_um, "expanded uncertainty of the instrument, constant part", kSize},
      {"--misalignment-mm", &C::misalignment_mm, "lateral offset between beam and axis over the measured length",
       kSize},
      {"--environment-um", &C::environment_um, "environmental variation error EVE: range of a drift test", kSize},
      {"--temperature-range", &C::temperature_range_degC,
       "range of the error of the measured machine temperature [degC]", kSize},
      {"--off-20", &C::off_20_degC, "machine temperature minus 20 degC", kSigned},
      {"--expansion", &C::expansion_um_per_m_degC, "expansion coefficient used [um/(m degC)]", kSize},
      {"--expansion-range", &C::expansion_range_um_per_m_degC, "range of the expansion coefficient [um/(m degC)]",
       kSize}}
      .under("Uncertainty (ISO 230-2 annex A, k = 2)");
}

/// null and no text where nothing was given, or no uncertainty exists.
Cell uncertainty_cell(const laser::Iso230& iso, const laser::Iso230Conditions& conditions) {
  if (!contributes(conditions)) return null_cell("");
  const auto uncertainty = laser::iso230_uncertainty_of(iso, conditions);
  if (!uncertainty) return null_cell("  no uncertainty: these options apply to lengths at two or more targets\n");
  Json parts = Json::array();
  std::string text = "  uncertainty and its contributions (all k = 2)";
  AnswerFields fields = described("coverage_factor"_is(laser::kCoverage), "length_mm"_is(uncertainty->length_mm));
  const char* separator = ": ";
  std::string not_stated;
  for (const LaserQuantity& quantity : kLaserQuantities) {
    if (quantity.uncertainty == nullptr) continue;
    const auto& U = *uncertainty.*quantity.uncertainty;
    fields.push_back(FieldKey(quantity.key)(U, ""));
    if (U && std::string_view(quantity.key).size() == 1) {
      text += fmt::format("{}U({}) {:.2f}", separator, quantity.key, *U);
      separator = ", ";
    } else if (!U && iso.*quantity.value && conditions.environment_um == 0.0 &&
               std::string_view(quantity.key).size() == 1) {
      not_stated += fmt::format("{}U({})", not_stated.empty() ? "" : ", ", quantity.key);
    }
  }
  text += not_stated.empty() ? " um\n" : fmt::format(" um; {}: not stated without --environment-um\n", not_stated);
  for (const laser::UncertaintyPart& part : uncertainty->parts) {
    parts.push_back(object_of("name"_is(part.name), "U_um"_is(part.U_um)));
    text += fmt::format("    {:<28} {:>8.2f} um\n", part.name, part.U_um);
  }
  fields.push_back("parts"_is(std::move(parts)));
  return {object_of(fields), std::move(text)};
}

/// Outliers of a line in the text without --all.
constexpr std::size_t kMostOutliers = 10;

struct StatsRequest {
  std::vector<std::string> files;
  bool all = false;
  laser::Iso230Conditions uncertainty;
  ImportArguments import = ImportArguments().of_any_axis();
  static Fields<StatsRequest> fields() {
    using R = StatsRequest;
    return {{"FILE", &R::files, "measurement files; files of the same line are joined as runs", Need::required},
            {"--all", &R::all, "show every measurement line in full"},
            {&R::uncertainty, uncertainty_fields()},
            &R::import};
  }
};

Json target_json(const laser::Iso230Target& t, bool rotary) {
  return object_of(FieldKey(rotary ? "position_deg" : "position_mm")(t.position_mm), "n_forward"_is(t.n_forward),
                   "n_reverse"_is(t.n_reverse), "mean_forward"_is(t.mean_forward), "mean_reverse"_is(t.mean_reverse),
                   "mean"_is(t.mean), "s_forward"_is(t.s_forward), "s_reverse"_is(t.s_reverse),
                   "s_undirected"_is(t.s_undirected), "B"_is(t.B), "R_forward"_is(t.R_forward),
                   "R_reverse"_is(t.R_reverse), "R"_is(t.R));
}

Cell quantity_cell(std::string_view symbol, const std::optional<double>& value, std::string_view unit,
                   std::string_view name) {
  return {number_or_null(value),
          fmt::format("  {:<8} {:>12} {:<5} {}\n", symbol, number_cell(value, 3).text, unit, name)};
}

/// One measured line with the files that it comes from.
struct MeasuredLine {
  const laser::MeasurementSet& set;
  const laser::Group& group;
  std::vector<std::string> files;
  /// Of a reading of the set.
  std::function<std::string(std::size_t)> file_of;
};

/// The command that leaves them out of the file that the first of them is in.
std::string leaving_out(const MeasuredLine& line, const std::vector<std::size_t>& outliers,
                        const ImportArguments& import) {
  const std::string file = line.file_of(outliers.front());
  std::string rows;
  for (const std::size_t i : outliers)
    if (line.file_of(i) == file) rows += fmt::format("{}{}", rows.empty() ? "" : ",", line.set.readings[i].row);
  std::vector<std::string> words{"ecs", "laser", "process", file, "--exclude-row", rows};
  const std::vector<std::string> given = import_words(import);
  words.insert(words.end(), given.begin(), given.end());
  return shell_command(words);
}

/// @param most  outliers in the text
Cell outliers_cell(const MeasuredLine& line, std::size_t most, const ImportArguments& import) {
  Cell list{Json::array(), {}};
  std::vector<std::size_t> named;
  for (const std::size_t i : laser::outliers_of(line.set, line.group)) {
    const laser::Reading& reading = line.set.readings[i];
    const bool shown = list.json.size() < most;
    if (shown) named.push_back(i);
    list.add(record_cell(
        shown ? "  outlier: {reading} {unit} at {at}, run {run}{approach}, differs strongly from its repeats "
                "({file}:{line}, row {row})\n"
              : "",
        "file"_is(line.file_of(i)), "line"_is(reading.line), "row"_is(reading.row), "run"_is(reading.run),
        FieldKey(reading.rotary ? "position_deg" : "position_mm")(laser::target_of(reading)),
        "reading"_is(reading.error, shortest(reading.error)), "unit"_shown(laser::unit_of(reading.sense)),
        "at"_shown(fmt::format("{:g} {}", laser::target_of(reading), laser::target_unit(reading.rotary))),
        "approach"_shown(reading.approach == Approach::unknown
                             ? std::string()
                             : std::string(reading.approach == Approach::forward ? " forward" : " reverse"))));
  }
  if (list.json.size() > most)
    list.text += fmt::format("  and {} more outliers: --all shows them\n", list.json.size() - most);
  if (!named.empty() && !line.group.rotary)  // `laser process` takes linear axes
    list.text +=
        fmt::format("  `{}` excludes {}\n", leaving_out(line, named, import), named.size() == 1 ? "it" : "them");
  return list;
}

Cell drift_cell(const MeasuredLine& line) {
  laser::Group without_outliers = line.group;
  const auto outliers = laser::outliers_of(line.set, line.group);
  std::erase_if(without_outliers.readings,
                [&](std::size_t i) { return std::binary_search(outliers.begin(), outliers.end(), i); });
  const auto drift = laser::run_drift_of(line.set, without_outliers);
  if (!drift) return null_cell("");
  const auto unit = laser::unit_of(line.group.sense);
  const Cell runs = list_cell(drift->runs, [&](const laser::RunOffset& run) {
    const bool apart = std::find(drift->apart.begin(), drift->apart.end(), run.run) != drift->apart.end();
    return record_cell(
        apart ? "  run {run} differs from the others by {offset:+.3g} +- {sigma:.2g} {unit} (k = 1)\n" : "",
        "run"_is(run.run), "offset"_is(run.offset), "sigma"_is(run.sigma), "unit"_shown(unit));
  });
  constexpr const char* kDrifts =
      "  drift: {per_run:+.3g} +- {per_run_sigma:.2g} {unit} (k = 1) per run, {first_to_last:+.3g} {unit} from the "
      "first to "
      "the last run\n{runs}";
  return record_cell(drift->drifts ? kDrifts : "{runs}", "per_run"_is(drift->per_run),
                     "per_run_sigma"_is(drift->per_run_sigma), "first_to_last"_is(drift->first_to_last),
                     "drifts"_is(drift->drifts), "apart"_is(drift->apart), "runs"_is(runs), "unit"_shown(unit));
}

std::string lag_text(double lag_s) {
  if (lag_s == 0.0) return "at once";
  return lag_s > 0.0 ? fmt::format("growth {:.3g} s later", lag_s) : fmt::format("sensor {:.3g} s later", -lag_s);
}

/// Of readings at one target over time (ISO 230-3).
Cell growth_cell(const MeasuredLine& line) {
  const auto growth = laser::growth_of(line.set, line.group);
  if (!growth) return null_cell("");
  const auto unit = laser::unit_of(line.group.sense);
  const Cell sensors = list_cell(growth->sensors, [&](const laser::SensorGrowth& one) {
    return record_cell(
        "    {sensor:<22} {per_degC:+8.3f} {unit} per degC, {lag_s}: {explained} % explained, residual {rms_left:.2f} "
        "{unit} rms\n",
        "sensor"_is(one.sensor), "per_degC"_is(one.per_degC), "lag_s"_is(one.lag_s, lag_text(one.lag_s)),
        "explained"_is(one.explained, fmt::format("{:.1f}", 100.0 * one.explained)), "rms_left"_is(one.rms_left),
        "unit"_shown(unit));
  });
  return record_cell(
      "  growth at one target in {hours:.2f} h{stretches}: {range:.2f} {unit}, {range_last_hour:.2f} {unit} in the "
      "last hour\n{sensors}",
      "hours"_is(growth->hours), "range"_is(growth->range), "range_last_hour"_is(growth->range_last_hour),
      "stretches"_is(growth->stretches,
                     growth->stretches > 1 ? fmt::format(" (the longest of {} runs)", growth->stretches) : ""),
      "sensors"_is(sensors), "unit"_shown(unit));
}

Cell wave_cell(const laser::TurnWave& wave, Sense sense) {
  constexpr double kUm_per_m_arcsec = 4.84813681;
  constexpr const char* kUsual[] = {"", ": an eccentric scale or table", ": an oval or tilted scale"};
  return record_cell(
      "    {order} per turn ({period_deg:.4g} deg): amplitude {amplitude:.2f} +- {amplitude_sigma:.2g} {unit}{arcsec} "
      "(k = 1), "
      "phase {phase_deg} deg{usual}\n",
      "order"_is(wave.order), "period_deg"_is(360.0 / wave.order), "amplitude"_is(wave.amplitude),
      "amplitude_sigma"_is(wave.amplitude_sigma),
      "phase_deg"_is(wave.phase_deg, fmt::format("{:.0f}", std::fmod(std::round(wave.phase_deg), 360.0))),
      "p_value"_is(wave.p_value), "unit"_shown(laser::unit_of(sense)),
      "usual"_shown(wave.order <= 2 ? kUsual[wave.order] : ""),
      "arcsec"_shown(is_rotation(sense) ? fmt::format(" ({:.2f} arcsec)", wave.amplitude / kUm_per_m_arcsec) : ""));
}

/// Of a rotary axis: offset, reversal and waves of a turn.
Cell turn_cell(const MeasuredLine& line) {
  const auto turn = laser::turn_of(line.set, line.group);
  if (!turn) return null_cell("");
  const auto unit = laser::unit_of(line.group.sense);
  const std::string none = fmt::format("    no wave with {} to {} periods per turn exceeds the noise\n",
                                       turn->least_waves, turn->most_waves);
  const bool has_terms = turn->reversal || !turn->waves.empty();
  return record_cell(
      "  fit over one turn: offset {offset:+.2f} {unit}{reversal}{explained}, residual {rms_left:.2f} {unit} "
      "rms\n{waves}",
      "offset"_is(turn->offset),
      "reversal"_is(turn->reversal, turn->reversal ? fmt::format(", reversal {:+.2f} {}", *turn->reversal, unit) : ""),
      "waves"_is(list_cell(
          turn->waves, [&](const auto& wave) { return wave_cell(wave, line.group.sense); },
          turn->waves.empty() ? none : "")),
      "least_order"_is(turn->least_waves), "most_order"_is(turn->most_waves), "rms"_is(turn->rms),
      "rms_left"_is(turn->rms_left),
      "explained"_is(turn->explained,
                     has_terms ? fmt::format("; it explains {:.1f} % of the variance", 100.0 * turn->explained) : ""),
      "unit"_shown(unit));
}

Cell iso230_cell(const laser::Iso230& iso, const MeasuredLine& line, const StatsRequest& request) {
  const auto unit = laser::unit_of(iso.sense);
  std::string layout =
      "{file}: {component} ({measured}), parked at {parked_mm} mm, {count} target{s}, "
      "{compensation}\n";
  AnswerFields fields =
      described("file"_is(line.files.front(), fmt::format("{}", fmt::join(line.files, " + "))), "files"_is(line.files));
  append(fields, measured_line_fields(line.group));
  append(fields, "compensation"_shown(compensation_text(line.group)));
  for (const LaserQuantity& q : kLaserQuantities) {
    fields.push_back(FieldKey(q.key)(quantity_cell(q.symbol, iso.*q.value, unit, q.name)));
    layout += fmt::format("{{{}}}", q.key);
  }
  append(fields, "unit_of_targets"_is(laser::target_unit(iso.rotary)),
         "range"_is(quantity_cell("range", iso.range, unit, "largest minus smallest reading")),
         "uncertainty"_is(uncertainty_cell(iso, request.uncertainty)), "merge_tolerance_mm"_is(iso.merge_tolerance_mm),
         "targets"_is(list_cell(iso.targets,
                                [&](const auto& target) {
                                  return Cell{target_json(target, iso.rotary), {}};
                                })),
         "count"_shown(iso.targets.size()), "s"_shown(iso.targets.size() == 1 ? "" : "s"),
         "outliers"_is(outliers_cell(line, request.all ? SIZE_MAX : kMostOutliers, request.import)),
         "drift"_is(drift_cell(line)), "growth"_is(growth_cell(line)), "turn"_is(turn_cell(line)),
         "notes"_is(lines_cell(iso.notes, "  note: ")));
  return record_cell(layout + "{range}{uncertainty}{growth}{turn}{outliers}{drift}{notes}", fields);
}

/// @param answer  the line as JSON
LineStatistics line_statistics(const laser::Iso230& iso, const MeasuredLine& line, const Json& answer) {
  const Json& drift = answer["drift"];
  const auto size_of = [&](std::size_t i) { return std::abs(line.set.readings[i].error); };
  const auto largest = std::max_element(line.group.readings.begin(), line.group.readings.end(),
                                        [&](std::size_t a, std::size_t b) { return size_of(a) < size_of(b); });
  return {.iso = iso,
          .group = line.group,
          .files = line.files,
          .outliers = answer["outliers"].size(),
          .drifts = drift.is_object() && (drift["drifts"] == true || !drift["apart"].empty()),
          .largest = line.set.readings[*largest].error};
}

/// Files that are joined, and the set that they make.
struct JoinedFiles {
  std::vector<laser::MeasurementSet> sets;
  laser::MeasurementSet all;

  /// Of a reading of `all`, whose readings follow each other as those of the sets.
  [[nodiscard]] std::string file_of(std::size_t reading) const {
    for (const laser::MeasurementSet& set : sets) {
      if (reading < set.readings.size()) return set.source;
      reading -= set.readings.size();
    }
    return {};
  }
  [[nodiscard]] std::vector<std::string> files_of(const laser::Group& group) const {
    std::vector<std::string> files;
    for (const std::size_t i : group.readings)
      if (const std::string file = file_of(i); std::find(files.begin(), files.end(), file) == files.end())
        files.push_back(file);
    return files;
  }
};

/// Files of one machine belong together; those of another start again.
std::vector<JoinedFiles> joined_by_machine(const std::vector<laser::MeasurementSet>& sets) {
  std::vector<JoinedFiles> machines;
  for (const laser::MeasurementSet& set : sets) {
    const auto is_joined = [&](JoinedFiles& machine) {
      auto with = machine.sets;
      with.push_back(set);
      auto all = joined(with);
      if (all) machine = {std::move(with), std::move(*all)};
      return all.has_value();
    };
    if (std::none_of(machines.begin(), machines.end(), is_joined)) machines.push_back({{set}, set});
  }
  return machines;
}

Result<Outcome> stats(VerbContext& context, const StatsRequest& request) {
  ECS_TRY(given, given_files(request.files));
  for (const std::string& note : given.notes) context.console.note(note);
  std::vector<laser::MeasurementSet> sets;
  for (const std::string& file : given.files) {
    ECS_TRY(imported, read_with_notes(context.console, file, request.import));
    if (imported.set.readings.empty()) return problem_at(file, 0, 0, "expected readings, found none");
    if (auto refused = laser::paths_refused(imported.set, file)) return tl::unexpected(std::move(*refused));
    imported.set.notes.clear();
    sets.push_back(std::move(imported.set));
  }
  Cell lines{Json::array(), {}};
  std::vector<LineStatistics> statistics;
  for (const JoinedFiles& machine : joined_by_machine(sets)) {
    for (const std::string& note : machine.all.notes) context.console.note(note);
    for (const laser::Group& group : laser::groups_of(machine.all)) {
      ECS_TRY(iso, laser::iso230_of(machine.all, group));
      if (!lines.text.empty()) lines.text += "\n";
      const MeasuredLine line{machine.all, group, machine.files_of(group),
                              [&](std::size_t i) { return machine.file_of(i); }};
      lines.add(iso230_cell(iso, line, request));
      statistics.push_back(line_statistics(iso, line, lines.json.back()));
    }
  }
  if (!request.all && statistics.size() > kMostWholeLines) lines.text = summary_text(statistics);
  return outcome_of(record_cell("{lines}", "lines"_is(lines)));
}

}  // namespace

extern const std::vector<Action> kLaserStatistics{action(
    "laser stats",
    "compute accuracy and repeatability by ISO 230-2, outliers, drift between runs, conditions of the standard not met",
    "ecs laser stats x_axis.csv y_axis.rtl --json", stats)};

}  // namespace ecs::app
