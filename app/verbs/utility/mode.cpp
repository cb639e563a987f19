// `ecs utility mode`: integration or compensation, and how far datuming is.
#include <chrono>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/unit/status_snapshot.hpp"
#include "commissioning/unit/status_view.hpp"
#include "commissioning/unit/utility_work.hpp"

namespace ecs::app {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPoll{250};

struct ModeArguments : VerbArguments {
  const std::string& mode = choice("MODE", {"compensate", "integrate"}, "mode", Need::required);
  const double& wait_s =
      number("--wait", "seconds to follow the datuming; 0 returns at once", 60.0, Need::optional, 0.0, 86400.0);
  const Access access = writes_to_unit();
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
  Json object{{"mode", full["mode"]}, {"fault", full["fault"]}, {"axes", full["axes"]}};
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
            "a bundled emulator that this command started ends with it, and forgets the mode; `ecs-emulator serve` or "
            "the screens keep one running");
      return outcome_of(snapshot, "the unit compensates", kDone);
    }
    if (snapshot.status.fault != Fault::none || mode == UnitMode::integration || mode == UnitMode::halted)
      return problem(ProblemKind::link, snapshot.status.fault == Fault::none
                                            ? std::string("the unit went back to integration mode")
                                            : fault_sentence(snapshot.status));
    const std::string stages = stages_of(snapshot);
    if (stages != noted) context.console.note(fmt::format("datuming: {}", stages));
    noted = stages;
    if (Clock::now() >= end)
      return outcome_of(
          snapshot,
          fmt::format("not yet compensating after {} s ({}); the unit goes on waiting until every axis has "
                      "been referenced; `ecs utility status` shows how far it is",
                      wait_s, stages),
          wait_s > 0.0 ? kDoesNotHold : kDone);
    if (!unit.client().link().pause(kPoll)) return problem(ProblemKind::link, "stopped while datuming");
  }
}

Result<Outcome> compensate(VerbContext& context, UnitLink& unit, double wait_s) {
  ECS_TRY(now, unit.client().status());
  const bool under_way = now.mode == UnitMode::datuming || now.mode == UnitMode::compensating;
  if (!under_way) ECS_DO(begin_compensation(unit.client()));
  if (now.mode != UnitMode::compensating) ask_to_reference(context, unit, "every axis");
  return follow(context, unit, wait_s);
}

Result<Outcome> change_mode(VerbContext& context, const ModeArguments& arguments) {
  ECS_TRY(unit, open_unit(context, arguments.access));
  return arguments.mode == "integrate" ? integrate(unit) : compensate(context, unit, arguments.wait_s);
}

}  // namespace

extern const VerbDefinition kUtilityMode = verb<ModeArguments>(
    "utility mode", "compensate (tests the memory, watches the referencing) or integrate (relays open)",
    "ecs utility mode compensate --wait 120\n  ecs utility mode integrate", change_mode);

}  // namespace ecs::app
