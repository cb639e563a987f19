// `ecs model effects`: the effect library, or one effect explained.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb.hpp"
#include "base/json.hpp"
#include "base/paragraph.hpp"
#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "model/effects/effect.hpp"

namespace ecs::app {
namespace {

using model::Carrier;
using model::EffectInfo;
using model::ParameterInfo;

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

bool is_bounded(const ParameterInfo& parameter) { return parameter.least != 0.0 || parameter.greatest != 0.0; }

std::string parameter_text(const ParameterInfo& parameter) {
  std::string text =
      fmt::format("{}{}{}: {}", parameter.name, parameter.unit.empty() ? "" : " ", parameter.unit, parameter.meaning);
  if (is_bounded(parameter)) text += fmt::format(", {} to {}", shortest(parameter.least), shortest(parameter.greatest));
  if (parameter.nonlinear) text += " (searched)";
  return text;
}

std::string whole_text(const EffectInfo& info) {
  std::string text = fmt::format("{}: {}\n", info.name, info.title);
  text += paragraph(fmt::format("formula:      {}", info.formula), 2, 16);
  text += paragraph(fmt::format("cause:        {}", info.cause), 2, 16);
  text += paragraph(fmt::format("separated by: {}", info.tells_apart), 2, 16);
  for (const ParameterInfo& parameter : info.parameters)
    text += paragraph("parameter:    " + parameter_text(parameter), 2, 16);
  if (info.of_approach) text += "  acts only on readings of known approach of its own moving axis\n";
  return text + paragraph(fmt::format("compensated:  {}; {}", word_for(info.carrier), info.how), 2, 16);
}

std::string list_text() {
  std::string text = fmt::format("{:<19} {:<42} {}\n", "effect", "contribution to a reading", "compensated by");
  for (const EffectInfo& info : model::effect_library())
    text += fmt::format("{:<19} {:<42} {}\n", info.name, info.formula, word_for(info.carrier));
  return text + "`ecs model effects NAME` explains one\n";
}

Json json_of_effect(const EffectInfo& info) {
  Json parameters = Json::array();
  for (const ParameterInfo& parameter : info.parameters)
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"least", is_bounded(parameter) ? Json(parameter.least) : Json(nullptr)},
                          {"greatest", is_bounded(parameter) ? Json(parameter.greatest) : Json(nullptr)},
                          {"searched", parameter.nonlinear},
                          {"meaning", parameter.meaning}});
  return {{"effect", info.name},
          {"title", info.title},
          {"formula", info.formula},
          {"cause", info.cause},
          {"tells_apart", info.tells_apart},
          {"parameters", std::move(parameters)},
          {"of_approach", info.of_approach},
          {"carrier", word_for(info.carrier)},
          {"compensated", info.carrier == Carrier::error_map || info.carrier == Carrier::parameters},
          {"how", info.how}};
}

Result<Outcome> one_effect(const std::string& name) {
  const auto id = model::effect_named(name);
  if (id) return Outcome{whole_text(model::info_of(*id)), one_line(json_of_effect(model::info_of(*id))), kDone};
  std::vector<std::string> names;
  for (const EffectInfo& info : model::effect_library()) names.emplace_back(info.name);
  const std::string like = nearest_word(name, names);
  return problem(ProblemKind::usage,
                 fmt::format("no effect \"{}\"{}; there are {}", name,
                             like.empty() ? "" : fmt::format("; did you mean \"{}\"?", like), fmt::join(names, ", ")));
}

Result<Outcome> effects(const std::string& name) {
  if (!name.empty()) return one_effect(name);
  Json all = Json::array();
  for (const EffectInfo& info : model::effect_library()) all.push_back(json_of_effect(info));
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
