// `ecs unit arm, disarm, events`: who may write to the unit, and what was done to it.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/link/host.hpp"
#include "commissioning/unit/status_snapshot.hpp"
#include "commissioning/unit/status_view.hpp"

namespace ecs::app {
namespace {

struct ArmArguments : VerbArguments {
  const std::string& code = text("--code", "the code that the unit shows; without it $ECS_ARM_CODE");
  const int& minutes =
      integer("--minutes", "how long this host may write", protocol::kUsualArmed_min, 1, protocol::kMostArmed_min);
  const Access access = uses_link();
};

Result<Outcome> arm(VerbContext& context, const ArmArguments& arguments) {
  ECS_TRY(unit, open_unit(context, Access::writes));
  std::string code = arguments.code;
  if (code.empty()) code = commissioning::arm_code_in_environment();
  if (code.empty() && unit.is_emulator()) code = unit.emulator_arm_code();
  if (code.empty()) return problem(ProblemKind::usage, "unit arm: expected --code with the code that the unit shows");
  ECS_DO(unit.client().arm(code, static_cast<std::uint16_t>(arguments.minutes)));
  return Outcome{fmt::format("the unit takes writes and commands of this host for {} minutes", arguments.minutes),
                 one_line(Json{{"armed", true}, {"minutes", arguments.minutes}}), kDone};
}

struct UnitReader : VerbArguments {
  const Access access = uses_link();
};

Result<Outcome> disarm(VerbContext& context, const UnitReader&) {
  ECS_TRY(unit, open_unit(context, Access::writes));
  ECS_DO(unit.client().disarm());
  return Outcome{"the unit is read-only for this host", one_line(Json{{"armed", false}}), kDone};
}

Result<Outcome> events(VerbContext& context, const UnitReader& arguments) {
  ECS_TRY(unit, open_unit(context, arguments.access));
  ECS_TRY(snapshot, commissioning::take_snapshot(unit.client(), unit.name(), protocol::kKeptEvents));
  return outcome_of(record_cell("{events}", {{"serial_number", text_cell(snapshot.identity.serial_number)},
                                             {"events", commissioning::events_cell(snapshot.events)}}));
}

}  // namespace

extern const VerbDefinition kUnitArm =
    verb<ArmArguments>("unit arm", "let this host write to the unit, move axes, close relays and run code, for a time",
                       "ecs unit arm --code 271828 --minutes 10", arm);

extern const VerbDefinition kUnitDisarm =
    verb<UnitReader>("unit disarm", "end that before its time", "ecs unit disarm", disarm);

extern const VerbDefinition kUnitEvents = verb<UnitReader>(
    "unit events", "what hosts did to the unit, or tried: when, who, with what result", "ecs unit events", events);

}  // namespace ecs::app
