// A model as one linear problem: columns of all its effects at given nonlinear parameters, and the part that is held.
// Internal to model/ (Eigen). Does not live here: noise (noise.hpp), solving (fit.cpp).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "base/result.hpp"
#include "model/fit/model_file.hpp"
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

  /// Whether the contribution has a derivative in its nonlinear parameters.
  [[nodiscard]] bool has_slope() const { return effect.definition().search.has_slope; }
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

  /// Columns of one slot anew, at its nonlinear values.
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

}  // namespace ecs::model
