#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/overwriting.hpp"
#include "ecs_emulator/instruments/arguments.hpp"
#include "ecs_emulator/instruments/files.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "ecs_emulator/workshop/actions.hpp"
#include "laser/writers/measurement_writer.hpp"

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
  std::error_code error;
  std::filesystem::create_directories(choice.folder, error);
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

using Json = nlohmann::json;
using Report = std::function<void(const std::string&)>;

std::optional<Sense> sense_in(Arguments& arguments) {
  const std::string name = arguments.word("sense");
  if (name.empty()) return std::nullopt;
  const auto sense = sense_named(name);
  if (!sense) arguments.complain(fmt::format("sense: expected EX, EY, EZ, EA, EB or EC, got \"{}\"", name));
  return sense;
}

std::optional<InstrumentKind> instrument_in(Arguments& arguments) {
  const std::string name = arguments.word("instrument");
  if (name.empty()) return std::nullopt;
  const auto kind = instrument_named(name);
  if (!kind)
    arguments.complain(
        fmt::format("instrument: expected linear, straightness, angular, level or square, got \"{}\"", name));
  return kind;
}

ProgramOrder order_in(Arguments& arguments) {
  ProgramOrder order;
  order.axis = arguments.axis("axis");
  order.sense = sense_in(arguments);
  order.instrument = instrument_in(arguments);
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
  Json place = Json::object();
  for (const Axis a : kAllAxes)
    if (simulation.machine().has(a))
      place[std::string(1, letter_of(a))] = simulation.machine().command_mm()[index_of(a)];
  return {{"blocks", result.summary.blocks},
          {"triggers", result.summary.readings},
          {"missed_trigger_lines", result.summary.missed_lines},
          {"path_mm", result.summary.path_mm},
          {"took_s", result.took_s},
          {"time_s", simulation.machine().time_s()},
          {"command_mm", place}};
}

}  // namespace

Result<Json> run_part_program(const Workshop& workshop, Arguments& arguments, const Report& report) {
  const std::string file = arguments.word("program");
  const ProgramOrder order = order_in(arguments);
  const auto outputs = arguments.words("output");
  if (file.empty()) arguments.complain("program: expected the file of a part program");
  if (!outputs.empty() && !order.axis) arguments.complain("output: expected axis and sense, what is measured");
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

}  // namespace ecs::emulator
