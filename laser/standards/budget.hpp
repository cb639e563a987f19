// Uncertainty budgets by the GUM (JCGM 100:2008): a function of inputs, linear and second-order propagation, effective
// degrees of freedom. Does not live here: which inputs a test has (iso230_uncertainty.hpp).
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace ecs::laser {

/// Degrees of freedom of an uncertainty that is known exactly.
inline constexpr double kExactlyKnown = std::numeric_limits<double>::infinity();
/// Coverage factor of the ISO 230 series: about 95 % (GUM 6.2).
inline constexpr double kCoverage = 2.0;

/// An input quantity, independent of the others. All inputs in one system of units.
struct BudgetInput {
  std::string name;
  double estimate = 0.0;
  double u = 0.0;                             ///< standard uncertainty
  double degrees_of_freedom = kExactlyKnown;  ///< above 0
};

/// Standard uncertainty of a rectangular distribution of that width: width/√12 (GUM 4.3.7).
[[nodiscard]] double u_of_range(double width);
/// Standard uncertainty of a U-shaped (arcsine) distribution of that half width: half/√2, of a cyclic temperature.
[[nodiscard]] double u_of_cycle(double half_width);

struct BudgetLine {
  std::string name;
  double sensitivity = 0.0;  ///< ∂f/∂x_i
  double u = 0.0;            ///< |∂f/∂x_i| u(x_i), in the unit of the result
  double degrees_of_freedom = kExactlyKnown;
};

struct Budget {
  double value = 0.0;
  std::vector<BudgetLine> lines;                        ///< in the order of the inputs
  double u = 0.0;                                       ///< combined standard uncertainty, linear (GUM eq. 10)
  double u_second_order = 0.0;                          ///< with the terms of GUM 5.1.2, note
  double effective_degrees_of_freedom = kExactlyKnown;  ///< Welch-Satterthwaite (GUM eq. G.2b), of the linear terms
  [[nodiscard]] double expanded() const { return kCoverage * u; }
};

using BudgetFunction = std::function<double(std::span<const double>)>;

/// Derivatives are taken by central differences at a third of u(x_i), exact for polynomials of second degree in each
/// input. An input with u = 0 is a constant.
[[nodiscard]] Budget budget_of(const BudgetFunction& f, const std::vector<BudgetInput>& inputs);

}  // namespace ecs::laser
