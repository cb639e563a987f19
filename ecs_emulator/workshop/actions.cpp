// Measuring, part programs and faults, from a request's arguments to its answer.
#include "ecs_emulator/workshop/actions.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "base/file.hpp"
#include "ecs_emulator/instruments/files.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::emulator {
namespace {

using Json = nlohmann::json;
using Answer = Result<Json>;

Answer handed_out(const laser::MeasurementSet& set, const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) ECS_DO(write_measurement(output, set));
  Json answer{
      {"readings", set.readings.size()}, {"output", outputs}, {"time_s", set.readings.back().time_s.value_or(0.0)}};
  if (outputs.empty()) answer["csv"] = laser::to_csv(set);
  return answer;
}

}  // namespace

Answer measure_machine(const Workshop& workshop, Arguments& arguments,
                       const std::function<void(const std::string&)>& report) {
  const auto plan = plan_in(arguments);
  const auto outputs = arguments.words("output");
  ECS_DO(arguments.checked());
  std::size_t percent = 0;
  const auto progress = [&](const MeasurementProgress& at) {
    const std::size_t now = at.readings_done * 100 / at.readings_total;
    if (now == percent || !report) return;
    percent = now;
    report(Json{{"progress", static_cast<double>(now) / 100.0}}.dump());
  };
  ECS_TRY(set, measure(*workshop.simulation, *plan, progress));
  return handed_out(set, outputs);
}

Answer follow_plan(const Workshop& workshop, Arguments& arguments,
                   const std::function<void(const std::string&)>& report) {
  const std::string plan = arguments.word("plan");
  PlanChoice choice;
  choice.phase = arguments.word("phase");
  choice.folder = arguments.word("folder");
  choice.moved = arguments.flag("moved");
  if (plan.empty()) arguments.complain("plan: expected the file of a plan");
  if (choice.folder.empty()) arguments.complain("folder: expected where the files go");
  ECS_DO(arguments.checked());
  ECS_TRY(requests, requests_of(plan, choice));
  std::vector<std::string> files;
  for (const std::string& request : requests) files.push_back(Json::parse(request)["output"][0]);
  ECS_DO(none_there(files, "give another folder"));
  disc::make_folders(choice.folder);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    if (report) report(Json{{"progress", static_cast<double>(k) / static_cast<double>(requests.size())}}.dump());
    const Json request = Json::parse(requests[k]);
    Arguments row(request);
    ECS_DO(measure_machine(workshop, row, {}));
  }
  return Json{{"output", files}};
}

Answer capture_machine(const Workshop& workshop, Arguments& arguments) {
  const auto plan = capture_in(arguments);
  const auto outputs = arguments.words("output");
  ECS_DO(arguments.checked());
  ECS_TRY(set, capture(*workshop.simulation, *plan));
  return handed_out(set, outputs);
}

namespace {

using Report = std::function<void(const std::string&)>;

ProgramOrder order_in(Arguments& arguments) {
  ProgramOrder order;
  order.axis = arguments.axis("axis");
  order.sense = arguments.sense(false);
  order.instrument = arguments.instrument();
  order.reversed = arguments.zero_or_one("reversed");
  order.trace = arguments.word("trace");
  order.trace_period_s = arguments.number_or("trace_period", order.trace_period_s);
  order.date = arguments.word("date");
  order.engineer = arguments.word("engineer");
  return order;
}

/// A line whenever a hundredth of the blocks is done.
std::function<void(const ProgramProgress&)> percents(const Report& report) {
  if (!report) return {};
  return [&report, last = std::size_t{0}](const ProgramProgress& at) mutable {
    const std::size_t now = at.blocks_done * 100 / std::max<std::size_t>(at.blocks_total, 1);
    if (now == last) return;
    last = now;
    // "progress" comes first: by that the client knows that this is not the answer.
    report(fmt::format(R"({{"progress":{},"line":{},"readings":{}}})", static_cast<double>(now) / 100.0, at.line,
                       at.readings));
  };
}

std::function<void(double)> spindle_of(const Workshop& workshop) {
  return [&workshop](double rpm) { workshop.simulation->spindle(std::abs(rpm)); };
}

Json answer_of(const ProgramResult& result, const Simulation& simulation) {
  return {{"blocks", result.summary.blocks},
          {"triggers", result.summary.readings},
          {"missed_trigger_lines", result.summary.missed_lines},
          {"path_mm", result.summary.path_mm},
          {"took_s", result.took_s},
          {"time_s", simulation.machine().time_s()},
          {"command_mm", by_axis(simulation.machine(), simulation.machine().command_mm())}};
}

}  // namespace

Result<Json> run_part_program(const Workshop& workshop, Arguments& arguments, const Report& report) {
  const std::string file = arguments.word("program");
  const ProgramOrder order = order_in(arguments);
  const auto outputs = arguments.words("output");
  if (file.empty()) arguments.complain("program: expected the file of a part program");
  if (!outputs.empty() && !order.axis) arguments.complain("output: expected axis and sense of the measurement");
  ECS_DO(arguments.checked());
  ECS_TRY(program, read_program(file));
  ProgramHooks hooks;
  hooks.report = percents(report);
  hooks.spindle = spindle_of(workshop);
  ECS_TRY(result, run_program(*workshop.simulation, program, order, hooks));
  Json answer = answer_of(result, *workshop.simulation);
  if (!result.readings) return answer;
  for (const std::string& output : outputs) ECS_DO(write_measurement(output, *result.readings));
  answer["readings"] = result.readings->readings.size();
  answer["output"] = outputs;
  if (outputs.empty()) answer["csv"] = laser::to_csv(*result.readings);
  return answer;
}

Result<Json> run_block(const Workshop& workshop, Arguments& arguments) {
  const std::string block = arguments.word("block");
  if (block.empty()) arguments.complain("block: expected one block, such as G01 X-100 F2000");
  if (block.find_first_of("\r\n") != block.npos) arguments.complain("block: expected one line");
  ECS_DO(arguments.checked());
  ECS_TRY(program, parse_program(block, "mdi"));
  ECS_TRY(result, run_program(*workshop.simulation, program, {}, {{}, spindle_of(workshop), {}}));
  return answer_of(result, *workshop.simulation);
}

namespace {

using Provoke = Result<void> (*)(const Workshop&, Arguments&);

std::optional<Address> address_in(Arguments& arguments, Unit& unit) {
  const auto address = arguments.integer("address", 0, 0xFFFFFF);
  if (!address || !unit.memory().exists(static_cast<Address>(*address), 1)) {
    arguments.complain("address: expected an address of the unit's memory");
    return std::nullopt;
  }
  return static_cast<Address>(*address);
}

Result<void> stick_ram(const Workshop& workshop, Arguments& arguments) {
  const auto address = address_in(arguments, *workshop.unit);
  const auto bit = arguments.integer("bit", 0, 7).value_or(0);
  const auto level = arguments.integer("level", 0, 1).value_or(1);
  ECS_DO(arguments.checked());
  workshop.unit->memory().stick(*address, static_cast<int>(bit), static_cast<int>(level));
  return {};
}

Result<void> corrupt_ram(const Workshop& workshop, Arguments& arguments) {
  const auto address = address_in(arguments, *workshop.unit);
  const auto bits = arguments.integer("bits", 1, 255).value_or(1);
  ECS_DO(arguments.checked());
  workshop.unit->memory().corrupt(*address, static_cast<std::uint8_t>(bits));
  return {};
}

Result<void> overrun(const Workshop& workshop, Arguments& arguments) {
  const double extra_us = arguments.number_or("us", 1e6);
  const auto periods = arguments.integer("count", 0, 100'000'000).value_or(0);
  ECS_DO(arguments.checked());
  workshop.unit->slow_down(extra_us, static_cast<std::uint64_t>(periods));
  return {};
}

Result<void> power_fails(const Workshop& workshop, Arguments& arguments) {
  const auto bytes = arguments.integer("count", 0, 100'000'000).value_or(0);
  ECS_DO(arguments.checked());
  workshop.unit->memory().power_fails_after(static_cast<std::uint64_t>(bytes));
  return {};
}

Result<void> hang(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(arguments.checked());
  workshop.unit->hang();
  return {};
}

/// The axis that a fault is asked for; complains where the machine has none.
std::optional<Axis> axis_in(const Workshop& workshop, Arguments& arguments) {
  const auto axis = arguments.axis("axis");
  if (axis && workshop.simulation->machine().has(*axis)) return axis;
  arguments.complain("axis: expected an axis of this machine");
  return std::nullopt;
}

/// A signal of an axis that is lost, or comes back.
template <void (AxisOfMachine::*kLose)(bool)>
Result<void> lose(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  (workshop.simulation->machine().axis(*axis).*kLose)(!back);
  return {};
}

Result<void> hang_switch(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const auto level = arguments.integer("level", 0, 1).value_or(1);
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  workshop.simulation->machine().axis(*axis).hang_switch(back ? std::nullopt : std::optional(level == 1));
  return {};
}

Result<void> miscount(const Workshop& workshop, Arguments& arguments) {
  const auto axis = axis_in(workshop, arguments);
  const auto counts = arguments.integer("count", -1'000'000'000, 1'000'000'000).value_or(10'000);
  ECS_DO(arguments.checked());
  workshop.simulation->machine().axis(*axis).miscount(counts);
  workshop.simulation->idle_tick();
  return {};
}

Result<void> line_fault(const Workshop& workshop, Arguments& arguments, protocol::LinkFault fault) {
  const auto count = arguments.integer("count", 0, 1'000'000);
  const double probability = arguments.number_or("probability", 0.0);
  const auto slow_ms = arguments.number("slow_ms");
  if (workshop.line == nullptr) arguments.complain("this workshop has no link to a host");
  if (!(probability >= 0.0 && probability <= 1.0)) arguments.complain("probability: expected 0 to 1");
  ECS_DO(arguments.checked());
  if (slow_ms) workshop.line->slow_ms = *slow_ms;
  if (count)
    workshop.line->next(fault, static_cast<std::uint32_t>(*count));
  else
    workshop.line->with_probability(fault, probability);
  return {};
}

/// A sensor at a temperature input of the unit.
Result<void> fail_sensor(const Workshop& workshop, Arguments& arguments) {
  const auto input = arguments.integer("input", 1, static_cast<long long>(kTemperatureInputs)).value_or(1);
  const bool back = arguments.flag("back");
  const std::string how = arguments.word("how");
  const double by_degC = arguments.number_or("by", 0.0);
  SensorFailure failure = SensorFailure::none;
  if (how == "open" || how == "stuck")
    failure = how == "open" ? SensorFailure::open : SensorFailure::stuck;
  else if (how == "shifted")
    failure = SensorFailure::shifted;
  else if (!back)
    arguments.complain("how: expected open, stuck or shifted, got \"{}\"", how);
  ECS_DO(arguments.checked());
  workshop.unit->fail_sensor(static_cast<std::size_t>(input - 1), failure,
                             failure == SensorFailure::shifted ? by_degC : 0.0);
  return {};
}

/// The battery that keeps the memory while the unit is off.
Result<void> empty_battery(const Workshop& workshop, Arguments& arguments) {
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  workshop.unit->battery(back ? protocol::BatteryState::good : protocol::BatteryState::low);
  return {};
}

Result<void> lose_deviation(const Workshop& workshop, Arguments& arguments) {
  const bool back = arguments.flag("back");
  ECS_DO(arguments.checked());
  workshop.simulation->lose_deviation(!back);
  return {};
}

Result<void> clear(const Workshop& workshop, Arguments& arguments) {
  ECS_DO(arguments.checked());
  workshop.simulation->lose_deviation(false);
  if (workshop.line != nullptr) workshop.line->clear();
  if (workshop.unit != nullptr) {
    workshop.unit->memory().repair();
    workshop.unit->slow_down(0.0);
    workshop.unit->battery(protocol::BatteryState::good);
    for (std::size_t i = 0; i < kTemperatureInputs; ++i) workshop.unit->fail_sensor(i, SensorFailure::none);
  }
  for (const Axis a : kAllAxes) {
    if (!workshop.simulation->machine().has(a)) continue;
    AxisOfMachine& axis = workshop.simulation->machine().axis(a);
    axis.lose_transducer(false);
    axis.lose_marker(false);
    axis.hang_switch(std::nullopt);
  }
  return {};
}

struct NamedFault {
  std::string_view name;
  Provoke provoke;
  bool in_unit;
};
constexpr std::array<NamedFault, 13> kFaults{{{"clear", clear, false},
                                              {"transducer", lose<&AxisOfMachine::lose_transducer>, false},
                                              {"marker", lose<&AxisOfMachine::lose_marker>, false},
                                              {"switch", hang_switch, false},
                                              {"miscount", miscount, false},
                                              {"ram_stuck", stick_ram, true},
                                              {"corrupt", corrupt_ram, true},
                                              {"overrun", overrun, true},
                                              {"hang", hang, true},
                                              {"power_fails", power_fails, true},
                                              {"sensor", fail_sensor, true},
                                              {"deviation", lose_deviation, false},
                                              {"battery", empty_battery, true}}};

}  // namespace

Result<void> provoke(const Workshop& workshop, Arguments& arguments) {
  const std::string name = arguments.word("name");
  std::string names;
  for (const NamedFault& fault : kFaults) {
    names += fmt::format("{}, ", fault.name);
    if (fault.name != name) continue;
    if (fault.in_unit && workshop.unit == nullptr) return problem(ProblemKind::usage, "this machine has no unit");
    return fault.provoke(workshop, arguments);
  }
  if (const auto line = protocol::link_fault_named(name)) return line_fault(workshop, arguments, *line);
  return problem(ProblemKind::usage, "name: expected {}{}, got \"{}\"", names,
                 fmt::join(protocol::kLinkFaultNames, ", "), name);
}

}  // namespace ecs::emulator
