// What columns gain, from their products with each other and with what is left. Internal to model/ (Eigen).
// Does not live here: where the products come from (search.cpp, search_bank.cpp).
#pragma once

#include <functional>
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

/// Price of using so many independent columns.
using CostOf = std::function<double(std::size_t)>;

/// Best choice of columns of a family by score: the best leading set of a curve, else the best of the variants, a
/// single coefficient kept inside its physical range. Gain below 0 where nothing is left of the columns.
/// @param gram      products of the columns, what is absorbed taken off (columns × columns), whitened
/// @param z         products with what is left
/// @param original  squares of the columns before anything was absorbed
[[nodiscard]] Choice best_choice(const Family& family, const std::vector<std::vector<Eigen::Index>>& variants,
                                 const Eigen::MatrixXd& gram, const Eigen::VectorXd& z, const Eigen::VectorXd& original,
                                 double absorbed, const CostOf& cost);

}  // namespace ecs::model
