// `ecs model what-if`: the error that compensation would leave; measured again, predicted against achieved.
#include "commissioning/models/what_if.hpp"

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/json.hpp"
#include "commissioning/models/json.hpp"

namespace ecs::app {
namespace {

struct WhatIfArguments {
  ModelArguments common;
  std::vector<std::string> after;
};

Json json_of_answer(const WhatIfAnswer& answer) {
  Json effects = Json::array(), directions = Json::array();
  for (const model::WhatIf::Share& share : answer.what.shares)
    effects.push_back({{"effect", share.effect},
                       {"rms_um", number_or_null(share.rms_um)},
                       {"carried", share.carried},
                       {"how", share.how}});
  for (const AfterDirection& one : answer.directions)
    directions.push_back({{"sense", name_of(one.sense)},
                          {"axis", axis_json(one.axis)},
                          {"approach", one.approach},
                          {"rms_now_um", number_or_null(one.now_um)},
                          {"rms_after_um", number_or_null(one.predicted_um)},
                          {"achieved_rms_um", number_or_null(one.achieved_um)},
                          {"readings", one.readings},
                          {"readings_after", one.readings_after}});
  Json object{{"rms_now_um", number_or_null(answer.what.rms_now_um)},
              {"rms_after_um", number_or_null(answer.what.rms_after_um)},
              {"peak_after_um", number_or_null(answer.what.peak_after_um)},
              {"effects", std::move(effects)},
              {"directions", std::move(directions)},
              {"achieved", nullptr},
              {"notes", answer.notes}};
  if (answer.achieved)
    object["achieved"] = {{"rms_um", number_or_null(answer.achieved->rms_um)},
                          {"peak_um", number_or_null(answer.achieved->peak_um)},
                          {"readings", answer.achieved->data.size()},
                          {"of_predicted", number_or_null(answer.achieved->rms_um / answer.what.rms_after_um)}};
  return object;
}

Result<Outcome> what_if(VerbContext& context, const WhatIfArguments& arguments) {
  const auto work = model_work(context.console, arguments.common);
  if (!work) return tl::unexpected(work.error());
  const auto answer =
      what_if_answer(context.console, *work, arguments.common.model, arguments.after, arguments.common.import);
  if (!answer) return tl::unexpected(answer.error());
  return Outcome{what_if_text(*answer), one_line(json_of_answer(*answer)), kDone};
}

}  // namespace

extern const VerbDefinition kModelWhatIf = verb<WhatIfArguments>(
    "model what-if", "the error that compensation would leave; predicted against achieved",
    "ecs model what-if model.toml before.csv --machine machine.toml --after measured_again.csv",
    [](Verb& verb, WhatIfArguments& arguments) {
      take_model_and_data(verb, arguments.common);
      verb.texts("--after", arguments.after, "the same measured again with the unit compensating");
    },
    what_if);

}  // namespace ecs::app
