// What speaks for and against the effects that a search found. Internal to model/ (Eigen).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "model/diagnosis/investigation.hpp"

namespace ecs::model {

/// Odds from which evidence for one of two hypotheses is positive (Kass and Raftery 1995, JASA 90, 773).
inline constexpr double kPositive = 3.0;
/// Below this e-value readings that an effect was not fitted to speak against it.
inline constexpr double kSpeaksAgainst = 1.0 / kPositive;
/// Readings that an effect was not fitted to speak for it from this e-value on.
inline constexpr double kSpeaksFor = 1.0;

/// The model with the effects of a solution.
[[nodiscard]] LinearProblem joined(const Base& base, const Search& search, const Solution& solution);
/// Whether a wander explains as much as an effect that changes like one. @param e_value  beside a wander, not yet
/// divided by the number of candidates
[[nodiscard]] bool is_replaced_by_wander(const EffectInstance& effect, std::optional<double> e_value);
/// Whether the readings wander beside all effects found, or from pass to pass beside those that no wander replaces.
[[nodiscard]] bool wanders_beside(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                  const LinearProblem& all, const std::optional<LinearProblem>& not_replaced);
/// All but the i-th.
[[nodiscard]] std::vector<Choice> others(std::vector<Choice> chosen, std::size_t i);
/// Readings that count, less what is absorbed.
[[nodiscard]] double freedom_beside(const Space& space, const std::vector<bool>& left_out);

/// Groups of the effects found, each with its e-value; those that readings they were not fitted to speak against are
/// taken back, the worst first. What remains is the best set of its size: one that needed what was taken back is not.
void weigh(const Regressors& regressors, const Base& base, const Search& search, StepwiseOptions stepwise,
           Found& found);

/// p-values of the effects found. An effect is tested at the best of the values tried, not at one sought nearby. Where
/// a wander is evident noise alone is no hypothesis, and a formula begins where the readings are fitted best: there the
/// e-value stands for the p-value (Markov).
void state_p_values(const Regressors& regressors, const Base& base, const Search& search, Found& found);

/// What speaks against the effects found: a run that explains as much, waves that can be anything.
void judge(const Regressors& regressors, const Base& base, const Search& search, const Whitener& whitener,
           double noise_freedom, Found& found);

}  // namespace ecs::model
