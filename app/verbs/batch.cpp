// `ecs batch`: a plan of many units, with a table at the end.
#include <memory>

#include <fmt/format.h>

#include "app/cli/menus.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/json.hpp"
#include "commissioning/batch/run.hpp"

namespace ecs::app {
namespace {

struct BatchArguments {
  std::string plan;
  bool dry_run = false;
};

Json json_of(const BatchReport& report) {
  return Json{{"name", report.name},
              {"link", report.link},
              {"emulator", report.is_emulator},
              {"serial_number", text_or_null(report.serial_number)},
              {"state", name_of(report.state)},
              {"bytes", report.bytes > 0 ? Json(report.bytes) : Json(nullptr)},
              {"notes", report.notes},
              {"error", report.problem ? ecs::json_of(*report.problem) : Json(nullptr)}};
}

std::string table_of(const std::vector<BatchReport>& reports) {
  std::string text = fmt::format("{:<20} {:<14} {:<14} {}\n", "unit", "serial number", "result", "link");
  for (const BatchReport& report : reports) {
    text += fmt::format("{:<20} {:<14} {:<14} {}{}\n", report.name,
                        report.serial_number.empty() ? "unknown" : report.serial_number, name_of(report.state),
                        report.is_emulator ? "EMULATOR " : "", report.link);
    if (report.problem) text += fmt::format("    {}\n", to_text(*report.problem));
    for (const std::string& note : report.notes) text += fmt::format("    note: {}\n", note);
  }
  return text;
}

/// The one that makes the exit code: a lost link before the rest.
const Problem* first_problem(const std::vector<BatchReport>& reports) {
  const Problem* first = nullptr;
  for (const BatchReport& report : reports) {
    if (!report.problem) continue;
    if (report.problem->kind == ProblemKind::link) return &*report.problem;
    if (first == nullptr) first = &*report.problem;
  }
  return first;
}

Result<Outcome> batch(VerbContext& context, const BatchArguments& arguments) {
  if (!context.link_option.empty())
    return problem(ProblemKind::usage, "batch: the plan names the link of each unit; leave --link out");
  const auto plan = read_batch_plan(arguments.plan);
  if (!plan) return tl::unexpected(plan.error());
  const auto reports =
      run_batch(*plan, arguments.dry_run ? BatchMode::dry_run : BatchMode::send, [&context](const PlannedUnit& unit) {
        context.console.message_prefix = unit.link.is_emulator() ? "EMULATOR: " : "";
        context.console.note(fmt::format("{}: {}", unit.name, to_text(unit.link)));
        return progress_bar(context, unit.name);
      });
  context.console.end_progress();
  context.console.message_prefix.clear();
  Json units = Json::array();
  for (const BatchReport& report : reports) units.push_back(json_of(report));
  const int exit_code = exit_code_of(reports);
  Json object{{"plan", arguments.plan}, {"dry_run", arguments.dry_run}, {"ok", exit_code == kDone}, {"units", units}};
  if (const Problem* problem = first_problem(reports); problem != nullptr && exit_code > kDoesNotHold)
    object["error"] = ecs::json_of(*problem);
  std::string text = table_of(reports);
  if (arguments.dry_run)
    text += "dry run: files, checks, images, links and serial numbers were looked at; nothing was written\n";
  return Outcome{text, one_line(object), exit_code};
}

}  // namespace

void add_batch_verb(Menu& root) {
  const auto arguments = std::make_shared<BatchArguments>();
  root.verb("batch", "parameters and maps for many units, by a plan",
            "ecs batch plan.toml --dry-run\n  plan.toml:  [[unit]]\n              name = \"mill 3\"\n              "
            "link = \"rtu:/dev/ttyUSB0:115200\"\n              serial_number = \"MCM-0107\"\n              params = "
            "\"mill3.toml\"\n              map = \"mill3_map.csv\"")
      .text("PLAN", arguments->plan, "plan file (TOML)", Need::required)
      .flag("--dry-run", arguments->dry_run, "check everything, write nothing")
      .runs([arguments](VerbContext& context) { return batch(context, *arguments); });
}

}  // namespace ecs::app
