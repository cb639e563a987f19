// What answers about models share: effects, parameters and tests by the names of docs/verbs.md. Only for .cpp
// files (heavy header).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/answer_table.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/model_file.hpp"

namespace ecs::commissioning {

/// {"effect", "axis", "sense", "approach", "code", "sensor", "name"}, and "sensor2" where one applies; absent parts
/// null; `name` is "cyclic:X:EX".
[[nodiscard]] Json effect_json(const model::EffectInstance& effect);
/// The same place out of such an object; only "effect" must be there. Nothing where that is no effect of the library.
[[nodiscard]] std::optional<model::EffectInstance> effect_in(const Json& object);

/// {"F", "p"}, or null without repeats; "F = 31.2, p = 1e-40", "too few repeats to judge".
[[nodiscard]] Cell lack_of_fit_cell(const std::optional<model::LackOfFit>& test);
/// name, unit, value, sigma, held, undetermined; the text of a value has as many digits as its sigma has meaning for.
[[nodiscard]] AnswerFields fields_of(const model::ParameterEstimate& parameter);
/// @param layout  of each
[[nodiscard]] Cell parameters_cell(const std::vector<model::ParameterEstimate>& parameters,
                                   std::string_view layout = {});
/// {"p_mm", "value"}
[[nodiscard]] Json curve_json(const model::FittedCurve& curve);
/// A number that is not finite is null.
[[nodiscard]] Json numbers_json(const std::vector<double>& values);

/// The text to a thousandth.
[[nodiscard]] Cell position_cell(double position_mm);
/// Columns of a position in a table, "{x_mm:>10} {y_mm:>10} {z_mm:>10}", and what belongs there.
[[nodiscard]] std::string position_layout(bool rotary);
void add_position(AnswerFields& fields, const Vector3& position_mm, bool rotary);
/// {"x_mm", "y_mm", "z_mm"}; of rotary axes {"a_deg", "b_deg", "c_deg"}
[[nodiscard]] Json position_json(const Vector3& position_mm, bool rotary = false);
[[nodiscard]] std::string axis_json(Axis axis, bool rotary = false);

}  // namespace ecs::commissioning
