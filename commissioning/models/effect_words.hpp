// What the library says of an effect, in words: the same in `ecs model effects ID`, on the MODEL screen and in the
// report; an effect of a model that its data could not tell from others, taken out or decided for.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "model/diagnosis/diagnose.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// "error map", "parameters", "put it right", "no": what carries the compensation.
[[nodiscard]] std::string_view carrier_text(model::Carrier carrier);

/// "cause: lost motion in the drive"
struct EffectFact {
  std::string label;
  std::string text;
};
/// Formula, cause, what distinguishes it, how it is compensated.
[[nodiscard]] std::vector<EffectFact> facts_of(const model::EffectDefinition& effect);

/// A candidate opened: its facts, its values, what else it could be, what to check at the machine.
[[nodiscard]] std::vector<EffectFact> details_of(const model::Candidate& candidate);

/// The numbers of the proof, each with the word "holds" or "fails".
[[nodiscard]] std::vector<EffectFact> evidence_of(const model::Candidate& candidate, const model::Diagnosis& diagnosis);

/// "cyclic:X:EX (or servo_lag:X:EX)": with what the data could not tell it from when it was added.
[[nodiscard]] std::string name_with_alternatives(const model::EffectInstance& effect);
/// The same for an effect of `model` by its name, to_text(); a name that the model lacks stays as it is.
[[nodiscard]] std::string name_with_alternatives(const model::Model& model, const std::string& name);
/// Errors of the measurement among what the data could not tell an effect from, "cosine:X:EX or air_refraction:X:EX";
/// "" where there is none.
[[nodiscard]] std::string measurement_alternatives(const model::EffectInstance& effect);
/// What compensating an effect costs if it is such an error.
/// @param amount  of it, "11.2 um rms"  @pre measurement_alternatives() are there
[[nodiscard]] std::string cost_if_of_measurement(const model::EffectInstance& effect, const std::string& amount);
/// Keeps the alternatives with the effect, in model files too. Empty: it is decided. @pre no effect of the user
void keep_alternatives(model::EffectInstance& effect, const std::vector<model::EffectInstance>& alternatives);

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
