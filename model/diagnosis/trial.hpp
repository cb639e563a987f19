// One effect tried beside a model at given values, and the numbers told of it: what a diagnosis reports and a check
// recomputes. Internal to model/ (Eigen). Does not live here: which effects and values (investigation.hpp).
#pragma once

#include <vector>

#include "model/diagnosis/investigation.hpp"

namespace ecs::model {

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
/// Proved causes explain the residual in part from this share on (docs/model.md, verdicts).
inline constexpr double kPartExplained = 0.5;

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
/// The model without any, its own terms where the fit found them. @param left  told_residual()
[[nodiscard]] FittedWith fitted_alone(const Base& base, Eigen::VectorXd left);
/// An effect and the values at which a search took it.
struct FoundEffect {
  EffectInstance effect;
  Choice choice;
};
/// All sizes of an effect are fitted, those that the search did without too: what is left out because it is small makes
/// the others look surer than they are (Leeb and Poetscher 2005). Harmonics of a wave stand on their own; where the
/// data do not determine all sizes, those of the search are fitted.
[[nodiscard]] Result<FittedWith> fitted_with(const Model& model, const std::vector<OwnTerm>& own,
                                             const std::vector<FoundEffect>& effects, const Regressors& regressors,
                                             bool plain);

/// @param before  what the model leaves  @param left  what it leaves with the effect; both as told_residual()
[[nodiscard]] TrialNumbers trial_numbers(const Eigen::VectorXd& before, const Eigen::VectorXd& left,
                                         const FittedWith& after);
/// What the model leaves with one effect, as told_residual(): effect and own terms at their values.
/// @param beside  whose noise and outliers are taken instead of those with the effect, which takes less time; or null
[[nodiscard]] Eigen::VectorXd residual_with(const Model& model, const std::vector<OwnTerm>& own,
                                            const FoundEffect& found, const LinearProblem& problem,
                                            const Whitener& whitener, const Regressors& regressors, bool plain,
                                            const CoreFit* beside);

}  // namespace ecs::model
