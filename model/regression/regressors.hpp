// What an effect can contribute to readings: columns over observations at a given value of its searched parameter.
// Internal to model/ (Eigen). Does not live here: what each effect contributes (its own file), which combination of
// columns fits (model/fit/fit.hpp), which effects to try (candidates.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "model/data/curve_basis.hpp"
#include "model/data/observations.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {

/// Most smooth functions a curve may use; evidence decides how many it does use.
inline constexpr std::size_t kMostCurveFunctions = 14;

/// Columns of one effect at given nonlinear parameters.
struct Columns {
  Eigen::MatrixXd of;       ///< (readings × linear coefficients), 0 where the effect does not act
  Eigen::VectorXd fixed;    ///< part that no coefficient scales (size 0: none)
  std::size_t leading = 0;  ///< curves: the first this many are mean and slope, then functions of rising roughness
};

/// Columns of an effect at all values that a search tries, a row for each reading that it acts on; of one that depends
/// on the position of its axis alone a row for each place.
struct Shapes {
  EffectInstance effect;
  std::vector<double> grid, facts;  ///< the values
  std::vector<double> place_mm;     ///< of each row; empty: of readings
  Eigen::MatrixXf columns;
};

class Regressors {
 public:
  /// @param data  outlives this
  explicit Regressors(const Observations& data);
  ~Regressors();
  Regressors(const Regressors&) = delete;
  Regressors& operator=(const Regressors&) = delete;

  [[nodiscard]] Acting acting(const EffectInstance& effect) const;
  /// With the readings that the rows are part of; readings that lack a cell in several rows are skipped once.
  [[nodiscard]] Acting with_readings(Acting acting) const;

  /// @param searched  value of the effect's searched parameter, in the unit of model files; not used by the others
  [[nodiscard]] Columns columns(const EffectInstance& effect, double searched) const;
  [[nodiscard]] Columns columns(const EffectInstance& effect, double searched, const Acting& acting) const;

  /// What the noise of a sensor leaves unknown of the one column of an effect that follows it, per reading, as a
  /// standard deviation; 0 of the others, and on paths.
  [[nodiscard]] Eigen::VectorXd unknown(const EffectInstance& effect, double searched) const;

  /// Contribution of the curve that the effect carries (FittedCurve), per reading; 0 where it does not act.
  [[nodiscard]] Eigen::VectorXd of_curve(const EffectInstance& effect, const Acting& acting) const;

  /// Root mean square of a curve with these sizes of all its columns, in its own unit, over the rows on which it acts.
  [[nodiscard]] double rms_of_curve(const EffectInstance& effect, const Acting& acting,
                                    const Eigen::VectorXd& sizes) const;

  /// Values of a user effect's formulas (UserFormulas::values) as contributions to the readings; 0 where a cell lacks.
  [[nodiscard]] Eigen::VectorXd of_formulas(const std::vector<double>& values) const;

  /// Smooth functions of an effect that is a curve, over the positions on which it acts.
  [[nodiscard]] const CurveBasis& basis_of(const EffectInstance& effect) const;

  [[nodiscard]] const Observations& data() const { return data_; }
  /// The rows on which effects act.
  [[nodiscard]] const Observations& motions() const { return motions_; }
  /// columns() before motions become readings: (motions × linear coefficients).
  [[nodiscard]] Columns motion_columns(const EffectInstance& effect, double searched, const Acting& acting) const;
  /// Values of motions as values of readings (a linear map), and the transposed map. Without paths the values as they
  /// are.
  [[nodiscard]] Eigen::MatrixXd readings_from(Eigen::MatrixXd of_motions) const;
  [[nodiscard]] Eigen::MatrixXd motions_from(Eigen::MatrixXd of_readings) const;

  /// What searches have made of these readings, for the next ones: noise and model do not change it.
  [[nodiscard]] const std::vector<std::shared_ptr<const Shapes>>& shapes() const { return shapes_; }
  void keep(std::shared_ptr<const Shapes> shapes) const { shapes_.push_back(std::move(shapes)); }

  /// Whether lines along the axis of an angular error see it through different levers at one target, which tells it
  /// from other shapes of position.
  [[nodiscard]] bool lever_varies(const EffectInstance& effect) const;

 private:
  [[nodiscard]] Eigen::MatrixXd curve_columns(const EffectInstance& effect, const Acting& acting) const;

  const Observations& data_;
  const Observations& motions_;
  mutable std::map<std::string, CurveBasis> bases_;
  mutable std::vector<std::shared_ptr<const Shapes>> shapes_;
};

/// Function of a column of an effect that is a curve, without its factor: mean and slope that it keeps, then `basis`.
/// @param p_mm  from the datum of its axis
[[nodiscard]] double curve_function(const EffectDefinition& definition, const CurveBasis& basis, std::size_t column,
                                    double p_mm);

/// A wave of a rotary axis: its period is a whole fraction of a turn, which is tried and never moved by a fit.
[[nodiscard]] bool has_exact_period(const EffectInstance& effect);

/// Linear coefficients → parameters with sigma. `covariance` of the coefficients; empty: none.
[[nodiscard]] std::vector<ParameterEstimate> parameters_from(const EffectInstance& effect,
                                                             const Eigen::VectorXd& linear,
                                                             const Eigen::MatrixXd& covariance,
                                                             std::optional<double> searched,
                                                             std::optional<double> searched_sigma);

/// Value of linear coefficient j held by `parameters` of the model file; nothing: it is to be fitted.
[[nodiscard]] std::optional<double> held_coefficient(const EffectInstance& effect, std::size_t j);

/// Name of the parameter that is 0 where coefficient j is: its own, or the amplitude of its wave.
[[nodiscard]] std::string parameter_of_coefficient(const EffectDefinition& definition, std::size_t j);

}  // namespace ecs::model
