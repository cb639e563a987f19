// A model as one linear problem, columns of all its effects at given nonlinear parameters and the part that is held;
// its fit to readings with outliers, noise and nonlinear parameters; that fit reported. Internal to model/ (Eigen).
// Does not live here: noise (noise.hpp), formulas (model/regression/user_formula.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/result.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/model_file.hpp"
#include "model/fit/noise.hpp"
#include "model/regression/regressors.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {

/// One effect of the model in the linear problem.
struct Slot {
  EffectInstance effect;
  Acting acting;
  std::vector<double> nonlinear;                         ///< values of the nonlinear parameters, given ones included
  std::vector<bool> nonlinear_free;                      ///< as many
  std::vector<Eigen::Index> used;                        ///< which of the effect's columns are fitted
  std::map<Eigen::Index, double> at_limit;               ///< columns held at a limit of their range, with it
  std::optional<UserFormulas> formulas;                  ///< of a user effect
  std::vector<std::size_t> user_linear, user_nonlinear;  ///< places in effect.user

  /// Whether the contribution has a derivative in its nonlinear parameters; what is exact is tried, but not fitted.
  [[nodiscard]] bool has_slope() const { return effect.definition().search.has_slope && !has_exact_period(effect); }
  /// Whether it has one free searched parameter, several values of it to try, and nothing else that is held.
  /// @param motions  of the readings
  [[nodiscard]] bool is_sought(const Observations& motions) const;

  Eigen::MatrixXd columns;     ///< (readings × used)
  Eigen::VectorXd fixed;       ///< held part (readings)
  Eigen::VectorXd held_sizes;  ///< of every column of the effect; 0 for the fitted ones
};

class Assembly {
 public:
  /// Refuses user formulas that do not compile and effects that act on no reading at all.
  [[nodiscard]] static Result<Assembly> of(const Model& model, const Regressors& regressors);

  std::vector<Slot> slots;

  /// Columns of one slot again, at its nonlinear values.
  void renew(std::size_t slot, const Regressors& regressors);
  [[nodiscard]] Eigen::MatrixXd columns() const;
  [[nodiscard]] Eigen::VectorXd fixed(std::size_t readings) const;
  [[nodiscard]] Eigen::Index first_column(std::size_t slot) const;
  /// Contribution of a slot with these sizes of its fitted columns.
  [[nodiscard]] Eigen::VectorXd contribution(std::size_t slot, const Eigen::VectorXd& sizes) const;
  /// Change of the slot's contribution per unit of its nonlinear parameter `j`, sizes held.
  [[nodiscard]] Eigen::VectorXd slope(std::size_t slot, std::size_t j, const Eigen::VectorXd& sizes,
                                      const Regressors& regressors);
};

/// The linear part at given nonlinear parameters.
struct Solved {
  Eigen::VectorXd sizes;  ///< of all fitted columns, slot after slot; 0 for undetermined ones
  Eigen::VectorXd white_residual;
  double chi2 = 0.0;  ///< whitened, without outliers
  Eigen::Index rank = 0;
  double condition = 1.0;
  std::vector<bool> undetermined;                   ///< per column
  std::vector<std::vector<Eigen::Index>> collides;  ///< per column: columns that do the same together
};

struct CoreFit : Solved {
  Eigen::MatrixXd covariance;  ///< of sizes, then of the free nonlinear parameters
  Eigen::VectorXd residual;
  NoiseModel noise;
  std::vector<bool> left_out;
};

struct CoreOptions {
  bool plain = false;
  bool all_curve_functions = false;  ///< curves use every function instead of as many as the evidence asks for
  bool from_values = false;          ///< as in FitOptions
  const CoreFit* beside = nullptr;   ///< noise and outliers are those of another fit: one step, without a covariance
};

/// Columns that a smooth machine could produce, for noise without repeats.
[[nodiscard]] Eigen::MatrixXd smooth_columns(const Observations& data);

/// Fits; `assembly` ends with the nonlinear values found.
[[nodiscard]] CoreFit fitted(Assembly& assembly, const Regressors& regressors, const CoreOptions& options);

/// Parameters with sigmas, correlations above one half, what is undetermined and why.
[[nodiscard]] Fit reported(const Assembly& assembly, const Regressors& regressors, const CoreFit& core);

/// F test of the means at repeated places against the scatter of the repeats; nothing without enough repeats.
/// @param residual  um or um/m, canonical order
/// @param fitted_parameters  rank of the fit, taken off the freedom of the means
[[nodiscard]] std::optional<LackOfFit> lack_of_fit_of(const Observations& data, const Eigen::VectorXd& residual,
                                                      const NoiseModel& noise, const std::vector<bool>& left_out,
                                                      double fitted_parameters);

/// The candidate, a user effect that is not in the model, with the `start` of its free nonlinear parameters where the
/// least squares of the readings have the least of several minima; unchanged where it has none or does not compile.
[[nodiscard]] EffectInstance with_best_start(const Model& model, const EffectInstance& candidate,
                                             const Regressors& regressors);

/// The same for the user effects in the model that have not been fitted before.
[[nodiscard]] Model with_best_starts(Model model, const Regressors& regressors);

/// Places in effect.user of the free parameters in which the formulas are no straight line; none of a library effect.
[[nodiscard]] std::vector<std::size_t> nonlinear_user_parameters(const EffectInstance& effect,
                                                                 const Observations& data);

}  // namespace ecs::model
