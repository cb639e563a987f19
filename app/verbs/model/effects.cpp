// `ecs model effects`: the effect library, or one effect explained.

#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/answer_table.hpp"
#include "base/paragraph.hpp"
#include "base/text.hpp"
#include "commissioning/models/effect_words.hpp"
#include "commissioning/models/view.hpp"
#include "model/effects/definition.hpp"

namespace ecs::app {
namespace {

using model::EffectDefinition;
using model::ParameterDefinition;

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

std::string label_before(std::string_view label) { return fmt::format("{:<14}", fmt::format("{}: ", label)); }

AnswerFields fields_of(const EffectDefinition& effect) {
  Cell parameters = list_cell(effect.parameters, parameter_cell);
  std::map<std::string, std::string> facts;
  for (const commissioning::EffectFact& fact : commissioning::facts_of(effect))
    facts[fact.label] = paragraph(label_before(fact.label) + fact.text, 2, 16);
  return {{"effect", word_cell(effect.id)},
          {"title", word_cell(effect.title)},
          {"formula", {effect.formula, facts["formula"]}},
          {"cause", {effect.cause, facts["cause"]}},
          {"tells_apart", {effect.tells_apart, facts["distinguished by"]}},
          {"check", {effect.check, facts["check"]}},
          {"parameters", std::move(parameters)},
          {"of_approach", yes_cell(effect.traits.of_approach,
                                   "  acts only on readings of known approach of its own moving axis\n", "")},
          {"carrier", word_cell(commissioning::carrier_text(effect.carrier))},
          {"compensated", {effect.is_carried(), ""}},
          {"how", {effect.how, facts["compensated"]}}};
}

Result<Outcome> one_effect(const std::string& name) {
  const model::EffectId id = model::effect_named(name);
  if (id)
    return outcome_of(record_cell(
        "{effect}: {title}\n{formula}{cause}{tells_apart}{check}{parameters}{of_approach}{how}", fields_of(*id)));
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
    all.add({object_of(fields_of(effect)), fmt::format("{:<19} {:<42} {}\n", effect.id, effect.formula,
                                                       commissioning::carrier_text(effect.carrier))});
  return outcome_of(record_cell("{effects}`ecs model effects NAME` explains one\n", {{"effects", std::move(all)}}));
}

}  // namespace

extern const VerbDefinition kModelEffects = verb<EffectsArguments>(
    "model effects", "the library of effects: cause, formula, how to distinguish each from similar ones",
    "ecs model effects cyclic", effects);

}  // namespace ecs::app
