#include "ecs_emulator/workshop/program.hpp"

#include <cmath>

#include <fmt/format.h>

#include "ecs_emulator/instruments/measurement_files.hpp"
#include "ecs_emulator/part_programs/run.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::emulator {
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
