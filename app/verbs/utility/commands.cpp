// `ecs utility position, output, run, ramtest, reset, clear`: single commands to the unit. `mode`: integration or
// compensation, and how far datuming is.

#include "commissioning/session/commands.hpp"

#include <chrono>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "app/verbs/utility/shown.hpp"
#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "commissioning/unit/status.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "params/position_unit.hpp"

namespace ecs::app {
namespace {

/// Opens the unit and gives one command whose success needs no more than this answer.
Result<Outcome> simple(VerbContext& context, const std::function<Result<void>(protocol::UnitClient&)>& command,
                       const Cell& answer) {
  ECS_TRY(unit, open_unit(context));
  ECS_DO(command(unit.client()));
  return outcome_of(answer);
}

Cell done_cell(std::string_view key, std::string text) { return {object_of(FieldKey(key)(true)), std::move(text)}; }

struct PositionRequest {
  std::string axis;
  double position_mm = 0.0;
  static Fields<PositionRequest> fields() {
    using R = PositionRequest;
    return {{"AXIS", &R::axis, "axis", Words{"X", "Y", "Z"}, Need::required},
            {"MM", &R::position_mm, "position [mm]", Need::required}};
  }
};

Result<Outcome> set_position(VerbContext& context, const PositionRequest& request) {
  ECS_TRY(axis, axis_named(request.axis));
  ECS_TRY(unit, open_unit(context));
  ECS_DO(unit.client().set_axis_position(axis, request.position_mm));
  const params::PositionUnit& shown_in = position_unit_for(context, unit);
  const std::string given = fmt::format("{} mm", request.position_mm);
  return outcome_of(record_cell(
      "axis {axis} now shows {position_mm}; this does not reference the axis", "axis"_is(request.axis),
      "position_mm"_is(
          request.position_mm,
          shown_in.mm == 1.0 ? given : fmt::format("{} ({})", shown_in.with_unit(request.position_mm), given))));
}

struct OutputRequest {
  std::string axis;
  std::optional<double> output_um;
  bool relay = false, off = false, yes = false;
  static Fields<OutputRequest> fields() {
    using R = OutputRequest;
    return {{"AXIS", &R::axis, "axis", Words{"X", "Y", "Z"}},
            {"UM", &R::output_um, "compensation [um]"},
            {"--relay", &R::relay, "close the relay, so that the machine axis moves (needs --yes)"},
            {"--off", &R::off, "set every output to 0 and open every relay"},
            {"--yes", &R::yes, "confirm that the axis may move"}};
  }
};

Result<Outcome> output_value(VerbContext& context, const OutputRequest& request) {
  const bool given = !request.axis.empty() && request.output_um.has_value();
  if (request.off == given)
    return problem(
        ProblemKind::usage,
        "utility output: expected an axis and a compensation in um, as in `ecs utility output X 5`, or --off alone");
  if (request.off)
    return simple(
        context, [](protocol::UnitClient& client) { return client.output_off(); },
        done_cell("off", "every output is set to 0 and every relay is open"));
  ECS_TRY(axis, axis_named(request.axis));
  if (request.relay)
    ECS_DO(confirmed(request.yes, fmt::format("the relay will be closed and axis {} will move by {} um", request.axis,
                                              *request.output_um)));
  std::vector<std::string> off{"ecs", "utility", "output", "--off"};
  if (!context.link_option.empty()) off.insert(off.end(), {"--link", context.link_option});
  return simple(
      context,
      [&](protocol::UnitClient& client) { return client.output_compensation(axis, *request.output_um, request.relay); },
      record_cell("axis {axis}: {output_um} um at the D/A converter, relay {relay_closed}; `{off}` ends it",
                  "off"_shown(shell_command(off)), "axis"_is(request.axis), "output_um"_is(*request.output_um),
                  "relay_closed"_is(request.relay, "closed", "open")));
}

struct RunRequest {
  std::string address;
  std::string argument = "0";
  double wait_s = 60.0;
  bool yes = false;
  static Fields<RunRequest> fields() {
    using R = RunRequest;
    return {{"ADDRESS", &R::address, "start address, decimal or 0x…", Need::required},
            {"--argument", &R::argument, "number passed to the program"},
            {"--wait", &R::wait_s, "time to wait for its end [s]", Range{0.0, 86400.0}},
            {"--yes", &R::yes, "confirm running the program"}};
  }
};

Result<Outcome> run_program_in_unit(VerbContext& context, const RunRequest& request) {
  ECS_TRY(address, whole_number(request.address, "ADDRESS"));
  ECS_TRY(argument, whole_number(request.argument, "--argument"));
  ECS_DO(confirmed(request.yes, fmt::format("the unit runs the machine code at {}", hex_address(address))));
  ECS_TRY(unit, open_unit(context));
  const std::chrono::milliseconds limit(static_cast<long long>(request.wait_s * 1000.0));
  ECS_TRY(value, unit.client().run_user_software(address, argument, limit));
  ECS_TRY(registers, kept_registers(unit.client()));
  return outcome_of(record_cell("the program at {address} returned {returned} ({hexadecimal})\n{registers}",
                                "address"_is(hex_address(address)), "argument"_is(argument), "returned"_is(value),
                                "registers"_is(registers_cell(registers)),
                                "hexadecimal"_shown(fmt::format("0x{:08X}", value))));
}

Result<Outcome> ram_test(VerbContext& context, const cli::Nothing&) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(result, unit.client().run_ram_test([&context](const protocol::CommandResult& busy) {
    context.console.progress("RAM test", busy.per_mille / 1000.0, 0.0);
  }));
  const bool passed = result.value == protocol::kUnused;
  const std::string address = passed ? std::string() : hex_address(result.value);
  return outcome_of(
      record_cell(passed ? "RAM test passed"
                         : "RAM test failed at {address}: replace the axis memory module that contains this address",
                  "passed"_is(passed), "address"_is(text_cell(address))),
      passed ? kDone : kDoesNotHold);
}

Result<Outcome> reset(VerbContext& context, const cli::Nothing&) {
  return simple(
      context, [](protocol::UnitClient& client) { return client.reset_unit(); },
      done_cell("reset", "the unit restarts"));
}

Result<Outcome> clear(VerbContext& context, const cli::Nothing&) {
  return simple(
      context, [](protocol::UnitClient& client) { return client.clear_fault(); },
      done_cell("cleared", "the fault is cleared"));
}

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPoll{250};

struct ModeRequest {
  std::string mode;
  double wait_s = 60.0;
  static Fields<ModeRequest> fields() {
    using R = ModeRequest;
    return {{"MODE", &R::mode, "mode", Words{"compensate", "integrate"}, Need::required},
            {"--wait", &R::wait_s, "time to wait for the datum routine to finish [s]; 0: return at once",
             Range{0.0, 86400.0}}};
  }
};

std::string stages_of(const StatusSnapshot& snapshot) {
  std::string text;
  for (const Axis axis : kAllAxes)
    if (snapshot.identity.axis_present[index_of(axis)])
      text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", letter_of(axis),
                          ecs::name_of(snapshot.status.axes[index_of(axis)].datum_stage));
  return text;
}

Outcome outcome_of(const StatusSnapshot& snapshot, std::string text, int exit_code) {
  const Json full = status_cell(snapshot).json;
  Json object = object_of("mode"_is(full["mode"]), "fault"_is(full["fault"]), "axes"_is(full["axes"]));
  return {std::move(text), one_line(object), exit_code};
}

Result<Outcome> integrate(UnitLink& unit) {
  ECS_DO(unit.client().enter_integration());
  ECS_TRY(snapshot, take_snapshot(unit.client(), unit.name()));
  return outcome_of(snapshot, "integration mode: relays open", kDone);
}

/// Follows the unit until it compensates, gives up or the time is over.
Result<Outcome> follow(VerbContext& context, UnitLink& unit, double wait_s) {
  const auto end = Clock::now() + std::chrono::duration<double>(wait_s);
  for (std::string noted;;) {
    ECS_TRY(snapshot, take_snapshot(unit.client(), unit.name()));
    const UnitMode mode = snapshot.status.mode;
    if (mode == UnitMode::compensating) {
      if (!unit.workshop().empty())
        context.console.note(
            "the emulator started by this command ends with it, and the mode is lost; `ecs-emulator serve` or the "
            "screens keep one running");
      return outcome_of(snapshot, "the unit is compensating", kDone);
    }
    if (snapshot.status.fault != Fault::none || mode == UnitMode::integration || mode == UnitMode::halted)
      return problem(ProblemKind::link, snapshot.status.fault == Fault::none
                                            ? std::string("the unit returned to integration mode")
                                            : fault_sentence(snapshot.status));
    const std::string stages = stages_of(snapshot);
    if (stages != noted) context.console.note(fmt::format("referencing: {}", stages));
    noted = stages;
    if (Clock::now() >= end)
      return outcome_of(snapshot,
                        fmt::format("not yet compensating after {} s ({}). The unit waits until every axis has been "
                                    "referenced; `ecs utility status` shows the progress",
                                    wait_s, stages),
                        wait_s > 0.0 ? kDoesNotHold : kDone);
    if (!unit.client().link().pause(kPoll)) return problem(ProblemKind::link, "stopped while referencing");
  }
}

Result<Outcome> compensate(VerbContext& context, UnitLink& unit, double wait_s) {
  ECS_TRY(now, unit.client().status());
  const bool under_way = now.mode == UnitMode::datuming || now.mode == UnitMode::compensating;
  if (!under_way) ECS_DO(begin_compensation(unit.client()));
  if (now.mode != UnitMode::compensating) ask_to_reference(context, unit, "every axis");
  return follow(context, unit, wait_s);
}

Result<Outcome> change_mode(VerbContext& context, const ModeRequest& request) {
  ECS_TRY(unit, open_unit(context));
  return request.mode == "integrate" ? integrate(unit) : compensate(context, unit, request.wait_s);
}

}  // namespace

extern const std::vector<Action> kUtilityCommands{
    action("utility position", "set the position of an axis in the unit; no motion", "ecs utility position X -100.5",
           set_position, {.link = Link::writes}),
    action("utility output", "output a compensation value at the D/A converter of one axis",
           "ecs utility output X 5\n  ecs utility output X 5 --relay --yes\n  ecs utility output --off", output_value,
           {.link = Link::writes}),
    action("utility run", "run machine code in the unit's memory", "ecs utility run 0x041000 --argument 7 --yes",
           run_program_in_unit, {.link = Link::writes}),
    action("utility ramtest", "test every location of the axis memory; its contents are preserved",
           "ecs utility ramtest", ram_test, {.link = Link::writes}),
    action("utility reset", "restart the unit", "ecs utility reset", reset, {.link = Link::writes}),
    action("utility clear", "clear the stored fault of the unit", "ecs utility clear", clear, {.link = Link::writes}),
    action("utility mode",
           "switch to compensation (tests the memory, waits for referencing) or to integration (relays open)",
           "ecs utility mode compensate --wait 120\n  ecs utility mode integrate", change_mode,
           {.link = Link::writes})};

}  // namespace ecs::app
