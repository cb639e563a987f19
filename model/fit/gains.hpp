// What columns gain, from their products with each other and with what is left. Internal to model/ (Eigen).
// Does not live here: where the products come from (search.cpp, search_bank.cpp).
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "model/fit/search.hpp"

namespace ecs::model {

/// A column of which less than this share (of its square) is left is taken as absorbed: half the digits of a double.
inline constexpr double kAbsorbed = 1e-8;
/// The same in the single precision of the screening (2⁻²⁴ = 6e-8 for one product, summed over the readings).
inline constexpr double kAbsorbedScreening = 1e-5;

/// The same for periods: a wave that the targets see as (nearly) what is absorbed already has any amplitude.
/// A choice: a fiftieth of the square makes amplitudes sevenfold uncertain.
inline constexpr double kAbsorbedPeriod = 0.02;

/// What one set of columns gains, without saying which columns they are.
struct Gain {
  double gain = -1.0;  ///< fall of χ²; below 0: nothing is left of the columns
  double cost = 0.0;
  std::size_t parameters = 0;  ///< independent columns; of a wave all
  std::size_t variant = 0;     ///< place in the list of variants
  [[nodiscard]] double score() const { return gain - cost; }
};

/// Best of the variants by score: of a curve a leading set, else any, a single coefficient kept inside its physical
/// range.
/// @param gram      products of the columns, what is absorbed taken off (columns × columns), whitened
/// @param z         products with what is left
/// @param original  squares of the columns before anything was absorbed
[[nodiscard]] Gain best_gain(const Family& family, const std::vector<std::vector<Eigen::Index>>& variants,
                             const Eigen::Ref<const Eigen::MatrixXd>& gram, const Eigen::Ref<const Eigen::VectorXd>& z,
                             const Eigen::Ref<const Eigen::VectorXd>& original, double absorbed, Price price);

/// The same as a choice, its family and nonlinear parameter still to be set.
[[nodiscard]] Choice choice_of(const Gain& gain, const std::vector<std::vector<Eigen::Index>>& variants);

}  // namespace ecs::model
