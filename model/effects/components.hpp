// Parameters of an effect without axis and sense that belong to components of the machine, each to one.
// Does not live here: effects of one axis and sense, whose component follows from these (curve_of()).
#pragma once

#include <span>
#include <string_view>

#include "core/axis.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {

/// The parameter is the slope of a curve along its axis, or a squareness [um/m].
struct ComponentTerm {
  std::string_view parameter;
  Component component = Component::EXX;
};

/// Of an artefact that shows errors which the unit can carry; empty for all other effects.
[[nodiscard]] std::span<const ComponentTerm> components_of(const EffectDefinition& effect);

}  // namespace ecs::model
