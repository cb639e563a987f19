// `ecs model effects`: the effect library, or one effect explained.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/json.hpp"
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

bool is_searched(const ParameterDefinition& parameter) { return parameter.coding == model::Coding::searched; }

std::string parameter_text(const ParameterDefinition& parameter) {
  std::string text =
      fmt::format("{}{}{}: {}", parameter.name, parameter.unit.empty() ? "" : " ", parameter.unit, parameter.meaning);
  if (parameter.limits)
    text += fmt::format(", {} to {}", shortest(parameter.limits->least), shortest(parameter.limits->greatest));
  if (is_searched(parameter)) text += " (searched)";
  return text;
}

std::string whole_text(const EffectDefinition& effect) {
  std::string text = fmt::format("{}: {}\n", effect.id, effect.title);
  text += paragraph(fmt::format("formula:      {}", effect.formula), 2, 16);
  text += paragraph(fmt::format("cause:        {}", effect.cause), 2, 16);
  text += paragraph(fmt::format("distinguished by: {}", effect.tells_apart), 2, 16);
  for (const ParameterDefinition& parameter : effect.parameters)
    text += paragraph("parameter:    " + parameter_text(parameter), 2, 16);
  if (effect.traits.of_approach) text += "  acts only on readings of known approach of its own moving axis\n";
  return text + paragraph(fmt::format("compensated:  {}; {}", word_for(effect.carrier), effect.how), 2, 16);
}

std::string list_text() {
  std::string text = fmt::format("{:<19} {:<42} {}\n", "effect", "contribution to a reading", "compensated by");
  for (const EffectDefinition& effect : model::effect_library())
    text += fmt::format("{:<19} {:<42} {}\n", effect.id, effect.formula, word_for(effect.carrier));
  return text + "`ecs model effects NAME` explains one\n";
}

Json json_of_effect(const EffectDefinition& effect) {
  Json parameters = Json::array();
  for (const ParameterDefinition& parameter : effect.parameters)
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"least", parameter.limits ? Json(parameter.limits->least) : Json(nullptr)},
                          {"greatest", parameter.limits ? Json(parameter.limits->greatest) : Json(nullptr)},
                          {"searched", is_searched(parameter)},
                          {"meaning", parameter.meaning}});
  return {{"effect", effect.id},
          {"title", effect.title},
          {"formula", effect.formula},
          {"cause", effect.cause},
          {"tells_apart", effect.tells_apart},
          {"parameters", std::move(parameters)},
          {"of_approach", effect.traits.of_approach},
          {"carrier", word_for(effect.carrier)},
          {"compensated", effect.is_carried()},
          {"how", effect.how}};
}

Result<Outcome> one_effect(const std::string& name) {
  const model::EffectId id = model::effect_named(name);
  if (id) return Outcome{whole_text(*id), one_line(json_of_effect(*id)), kDone};
  std::vector<std::string> names;
  for (const EffectDefinition& effect : model::effect_library()) names.emplace_back(effect.id);
  const std::string like = nearest_word(name, names);
  return problem(ProblemKind::usage,
                 fmt::format("no effect \"{}\"{}; there are {}", name,
                             like.empty() ? "" : fmt::format("; did you mean \"{}\"?", like), fmt::join(names, ", ")));
}

Result<Outcome> effects(const std::string& name) {
  if (!name.empty()) return one_effect(name);
  Json all = Json::array();
  for (const EffectDefinition& effect : model::effect_library()) all.push_back(json_of_effect(effect));
  return Outcome{list_text(), one_line(Json{{"effects", std::move(all)}}), kDone};
}

struct EffectsArguments {
  std::string name;
  std::string machine;
};

}  // namespace

extern const VerbDefinition kModelEffects = verb<EffectsArguments>(
    "model effects", "the library of effects: cause, formula, how to distinguish each from similar ones",
    "ecs model effects cyclic",
    [](Verb& verb, EffectsArguments& arguments) {
      verb.text("EFFECT", arguments.name, "explain this one")
          .text("--machine", arguments.machine, "taken as by every verb of MODEL; the library is the same for all");
    },
    [](VerbContext&, const EffectsArguments& arguments) { return effects(arguments.name); });

}  // namespace ecs::app
