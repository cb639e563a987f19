// Changes of a model that the ladder does not make: an effect taken out of its middle, one decided for among its
// alternatives.
#pragma once

#include <cstddef>
#include <string>

#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// The place of an effect by its name, "cyclic:X:EX". A `usage` problem names those that there are.
[[nodiscard]] Result<std::size_t> effect_in(const model::Model& model, const std::string& name);

/// The model without that effect, refitted, with a step more on its ladder.
struct WithoutEffect {
  model::Model model;
  model::Fit fit;
  std::string name;
  double rms_before_um = 0.0;
};
/// Refused where it is the only one. @param before  the fit with it
[[nodiscard]] Result<WithoutEffect> without_effect(const model::Model& model, const model::Observations& data,
                                                   std::size_t effect, const model::Fit& before,
                                                   const std::string& data_name);

}  // namespace ecs::commissioning
