// `ecs unit arm, disarm, events`: who may write to the unit, and what was done to it.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/link/unit_link.hpp"
#include "commissioning/unit/status.hpp"

namespace ecs::app {
namespace {

struct ArmRequest {
  std::string code;
  int minutes = protocol::kUsualArmed_min;
  static Fields<ArmRequest> fields() {
    using R = ArmRequest;
    return {{"--arm-code", &R::code, "arming code shown by the unit; default: $ECS_ARM_CODE", Is::secret},
            {"--minutes", &R::minutes, "time for which this host may write", Range{1, protocol::kMostArmed_min}}};
  }
};

Result<Outcome> arm(VerbContext& context, const ArmRequest& request) {
  ECS_TRY(unit, open_unit(context));
  std::string code = request.code;
  if (code.empty()) code = commissioning::arm_code_in_environment();
  if (code.empty() && unit.is_emulator()) code = unit.emulator_arm_code();
  if (code.empty()) return problem(ProblemKind::usage, "unit arm: expected --arm-code with the code shown by the unit");
  ECS_DO(unit.client().arm(code, static_cast<std::uint16_t>(request.minutes)));
  return Outcome{fmt::format("the unit accepts writes and commands from this host for {} minutes", request.minutes),
                 one_line(object_of("armed"_is(true), "minutes"_is(request.minutes))), kDone};
}

Result<Outcome> disarm(VerbContext& context, const cli::Nothing&) {
  ECS_TRY(unit, open_unit(context));
  ECS_DO(unit.client().disarm());
  return Outcome{"write access withdrawn: this host can now only read from the unit, or put it into integration mode",
                 one_line(object_of("armed"_is(false))), kDone};
}

Result<Outcome> events(VerbContext& context, const cli::Nothing&) {
  ECS_TRY(unit, open_unit(context));
  ECS_TRY(snapshot, commissioning::take_snapshot(unit.client(), unit.name(), protocol::kKeptEvents));
  return outcome_of(record_cell("{events}", "serial_number"_is(text_cell(snapshot.identity.serial_number)),
                                "events"_is(commissioning::events_cell(snapshot.events))));
}

}  // namespace

extern const std::vector<Action> kUnitAccess{
    action("unit arm", "allow this host to write to the unit, move axes, close relays and run code, for a limited time",
           "ecs unit arm --arm-code 271828 --minutes 10", arm, {.link = Link::arms}),
    action("unit disarm", "withdraw the write access of this host", "ecs unit disarm", disarm, {.link = Link::arms}),
    action("unit events", "list the accesses of hosts to the unit: time, host, action, result", "ecs unit events",
           events, {.link = Link::reads})};

}  // namespace ecs::app
