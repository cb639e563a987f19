// `ecs model effects`: the effect library, or one effect explained.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/paragraph.hpp"
#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "model/effects/definition.hpp"

namespace ecs::app {
namespace {

using model::Carrier;
using model::EffectDefinition;
using model::ParameterDefinition;

std::string_view word_for(Carrier carrier) {
  switch (carrier) {
    case Carrier::error_map:
      return "error map";
    case Carrier::parameters:
      return "parameters";
    case Carrier::set_up:
      return "put it right";
    default:
      return "no";
  }
}

Cell parameter_cell(const ParameterDefinition& parameter) {
  const auto& limits = parameter.limits;
  const AnswerFields fields{
      {"name", word_cell(parameter.name)},
      {"unit", {parameter.unit, fmt::format("{}{}", parameter.unit.empty() ? "" : " ", parameter.unit)}},
      {"least", limits ? Cell{limits->least, fmt::format(", {} to ", shortest(limits->least))} : null_cell()},
      {"greatest", limits ? Cell{limits->greatest, shortest(limits->greatest)} : null_cell()},
      {"searched", yes_cell(parameter.coding == model::Coding::searched, " (searched)", "")},
      {"meaning", word_cell(parameter.meaning)}};
  return {object_of(fields),
          paragraph(laid_out("parameter:    {name}{unit}: {meaning}{least}{greatest}{searched}", fields), 2, 16)};
}

Cell explained(std::string_view value, std::string_view begin) {
  return {value, paragraph(fmt::format("{}{}", begin, value), 2, 16)};
}

AnswerFields fields_of(const EffectDefinition& effect) {
  Cell parameters = list_cell(effect.parameters, parameter_cell);
  const std::string_view carrier = word_for(effect.carrier);
  return {{"effect", word_cell(effect.id)},
          {"title", word_cell(effect.title)},
          {"formula", explained(effect.formula, "formula:      ")},
          {"cause", explained(effect.cause, "cause:        ")},
          {"tells_apart", explained(effect.tells_apart, "distinguished by: ")},
          {"parameters", std::move(parameters)},
          {"of_approach", yes_cell(effect.traits.of_approach,
                                   "  acts only on readings of known approach of its own moving axis\n", "")},
          {"carrier", word_cell(carrier)},
          {"compensated", {effect.is_carried(), ""}},
          {"how", {effect.how, paragraph(fmt::format("compensated:  {}; {}", carrier, effect.how), 2, 16)}}};
}

Result<Outcome> one_effect(const std::string& name) {
  const model::EffectId id = model::effect_named(name);
  if (id)
    return outcome_of(
        record_cell("{effect}: {title}\n{formula}{cause}{tells_apart}{parameters}{of_approach}{how}", fields_of(*id)));
  std::vector<std::string> names;
  for (const EffectDefinition& effect : model::effect_library()) names.emplace_back(effect.id);
  const std::string like = nearest_word(name, names);
  return problem(ProblemKind::usage,
                 fmt::format("no effect \"{}\"{}; there are {}", name,
                             like.empty() ? "" : fmt::format("; did you mean \"{}\"?", like), fmt::join(names, ", ")));
}

struct EffectsArguments : VerbArguments {
  const std::string& name = text("EFFECT", "explain this one");
  const std::string& machine = text("--machine", "taken as by every verb of MODEL; the library is the same for all");
};

Result<Outcome> effects(VerbContext&, const EffectsArguments& arguments) {
  if (!arguments.name.empty()) return one_effect(arguments.name);
  Cell all{Json::array(), fmt::format("{:<19} {:<42} {}\n", "effect", "contribution to a reading", "compensated by")};
  for (const EffectDefinition& effect : model::effect_library())
    all.add({object_of(fields_of(effect)),
             fmt::format("{:<19} {:<42} {}\n", effect.id, effect.formula, word_for(effect.carrier))});
  return outcome_of(record_cell("{effects}`ecs model effects NAME` explains one\n", {{"effects", std::move(all)}}));
}

}  // namespace

extern const VerbDefinition kModelEffects = verb<EffectsArguments>(
    "model effects", "the library of effects: cause, formula, how to distinguish each from similar ones",
    "ecs model effects cyclic", effects);

}  // namespace ecs::app
