// One try at each kind of hidden case; nothing comes of it where the design drawn cannot show what shall be hidden.
// Does not live here: trying again (case.cpp).
#pragma once

#include "modules/hidden_cases/case.hpp"
#include "modules/hidden_cases/space.hpp"

namespace ecs::emulator {

/// A design on which different effects do the same (confounded.cpp).
struct ConfoundedDesign;

/// What all tries of a case have in common.
struct Wanted {
  CaseKind kind = CaseKind::blank;
  std::vector<const EffectDefinition*> effects;    ///< hidden; of a blank: what the design is made for
  const StructureDefinition* structure = nullptr;  ///< out of library
  const ConfoundedDesign* design = nullptr;        ///< confounded
  bool free_base = false;
  const EffectDefinition* in_base = nullptr;  ///< of a free base: an effect that it must hold
  NoiseLaw law = NoiseLaw::usual;
  double snr = 3.0;
  std::size_t readings = 300;
};

[[nodiscard]] std::optional<HiddenCase> compose(Random& random, const Wanted& wanted);
[[nodiscard]] std::optional<HiddenCase> compose_confounded(Random& random, const Wanted& wanted);
[[nodiscard]] std::optional<HiddenCase> compose_xytz(Random& random, const Wanted& wanted);

[[nodiscard]] const std::vector<const ConfoundedDesign*>& confounded_designs();
/// Those that may hide this effect.
[[nodiscard]] std::vector<const ConfoundedDesign*> confounded_designs_of(const EffectDefinition& kind);

/// Sizes, noise, background, readings and truth for a scene with its hidden effects (sizes still open) and its base
/// model. Nothing where sizes or noise would be out of reach.
[[nodiscard]] std::optional<HiddenCase> finished(Random& random, HiddenCase begun, const Ground& ground,
                                                 const Absorbed& absorbed, double snr, NoiseLaw law = NoiseLaw::usual);

}  // namespace ecs::emulator
