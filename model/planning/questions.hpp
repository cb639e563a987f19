// What the next measurement is asked: which explanations are open after a diagnosis, as shapes over present and new
// readings. Internal to model/ (Eigen). Does not live here: how far runs separate them (separation.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/planning/separation.hpp"

namespace ecs::model {

/// A group of rivals of a diagnosis.
struct OpenGroup {
  std::vector<EffectInstance> rivals;
  std::vector<std::string> names;       ///< one per rival
  std::vector<EffectInstance> settled;  ///< named effects outside the group
};
/// The first group of several; the first named cause where no group has any.
[[nodiscard]] OpenGroup open_group(const Diagnosis& diagnosis);

/// "thermal_drift:X:EX (t_spindle_degC)"
[[nodiscard]] std::string name_with_sensor(const EffectInstance& effect);

/// Extra columns that the formulas of a user effect read; none for effects of the library.
[[nodiscard]] std::vector<std::string> extra_columns_of(const EffectInstance& effect, const Observations& data);

/// Whether a dependence on the variable says what a new run shows: not where each run is another, or each hour.
[[nodiscard]] bool says_what_comes(const std::string& variable);

/// The residual as a function of one variable, for structure that no effect explains.
[[nodiscard]] Explanation depends_on(const Dependence& dependence, const Observations& all);

/// Causes with one size to fit that the present readings could hold unseen although as large as the noise, each with
/// that size, at most `most`.
[[nodiscard]] std::vector<Explanation> unseen_causes(const Belief& belief, const WithProposals& all,
                                                     const Regressors& regressors, const Model& model,
                                                     std::size_t most);

}  // namespace ecs::model
