// `ecs model new`: a model to begin with, of what every measured curve has.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/json.hpp"
#include "commissioning/models/json.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::app {
namespace {

struct NewArguments : VerbArguments {
  ModelOptions common{*this};
};

Result<Outcome> begin(VerbContext& context, const NewArguments& given) {
  const ModelArguments& arguments = given.common;
  const auto work = begun_model(context.console, arguments);
  if (!work) return tl::unexpected(work.error());
  std::string text = fmt::format("begun in {}: offset, slope and backlash of what was measured\n", arguments.model);
  Json effects = Json::array();
  for (const model::EffectInstance& effect : work->model.effects) {
    text += "  " + place_text(effect) + "\n";
    effects.push_back(place_text(effect));
  }
  text += fmt::format("next: ecs model diagnose {} {}\n", arguments.model, work->data_name);
  return Outcome{text, one_line(Json{{"model", arguments.model}, {"effects", std::move(effects)}}), kDone};
}

}  // namespace

extern const VerbDefinition kModelNew =
    verb<NewArguments>("model new", "a model to begin with: offset, slope and backlash of what was measured",
                       "ecs model new model.toml data.csv --machine machine.toml", begin);

}  // namespace ecs::app
