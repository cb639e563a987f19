// The emulator's own list of effects.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

/// All of them. Hidden cases draw by the order of this list: new ones go to its end.
[[nodiscard]] std::span<const EffectDefinition* const> effects();
/// Those that a hidden case may draw by itself.
[[nodiscard]] const std::vector<const EffectDefinition*>& drawn_effects();
/// Null where there is none of that id.
[[nodiscard]] const EffectDefinition* effect_named(std::string_view id);

}  // namespace ecs::emulator
