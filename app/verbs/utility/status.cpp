// `ecs utility status`: the unit's state and faults, live or from a file.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/cli/verb_unit.hpp"
#include "base/answer_table.hpp"
#include "commissioning/unit/status_snapshot.hpp"
#include "commissioning/unit/status_view.hpp"

namespace ecs::app {
namespace {

struct StatusArguments : VerbArguments {
  const std::string& save = output_file("--save", "write decoded values and raw registers to this file");
  const std::vector<std::string>& from = texts("--from", "decode such a file; no unit is asked");
  const Access access = uses_link();
};

Result<StatusSnapshot> snapshot_of_unit(VerbContext& context) {
  ECS_TRY(unit, open_unit(context, Access::reads));
  return take_snapshot(unit.client(), unit.name(), protocol::kKeptEvents);
}

Result<Outcome> show_status(VerbContext& context, const StatusArguments& arguments) {
  if (arguments.from.size() > 1) return problem(ProblemKind::usage, "utility status: --from takes one file");
  ECS_TRY(snapshot, arguments.from.empty() ? snapshot_of_unit(context) : read_snapshot(arguments.from.front()));
  if (!arguments.save.empty()) {
    ECS_DO(write_snapshot(arguments.save, snapshot));
    context.console.note(fmt::format("status written to {}", arguments.save));
  }
  return outcome_of(status_cell(snapshot));
}

}  // namespace

extern const VerbDefinition kUtilityStatus = verb<StatusArguments>(
    "utility status", "mode, fault and what to do, memory tests, address pointers, relays",
    "ecs utility status --save status.json\n  ecs utility status --from status.json", show_status);

}  // namespace ecs::app
