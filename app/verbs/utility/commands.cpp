// `ecs utility position, output, run, ramtest, reset, clear`: single commands to the unit.
#include <chrono>

#include <fmt/format.h>

#include "app/cli/axis_argument.hpp"
#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "base/numbers.hpp"
#include "commissioning/session/shell_word.hpp"
#include "commissioning/unit/utility_work.hpp"

namespace ecs::app {
namespace {

/// Opens the unit and gives one command whose success needs no more than this answer.
Result<Outcome> simple(VerbContext& context, const std::function<Result<void>(protocol::UnitClient&)>& command,
                       const Cell& answer) {
  ECS_TRY(unit, open_unit(context, Access::writes));
  ECS_DO(command(unit.client()));
  return outcome_of(answer);
}

Cell done_cell(std::string_view key, std::string text) {
  return {object_of({{key, yes_cell(true, "", "")}}), std::move(text)};
}

struct PositionArguments : VerbArguments {
  const std::string& axis = choice("AXIS", {"X", "Y", "Z"}, "axis", Need::required);
  const double& position_mm = number("MM", "position, mm", 0.0, Need::required);
  const Access access = writes_to_unit();
};

Result<Outcome> set_position(VerbContext& context, const PositionArguments& arguments) {
  ECS_TRY(axis, axis_named(arguments.axis));
  return simple(
      context, [&](protocol::UnitClient& client) { return client.set_axis_position(axis, arguments.position_mm); },
      record_cell("axis {axis} now shows {position_mm} mm",
                  {{"axis", word_cell(arguments.axis)}, {"position_mm", plain_cell(arguments.position_mm)}}));
}

struct OutputArguments : VerbArguments {
  const std::string& axis = choice("AXIS", {"X", "Y", "Z"}, "axis");
  const std::optional<double>& output_um = optional_number("UM", "compensation, um");
  const bool& relay = flag("--relay", "close the relay: the machine axis moves (needs --yes)");
  const bool& off = flag("--off", "every output 0, every relay open");
  const bool& yes = flag("--yes", "the axis may move");
  const Access access = writes_to_unit();
};

Result<Outcome> output_value(VerbContext& context, const OutputArguments& arguments) {
  const bool given = !arguments.axis.empty() && arguments.output_um.has_value();
  if (arguments.off == given) return problem(ProblemKind::usage, "utility output: give either AXIS UM or --off");
  if (arguments.off)
    return simple(
        context, [](protocol::UnitClient& client) { return client.output_off(); },
        done_cell("off", "every output 0, every relay open"));
  ECS_TRY(axis, axis_named(arguments.axis));
  if (arguments.relay)
    ECS_DO(confirmed(arguments.yes, fmt::format("with the relay closed, axis {} moves by {} um", arguments.axis,
                                                *arguments.output_um)));
  std::vector<std::string> off{"ecs", "utility", "output", "--off"};
  if (!context.link_option.empty()) off.insert(off.end(), {"--link", context.link_option});
  return simple(
      context,
      [&](protocol::UnitClient& client) {
        return client.output_compensation(axis, *arguments.output_um, arguments.relay);
      },
      record_cell("axis {axis}: {output_um} um at the D/A converter, relay {relay_closed}; `{off}` ends it",
                  {{"off", shown_cell(shell_command(off))},
                   {"axis", word_cell(arguments.axis)},
                   {"output_um", plain_cell(*arguments.output_um)},
                   {"relay_closed", yes_cell(arguments.relay, "closed", "open")}}));
}

struct RunArguments : VerbArguments {
  const std::string& address = text("ADDRESS", "start address, decimal or 0x…", Need::required);
  const std::string& argument = text("--argument", "a number that the program is given", Need::optional, "0");
  const double& wait_s = number("--wait", "seconds to wait for its end", 60.0, Need::optional, 0.0, 86400.0);
  const bool& yes = flag("--yes", "run it");
  const Access access = writes_to_unit();
};

Result<Outcome> run_program_in_unit(VerbContext& context, const RunArguments& arguments) {
  ECS_TRY(address, whole_number(arguments.address, "ADDRESS"));
  ECS_TRY(argument, whole_number(arguments.argument, "--argument"));
  if (const auto sure =
          confirmed(arguments.yes, fmt::format("the unit runs the machine code at {}", hex_address(address)));
      !sure)
    return tl::unexpected(sure.error());
  ECS_TRY(unit, open_unit(context, arguments.access));
  const std::chrono::milliseconds limit(static_cast<long long>(arguments.wait_s * 1000.0));
  ECS_TRY(value, unit.client().run_user_software(address, argument, limit));
  ECS_TRY(registers, kept_registers(unit.client()));
  return outcome_of(record_cell("the program at {address} returned {returned} ({hexadecimal})\n{registers}",
                                {{"address", word_cell(hex_address(address))},
                                 {"argument", integer_cell(argument)},
                                 {"returned", integer_cell(value)},
                                 {"registers", registers_cell(registers)},
                                 {"hexadecimal", shown_cell(fmt::format("0x{:08X}", value))}}));
}

struct UnitWriter : VerbArguments {
  const Access access = writes_to_unit();
};

Result<Outcome> ram_test(VerbContext& context, const UnitWriter& arguments) {
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(result, unit.client().run_ram_test([&context](const protocol::CommandResult& busy) {
    context.console.progress("RAM test", busy.per_mille / 1000.0, 0.0);
  }));
  const bool passed = result.value == protocol::kUnused;
  const std::string address = passed ? std::string() : hex_address(result.value);
  return outcome_of(
      record_cell(passed ? "RAM test passed" : "RAM test failed at {address}: replace that axis memory module",
                  {{"passed", yes_cell(passed, "", "")}, {"address", text_cell(address)}}),
      passed ? kDone : kDoesNotHold);
}

Result<Outcome> reset(VerbContext& context, const UnitWriter&) {
  return simple(
      context, [](protocol::UnitClient& client) { return client.reset_unit(); },
      done_cell("reset", "the unit restarts"));
}

Result<Outcome> clear(VerbContext& context, const UnitWriter&) {
  return simple(
      context, [](protocol::UnitClient& client) { return client.clear_fault(); },
      done_cell("cleared", "the fault is cleared"));
}

}  // namespace

extern const VerbDefinition kUtilityPosition =
    verb<PositionArguments>("utility position", "preset the position that the unit shows for an axis",
                            "ecs utility position X -100.5", set_position);

extern const VerbDefinition kUtilityOutput = verb<OutputArguments>(
    "utility output", "put a compensation value on the D/A converter of one axis",
    "ecs utility output X 5\n  ecs utility output X 5 --relay --yes\n  ecs utility output --off", output_value);

extern const VerbDefinition kUtilityRun =
    verb<RunArguments>("utility run", "run machine code in the unit's memory",
                       "ecs utility run 0x041000 --argument 7 --yes", run_program_in_unit);

extern const VerbDefinition kUtilityRamtest = verb<UnitWriter>(
    "utility ramtest", "test every location of the axis memory; its contents stay", "ecs utility ramtest", ram_test);

extern const VerbDefinition kUtilityReset =
    verb<UnitWriter>("utility reset", "restart the unit", "ecs utility reset", reset);

extern const VerbDefinition kUtilityClear =
    verb<UnitWriter>("utility clear", "clear the fault that the unit keeps", "ecs utility clear", clear);

}  // namespace ecs::app
