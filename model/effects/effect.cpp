#include "model/effects/effect.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "laser/measurement_set.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {
namespace {
constexpr std::array<std::string_view, 3> kModes{"both", "forward", "reverse"};
}

std::string_view name_of(EffectId id) { return id->id; }

std::string_view name_of(ApproachMode mode) { return kModes[static_cast<std::size_t>(mode)]; }

std::optional<ApproachMode> approach_mode_named(std::string_view name) {
  const auto found = std::find(kModes.begin(), kModes.end(), name);
  if (found == kModes.end()) return std::nullopt;
  return static_cast<ApproachMode>(found - kModes.begin());
}

char axis_letter(const EffectInstance& effect) { return laser::letter_of(*effect.axis, effect.rotary); }

std::string to_text(const EffectInstance& effect) {
  if (effect.is_user()) return fmt::format("user:{}", effect.name);
  std::string text(name_of(effect.id));
  if (!effect.axis && !effect.sense && !effect.code) return text;
  const EffectDefinition& definition = effect.definition();
  if (definition.place != Place::set_up) text += effect.axis ? fmt::format(":{}", axis_letter(effect)) : ":";
  const bool by_sense = definition.place == Place::known_component && effect.sense;
  if (effect.code && !by_sense) return text + fmt::format(":{}", name_of(*effect.code));
  if (effect.sense) text += fmt::format(":{}", name_of(*effect.sense));
  return text;
}

std::string place_text(const EffectInstance& effect) {
  std::string text = to_text(effect);
  if (effect.approach != ApproachMode::both) text += fmt::format(", {}", name_of(effect.approach));
  if (!effect.sensor.empty()) text += fmt::format(" with {}", sensors_text(effect));
  return text;
}

std::string_view sense_text(const EffectInstance& effect) {
  return effect.sense && effect.definition().place != Place::set_up ? name_of(*effect.sense) : "";
}

std::string_view code_text(const EffectInstance& effect) {
  if (effect.sense && effect.definition().place == Place::set_up) return name_of(*effect.sense);
  return effect.code ? name_of(*effect.code) : "";
}

bool set_code(EffectId id, std::string_view word, std::optional<Sense>& sense, std::optional<Component>& code) {
  if (id->place != Place::set_up) return (code = component_of(word)).has_value();
  sense = sense_named(word);
  return sense && is_rotation(*sense);
}

std::string sensors_text(const EffectInstance& effect) {
  return effect.sensor2.empty() ? effect.sensor : fmt::format("{} and {}", effect.sensor, effect.sensor2);
}

bool same_place(const EffectInstance& a, const EffectInstance& b) {
  return a.id == b.id && a.axis == b.axis && a.sense == b.sense && a.code == b.code && a.name == b.name &&
         a.rotary == b.rotary;
}

bool same_sensors(const EffectInstance& a, const EffectInstance& b) {
  return a.sensor == b.sensor && a.sensor2 == b.sensor2;
}

bool same_candidate(const EffectInstance& a, const EffectInstance& b) {
  return same_place(a, b) && same_sensors(a, b) && a.approach == b.approach;
}

}  // namespace ecs::model
