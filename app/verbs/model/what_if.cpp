// `ecs model what-if`: the error that compensation would leave; measured again, predicted against achieved.
#include "commissioning/models/what_if.hpp"

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"

namespace ecs::app {
namespace {

struct WhatIfArguments : VerbArguments {
  ModelOptions common{*this};
  const std::vector<std::string>& after = texts("--after", "the same measured again with the unit compensating");
};

Result<Outcome> what_if(VerbContext& context, const WhatIfArguments& arguments) {
  ECS_TRY(work, model_work(context.console, arguments.common));
  const auto answer =
      what_if_answer(context.console, work, arguments.common.model, arguments.after, arguments.common.import);
  if (!answer) return tl::unexpected(answer.error());
  return outcome_of(what_if_cell(*answer));
}

}  // namespace

extern const VerbDefinition kModelWhatIf = verb<WhatIfArguments>(
    "model what-if", "the error that compensation would leave; predicted against achieved",
    "ecs model what-if model.toml before.csv --machine machine.toml --after measured_again.csv", what_if);

}  // namespace ecs::app
