// `ecs model new`: a model to begin with, of what every measured curve has.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/model/model_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/laser_session/choices.hpp"
#include "commissioning/models/effect_words.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/session/shell_word.hpp"

namespace ecs::app {
namespace {

struct NewArguments : VerbArguments {
  ModelOptions common{*this};
};

Result<Outcome> begin(VerbContext& context, const NewArguments& given) {
  const ModelArguments& arguments = given.common;
  ECS_TRY(work, begun_model(context.console, arguments));
  std::vector<std::string> effects;
  for (const model::EffectInstance& effect : work.model.effects) effects.push_back(name_with_alternatives(effect));
  std::vector<std::string> next{"ecs", "model", "diagnose", arguments.model};
  next.insert(next.end(), arguments.data.begin(), arguments.data.end());
  if (!arguments.machine.empty()) next.insert(next.end(), {"--machine", arguments.machine});
  const std::vector<std::string> import = commissioning::import_words(arguments.import);
  next.insert(next.end(), import.begin(), import.end());
  return outcome_of(
      record_cell("begun in {model}: {usual}{of_paths}\n{effects}next: {next}\n",
                  {{"model", word_cell(arguments.model)},
                   {"usual", shown_cell(usual_in_words(work.data))},
                   {"of_paths", shown_cell(work.data.paths.empty() ? "" : "; of circles and diagonals nothing")},
                   {"effects", lines_cell(effects, "  ")},
                   {"next", shown_cell(shell_command(next))}}));
}

}  // namespace

extern const VerbDefinition kModelNew = verb<NewArguments>(
    "model new", "a model to begin with: offset, slope, backlash of what was measured; of a ball its place",
    "ecs model new model.toml data.csv --machine machine.toml", begin);

}  // namespace ecs::app
