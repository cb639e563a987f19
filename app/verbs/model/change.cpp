// `ecs model remove` and `ecs model decide`: an effect taken out of a model, one kept without its alternatives.
#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/models/effect_changes.hpp"
#include "commissioning/models/effect_words.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::app {
namespace {

struct RemoveArguments : VerbArguments {
  const std::string& effect = text("EFFECT", "effect of the model, as in cyclic:X:EX", Need::required);
  ModelOptions common{*this};
  const std::string& output = output_file("-o,--output", "the model to write; MODEL itself if not given");
};

Result<Outcome> remove(VerbContext& context, const RemoveArguments& given) {
  const ModelArguments& arguments = given.common;
  const std::string output = given.output.empty() ? arguments.model : given.output;
  ECS_DO(check_output_not_input(output, arguments.data));
  ECS_TRY(work, model_work(context.console, arguments));
  ECS_TRY(effect, effect_in(work.model, given.effect));
  const auto before = model::fit(work.model, work.data);
  if (!before) return tl::unexpected(in_file(before.error(), arguments.model));
  const auto without = without_effect(work.model, work.data, effect, *before, work.data_name);
  if (!without) return tl::unexpected(in_file(without.error(), arguments.model));
  const model::Model kept = model_to_keep(without->model, without->fit, work.data, work.data_name);
  ECS_DO(model::write_model(output, kept, arguments.model));
  return outcome_of(
      record_cell("removed {effect}: rms {rms_before_um} -> {rms_after_um} {unit}\n\n{history}model written "
                  "to {model}\n",
                  {{"effect", word_cell(without->name)},
                   {"rms_before_um", number_cell(without->rms_before_um, 3)},
                   {"rms_after_um", number_cell(without->fit.rms_um, 3)},
                   {"unit", shown_cell(std::string(work.data.reading_unit()))},
                   {"history", ladder_cell(kept)},
                   {"model", word_cell(output)}}));
}

struct DecideArguments : VerbArguments {
  const std::string& effect = text("EFFECT", "effect of the model, as in cyclic:X:EX", Need::required);
  const std::string& model = text("MODEL", "model file (.toml)", Need::required);
  const std::string& output = output_file("-o,--output", "the model to write; MODEL itself if not given");
};

Result<Outcome> decide(VerbContext&, const DecideArguments& arguments) {
  auto model = model::read_model(arguments.model);
  if (!model) return tl::unexpected(model.error());
  ECS_TRY(effect, effect_in(*model, arguments.effect));
  model::EffectInstance& decided = model->effects[effect];
  const std::string alternatives = decided.tied_with;
  if (alternatives.empty())
    return tl::unexpected(Problem{ProblemKind::refused,
                                  fmt::format("{} has no alternatives: nothing to decide", arguments.effect),
                                  arguments.model,
                                  0,
                                  0,
                                  {}});
  keep_alternatives(decided, {});
  const std::string output = arguments.output.empty() ? arguments.model : arguments.output;
  ECS_DO(model::write_model(output, *model, arguments.model));
  return outcome_of(record_cell("it is {effect}, not {alternatives}\nmodel written to {model}\n",
                                {{"effect", word_cell(arguments.effect)},
                                 {"alternatives", word_cell(alternatives)},
                                 {"model", word_cell(output)}}));
}

}  // namespace

extern const VerbDefinition kModelRemove =
    verb<RemoveArguments>("model remove", "a model without one of its effects, fitted to the data again",
                          "ecs model remove cyclic:X:EX model.toml data.csv --machine machine.toml", remove);

extern const VerbDefinition kModelDecide =
    verb<DecideArguments>("model decide", "an effect without the alternatives that `model add --or` kept with it",
                          "ecs model decide cyclic:X:EX model.toml", decide);

}  // namespace ecs::app
