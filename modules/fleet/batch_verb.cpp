// `ecs batch`: a plan of many units, with a table at the end.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "modules/fleet/batch.hpp"

namespace ecs::app {
namespace {

struct BatchRequest {
  std::string plan, output;
  bool dry_run = false;
  int lines = kUsualLines;
  static Fields<BatchRequest> fields() {
    using R = BatchRequest;
    return {{"PLAN", &R::plan,
             "plan file (TOML), or a table (.csv) with the columns id, link, params, serial_number, map, arm_code",
             Need::required},
            {"--dry-run", &R::dry_run, "check everything, write nothing"},
            {"--lines", &R::lines, "lines that are served at the same time", Range{1, kMostLines}},
            {"-o,--output", &R::output, "the report, a line of JSON a unit", Is::output}};
  }
};

Cell report_cell(const BatchReport& r) {
  std::string below;
  if (r.problem) below += fmt::format("    {}\n", to_text(*r.problem));
  for (const std::string& note : r.notes) below += fmt::format("    note: {}\n", note);
  return record_cell(
      "{name:<20} {serial_number:<14} {state:<14} {link}\n{error}",
      {{"name", word_cell(r.name)},
       {"link", {r.link, (r.is_emulator ? "EMULATOR " : "") + r.link}},
       {"emulator", {r.is_emulator, ""}},
       {"serial_number", {text_or_null(r.serial_number), r.serial_number.empty() ? "unknown" : r.serial_number}},
       {"state", word_cell(name_of(r.state))},
       {"bytes", {r.bytes > 0 ? Json(r.bytes) : Json(nullptr), ""}},
       {"notes", {r.notes, ""}},
       {"error", {r.problem ? problem_json(*r.problem) : Json(nullptr), below}}});
}

Cell reports_cell(const std::vector<BatchReport>& reports) {
  return list_cell(reports, report_cell, fmt::format("{:<20} {:<14} {:<14} link\n", "unit", "serial number", "result"));
}

/// A line as that of a machine in the results of `ecs fleet diagnose`: {"id", "state", …} or {"id", "error"}.
std::string report_line(const BatchReport& r) {
  if (r.problem) return one_line({{"id", r.name}, {"error", to_text(*r.problem)}});
  return one_line({{"id", r.name},
                   {"state", name_of(r.state)},
                   {"serial_number", text_or_null(r.serial_number)},
                   {"link", r.link},
                   {"bytes", r.bytes}});
}

Result<void> write_report(const std::string& path, const std::vector<BatchReport>& reports) {
  if (path.empty()) return {};
  std::string text;
  for (const BatchReport& report : reports) text += report_line(report) + '\n';
  return write_file(path, text);
}

Result<Outcome> batch(VerbContext& context, const BatchRequest& request) {
  if (!context.link_option.empty())
    return problem(ProblemKind::usage, "batch: the plan names the link of each unit; leave --link out");
  ECS_TRY(plan, read_batch_plan(request.plan));
  BatchWatch watch;
  watch.begun = [&context](const PlannedUnit& unit) {
    context.console.message_prefix = unit.link.is_emulator() ? "EMULATOR: " : "";
    context.console.note(fmt::format("{}: {}", unit.name, to_text(unit.link)));
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
  Json object{{"plan", request.plan}, {"dry_run", request.dry_run}, {"ok", exit_code == kDone}, {"units", units.json}};
  if (const Problem* problem = first_problem(reports); problem != nullptr && exit_code > kDoesNotHold)
    object["error"] = problem_json(*problem);
  std::string text = units.text;
  if (request.dry_run)
    text += "dry run: files, checks, images, links and serial numbers were looked at; nothing was written\n";
  return Outcome{text, one_line(object), exit_code};
}

}  // namespace

extern const std::vector<Action> kBatch{
    action("batch", "parameters and maps for many units, by a plan",
           "ecs batch plan.toml --dry-run\n  plan.toml:  [[unit]]\n              name = \"mill 3\"\n              "
           "link = \"rtu:/dev/ttyUSB0:115200\"\n              serial_number = \"MCM-0107\"\n              params = "
           "\"mill3.toml\"\n              map = \"mill3_map.csv\"\n              arm_code = \"271828\"",
           batch)};

}  // namespace ecs::app
