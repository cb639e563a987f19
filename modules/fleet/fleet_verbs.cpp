// `ecs batch`: a plan of many units, with a table at the end. `ecs fleet diagnose`: the machines of a manifest, on all
// cores, resumed where a former run ended. `merge`: the results of many hosts as one answer, with the false-discovery
// rate controlled over machines. What the module brings.

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "modules/fleet/batch.hpp"
#include "modules/fleet/result.hpp"
#include "modules/fleet/run.hpp"

namespace ecs::app {
namespace {

struct BatchRequest {
  std::string plan, output;
  bool dry_run = false;
  int lines = kUsualLines;
  static Fields<BatchRequest> fields() {
    using R = BatchRequest;
    return {
        {"PLAN", &R::plan,
         "plan file (TOML), or table (.csv) with the columns id (name of the unit), link, params, serial_number, map, "
         "arm_code",
         Need::required},
        {"--dry-run", &R::dry_run, "check everything except the arming codes, write nothing"},
        {"--lines", &R::lines, "number of links (serial or network lines) used at the same time", Range{1, kMostLines}},
        {"-o,--output", &R::output, "report to write, one line of JSON per unit", Is::output}};
  }
};

Cell report_cell(const BatchReport& r) {
  std::string below;
  if (r.problem) below += fmt::format("    {}\n", to_text(*r.problem));
  for (const std::string& note : r.notes) below += fmt::format("    note: {}\n", note);
  return record_cell(
      "{name:<20} {serial_number:<14} {state:<14} {link}\n{error}", "name"_is(r.name),
      "link"_is(r.link, (r.is_emulator ? "EMULATOR " : "") + r.link), "emulator"_is(r.is_emulator),
      "serial_number"_is(text_or_null(r.serial_number), r.serial_number.empty() ? "unknown" : r.serial_number),
      "state"_is(name_of(r.state)), "bytes"_is(r.bytes > 0 ? Json(r.bytes) : Json(nullptr)), "notes"_is(r.notes),
      "error"_is(r.problem ? problem_json(*r.problem) : Json(nullptr), below));
}

Cell reports_cell(const std::vector<BatchReport>& reports) {
  return list_cell(reports, report_cell, fmt::format("{:<20} {:<14} {:<14} link\n", "unit", "serial number", "result"));
}

/// A line as that of a machine in the results of `ecs fleet diagnose`: {"id", "state", …} or {"id", "error"}.
std::string report_line(const BatchReport& r) {
  if (r.problem) return one_line(object_of("id"_is(r.name), "error"_is(to_text(*r.problem))));
  return one_line(object_of("id"_is(r.name), "state"_is(name_of(r.state)),
                            "serial_number"_is(text_cell(r.serial_number)), "link"_is(r.link), "bytes"_is(r.bytes)));
}

Result<void> write_report(const std::string& path, const std::vector<BatchReport>& reports) {
  if (path.empty()) return {};
  std::string text;
  for (const BatchReport& report : reports) text += report_line(report) + '\n';
  return write_file(path, text);
}

Result<Outcome> batch(VerbContext& context, const BatchRequest& request) {
  if (!context.link_option.empty())
    return problem(ProblemKind::usage, "batch: the plan gives the link of each unit; omit --link");
  ECS_TRY(plan, read_batch_plan(request.plan));
  BatchWatch watch;
  watch.started = [&context](const PlannedUnit& unit) {
    context.console.message_prefix = unit.link.is_emulator() ? "EMULATOR: " : "";
    context.console.note(fmt::format("{}: link {}", unit.name, to_text(unit.link)));
    context.console.message_prefix.clear();
  };
  watch.progress = [&context](const BatchProgress& now) {
    context.console.progress(fmt::format("{} of {} units", now.units_done, now.units), now.share, now.seconds_left);
  };
  const auto reports = run_batch(plan, request.dry_run ? BatchMode::dry_run : BatchMode::send, request.lines, watch);
  context.console.end_progress();
  ECS_DO(write_report(request.output, reports));
  const int exit_code = exit_code_of(reports);
  const Cell units = reports_cell(reports);
  Json object = object_of("plan"_is(request.plan), "dry_run"_is(request.dry_run), "ok"_is(exit_code == kDone),
                          "units"_is(units.json));
  if (const Problem* problem = first_problem(reports); problem != nullptr && exit_code > kDoesNotHold)
    object["error"] = problem_json(*problem);
  std::string text = units.text;
  if (request.dry_run)
    text +=
        "dry run: files, images and links were checked, and the serial numbers that the plan states; not the arming "
        "codes. No unit was changed\n";
  return Outcome{text, one_line(object), exit_code};
}

const std::vector<Action> kBatch{
    action("batch", "send parameters and maps to many units, as listed in a plan",
           "ecs batch plan.toml --dry-run\n  plan.toml:  [[unit]]\n              name = \"mill 3\"\n              link "
           "= \"rtu:/dev/ttyUSB0:115200\"\n              serial_number = \"MCM-0107\"\n              params = "
           "\"mill3.toml\"\n              map = \"mill3_map.csv\"\n              arm_code = \"271828\"",
           batch)};

/// Errors listed in the answer; all of them are in the results.
constexpr std::size_t kMostErrors = 1000;

struct FleetDiagnoseRequest {
  std::string manifest, output;
  int threads = 0;
  int blanks = static_cast<int>(FleetOptions{}.noise_replicates);
  std::string part = "1/1";
  double limit = FleetOptions{}.most_s;
  static Fields<FleetDiagnoseRequest> fields() {
    using R = FleetDiagnoseRequest;
    return {
        {"MANIFEST", &R::manifest,
         "table (.csv) with the columns id, model, data, machine, type, batch; file names are relative to its folder",
         Need::required},
        {"-o,--output", &R::output, "results, one line of JSON per machine; an earlier run is continued",
         Need::required},
        {"--threads", &R::threads, "number of machines at the same time; 0: the number of cores",
         Range{0, kMostThreads}},
        {"--blanks", &R::blanks, "number of simulated noise-only data sets with which each finding is compared",
         Range{50, 20'000}},
        {"--part", &R::part, "process only this part of the rows, for one of many hosts: 3/16 is part 3 of 16"},
        {"--limit", &R::limit, "time limit for one machine [s]; the others continue", Range{0.1, 86'400.0}}};
  }
};

Cell errors_cell(const FleetReport& report) {
  Cell errors{Json::array(), {}};
  for (const FleetError& error : report.errors)
    if (errors.json.size() < kMostErrors)
      errors.add(record_cell({}, "line"_is(error.line), "id"_is(text_cell(error.id)), "message"_is(error.message)));
  return errors;
}

std::string_view title_of_verdict(std::string_view name) {
  model::Verdict verdict = model::Verdict::adequate;
  while (verdict != model::Verdict::cannot_tell && name_of(verdict) != name)
    verdict = static_cast<model::Verdict>(static_cast<int>(verdict) + 1);
  return title_of(verdict);
}

Cell verdicts_cell(const FleetReport& report) {
  Cell verdicts{Json::object(), {}};
  for (const auto& [verdict, count] : report.verdicts) {
    verdicts.json[verdict] = count;
    verdicts.text += fmt::format("  {:<52} {:>8}\n", title_of_verdict(verdict), count);
  }
  return verdicts;
}

Result<Outcome> fleet_diagnose(VerbContext& context, const FleetDiagnoseRequest& request) {
  ECS_TRY(manifest, Manifest::read(request.manifest, fleet_columns()));
  ECS_TRY(part, fleet_part(request.part));
  FleetWatch watch;
  watch.progress = [&context](const FleetProgress& now) {
    context.console.progress(
        fmt::format("{} of {} machines", now.done, now.machines),
        now.machines == 0 ? 1.0 : static_cast<double>(now.done) / static_cast<double>(now.machines), now.seconds_left);
  };
  watch.error = [&context](const FleetError& error) { context.console.warn(error.message); };
  const auto report =
      run_fleet(manifest, request.output,
                {request.threads, static_cast<std::size_t>(request.blanks), request.limit, part}, watch);
  context.console.end_progress();
  if (!report) return tl::unexpected(report.error());
  const Cell answer = record_cell(
      "{machines} machines: {diagnosed} diagnosed, {skipped} diagnosed before, {error_count} failed; {processor_s} s "
      "of processor time\n{verdicts}{stopped}",
      "manifest"_is(request.manifest), "output"_is(request.output), "machines"_is(report->machines),
      "diagnosed"_is(report->diagnosed), "skipped"_is(report->skipped), "error_count"_is(report->errors.size()),
      "errors"_is(errors_cell(*report)), "verdicts"_is(verdicts_cell(*report)),
      "processor_s"_is(report->processor_s, 1), "seconds"_is(report->seconds, 1),
      "stopped"_is(report->stopped, "stopped by a signal: repeat the command to continue\n", ""));
  return outcome_of(answer, report->errors.empty() ? kDone : kDoesNotHold);
}

constexpr double kUsualRate = 0.05;

struct FleetMergeRequest {
  std::vector<std::string> results;
  double rate = kUsualRate;
  std::string previous, output;
  static Fields<FleetMergeRequest> fields() {
    using R = FleetMergeRequest;
    return {{"RESULTS", &R::results, "results of `ecs fleet diagnose`, from one host or many", Need::required},
            {"--fdr", &R::rate,
             "accepted share of wrong alarms: of the machines named as changed, this share is unchanged on average",
             Range{1e-6, 1.0}},
            {"--previous", &R::previous, "earlier results, or the answer of `fleet merge --json`, for comparison"},
            {"-o,--output", &R::output, "file for the results of all hosts", Is::output}};
  }
};

Cell q_value_cell(const std::optional<double>& q) {
  return {number_or_null(q), q ? fmt::format("{:.1e}", *q) : "no evidence"};
}

Cell named_cell(const std::vector<NamedMachine>& machines, const char* title) {
  const std::string heading = machines.empty() ? "" : fmt::format("\n{}\n", title);
  return list_cell(
      machines,
      [](const NamedMachine& one) {
        const std::string rivals = one.rivals.empty() ? ""
                                                      : fmt::format("    or {}: these data cannot distinguish them\n",
                                                                    fmt::join(one.rivals, ", "));
        return record_cell("  {id:<24} {cause:<36} {q_value:>10}  {type} {batch}\n{indistinguishable_from}",
                           "id"_is(one.id), "cause"_is(one.cause), "q_value"_is(q_value_cell(one.q_value)),
                           "type"_is(text_or_null(one.type), one.type), "batch"_is(text_or_null(one.batch), one.batch),
                           "indistinguishable_from"_is(Json(one.rivals), rivals));
      },
      heading);
}

Cell groups_cell(const std::vector<SharedCause>& groups) {
  return list_cell(
      groups,
      [](const SharedCause& one) {
        return record_cell("  {by:<6} {value:<24} {cause:<36} {machines:>6} of {of:<6} p = {p_holm}\n", "by"_is(one.by),
                           "value"_is(one.value), "cause"_is(one.cause), "machines"_is(one.machines), "of"_is(one.of),
                           "p_value"_is(one.p_value), "p_holm"_is(one.p_holm, fmt::format("{:.1e}", one.p_holm)));
      },
      groups.empty() ? "" : "\nshared by a type or batch (for all of them together)\n");
}

Cell changed_cell(const FleetChanges& changes) {
  return list_cell(
      changes.machines,
      [](const FleetChange& one) {
        return record_cell("  {id:<24} {cause:<36} {change}\n", "id"_is(one.id), "cause"_is(one.cause),
                           "change"_is(one.is_new ? "new" : "gone"));
      },
      changes.machines.empty() ? "" : "\nchanged since last time\n");
}

Cell changed_causes_cell(const FleetChanges& changes) {
  return list_cell(
      changes.causes,
      [](const FleetChanges::Count& one) {
        return record_cell("  {cause:<36} {new:>6} new {gone:>6} gone\n", "cause"_is(one.cause), "new"_is(one.is_new),
                           "gone"_is(one.gone));
      },
      changes.causes.empty() ? "" : "\nby cause\n");
}

Result<Outcome> fleet_merge(VerbContext& context, const FleetMergeRequest& request) {
  ECS_TRY(gathered, gathered_results(request.results));
  for (const std::string& line : gathered.unreadable) context.console.warn(line);
  for (const std::string& line : gathered.conflicts) context.console.warn(line);
  const FleetNames names = fleet_names(gathered.results, request.rate);
  std::vector<std::string> errors;
  for (const FleetResult& result : gathered.results)
    if (!result.error.empty()) errors.push_back(result.id);
  AnswerFields fields =
      described("machines"_is(names.machines), "errors"_is(errors, fmt::format("{}", errors.size())),
                "conflicts"_is(gathered.conflicts), "fdr"_is(request.rate, fmt::format("{:g}", 100.0 * request.rate)),
                "count"_shown(names.named.size()), "named"_is(named_cell(names.named, "causes named (q-value)")),
                "unconfirmed"_is(named_cell(
                    names.unconfirmed, "not confirmed: among this number of machines, chance may have named these")),
                "unexplained"_is(names.unexplained,
                                 names.unexplained.empty()
                                     ? ""
                                     : fmt::format("\n{} machines with a systematic residual that no effect explains\n",
                                                   names.unexplained.size())),
                "groups"_is(groups_cell(names.groups)));
  std::string layout =
      "{machines} machines, {errors} without an answer; {count} causes named. On average at most {fdr} % of the "
      "machines with a named cause are false alarms: they differ from their model by noise only\n"
      "{named}{unconfirmed}{unexplained}{groups}";
  if (!request.previous.empty()) {
    ECS_TRY(before, previously_named(request.previous, request.rate));
    const FleetChanges changes = changes_between(before, names.named, errors);
    fields.push_back("changed"_is(changed_cell(changes)));
    fields.push_back("changed_causes"_is(changed_causes_cell(changes)));
    layout += "{changed}{changed_causes}";
  }
  if (!request.output.empty()) ECS_DO(write_results(request.output, gathered.results));
  return outcome_of(record_cell(layout, fields), gathered.conflicts.empty() ? kDone : kDoesNotHold);
}

const std::vector<Action> kFleet{
    action("fleet diagnose", "find the effects missing from the models of many machines, on all cores",
           "ecs fleet diagnose fleet.csv -o results.jsonl\n"
           "  fleet.csv:  id,model,data,machine,type,batch\n"
           "              7001,mill.toml,7001.csv,mill_machine.toml,mill,2026-04",
           fleet_diagnose),
    action("fleet merge",
           "combine the results of many machines: confirmed causes, changes, causes common to a batch of machines",
           "ecs fleet merge results*.jsonl --fdr 0.05 --previous yesterday.jsonl -o today.jsonl", fleet_merge)};

}  // namespace

const Module& fleet_module() {
  static const Module module{.menus = {{"fleet", "MODEL: many machines, on many hosts"}},
                             .verbs = {{"volume", &kFleet}, {"volume", &kBatch}},
                             .synonyms = {{"batch", "many units fleet"},
                                          {"fleet diagnose", "many machines batch night slurm parallel"},
                                          {"fleet merge", "many machines batch false discovery rate changed"}}};
  return module;
}

}  // namespace ecs::app
