// What an effect can contribute to readings: columns over observations at given nonlinear parameters. Internal to this
// room (Eigen). Does not live here: which combination of columns fits (model/fit/fit.hpp), which effects to try
// (model/diagnosis/candidates.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "model/data/curve_basis.hpp"
#include "model/data/observations.hpp"
#include "model/effects/effect.hpp"
#include "model/fit/fit.hpp"

namespace ecs::model {

/// Most smooth functions a curve may use; evidence decides how many it does use.
inline constexpr std::size_t kMostCurveFunctions = 14;

/// Readings on which an effect acts.
struct Acting {
  std::vector<std::size_t> rows;  ///< canonical order, ascending
  std::size_t skipped = 0;        ///< it would act, but the row lacks a cell
  std::string lacking;            ///< the column that is missing, "" if none
};

/// Columns of one effect at given nonlinear parameters.
struct Columns {
  Eigen::MatrixXd of;     ///< (readings × linear coefficients), 0 where the effect does not act
  Eigen::VectorXd fixed;  ///< part that no coefficient scales (size 0: none)
  std::size_t leading =
      0;  ///< curves: the first `leading` belong together, the others are functions of rising roughness
};

class Regressors {
 public:
  /// @param data  outlives this
  explicit Regressors(const Observations& data);
  ~Regressors();
  Regressors(const Regressors&) = delete;
  Regressors& operator=(const Regressors&) = delete;

  [[nodiscard]] Acting acting(const EffectInstance& effect) const;

  /// @param nonlinear  value of the effect's nonlinear parameter, in the unit of model files; not used by the others
  [[nodiscard]] Columns columns(const EffectInstance& effect, double nonlinear) const;
  [[nodiscard]] Columns columns(const EffectInstance& effect, double nonlinear, const Acting& acting) const;

  /// Contribution of the curve that the effect carries (FittedCurve), per reading; 0 where it does not act.
  [[nodiscard]] Eigen::VectorXd of_curve(const EffectInstance& effect, const Acting& acting) const;

  /// Smooth functions of a curve effect (progressive, reversal_curve, angular).
  [[nodiscard]] const CurveBasis& basis_of(const EffectInstance& effect) const;

  [[nodiscard]] const Observations& data() const { return data_; }

 private:
  const Observations& data_;
  mutable std::map<std::string, CurveBasis> bases_;
};

/// Name of the nonlinear parameter of a library effect; "" if it has none.
[[nodiscard]] std::string_view nonlinear_parameter_of(EffectId id);
/// progressive, reversal_curve, angular
[[nodiscard]] bool is_curve(EffectId id);
/// Its size is not fitted: map_polarity, map_shift, map_direction_swap.
[[nodiscard]] bool has_fixed_size(EffectId id);

/// True where the axis of the effect is the one being moved and the approach is known.
[[nodiscard]] bool is_own_motion(const Observations& data, std::size_t k, Axis axis);

/// The map's compensation in reading k, µm (µm/m for rotations), of the tables chosen by `effect` (axis, code; all if
/// it names none), with the moving axis shifted by `shift_mm` and the approach taken `as_approach`.
[[nodiscard]] double map_compensation(const Observations& data, std::size_t k, const EffectInstance& effect,
                                      double shift_mm, int as_approach);

/// Linear coefficients → parameters with sigma. `covariance` of the coefficients; empty: none.
[[nodiscard]] std::vector<ParameterEstimate> parameters_from(const EffectInstance& effect,
                                                             const Eigen::VectorXd& linear,
                                                             const Eigen::MatrixXd& covariance,
                                                             std::optional<double> nonlinear,
                                                             std::optional<double> nonlinear_sigma);

/// Value of linear coefficient j held by `parameters` of the model file; nothing: it is to be fitted.
[[nodiscard]] std::optional<double> held_coefficient(const EffectInstance& effect, std::size_t j);

}  // namespace ecs::model
