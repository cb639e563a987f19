#include "commissioning/models/effect_changes.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/models/effect_words.hpp"

namespace ecs::commissioning {

Result<std::size_t> effect_in(const model::Model& model, const std::string& name) {
  std::vector<std::string> names;
  for (const model::EffectInstance& effect : model.effects) names.push_back(place_text(effect));
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  return problem(ProblemKind::usage,
                 fmt::format("expected an effect of the model: {}; found \"{}\"", fmt::join(names, ", "), name));
}

Result<WithoutEffect> without_effect(const model::Model& model, const model::Observations& data, std::size_t effect,
                                     const model::Fit& before, const std::string& data_name) {
  if (model.effects.size() == 1) return problem(ProblemKind::refused, "a model keeps at least one effect");
  WithoutEffect without{model, {}, place_text(model.effects[effect]), before.rms_um};
  without.model.effects.erase(without.model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  ECS_TRY(fit, model::fit(without.model, data));
  without.fit = std::move(fit);
  without.model.history.push_back(
      rung_of("without " + to_text(model.effects[effect]), data_name, before.residual, without.fit, data));
  return without;
}

}  // namespace ecs::commissioning
