// `ecs params show, check, set, diff, new`: what works on parameter files; show and diff also look into a unit. `send`
// and `receive`: the parameters between file and unit. `adjust`: a squareness value in the unit by an indicator.

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/parameters/set.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/transfer.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "core/mode_word.hpp"
#include "core/parameters.hpp"
#include "params/check.hpp"
#include "params/fields.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kUnitWord = "unit";

Result<UnitParameters> parameters_in_unit(VerbContext& context) {
  ECS_TRY(unit, open_unit(context));
  return receive_parameters(unit.client());
}

Result<UnitParameters> parameters_from(VerbContext& context, const std::string& file_or_unit) {
  if (file_or_unit == kUnitWord) return parameters_in_unit(context);
  ECS_TRY(file, params::read_parameters(file_or_unit));
  return file.parameters;
}

// --- show
struct ShowRequest {
  std::string file;
  bool unit = false;
  static Fields<ShowRequest> fields() {
    using R = ShowRequest;
    return {{"FILE", &R::file, "parameter file, or `unit`; needed unless --unit is given"},
            {"--unit", &R::unit, "the same as the word `unit`"}};
  }
};

Result<Outcome> show_unit(VerbContext& context) {
  ECS_TRY(parameters, parameters_in_unit(context));
  return outcome_of(record_cell("{parameters}", "parameters"_is(parameters_cell(parameters))));
}

Result<Outcome> show(VerbContext& context, const ShowRequest& request) {
  if (request.unit == !request.file.empty())
    return problem(ProblemKind::usage,
                   "params show: expected either a parameter file or `unit` (`--unit`), and not both");
  if (request.unit || request.file == kUnitWord) return show_unit(context);
  ECS_TRY(file, params::read_parameters(request.file));
  const auto& [machine, serial_number] = file.identity;
  const bool named = !machine.empty() || !serial_number.empty();
  const Cell identity =
      record_cell(named ? "{of_machine}, {of_unit}\n\n" : "", "machine"_is(text_cell(machine)),
                  "serial_number"_is(text_cell(serial_number)),
                  "of_machine"_shown(machine.empty() ? "no machine" : "machine " + machine),
                  "of_unit"_shown(serial_number.empty() ? "no serial number" : "serial number " + serial_number));
  return outcome_of(record_cell("{identity}{parameters}", "file"_is(request.file), "identity"_is(identity),
                                "parameters"_is(parameters_cell(file.parameters)), "defaulted"_is(file.defaulted)));
}

// --- set
struct SetRequest {
  std::string file, output;
  std::vector<std::string> words;
  bool accept_incomplete = false;
  static Fields<SetRequest> fields() {
    using R = SetRequest;
    return {{"FILE", &R::file, "parameter file", Need::required},
            {"KEY=VALUE", &R::words,
             "one or more KEY=VALUE or KEY VALUE; also identity.machine and identity.serial_number", Need::required},
            {"-o,--output", &R::output, "write to this file instead of FILE", Is::output},
            {"--accept-incomplete", &R::accept_incomplete,
             "change FILE even if its last line, which marks it as complete, is missing; missing values are written as "
             "their defaults"}};
  }
};

struct Assignment {
  std::string key;
  std::string value;
};

/// KEY=VALUE words and KEY VALUE pairs, mixed.
Result<std::vector<Assignment>> assignments_of(const std::vector<std::string>& words) {
  std::vector<Assignment> all;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    if (equals != std::string::npos) {
      all.push_back({words[i].substr(0, equals), words[i].substr(equals + 1)});
    } else if (i + 1 < words.size()) {
      all.push_back({words[i], words[i + 1]});
      ++i;
    } else {
      return problem(ProblemKind::usage, "params set: expected a value after \"{}\"", words[i]);
    }
  }
  return all;
}

Cell changed_cell(const params::Difference& d) {
  return record_cell("{key}: {from} -> {to}{unit}\n", "key"_is(d.key), "from"_is(d.a), "to"_is(d.b),
                     "unit"_shown(d.unit.empty() ? "" : " " + d.unit));
}

void add_identity_change(Cell& changed, const char* key, const std::string& from, const std::string& to) {
  if (from != to) changed.add(changed_cell({key, "", from, to}));
}

Result<Outcome> set_values(VerbContext& context, const SetRequest& request) {
  ECS_TRY(file, request.accept_incomplete ? params::read_parameters(request.file)
                                          : params::read_whole_parameters(request.file));
  for (const std::string& taken : params::defaults_in_short(file)) context.console.warn(taken);
  ECS_TRY(assignments, assignments_of(request.words));
  const UnitParameters before = file.parameters;
  const params::Identity owner_before = file.identity;
  commissioning::ParameterSet values{file.parameters, file.identity};
  std::vector<Problem> problems;
  for (const Assignment& assignment : assignments)
    if (auto set = commissioning::set_value(assignment.key, values, assignment.value); !set)
      problems.push_back(set.error());
  file.parameters = values.parameters;
  file.identity = values.identity;
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  for (const params::Finding& finding : params::check(file.parameters))
    context.console.warn(fmt::format("{}: {}", finding.keys.empty() ? "" : finding.keys.front(), finding.message));
  const std::string output = request.output.empty() ? request.file : request.output;
  ECS_DO(params::write_parameters(output, file.parameters, file.identity));
  Cell changed = list_cell(params::diff(before, file.parameters), changed_cell);
  add_identity_change(changed, "identity.machine", owner_before.machine, file.identity.machine);
  add_identity_change(changed, "identity.serial_number", owner_before.serial_number, file.identity.serial_number);
  const bool same = changed.json.empty();
  if (same) changed.text = fmt::format("no value changes: {} already has these values\n", request.file);
  return outcome_of(record_cell("{changed}written to {file}", "file"_is(output), "changed"_is(changed)));
}

// --- diff
struct DiffRequest {
  std::string a, b;
  static Fields<DiffRequest> fields() {
    using R = DiffRequest;
    return {{"A", &R::a, "parameter file, or `unit`", Need::required},
            {"B", &R::b, "parameter file, or `unit`", Need::required}};
  }
};

Result<Outcome> diff_two(VerbContext& context, const DiffRequest& request) {
  ECS_TRY(a, parameters_from(context, request.a));
  ECS_TRY(b, parameters_from(context, request.b));
  const auto differences = params::diff(a, b);
  Cell list = differences_cell(differences, "a", "b", request.a, request.b);
  if (differences.empty()) list.text = "no difference; machine name and serial number are not compared";
  return outcome_of(record_cell("{differences}", "a"_is(request.a), "b"_is(request.b), "same"_is(differences.empty()),
                                "differences"_is(list)),
                    differences.empty() ? kDone : kDoesNotHold);
}

// --- new
struct NewRequest {
  std::string machine, output;
  static Fields<NewRequest> fields() {
    using R = NewRequest;
    return {{"--machine", &R::machine, "machine file", Need::required},
            {"-o,--output", &R::output, "parameter file to write", Is::output, Need::required}};
  }
};

Result<Outcome> new_file(VerbContext& context, const NewRequest& request) {
  ECS_TRY(machine, params::read_machine(request.machine));
  for (const Problem& warning : machine.warnings) context.console.warn(to_text(warning));
  const UnitParameters parameters = params::default_parameters_for(machine.machine);
  ECS_DO(params::write_parameters(request.output, parameters, {machine.machine.name, {}}));
  return outcome_of(
      record_cell("{file}: initial parameters. Set the datum type, the output scale and the polarity: no check can "
                  "verify them. Then run `{check}`",
                  "file"_is(request.output), "check"_shown(shell_command({"ecs", "params", "check", request.output})),
                  "parameters"_is(parameters_cell(parameters))));
}

struct CheckRequest {
  std::string file, machine;
  static Fields<CheckRequest> fields() {
    using R = CheckRequest;
    return {{"FILE", &R::file, "parameter file", Need::required},
            {"--machine", &R::machine, "machine file to compare with"}};
  }
};

Cell findings_cell(const std::vector<params::Finding>& findings, const std::string& file) {
  Cell list = list_cell(findings, [](const params::Finding& finding) {
    return record_cell({}, "severity"_is(params::name_of(finding.severity)), "keys"_is(lines_cell(finding.keys, "")),
                       "message"_is(finding.message));
  });
  list.text = findings.empty() ? fmt::format("{}: no findings", file) : params::to_text(findings);
  return list;
}

Result<Outcome> check_file(VerbContext& context, const CheckRequest& request) {
  ECS_TRY(file, params::read_parameters(request.file));
  std::optional<params::Machine> machine;
  if (!request.machine.empty()) {
    ECS_TRY(read, params::read_machine(request.machine));
    for (const Problem& warning : read.warnings) context.console.warn(to_text(warning));
    machine = read.machine;
  }
  std::vector<params::Finding> findings = params::check_file(file);
  for (params::Finding& finding : params::check(file.parameters, machine ? &*machine : nullptr))
    findings.push_back(std::move(finding));
  std::string taken;
  for (const std::string& line : params::defaults_taken(file)) taken += "\n" + line;
  return outcome_of(
      record_cell("{findings}{defaulted}", "file"_is(request.file), "sound"_is(!params::has_errors(findings)),
                  "findings"_is(findings_cell(findings, request.file)), "defaulted"_is(file.defaulted, taken)),
      findings.empty() ? kDone : kDoesNotHold);
}

// --- scale
struct ScaleRequest {
  std::optional<double> lines, counts;
  double pitch_mm = 0.0, gear = 1.0;
  static Fields<ScaleRequest> fields() {
    using R = ScaleRequest;
    return {
        {"--lines", &R::lines, "lines per turn of an incremental encoder; the unit counts four times as many",
         Range{1, 1e6}},
        {"--counts", &R::counts, "counts per turn of a resolver, in place of --lines", Range{1, 1e8}},
        {"--pitch-mm", &R::pitch_mm, "travel per turn of the screw, mm", Range{1e-3, 1e4}, Need::required},
        {"--gear", &R::gear, "turns of the screw per turn of the transducer (`ecs model drive` uses the inverse ratio)",
         Range{1e-4, 1e4}}};
  }
};

Result<Outcome> scale(VerbContext&, const ScaleRequest& request) {
  if (request.lines.has_value() == request.counts.has_value())
    return problem(ProblemKind::usage, "params scale: give either --lines of an encoder or --counts of a resolver");
  constexpr double kCountsPerLine = 4.0, kUmPerMm = 1000.0;
  const double counts_per_turn = request.lines ? kCountsPerLine * *request.lines : *request.counts;
  const double um_per_count = kUmPerMm * request.pitch_mm * request.gear / counts_per_turn;
  UnitParameters checked;
  const std::string value = fmt::format("{:.9g}", um_per_count);
  ECS_DO(params::set(checked, "axis.X.position_scale_um_per_count", value));
  return outcome_of(
      record_cell("{counts_per_turn} counts per turn, {um_per_turn} um per turn: {um_per_count} um per count\nset it "
                  "with `{set}`; make it negative if the axis counts down while its coordinate increases",
                  "counts_per_turn"_is(counts_per_turn), "um_per_turn"_is(kUmPerMm * request.pitch_mm * request.gear),
                  "um_per_count"_is(um_per_count, value),
                  "set"_shown("ecs params set FILE axis.X.position_scale_um_per_count=" + value)));
}

// --- adjust
struct AdjustRequest {
  std::string component;
  double reading_um = 0.0, over_mm = 0.0, nothing_um = 1.0;
  bool trial = false;
  static Fields<AdjustRequest> fields() {
    using R = AdjustRequest;
    return {
        {"COMPONENT", &R::component, "squareness value", Words{"C0Y", "B0Z", "A0Z"}, Need::required},
        {"UM", &R::reading_um,
         "displacement of the tool that the indicator shows now: along X for C0Y and B0Z, along Y for A0Z [um]",
         Need::required},
        {"--over-mm", &R::over_mm,
         "distance over which it shows this, in the positive direction of Y for C0Y, of Z for B0Z and A0Z [mm]",
         Range{1.0, 1e5}, Need::required},
        {"--nothing-um", &R::nothing_um, "largest reading that is regarded as zero [um]", Range{0.0, 1e3}},
        {"--trial", &R::trial,
         "only try the value: the unit keeps compensating and stores nothing. To store it, repeat the command without "
         "--trial when the indicator reads 0"}};
  }
};

/// Squareness that is left, by the term with which the unit corrects it; nothing if it does not.
std::optional<double> squareness_left(const UnitParameters& parameters, Component component, double reading_um,
                                      double over_mm) {
  const auto terms = terms_of(parameters);
  if (!terms) return std::nullopt;
  constexpr double kMmPerM = 1000.0;
  for (const Term& term : *terms)
    if (term.component == component) return reading_um / (term.sign * over_mm / kMmPerM);
  return std::nullopt;
}

/// The parameters sent, and the unit back in the mode in which it was.
Result<void> send_adjusted(VerbContext& context, UnitLink& unit, const UnitParameters& parameters, bool compensated) {
  ECS_DO(unit.client().enter_integration());
  auto sent = send_parameters(unit.client(), parameters, {}, UnfitMap::refuse, progress_bar(context, "sending"));
  if (!sent) {
    if (compensated)
      sent.error().message +=
          ". For the transfer the unit was put into integration mode, and compensation is off: correct the cause and "
          "repeat the command, or run `ecs utility mode compensate`";
    return tl::unexpected(sent.error());
  }
  if (!compensated) return {};
  ECS_DO(begin_compensation(unit.client()));
  ask_to_reference(context, unit, "every axis");
  return {};
}

std::string command_that_stores(const AdjustRequest& request) {
  return fmt::format("`ecs params adjust {} 0 --over-mm {}`", request.component, request.over_mm);
}

/// What is done with a value: its words, and whether the unit stores it.
struct Adjusted {
  std::string_view done;
  std::string then;
  bool sends = false;
};
Adjusted adjusted(const AdjustRequest& request, bool shows_nothing, bool tried, bool compensated) {
  if (shows_nothing && (request.trial || !tried))
    return {"{component}: {before} um/m stays: the indicator reads zero within {nothing_um} um\n{then}",
            tried ? fmt::format("it is in effect for a trial only: {} stores it\n", command_that_stores(request)) : ""};
  if (request.trial)
    return {"{component}: {before} -> {after} um/m, in effect for a trial, not stored\n{then}",
            fmt::format("the unit keeps compensating; measure again. When the indicator reads zero, {} (no further "
                        "change) stores the value on trial\n",
                        command_that_stores(request))};
  return {"{component}: {before} -> {after} um/m, sent and verified\n{then}",
          compensated ? "the unit compensates again when every axis has been referenced; then measure again\n"
                      : "the unit is in integration mode\n",
          true};
}

/// The value changed by what the indicator shows, and tried or sent (thesis 7.2.4).
Result<Outcome> adjust(VerbContext& context, const AdjustRequest& request) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(status, unit.client().status());
  if (request.trial && status.mode != UnitMode::compensating)
    return problem(ProblemKind::refused,
                   "--trial: expected a unit that compensates, and its mode is {}. Give the command without --trial, "
                   "or first run `ecs utility mode compensate` and reference every axis",
                   word_of(status.mode));
  ECS_TRY(parameters, receive_parameters(unit.client()));
  const Component component = *component_of(request.component);
  const auto left = squareness_left(parameters, component, request.reading_um, request.over_mm);
  if (!left)
    return problem(ProblemKind::refused,
                   "the unit does not correct {}: its scope or its axes do not contain it (compensation.scope)",
                   request.component);
  const Vector3 stored{parameters.C0Y_um_per_m, parameters.B0Z_um_per_m, parameters.A0Z_um_per_m};
  Vector3 values = stored;
  if (status.mode == UnitMode::compensating) {
    ECS_TRY(lines, unit.client().control_lines());
    for (std::size_t i = 0; i < kAxes; ++i)  // a trial is sent in steps: less than a step is rounding
      if (std::abs(lines.squareness_um_per_m[i] - stored[i]) > protocol::kSquarenessStep_um_per_m)
        values[i] = lines.squareness_um_per_m[i];
  }
  const std::size_t place = static_cast<std::size_t>(component) - static_cast<std::size_t>(Component::C0Y);
  double& value = values[place];
  const double before = value;
  // a parameter of 0 says that nobody has measured it, and a map that needs it would not fit
  constexpr double kMeasuredAsZero_um_per_m = 1e-4;
  const bool shows_nothing = std::abs(request.reading_um) <= request.nothing_um;
  if (!shows_nothing && !request.trial && before != stored[place])  // the reading may be the one that has been tried
    return problem(
        ProblemKind::refused,
        "{} {:.2f} um/m is tried and not stored, and this reading would change it again. If the indicator now "
        "reads zero, store the value with {}; else try the present reading first, with --trial",
        request.component, before, command_that_stores(request));
  if (!shows_nothing) value = before + *left;
  if (!shows_nothing && std::abs(value) < kMeasuredAsZero_um_per_m) value = kMeasuredAsZero_um_per_m;
  const bool compensated = status.mode == UnitMode::compensating || status.mode == UnitMode::datuming;
  const Adjusted told = adjusted(request, shows_nothing, values != stored, compensated);
  if (request.trial && !shows_nothing) ECS_DO(unit.client().try_squareness(values));
  if (told.sends) {
    for (std::size_t i = 0; i < kAxes; ++i)
      squareness_um_per_m(parameters, static_cast<Component>(static_cast<std::size_t>(Component::C0Y) + i)) = values[i];
    ECS_DO(params::set(parameters, fmt::format("compensation.squareness.{}_um_per_m", request.component),
                       fmt::format("{:.4f}", value)));
    ECS_DO(send_adjusted(context, unit, parameters, compensated));
  }
  std::string others;
  for (std::size_t i = 0; told.sends && i < kAxes; ++i)
    if (values[i] != stored[i] && &values[i] != &value)
      others += fmt::format("also stored, as it was tried: {} {:.2f} um/m\n",
                            name_of(static_cast<Component>(static_cast<std::size_t>(Component::C0Y) + i)), values[i]);
  return outcome_of(record_cell(told.done, "component"_is(request.component), "before"_is(before, 2),
                                "after"_is(value, 2), "nothing_um"_is(request.nothing_um),
                                "adjusted"_is(!shows_nothing), "stored"_is(told.sends),
                                "then"_shown(others + told.then)));
}

struct SendRequest {
  std::string file;
  bool force = false, other_machine = false, accept_incomplete = false;
  static Fields<SendRequest> fields() {
    using R = SendRequest;
    return {{"FILE", &R::file, "parameter file", Need::required},
            {"--force", &R::force, "delete a map in the unit that does not fit, instead of refusing"},
            {"--other-machine", &R::other_machine, "send even if [identity] names another machine"},
            {"--accept-incomplete", &R::accept_incomplete,
             "send even if the last line of the parameter file, which marks it as complete, is missing"}};
  }
};

Outcome sent(const SendRequest& request, const SendReport& report, const params::ParametersFile& file) {
  return finished_outcome_of(record_cell(
      report.already_held
          ? "the unit already has the parameters of {file}, commit no. {commit_sequence}: not sent again"
      : report.was_in_other_bank()
          ? "the unit already contained the parameters of {file} in its inactive bank: nothing sent, made active, "
            "commit no. {commit_sequence}{map_kept}{map_dropped}"
          : "parameters of {file} sent and verified: {bytes} bytes, commit no. "
            "{commit_sequence}{map_kept}{map_dropped}",
      "file"_is(request.file), "bytes"_is(report.bytes), "commit_sequence"_is(report.commit_sequence),
      "verified"_is(true), "defaulted"_is(lines_cell(file.defaulted, "")),
      "map_kept"_is(report.map_kept, "\nthe map in the unit fits and is kept", ""),
      "map_dropped"_is(report.map_dropped, "\nthe unit now has no map: send one with `ecs map send`", ""),
      "map_objections"_is(lines_cell(report.map_objections, ""))));
}

Result<Outcome> send(VerbContext& context, const SendRequest& request) {
  ECS_TRY(file, params::read_parameters(request.file));
  const Incomplete incomplete = request.accept_incomplete ? Incomplete::accept : Incomplete::refuse;
  if (auto objections = objections_to(file, request.file, incomplete)) return tl::unexpected(std::move(*objections));
  for (const std::string& taken : params::defaults_in_short(file)) context.console.warn(taken);
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  const params::Identity owner = request.other_machine ? params::Identity() : file.identity;
  if (auto refused = refused_map(other_unit(owner, identity.serial_number), request.file))
    return tl::unexpected(std::move(*refused));
  if (const std::string beyond = tools_beyond_range(unit.client(), file.parameters); !beyond.empty())
    context.console.warn(beyond);
  ECS_TRY(report,
          send_parameters(unit.client(), file.parameters, owner, request.force ? UnfitMap::drop : UnfitMap::refuse,
                          progress_bar(context, "parameters")));
  if (report.map_dropped) context.console.warn("the map in the unit did not fit these parameters and has been deleted");
  for (const std::string& objection : report.map_objections) context.console.note(objection);
  return sent(request, report, file);
}

struct ReceiveRequest {
  std::string output;
  static Fields<ReceiveRequest> fields() {
    using R = ReceiveRequest;
    return {{"-o,--output", &R::output, "file to write; without it the text is printed on the screen", Is::output}};
  }
};

Result<Outcome> receive(VerbContext& context, const ReceiveRequest& request) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(identity, unit.client().identity());
  ECS_TRY(parameters, receive_parameters(unit.client()));
  const params::Identity owner{{}, identity.serial_number};
  if (!request.output.empty()) ECS_DO(params::write_parameters(request.output, parameters, owner));
  return outcome_of(record_cell(
      request.output.empty() ? "{toml}" : "parameters of unit {serial_number}{of_machine} written to {file}",
      "file"_is(text_cell(request.output)), "serial_number"_is(text_cell(identity.serial_number)),
      "of_machine"_shown(identity.machine.empty() ? " (the unit names no machine)"
                                                  : ", of machine " + identity.machine),
      "machine"_is(text_cell(identity.machine)), "parameters"_is(parameters_cell(parameters)),
      "toml"_shown(params::parameters_toml(parameters, owner))));
}

}  // namespace

extern const std::vector<Action> kParameters{
    action("params show", "show the parameters of a file; `unit` means the connected unit",
           "ecs params show mill-parameters.toml", show, {.link = Link::reads}),
    action("params check", "list every finding on a parameter file, with its remedy",
           "ecs params check mill.toml --machine machine.toml", check_file),
    action("params set", "change values in a parameter file",
           "ecs params set mill-parameters.toml axis.X.deadband_um=2.5 compensation.scope planar -o planar.toml",
           set_values, {.logged = Logged::when_written, .kind = "parameters"}),
    action("params diff", "list the differences between two parameter sets; `unit` means the connected unit",
           "ecs params diff mill-parameters.toml unit --link rtu:/dev/ttyUSB0:115200", diff_two, {.link = Link::reads}),
    action("params new", "create initial parameters for a machine file",
           "ecs params new --machine machine.toml -o mill-parameters.toml", new_file,
           {.logged = Logged::when_written, .kind = "parameters"}),
    action("params send", "check a parameter file and send it to the unit; the map in the unit is kept",
           "ecs params send mill-parameters.toml --link rtu:/dev/ttyUSB0:115200", send, {.link = Link::writes}),
    action("params receive", "read the unit's parameters into a file",
           "ecs params receive -o from-unit.toml --link rtu:/dev/ttyUSB0:115200", receive,
           {.link = Link::reads, .logged = Logged::when_written, .kind = "transfer"}),
    action("params scale", "compute the travel per position count from encoder, screw and gear",
           "ecs params scale --lines 2500 --pitch-mm 10", scale),
    action("params adjust", "adjust a squareness value in the unit until the indicator reads zero",
           "ecs params adjust C0Y 4.5 --over-mm 300 --link rtu:/dev/ttyUSB0:115200", adjust, {.link = Link::writes})};

}  // namespace ecs::app
