#include "ecs_emulator/part_programs/writer.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/instruments/files.hpp"
#include "ecs_emulator/part_programs/reader.hpp"
#include "ecs_emulator/part_programs/run.hpp"

namespace ecs::emulator {
namespace {

constexpr double kTrigger_s = 1.0;      ///< between M08 and M09 (appendix B)
constexpr std::size_t kWorthALoop = 3;  ///< equal steps

/// As a control takes it: one decimal at least, six at most.
std::string word(double mm) {
  const double rounded = to_nanometre(mm);
  std::string text = fmt::format("{:.6f}", rounded == 0.0 ? 0.0 : rounded);
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  return text;
}

/// A dwell, feed or time: no more decimals than it has.
std::string short_word(double value) {
  std::string text = fmt::format("{:.6f}", value);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

class PlanProgram {
 public:
  explicit PlanProgram(const MeasurementPlan& plan) : plan_(plan), name_(letter_of(plan.axis)) {}

  std::string text() {
    head();
    std::string parked;
    for (const Axis a : kAllAxes)
      if (a != plan_.axis && plan_.parked_mm[index_of(a)]) parked += letter_of(a) + word(*plan_.parked_mm[index_of(a)]);
    if (!parked.empty()) block("G90G00" + parked, "PARK THE OTHER AXES");
    if (plan_.runs > 1) line(fmt::format("$REP {}", plan_.runs), fmt::format("REPEAT THE RUN {} TIMES", plan_.runs));
    auto back = plan_.targets_mm;
    std::reverse(back.begin(), back.end());
    pass(plan_.targets_mm);
    if (plan_.bidirectional) pass(back);
    if (plan_.runs > 1) line("$END", "END OF THE RUNS");
    return text_;
  }

 private:
  void line(const std::string& code, const std::string& remark = "") {
    text_ += remark.empty() ? code + "\n" : fmt::format("{:<22};{}\n", code, remark);
  }
  void block(const std::string& code, const std::string& remark = "") { line("> " + code, remark); }
  void note(const std::string& remark) { text_ += "; " + remark + "\n"; }

  void head() {
    const auto kind = plan_.instrument.value_or(instrument_for(plan_.sense, plan_.axis));
    note(fmt::format("{} along {}: {} targets from {} to {} mm, {} {} {}", name_of(plan_.sense), name_,
                     plan_.targets_mm.size(), word(plan_.targets_mm.front()), word(plan_.targets_mm.back()), plan_.runs,
                     plan_.runs == 1 ? "run" : "runs", plan_.bidirectional ? "there and back" : "one way"));
    note(fmt::format("run with --axis {} --sense {} --instrument {}", name_, name_of(plan_.sense), name_of(kind)));
    note("M08 switches the coolant on at most controls: change it before the program runs on a machine.");
    if (plan_.on_the_fly) note("readings at standstill, although the plan specifies readings on the fly");
  }

  void reading() {
    if (plan_.dwell_s > 0.0) block("G04H" + short_word(plan_.dwell_s), "DELAY FOR AXIS POSITION TO SETTLE");
    block("M08", "TRIGGER MEASUREMENT SYSTEM TO TAKE READING");
    block("G04H" + short_word(kTrigger_s));
    block("M09");
  }

  /// How many steps from place `i` on are all the same, added up as the control does.
  static std::size_t equal_steps(const std::vector<double>& targets, std::size_t i) {
    if (i + 1 >= targets.size()) return 0;
    const double step = to_nanometre(targets[i + 1] - targets[i]);
    double place = to_nanometre(targets[i]);
    std::size_t count = 0;
    while (i + count + 1 < targets.size()) {
      place = to_nanometre(place + step);
      if (place != to_nanometre(targets[i + count + 1])) break;
      ++count;
    }
    return count;
  }

  void pass(const std::vector<double>& targets) {
    const double onward = targets[1] > targets[0] ? 1.0 : -1.0;
    const std::string feed = "F" + short_word(plan_.feed_mm_min);
    if (plan_.overrun_mm > 0.0)
      block(fmt::format("G90G01{}{}{}", name_, word(targets.front() - onward * plan_.overrun_mm), feed),
            "REMOVE BACKLASH BEFORE FIRST READING");
    block(fmt::format("G90G01{}{}{}", name_, word(targets.front()), feed));
    reading();
    for (std::size_t i = 0; i + 1 < targets.size();) {
      const std::size_t steps = equal_steps(targets, i);
      if (steps >= kWorthALoop) {
        const std::string step = word(targets[i + 1] - targets[i]);
        line(fmt::format("$REP {}", steps), fmt::format("REPEAT {} TIMES", steps));
        block(fmt::format("{}{}G91", name_, step), fmt::format("MOVE INCREMENTALLY {} mm", step));
        reading();
        line("$END");
        i += steps;
      } else {
        block(fmt::format("G90{}{}", name_, word(targets[++i])));
        reading();
      }
    }
  }

  const MeasurementPlan& plan_;
  char name_;
  std::string text_;
};

}  // namespace

std::string program_for(const MeasurementPlan& plan) { return PlanProgram(plan).text(); }

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
    return problem(ProblemKind::usage, "feed: expected {} mm/min or more", kSlowestFeed_mm_min);
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
