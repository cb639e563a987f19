// From single candidates to a set of missing effects: forward steps on several branches, exchange of earlier choices,
// the rivals that do as well; one effect tried beside a model at given values, as a diagnosis reports and a check
// recomputes it; waves that stand for something else, or whose phase is another in every pass. Internal to model/
// (Eigen). Does not live here: the gains (search.hpp), which effects and values (investigation.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "model/data/observations.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/fit/search.hpp"

namespace ecs::model {

struct StepwiseOptions {
  std::size_t most_effects = 3;
  double entry_score = 10.0;  ///< least score of an effect that may be added
  double entry_gain = 0.0;    ///< least fall of χ² of the first two: what noise known imperfectly may fake
  double late_gain = 0.0;     ///< least fall of χ² of any further one
};

/// The best set of effects; empty where none reaches the entry score. Does not depend on the order of the families.
[[nodiscard]] Solution best_solution(const Search& search, const StepwiseOptions& options);

/// A member of a solution and the rivals that these data cannot distinguish from it.
struct Group {
  Choice member;
  std::vector<Choice> rivals;  ///< equal in fit within what noise allows, with few parameters more
  std::vector<Choice> weaker;  ///< the next best, best first
  /// At all values of its searched parameter that fit within Δχ² 9 of the best (14.2 where they need one harmonic
  /// less), the facts of the machine first; of one without a derivative (a place) at the least and the greatest.
  std::vector<Choice> values;
  bool denied = false;  ///< something speaks against it although it explains: a run, waves that can be anything
  bool wander = false;  ///< a slow wander of the readings explains it as well
  std::optional<double> e_value;  ///< on readings it was not fitted to, for having been chosen among all candidates
  double p_value = 1.0;           ///< p_value.hpp, beside the other effects of the solution
  double p_value_alone = 1.0;     ///< the same beside the model
};
/// One group per effect of the solution, in its order.
[[nodiscard]] std::vector<Group> groups_of(const Search& search, const Solution& solution, double entry_score);

/// Probability of each of these alternatives for one cause, in their order; they add up to 1.
/// @param families  those of the search that made them
[[nodiscard]] std::vector<double> probabilities_of(const std::vector<Choice>& alternatives,
                                                   const std::vector<Family>& families);

/// Every effect that a diagnosis of these data tries: the library's, then the model's own candidates.
[[nodiscard]] std::vector<EffectInstance> all_candidates(const Model& model, const Regressors& regressors);

/// An even choice of readings, at random one from each stretch of the file; the same for the same data.
[[nodiscard]] Observations searched_part(const Observations& data, std::size_t wanted);

/// Columns of an effect on all readings at the values of a choice.
[[nodiscard]] Columns columns_on(const Regressors& regressors, const EffectInstance& effect, const Choice& choice);
[[nodiscard]] LinearProblem joined_with(const LinearProblem& problem, const Columns& more);

/// Columns and target of the model, its own terms at these values.
[[nodiscard]] LinearProblem problem_with_own(const Model& model, const Base& base, const Regressors& regressors,
                                             const std::vector<OwnTerm>& own);

/// √(mean r²) of all readings but the outliers.
[[nodiscard]] double rms_without(const Eigen::VectorXd& residual, const std::vector<bool>& left_out);
/// Share of what is above noise in `rms_um` that is gone, 0 … 1; 0 where nothing is above noise.
[[nodiscard]] double explainable_share(double rms_um, double rms_after_um, double noise_um);

/// What a model leaves as fit() tells it: its curves as rough as the evidence asks for. A diagnosis searches beside all
/// functions of the curves, so that nothing that a curve can follow is named.
/// @param left  what the model leaves with all functions: the same where it has no curve, or the fit fails
/// @param from_values  as in FitOptions
[[nodiscard]] Eigen::VectorXd told_residual(const Model& model, const Observations& data, bool plain,
                                            Eigen::VectorXd left, bool from_values = false);

/// The model with effects of a diagnosis, all fitted together from their values.
struct FittedWith {
  Fit fit;
  Eigen::VectorXd left;  ///< told_residual()
  NoiseModel noise;
  std::vector<bool> left_out;
};
/// An effect and the values at which a search took it.
struct FoundEffect {
  EffectInstance effect;
  Choice choice;
};
/// All sizes of an effect are fitted, those that the search did without too: what is left out because it is small makes
/// the others look surer than they are (Leeb and Poetscher 2005). Harmonics of a wave stand by themselves; where the
/// data do not determine all sizes, those of the search are fitted.
[[nodiscard]] Result<FittedWith> fitted_with(const Model& model, const std::vector<OwnTerm>& own,
                                             const std::vector<FoundEffect>& effects, const Regressors& regressors,
                                             bool plain);

/// @param before  what the model leaves  @param left  what it leaves with the effect; both as told_residual()
[[nodiscard]] TrialNumbers trial_numbers(const Eigen::VectorXd& before, const Eigen::VectorXd& left,
                                         const FittedWith& after);
/// What the model leaves with one effect, as told_residual(): effect and own terms at their values.
[[nodiscard]] Eigen::VectorXd residual_with(const Model& model, const std::vector<OwnTerm>& own,
                                            const FoundEffect& found, const LinearProblem& problem,
                                            const Whitener& whitener, const Observations& data, bool plain);

/// Why the waves among these effects are no cause although their sum may reach the noise, as the end of a sentence; ""
/// where nothing speaks against them. Anything can be written as enough waves: several unrelated periods none of which
/// is a pitch of the machine, neighbouring periods that beat, a wave that needs a step to help.
/// @param each_proved  every one of these effects is proved on readings it was not fitted to: then one wave and one
/// step, and nothing else, are two causes
[[nodiscard]] std::string objection_to_waves(const Observations& data, const std::vector<Family>& families,
                                             const std::vector<Choice>& chosen, bool each_proved);

/// Where a wave found changes its size or its phase along the travel or in time, beyond what noise does: the reason as
/// the end of a sentence; else "".
/// @param space  with all effects absorbed
[[nodiscard]] std::string objection_to_steadiness(const Regressors& regressors, const Whitener& whitener,
                                                  const Space& space, const Family& family, const Choice& choice,
                                                  double noise_freedom);

/// Whether each wave among these effects is a pitch of the machine, as below, or all are whole fractions of one period.
[[nodiscard]] bool are_pitches_or_fractions(const std::vector<Family>& families, const std::vector<Choice>& chosen);

/// Whether an effect is no wave, or its period is a pitch of the machine or one of its parts and multiples.
[[nodiscard]] bool is_pitch_or_no_wave(const Family& family, const Choice& choice);

struct FreeWave {
  double period_mm = 0.0;
  double minus_log_p = 0.0;  ///< base 10, for having been sought among all frequencies
};
/// The strongest wave along the moving axis whose phase and size differ from pass to pass; nothing where noise shows
/// one as strong in one of a million sets.
/// @param residual  whitened, with everything found absorbed  @param left_out  outliers, not counted
[[nodiscard]] std::optional<FreeWave> free_wave(const Observations& data, const Eigen::VectorXd& residual,
                                                const std::vector<bool>& left_out);

}  // namespace ecs::model
