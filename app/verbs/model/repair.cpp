// `ecs model repair`: repair or compensate, cause by cause.
#include "commissioning/volume/repair.hpp"

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"

namespace ecs::app {
namespace {

struct RepairArguments : VerbArguments {
  ModelOptions common{*this};
  const int& points =
      integer("--points", "places in the volume, at most, and more for a wave and beside a step", 1331, 8, 100'000);
};

Result<Outcome> repair(VerbContext& context, const RepairArguments& arguments) {
  ECS_TRY(work, model_work(context.console, arguments.common));
  ECS_TRY(answer, repair_answer(work, arguments.common.model, static_cast<std::size_t>(arguments.points)));
  return outcome_of(repair_cell(answer));
}

}  // namespace

extern const VerbDefinition kModelRepair =
    verb<RepairArguments>("model repair", "repair or compensate: what each cause leaves in readings, volume and circle",
                          "ecs model repair model.toml data.csv --machine machine.toml", repair);

}  // namespace ecs::app
