// Models, fits and diagnoses as JSON, by the names of docs/design.md 3.4. Only for .cpp files (heavy header).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {

/// {"effect", "axis", "sense", "approach", "code", "sensor", "name"}, and "sensor2" where one applies; absent parts
/// null; `name` is "cyclic:X:EX".
[[nodiscard]] Json json_of(const model::EffectInstance& effect);
/// The same place out of such an object; only "effect" must be there. Nothing where that is no effect of the library.
[[nodiscard]] std::optional<model::EffectInstance> effect_in(const Json& object);

/// {"F", "p"}, or null without repeats.
[[nodiscard]] Json json_of(const std::optional<model::LackOfFit>& test);
/// {"name", "unit", "value", "sigma", "held", "undetermined"}
[[nodiscard]] Json json_of(const model::ParameterEstimate& parameter);
[[nodiscard]] Json json_of(const std::vector<model::ParameterEstimate>& parameters);
/// {"effect", "data", "rms_before_um", "rms_um", "peak_um", "noise_um", "held_out_rms_um"}
[[nodiscard]] Json json_of(const model::LadderStep& step);
[[nodiscard]] Json json_of(const std::vector<model::LadderStep>& history);
[[nodiscard]] Json json_of(const model::FittedCurve& curve);
[[nodiscard]] Json json_of(const model::Diagnosis& diagnosis);

/// {"x_mm", "y_mm", "z_mm"}
[[nodiscard]] Json position_json(const Vector3& position_mm);
[[nodiscard]] std::string axis_json(Axis axis);

}  // namespace ecs::commissioning
