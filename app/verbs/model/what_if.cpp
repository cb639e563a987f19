// `ecs model what-if`: the error that compensation would leave; measured again, predicted against achieved. `repair`:
// repair or compensate, cause by cause.

#include "commissioning/models/what_if.hpp"

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "commissioning/models/work.hpp"
#include "commissioning/volume/repair.hpp"

namespace ecs::app {
namespace {

struct WhatIfRequest {
  ModelArguments common;
  std::vector<std::string> after;
  static Fields<WhatIfRequest> fields() {
    using R = WhatIfRequest;
    return {&R::common, {"--after", &R::after, "the same lines measured again with the unit compensating"}};
  }
};

Result<Outcome> what_if(VerbContext& context, const WhatIfRequest& request) {
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(answer, what_if_answer(context.console, work, request.common.model, request.after, request.common.import));
  return outcome_of(what_if_cell(answer));
}

struct RepairRequest {
  ModelArguments common;
  int points = 1331;
  static Fields<RepairRequest> fields() {
    using R = RepairRequest;
    return {
        &R::common,
        {"--points", &R::points, "maximum number of positions in the volume; more are added for a wave and near a step",
         Range{8, 100'000}}};
  }
};

Result<Outcome> repair(VerbContext& context, const RepairRequest& request) {
  ECS_TRY(work, model_work(context.console, request.common));
  ECS_TRY(answer, repair_answer(work, request.common.model, static_cast<std::size_t>(request.points)));
  return outcome_of(repair_cell(answer));
}

}  // namespace

extern const std::vector<Action> kModelJudgement{
    action("model what-if", "predict the error after compensation; compare it with the achieved error",
           "ecs model what-if model.toml before.csv --machine machine.toml --after measured_again.csv", what_if),
    action("model repair",
           "compare repair and compensation of each cause: remaining error in readings, volume and circle",
           "ecs model repair model.toml data.csv --machine machine.toml", repair)};

}  // namespace ecs::app
