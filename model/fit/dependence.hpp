// What a residual may depend on, as functions without a shape of their own, and how much of it each variable explains:
// one number for `ecs model compare` and `diagnose`. Does not live here: whether noise does as much
// (model/diagnosis/structure.hpp), what effect it may be (search.hpp). Internal to model/ (Eigen).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "model/data/observations.hpp"
#include "model/fit/search.hpp"

namespace ecs::model {

/// What a residual may depend on, whatever the shape.
struct Variable {
  std::string name;         ///< "x_mm", "approach", "run", …
  Eigen::MatrixXd columns;  ///< functions of it (readings × functions), not whitened
};
[[nodiscard]] std::vector<Variable> variables_of(const Observations& data);

/// Levels of the position along each measured line: what a variable shows, it shows beyond these (readings × levels).
/// Without those of the lines along which the variable is the position itself. @param variable  a name of
/// variables_of()
[[nodiscard]] Eigen::MatrixXd position_beside(const Observations& data, const std::string& variable);

/// A space with position_beside() absorbed, for one variable after the other: for most it is the same.
class BesidePosition {
 public:
  /// @param white  what is done to columns before they are absorbed
  BesidePosition(const Observations& data, Space space, std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> white)
      : data_(data), space_(std::move(space)), white_(std::move(white)) {}
  [[nodiscard]] const Space& of(const std::string& variable);

 private:
  const Observations& data_;
  Space space_;
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)> white_;
  std::map<std::string, Space> made_;  ///< by the position that is left out; "": by none
};

/// share_beyond_position() of a variable.
struct NamedShare {
  std::string variable;
  double share = 0.0;
};
/// Of all variables that are wanted, in the order of variables_of(); of large sets from an even choice of the readings.
[[nodiscard]] std::vector<NamedShare> shares_by_variable(
    const Observations& data, const Eigen::VectorXd& residual, double noise_um,
    const std::function<bool(const std::string&)>& is_wanted = [](const std::string&) { return true; });

/// Share of Σ r² of a residual [um or um/m, canonical order] that functions of a variable explain beyond what noise
/// does, and beyond the position along the measured line, 0 … 1.
[[nodiscard]] double share_beyond_position(const Observations& data, const Variable& variable,
                                           const Eigen::VectorXd& residual, double noise_um);

}  // namespace ecs::model
