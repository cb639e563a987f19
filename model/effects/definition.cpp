#include "model/effects/definition.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "laser/measurement_set.hpp"

namespace ecs::model {
namespace {
constexpr std::array<std::string_view, 3> kModes{"both", "forward", "reverse"};
/// Location errors of A, B, C by their first letter (ISO 230-7).
constexpr std::array<std::array<std::string_view, kAxes>, 6> kLocations{{{"XOA", "XOB", "XOC"},
                                                                         {"YOA", "YOB", "YOC"},
                                                                         {"ZOA", "ZOB", "ZOC"},
                                                                         {"AOA", "AOB", "AOC"},
                                                                         {"BOA", "BOB", "BOC"},
                                                                         {"COA", "COB", "COC"}}};
}  // namespace

std::string_view name_of(EffectId id) { return id->id; }

std::string_view name_of(ApproachMode mode) { return kModes[static_cast<std::size_t>(mode)]; }

std::optional<ApproachMode> approach_mode_named(std::string_view name) {
  const auto found = std::find(kModes.begin(), kModes.end(), name);
  if (found == kModes.end()) return std::nullopt;
  return static_cast<ApproachMode>(found - kModes.begin());
}

std::optional<double> given_or_fitted(const EffectInstance& effect, std::string_view parameter) {
  for (const auto* values : {&effect.parameters, &effect.fitted})
    if (const auto found = values->find(std::string(parameter)); found != values->end()) return found->second;
  return std::nullopt;
}

char axis_letter(const EffectInstance& effect) { return laser::letter_of(*effect.axis, effect.rotary); }

std::string to_text(const EffectInstance& effect) {
  if (effect.is_user()) return fmt::format("user:{}", effect.name);
  std::string text(name_of(effect.id));
  if (effect.ball > 1) return text + fmt::format(":{}", effect.ball);
  if (!effect.axis && !effect.sense && !effect.code) return text;
  const EffectDefinition& definition = effect.definition();
  if (definition.place != Place::set_up) text += effect.axis ? fmt::format(":{}", axis_letter(effect)) : ":";
  if (definition.place == Place::location) return text + fmt::format(":{}", code_text(effect));
  const bool by_sense = definition.place == Place::known_component && effect.sense;
  if (effect.code && !by_sense) return text + fmt::format(":{}", name_of(*effect.code));
  if (effect.sense) text += fmt::format(":{}", name_of(*effect.sense));
  if (effect.line > 0) text += fmt::format(":{}", effect.line);
  if (effect.from_run > 0) text += fmt::format(":run{}", effect.from_run);
  return text;
}

std::string place_text(const EffectInstance& effect) {
  std::string text = to_text(effect);
  if (effect.approach != ApproachMode::both) text += fmt::format(", {}", name_of(effect.approach));
  if (!effect.sensor.empty()) text += fmt::format(" with {}", sensors_text(effect));
  return text;
}

std::string_view sense_text(const EffectInstance& effect) {
  const Place place = effect.definition().place;
  return effect.sense && place != Place::set_up && place != Place::location ? name_of(*effect.sense) : "";
}

std::string_view code_text(const EffectInstance& effect) {
  if (effect.definition().place == Place::location)
    return effect.sense && effect.axis ? kLocations[static_cast<std::size_t>(*effect.sense)][index_of(*effect.axis)]
                                       : "";
  if (effect.sense && effect.definition().place == Place::set_up) return name_of(*effect.sense);
  return effect.code ? name_of(*effect.code) : "";
}

std::optional<Coded> code_named(EffectId id, std::string_view word) {
  if (id->place == Place::location) {
    for (std::size_t s = 0; s < kLocations.size(); ++s)
      for (const Axis axis : kAllAxes)
        if (kLocations[s][index_of(axis)] == word) return Coded{axis, static_cast<Sense>(s), {}};
    return std::nullopt;
  }
  if (id->place == Place::set_up) {
    const auto sense = sense_named(word);
    return sense && is_rotation(*sense) ? std::optional(Coded{{}, sense, {}}) : std::nullopt;
  }
  const auto component = component_of(word);
  return component ? std::optional(Coded{{}, {}, component}) : std::nullopt;
}

bool set_code(EffectInstance& effect, std::string_view word) {
  const auto coded = code_named(effect.id, word);
  if (!coded || (coded->axis && effect.axis && (effect.axis != coded->axis || !effect.rotary))) return false;
  if (coded->axis) {
    effect.axis = coded->axis;
    effect.rotary = true;
  }
  if (coded->sense) effect.sense = coded->sense;
  if (coded->code) effect.code = coded->code;
  return true;
}

std::string sensors_text(const EffectInstance& effect) {
  return effect.sensor2.empty() ? effect.sensor : fmt::format("{} and {}", effect.sensor, effect.sensor2);
}

bool same_place(const EffectInstance& a, const EffectInstance& b) {
  return a.id == b.id && a.axis == b.axis && a.sense == b.sense && a.code == b.code && a.name == b.name &&
         a.rotary == b.rotary && a.ball == b.ball && a.line == b.line && a.from_run == b.from_run;
}

bool same_sensors(const EffectInstance& a, const EffectInstance& b) {
  return a.sensor == b.sensor && a.sensor2 == b.sensor2;
}

bool same_candidate(const EffectInstance& a, const EffectInstance& b) {
  return same_place(a, b) && same_sensors(a, b) && a.approach == b.approach;
}

}  // namespace ecs::model
