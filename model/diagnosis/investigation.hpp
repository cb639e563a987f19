// The search on one choice of readings: noise and replicates of it, the best set of effects, what is left. Internal to
// model/ (Eigen). Does not live here: how it is reported (diagnose.cpp).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "model/diagnosis/bad_run.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/diagnosis/stepwise.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/fit/core.hpp"

namespace ecs::model {

/// Least share of what is above noise that an explanation predicts at targets not fitted to. A choice: columns
/// fitted to noise predict nothing or less than nothing, a true shape nearly all (tests/model/fit/held_out_test.cpp).
inline constexpr double kLeastCrossValidated = 0.25;
/// The same where nothing but the effect itself speaks against noise: then it has to predict half.
inline constexpr double kLeastCrossValidatedAlone = 0.5;

/// Noise of fewer degrees of freedom is known little: the thousandth of Student's t of 30 is a tenth beyond the normal
/// one.
inline constexpr double kManyDegrees = 30.0;

/// A cause is proved by this e-value (docs/model.md, verdicts).
inline constexpr double kProved = 100.0;
/// One is likely where noise alone looks like it in at most this share of cases (docs/model.md, verdicts).
inline constexpr double kLikelyChance = 0.01;

/// Readings beyond the fitted parameters below which structure cannot be told from noise: F(1, 6) exceeds 6 in one case
/// of twenty.
inline constexpr double kFewestSpare = 6.0;
/// With fewer, an effect is named that noise of any size does not look like; below this one size is all that is left.
inline constexpr double kFewestToName = 3.0;

/// The model as it is: what it absorbs and what it leaves.
struct Base {
  Eigen::MatrixXd columns;               ///< of the fitted sizes and nonlinear parameters, without those of `own`
  Eigen::MatrixXd own_columns;           ///< those of `own`, at the values fitted
  std::vector<std::size_t> own;          ///< effects of the model whose searched parameter is free, with nothing held
  std::vector<EffectInstance> at_limit;  ///< effects of the model held at the limit of their range: no candidates
  Eigen::VectorXd target;                ///< readings less the part held
  Eigen::VectorXd residual;              ///< of the fit
  CoreFit core;
  NoiseModel noise;  ///< beside all these columns, which took a part of it
  Fit fit;           ///< as it is reported
};

/// What noise that wanders looks like, should the readings do so.
struct WanderScores {
  double probability = 0.0;    ///< that they do
  std::vector<double> scores;  ///< the best of each replicate; none where they probably do not
};

/// Everything found on one choice of readings.
struct Found {
  Solution solution;
  std::vector<Group> groups;
  std::vector<Family> families;
  std::size_t candidates_tried = 0;
  std::vector<double> replicate_scores;  ///< best of each noise replicate
  /// Takes time; the readings and the base must be there still.
  std::function<WanderScores()> wander_scores;
  std::vector<StructureTest> before, after;    ///< structure of the residual without and with the effects found
  std::vector<StructureTest> beyond_position;  ///< the former, of each variable beyond the position along the line
  double structure_p_after = 1.0;
  double entry_score = 0.0;
  double cross_validated_share = 1.0;  ///< share of what is above noise that is predicted in runs or at targets not
                                       ///< fitted to, the lesser
  std::vector<Choice> taken_back;  ///< the best sum, where readings left out speak against a member of it: each member
                                   ///< may speak for itself only together with the others
  std::vector<Choice> closest;     ///< where nothing is found: the best of what was tried, best first
  /// That noise of any size looks like the best of them, where the readings tell little of the noise; of the effect
  /// that is named for this alone.
  std::optional<double> chance_of_closest;
  std::optional<Choice> stands_out;  ///< the effect that noise of any size does not look like
  bool proves_nothing = false;       ///< the noise is the residual of an effect that is only likely
  [[nodiscard]] double false_naming(double score) const;
  std::optional<RunOffset> bad_run;  ///< explains the residual as well as the effects do
  std::optional<NoisyRun> noisy;     ///< scatters more than the others
  std::optional<OddPass> odd_pass;   ///< where nothing is found: stands off the others
  std::optional<StepOfRuns> step;    ///< explains more than any one run does: no run is bad then
  bool wanders = false;              ///< what was taken for noise does
  bool wander_is_evident = false;    ///< beside the effects found: wanders_beside()
  std::optional<FreeWave> wave;      ///< in what is left, with another phase in every pass
  std::string run_note;              ///< a run that explains nearly as much as an effect found, "" for none
  std::string objection;             ///< why the effects found are no causes although they explain, "" for none
  std::string doubt;                 ///< why they are not proved although nothing speaks against them, "" for none
  NoiseModel noise;
  std::vector<bool> left_out;
};

/// Target less the fixed parts, and columns, of base and chosen effects.
struct LinearProblem {
  Eigen::MatrixXd columns;
  Eigen::VectorXd target;
};
/// √(mean r²)
[[nodiscard]] double rms_of(const Eigen::VectorXd& r);

/// Fits the model with every function of its curves.
[[nodiscard]] Result<Base> base_of(const Model& model, const Regressors& regressors, bool plain);

[[nodiscard]] Eigen::VectorXd residual_of(const LinearProblem& problem, const Whitener& whitener);

/// The noise is looked at again, with what was found taken off, this many times at the utmost.
inline constexpr int kMostRounds = 2;
/// Noise and outliers again from what is left; false: they are what they were, or too little is left to tell.
[[nodiscard]] bool noise_changed(const Observations& data, const Base& base, const LinearProblem& all,
                                 const Whitener& whitener, bool plain, NoiseModel& noise, std::vector<bool>& left_out);

/// The candidates but those that the model has already with a free searched parameter (`own`).
[[nodiscard]] std::vector<EffectInstance> others_than(const std::vector<EffectInstance>& own,
                                                      std::vector<EffectInstance> candidates);

/// The same, and without a lag for a term of the model: that one has the lag that it has.
[[nodiscard]] std::vector<EffectInstance> candidates_beside(const Model& model, const std::vector<EffectInstance>& own,
                                                            const std::vector<EffectInstance>& candidates);

[[nodiscard]] Found searched(const Model& model, const Regressors& regressors, const Base& base,
                             const std::vector<EffectInstance>& candidates, const DiagnoseOptions& options);

/// Whether nothing is found but a wave in time; the objection says so.
[[nodiscard]] bool is_wave_in_time(const Found& found);

/// Whether the effects found leave nothing but noise.
[[nodiscard]] bool noise_left(const Found& found, const DiagnoseOptions& options);
/// Whether what they leave depends on a variable beyond chance.
[[nodiscard]] bool leaves_structure(const Found& found, const DiagnoseOptions& options);

}  // namespace ecs::model
