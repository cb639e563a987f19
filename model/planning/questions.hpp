// A proposed run in one sentence, and what the next measurement is asked: which explanations are open after a
// diagnosis, as shapes over present and new readings. Internal to model/ (Eigen). Does not live here: the same as a
// part program (part_program.hpp), how far runs separate them (separation.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/planning/next_measurement.hpp"
#include "model/planning/separation.hpp"

namespace ecs::model {

/// Separation that counts as one [sigma]: three, one case of 370 by chance; the convention of control charts (Shewhart
/// 1931).
inline constexpr double kSeparates = 3.0;

/// What is asked of a run.
enum class Question {
  separate,  ///< rivals from each other
  confirm,   ///< a lone cause
  see,       ///< causes that may be there unseen
  repeat,    ///< whether what is left comes back
};

/// "tells backlash:X:EX from servo_lag:X:EX: 12.0 sigma, 9 min"; the surest pairs first.
[[nodiscard]] std::string what_it_tells(const MeasurementProposal& proposal, Question question);

/// What to measure and how, in one sentence.
[[nodiscard]] std::string sentence_of(const MeasurementProposal& proposal);

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
