// The effect library as physics.md section 4 words it: columns over the readings, and the limits of section 5.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/foreign/linear.hpp"
#include "bench/foreign/setup.hpp"

namespace foreign {

/// One effect at one place, with its numbers. The contribution is fixed(nonlinear) + Σ coefficient · column(nonlinear).
struct Term {
  std::string id;
  char axis = 'X';
  std::string sense;       ///< empty for angular, squareness and set_up_rotation
  std::string code;        ///< of angular, squareness, set_up_rotation and measurement_line
  int approach = 0;        ///< of cyclic: 0 both, 1 forward, -1 reverse
  std::string sensor;      ///< of thermal_drift and thermal_bend
  std::string sensor2;     ///< of thermal_bend
  double nonlinear = 0.0;  ///< period_mm, position_mm, tau_s, u0_mm or shift_mm
  std::vector<double> coefficients;
  bool given = false;  ///< of the base model: the model file states the parameters, they are not free
};

inline constexpr int kCurveColumns = 8;  ///< of s(p): Legendre degrees 2 to 9, ten with mean and slope
/// Of a progressive term in a base model: a program may let "about ten" degrees of freedom be a few more.
inline constexpr int kFreeCurveColumns = 12;

/// "cyclic:X:EX", as `indistinguishable_from` writes it.
[[nodiscard]] std::string name_of(const Term& term);
[[nodiscard]] bool has_nonlinear(const std::string& id);
/// Whether the contribution has no free size (map_shift, map_direction_swap) or one bound by nature (map_polarity).
[[nodiscard]] bool has_fixed_size(const std::string& id);

/// Lowest and highest coordinate of an axis in the set [mm].
[[nodiscard]] std::pair<double, double> span_of(const Setup& setup, char axis);

/// Columns of the term's linear coefficients; shape (coefficients × readings). A map_shift and a map_direction_swap
/// have one column whose coefficient is 1.
[[nodiscard]] std::vector<Column> columns_of(const Setup& setup, const Term& term);
/// What a base term takes when it is fitted: its columns, and the derivative by its nonlinear parameter.
[[nodiscard]] std::vector<Column> free_columns_of(const Setup& setup, const Term& term);
[[nodiscard]] Column contribution(const Setup& setup, const Term& term);
/// Derivative with respect to the nonlinear parameter, by central difference.
[[nodiscard]] Column nonlinear_derivative(const Setup& setup, const Term& term);

/// The scalar parameters under the names of model files; curves have none.
[[nodiscard]] std::map<std::string, double> parameters_of(const Setup& setup, const Term& term);

/// Values of the nonlinear parameter that physics.md 5 allows on these readings, fine enough to start a search; {0}
/// for effects without one.
[[nodiscard]] std::vector<double> nonlinear_grid(const Setup& setup, const Term& term);
/// Whether physics.md 5 lets this effect be a candidate on these readings.
[[nodiscard]] bool may_be_candidate(const Setup& setup, const Term& term);
/// Range of the one coefficient, infinite where nothing binds it.
[[nodiscard]] std::pair<double, double> coefficient_limits(const std::string& id);

/// Every effect at every place where these readings could show it; coefficients empty, nonlinear 0.
[[nodiscard]] std::vector<Term> library_of(const Setup& setup);

}  // namespace foreign
