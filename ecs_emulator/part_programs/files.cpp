#include "ecs_emulator/part_programs/files.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ecs_emulator/instruments/measurement_request.hpp"
#include "ecs_emulator/instruments/plan_file.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "ecs_emulator/part_programs/writer.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;

Result<std::optional<WorkshopMachine>> machine_at(const std::optional<std::filesystem::path>& path) {
  if (!path) return std::optional<WorkshopMachine>{};
  ECS_TRY(machine, load_workshop_machine(*path));
  return std::optional(std::move(machine));
}

/// Empty where `measure` would not refuse the plan either.
Result<void> fits(const MeasurementPlan& plan) {
  const auto& targets = plan.targets_mm;
  if (targets.size() < 2) return problem(ProblemKind::usage, "targets: expected at least 2");
  for (std::size_t i = 1; i < targets.size(); ++i)
    if ((targets[i] - targets[i - 1]) * (targets[1] - targets[0]) <= 0.0)
      return problem(ProblemKind::usage, "targets: expected one direction");
  if (!(plan.feed_mm_min >= kSlowestFeed_mm_min))
    return problem(ProblemKind::usage, fmt::format("feed: expected {} mm/min or more", kSlowestFeed_mm_min));
  if (!(plan.dwell_s >= 0.0 && plan.dwell_s <= 86'400.0))
    return problem(ProblemKind::usage, "dwell: expected 0 to 86400 s");
  if (!(plan.overrun_mm >= 0.0)) return problem(ProblemKind::usage, "overrun: expected 0 mm or more");
  return {};
}

void park(MeasurementPlan& plan, const WorkshopMachine& machine) {
  const Vector3 place_mm = parking_place(machine, plan);
  for (const Axis a : kAllAxes)
    if (a != plan.axis && machine.machine.axes[index_of(a)]) plan.parked_mm[index_of(a)] = place_mm[index_of(a)];
}

Result<void> checked(const ProgramFile& file, const WorkshopMachine& machine) {
  ECS_TRY(program, parse_program(file.text, file.name));
  const MachineTool tool(machine);
  ECS_DO(checked_program(program, tool.command_mm(), range_of(tool)));
  return {};
}

Result<ProgramFile> written(const std::string& request, const std::string& name,
                            const std::optional<WorkshopMachine>& machine) {
  const Json json = Json::parse(request, nullptr, false);
  Arguments arguments(json);
  static_cast<void>(arguments.words("output"));  // of a plan: where its readings would go
  auto plan = plan_in(arguments);
  ECS_DO(arguments.checked());
  ECS_DO(fits(*plan));
  if (machine) park(*plan, *machine);
  ProgramFile file{name, program_for(*plan)};
  if (machine) ECS_DO(checked(file, *machine));
  return file;
}

}  // namespace

Result<std::vector<ProgramFile>> programs_of_plan(const std::filesystem::path& plan,
                                                  const std::optional<std::filesystem::path>& machine, bool even) {
  PlanChoice choice;
  choice.moved = !even;
  ECS_TRY(requests, requests_of(plan, choice));
  ECS_TRY(tool, machine_at(machine));
  std::vector<ProgramFile> files;
  std::vector<Problem> problems;
  for (const std::string& request : requests) {
    const std::filesystem::path output = Json::parse(request)["output"][0].get<std::string>();
    auto file = written(request, output.stem().string() + ".nc", tool);
    if (file)
      files.push_back(std::move(*file));
    else
      problems.push_back(file.error());
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return files;
}

Result<ProgramFile> program_of_request(const std::string& request, const std::string& name,
                                       const std::optional<std::filesystem::path>& machine) {
  ECS_TRY(tool, machine_at(machine));
  return written(request, name, tool);
}

}  // namespace ecs::emulator
