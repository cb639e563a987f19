// `ecs map show` and `header`: a map from a file or from the unit, as text, JSON or plot. `compare`: two maps. `send`:
// a complete map of this machine, with its parameters, into the unit; checked there. `receive` and `verify`: the map in
// the unit as a file, and against a file.
#include "app/verbs/map/unit.hpp"

#include <utility>

#include <fmt/format.h>

#include "app/cli/verb_unit.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "commissioning/maps/compare.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/measurements/files.hpp"
#include "commissioning/plot/curves.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/transfer.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"
#include "laser/writers/writers.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {

Result<FoundMap> found_map(VerbContext& context, const std::string& file, bool from_unit) {
  if (file.empty() != from_unit) return problem(ProblemKind::usage, "expected either a map FILE or --unit");
  if (!from_unit) {
    ECS_TRY(map, laser::read_map_csv(file));
    return FoundMap{std::move(map), std::nullopt, file};
  }
  ECS_TRY(unit, open_unit(context));
  auto found = commissioning::map_in(unit.client(), progress_bar(context, "map"));
  context.console.end_progress();
  return found;
}

namespace {

struct ShowRequest {
  std::string file, component, params, machine, plot;
  bool unit = false;
  static Fields<ShowRequest> fields() {
    using R = ShowRequest;
    return {{"FILE", &R::file, "map CSV; or give --unit"},
            {"--unit", &R::unit, "use the map in the unit"},
            {"--component", &R::component, "show only this one of the 18 curves; --json then lists its values"},
            {"--params", &R::params, "parameters to check the map against; with --unit, those of the unit"},
            {"--machine", &R::machine,
             "machine file (.toml) with the travels to cover; default: machine.toml in the folder of the parameters"},
            {"--plot", &R::plot, "plot file, OUT.svg or OUT.png", Is::output}};
  }
};

Result<std::optional<Component>> chosen(const std::string& name) {
  if (name.empty()) return std::optional<Component>();
  const auto component = component_of(name);
  if (!component || is_squareness(*component))
    return problem(ProblemKind::usage, "--component: expected one of the 18 curves, as in EXX, got \"{}\"{}", name,
                   component ? "; squareness is stored in the parameters" : "");
  return component;
}

using Judged = std::optional<std::vector<laser::MapFinding>>;

/// By --params, else by the parameters of the unit; nothing if neither. Travels: of --machine, else beside --params.
Result<Judged> judged(const ShowRequest& request, const FoundMap& found) {
  params::ParametersFile by;
  if (!request.params.empty()) {
    ECS_TRY(file, params::read_parameters(request.params));
    by = std::move(file);
  } else if (found.parameters) {
    by.parameters = *found.parameters;
  } else {
    return Judged();
  }
  ECS_TRY(travels, travels_given(request.machine, request.params, by));
  return Judged(findings_before_sending(found.map, by.parameters, travels));
}

Cell judged_cell(const Judged& findings) {
  if (!findings) return null_cell("not checked: give --params to check whether the map can be sent\n");
  Cell cell = findings_cell(*findings);
  if (findings->empty()) cell.text = "no findings\n";
  return cell;
}

/// The words of its lines `uncertainty`; "" where it has none.
std::string_view uncertainty_text(const laser::MapHeader& header) {
  return header.uncertainty.empty() ? ""
                                    : "uncertainty: standard uncertainties (k = 1), um or um/m; value: part that "
                                      "differs from value to value; pass: part common to a pass, which is one run in "
                                      "one direction\n";
}

Result<Outcome> show(VerbContext& context, const ShowRequest& request) {
  ECS_TRY(only, chosen(request.component));
  if (!request.plot.empty()) ECS_DO(plot_format_of(request.plot));
  ECS_TRY(found, found_map(context, request.file, request.unit));
  ECS_TRY(findings, judged(request, found));
  std::vector<laser::MapTable> tables;
  for (const laser::MapTable& table : found.map.tables)
    if (!only || table.component == *only) tables.push_back(table);
  if (only && tables.empty()) return problem(ProblemKind::refused, "{} has no table of {}", found.name, name_of(*only));
  if (!request.plot.empty()) {
    const std::string title = fmt::format("Error map of {}: compensation",
                                          found.map.header.machine.empty() ? found.name : found.map.header.machine);
    ECS_DO(write_plot(request.plot, figure_of(found.map, only, title)));
  }
  constexpr std::string_view kSigns =
      "values: compensation = -error = target - actual. The unit moves the tool relative\n"
      "to the workpiece by it (angles: by angle times lever arm)\n";
  return outcome_of(record_cell("{header}\n{tables}{signs}{uncertainty}{findings}{plot}", "map"_is(found.name),
                                "uncertainty"_shown(uncertainty_text(found.map.header)),
                                "signs"_shown(tables.empty() ? "" : kSigns), "header"_is(header_cell(found.map.header)),
                                "tables"_is(tables_cell(tables, only.has_value())),
                                "findings"_is(judged_cell(findings)), "plot"_is(written_cell("plot", request.plot))));
}

struct HeaderRequest {
  std::string file;
  bool unit = false;
  static Fields<HeaderRequest> fields() {
    using R = HeaderRequest;
    return {{"FILE", &R::file, "map CSV; or give --unit"}, {"--unit", &R::unit, "use the map in the unit"}};
  }
};

Result<Outcome> header(VerbContext& context, const HeaderRequest& request) {
  ECS_TRY(found, found_map(context, request.file, request.unit));
  const Cell header = header_cell(found.map.header);
  return outcome_of({object_of("map"_is(found.name), inlined(header)),
                     header.text + std::string(uncertainty_text(found.map.header))});
}

struct CompareRequest {
  std::string first, second, output;
  static Fields<CompareRequest> fields() {
    using R = CompareRequest;
    return {{"FIRST", &R::first, "map CSV, or measurements such as a grid over the surface of a bed", Need::required},
            {"SECOND", &R::second, "file of the same kind to compare with it", Need::required},
            {"-o,--output", &R::output, "measurement CSV of the difference, for `ecs model diagnose`", Is::output}};
  }
};

struct FilesCompared {
  MapChange change;
  std::string machine;    ///< of the second
  bool measured = false;  ///< no maps
  bool rotary = false;    ///< maps with rotary axes
};

/// Two maps, or two files of measurements.
Result<FilesCompared> compared(VerbContext& context, const CompareRequest& request) {
  ECS_TRY(first_bytes, read_file(request.first));
  ECS_TRY(second_bytes, read_file(request.second));
  if (kind_of_content(first_bytes) == FileKind::map || kind_of_content(second_bytes) == FileKind::map) {
    ECS_TRY(first, laser::read_map_csv(request.first));
    ECS_TRY(second, laser::read_map_csv(request.second));
    return FilesCompared{change_between(first, second), second.header.machine, false,
                         !first.header.rotary.empty() || !second.header.rotary.empty()};
  }
  ECS_TRY(first, commissioning::read_with_notes(context.console, request.first, {}));
  ECS_TRY(second, commissioning::read_with_notes(context.console, request.second, {}));
  for (const auto& [set, file] : {std::pair(&first.set, &request.first), {&second.set, &request.second}})
    if (auto refused = laser::paths_refused(*set, *file)) return tl::unexpected(std::move(*refused));
  return FilesCompared{change_between(first.set, second.set), laser::measured_machine(second.set.metadata).name, true};
}

Result<Outcome> compare(VerbContext& context, const CompareRequest& request) {
  ECS_DO(check_output_not_input(request.output, {request.first, request.second}));
  ECS_TRY(files, compared(context, request));
  MapChange& change = files.change;
  if (change.curves.empty() && (change.rotary.empty() || !request.output.empty()))
    return problem(ProblemKind::refused, "{} and {} cannot be compared: {}", request.first, request.second,
                   fmt::join(change.notes, "; "));
  if (!request.output.empty())
    ECS_DO(laser::write_measurement_set(request.output,
                                        measurement_of(change, files.machine, {request.first, request.second})));
  if (!request.output.empty() && !change.rotary.empty())
    change.notes.push_back(fmt::format("{} does not contain the rotary axes", request.output));
  const Cell rotary = rotary_change_cell(change);
  Cell cell = record_cell(
      "difference: errors of {second} minus errors of {first}; residual: rms after subtracting mean, slope and "
      "reversal\n"
      "{curves}{rotary}{notes}{closing}{output}",
      "first"_is(request.first), "second"_is(request.second), "curves"_is(change_cell(change)),
      "notes"_is(lines_cell(change.notes, "note: ")),
      "output"_is(written_cell("difference", request.output,
                               is_without_change(change)
                                   ? ""
                                   : "To find the cause, save the difference with -o difference.csv, then run `ecs "
                                     "model new` and `ecs model diagnose`.\n")),
      "rotary"_shown(rotary.text),
      "closing"_shown(files.measured && !is_without_change(change)
                          ? std::string()
                          : closing_text(change, request.first, request.second)));
  if (files.rotary) cell.json["rotary"] = rotary.json;
  return outcome_of(cell);
}

constexpr std::string_view kBeforeFirstCompensation =
    "check polarity and scale of every axis with `ecs utility output` before the first compensation";

struct SendRequest {
  std::string file, params;
  bool other_machine = false, accept_incomplete = false, accept_resampling = false;
  static Fields<SendRequest> fields() {
    using R = SendRequest;
    return {{"FILE", &R::file, "map CSV", Need::required},
            {"--params", &R::params, "parameters of the unit, sent together with the map", Need::required},
            {"--other-machine", &R::other_machine,
             "send even if map, parameters and unit belong to different machines, or do not name a machine"},
            {"--accept-incomplete", &R::accept_incomplete,
             "send even if the last line of the parameter file, which marks it as complete, is missing"},
            {"--accept-resampling", &R::accept_resampling,
             "send even if resampling to equal increments changes a table by more than its resolution"}};
  }
};

Result<Outcome> send(VerbContext& context, const SendRequest& request) {
  ECS_TRY(ready,
          prepared_map(request.file, request.params,
                       {request.other_machine, request.accept_incomplete ? Incomplete::accept : Incomplete::refuse,
                        request.accept_resampling}));
  ECS_TRY(unit, open_unit(context));
  if (const auto parameters = ImageView(ready.image.bytes).parameters())
    if (const std::string beyond = tools_beyond_range(unit.client(), *parameters); !beyond.empty())
      context.console.warn(beyond);
  bool remarks_shown = false;  // when the unit accepts data: why it refuses them comes first
  const auto show_remarks = [&] {
    if (std::exchange(remarks_shown, true)) return;
    for (const std::string& note : ready.image.notes) context.console.note(note);
    for (const std::string& remark : ready.remarks) context.console.warn(remark);
  };
  const auto sent = send_map(unit.client(), ready, request.file, request.other_machine, {},
                             [&, bar = progress_bar(context, "map")](const auto& progress) {
                               show_remarks();
                               bar(progress);
                             });
  context.console.end_progress();
  if (!sent) return tl::unexpected(sent.error());
  show_remarks();
  if (sent->check_before != sent->check && !context.console.json) context.console.note(kBeforeFirstCompensation);
  return finished_outcome_of(record_cell(
      sent->report.already_held
          ? "unit {serial_number} already contains {map}, checksum (CRC-32) {check}, commit no. {commit_sequence}: not "
            "sent again"
      : sent->report.was_in_other_bank()
          ? "unit {serial_number} already contained {map} in its inactive bank: nothing sent, made active, checksum "
            "(CRC-32) {check}, commit no. {commit_sequence}"
          : "{map} sent to unit {serial_number} and verified: {bytes} bytes in {seconds} s, checksum (CRC-32) {check}, "
            "commit no. {commit_sequence}",
      "map"_is(request.file), "bytes"_is(sent->report.bytes), "bytes_sent"_is(sent->report.bytes_sent),
      "already_held"_is(sent->report.already_held), "seconds"_is(sent->seconds, 1),
      "check"_is(fmt::format("{:08X}", sent->check)), "verified"_is(true),
      "commit_sequence"_is(sent->report.commit_sequence), "serial_number"_is(text_cell(sent->identity.serial_number)),
      "notes"_is(lines_cell(ready.image.notes, ""))));
}

constexpr std::size_t kMostShown = 20;

struct ReceiveRequest {
  std::string output;
  static Fields<ReceiveRequest> fields() {
    using R = ReceiveRequest;
    return {{"-o,--output", &R::output, "file to write; without it the CSV is printed on the screen", Is::output}};
  }
};

Result<Outcome> receive(VerbContext& context, const ReceiveRequest& request) {
  ECS_TRY(found, found_map(context, {}, true));
  if (found.map.tables.empty() && found.map.header.declared_zero.empty())
    return problem(ProblemKind::refused, "the unit contains parameters but no map: send one with `ecs map send`");
  const bool to_stdout = request.output.empty();
  const std::string csv = laser::to_map_csv(found.map);
  if (!to_stdout) ECS_DO(write_file(request.output, csv));
  return outcome_of(record_cell(to_stdout ? "{csv}" : "map of the unit written to {map}: {count} tables",
                                "map"_is(text_cell(request.output)), "header"_is(header_cell(found.map.header)),
                                "tables"_is(tables_cell(found.map.tables, to_stdout)),
                                "count"_shown(found.map.tables.size()), "csv"_shown(csv)));
}

struct VerifyRequest {
  std::string file, params;
  static Fields<VerifyRequest> fields() {
    using R = VerifyRequest;
    return {{"FILE", &R::file, "map CSV", Need::required},
            {"--params", &R::params, "parameter file to compare with the unit as well"}};
  }
};

Cell difference_cell(const MapDifference& d) {
  return record_cell("{message}\n", "component"_is(d.component ? cell_of(name_of(*d.component)) : null_cell()),
                     "approach"_is(d.component ? cell_of(word_for(d.approach)) : null_cell()),
                     "position_mm"_is(d.position_mm), "expected"_is(d.expected), "found"_is(d.found),
                     "message"_is(d.message));
}

/// All in JSON, the first in the text.
Cell places_cell(const std::vector<MapDifference>& differences) {
  Cell list{Json::array(), {}};
  for (const MapDifference& difference : differences) {
    Cell one = difference_cell(difference);
    if (list.json.size() >= kMostShown) one.text.clear();
    list.add(one);
  }
  if (differences.size() > kMostShown) list.text += fmt::format("… and {} more\n", differences.size() - kMostShown);
  return list;
}

Cell largest_cell(const std::optional<LargestDifference>& largest) {
  if (!largest) return null_cell();
  constexpr double kShownAsZero = 0.0005;  // by the three digits of the text, and then at no place
  return record_cell(
      largest->difference() < kShownAsZero
          ? "largest difference from the curves of the file: {difference} {unit}\n"
          : "largest difference from the curves of the file: {difference} {unit} ({component} {approach} at "
            "{position_mm} mm)\n",
      "component"_is(name_of(largest->component)), "approach"_is(word_for(largest->approach)),
      "position_mm"_is(largest->position_mm, fmt::format("{:.6g}", largest->position_mm)),
      "expected"_is(largest->expected), "found"_is(largest->found), "difference"_shown(largest->difference(), 3),
      "unit"_shown(unit_of(largest->component)));
}

/// Of the map, then of the parameters.
std::string differing_words(const VerifyRequest& request, const MapVerdict& verdict, bool is_resampled) {
  const std::size_t count = verdict.differences.size(), parameters = verdict.parameters.size();
  std::string words = count == 0 ? fmt::format("the map in the unit agrees with {}", request.file)
                                 : fmt::format("the map in the unit differs from {}: {} difference{}", request.file,
                                               count, count == 1 ? "" : "s");
  if (parameters > 0)
    words += fmt::format("; {} parameter{} from {}", parameters, parameters == 1 ? " differs" : "s differ",
                         request.params.empty() ? request.file : request.params);
  if (count > 0 && is_resampled)
    words += ". The points of the file are unequally spaced; the unit holds the curve resampled at equal spacing";
  return words;
}

Result<Outcome> verify(VerbContext& context, const VerifyRequest& request) {
  ECS_TRY(map, laser::read_map_csv(request.file));
  ECS_TRY(found, found_map(context, {}, true));
  ECS_TRY(verdict, verdict_on(found, request.file, request.params));
  return outcome_of(
      record_cell("{differences}{parameters}{largest_difference}{same}", "map"_is(request.file),
                  "same"_is(verdict.same(), fmt::format("the unit contains {}", request.file),
                            differing_words(request, verdict, !laser::change_by_resampling(map).empty())),
                  "differences"_is(places_cell(verdict.differences)),
                  "parameters"_is(differences_cell(verdict.parameters, "expected", "found", "file", "unit")),
                  "largest_difference"_is(largest_cell(verdict.largest))),
      verdict.same() ? kDone : kDoesNotHold);
}

}  // namespace

extern const std::vector<Action> kMapOfUnit{
    action("map show", "show header, tables and findings of a map file or of the map in the unit",
           "ecs map show map.csv --params mill.toml --component EXX --plot exx.svg", show, {.link = Link::reads}),
    action("map header", "show who made a map, when, for which machine, from which files and how",
           "ecs map header --unit", header, {.link = Link::reads}),
    action("map compare",
           "compare two error maps or two measurements, component by component, for example of two dates or machines, "
           "or before and after a repair",
           "ecs map compare map-2025.csv map-2026.csv -o difference.csv", compare,
           {.logged = Logged::when_written, .kind = "measurement"}),
    action("map send",
           "send a complete map with its parameters to the unit, all or nothing, and verify the unit's memory",
           "ecs map send map.csv --params mill.toml --link rtu:/dev/ttyUSB0:115200", send, {.link = Link::writes}),
    action("map receive", "read the map in the unit into a map CSV",
           "ecs map receive -o from-unit.csv --link tcp:192.168.0.7:502", receive,
           {.link = Link::reads, .logged = Logged::when_written, .kind = "transfer"}),
    action("map verify", "check that the unit contains this map, to the resolution of its memory",
           "ecs map verify map.csv --params mill.toml", verify, {.link = Link::reads})};

}  // namespace ecs::app
