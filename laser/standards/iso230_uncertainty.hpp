// Measurement uncertainty of the quantities of ISO 230-2, coverage factor 2 (ISO 230-2:2014 annex A, ISO/TR 230-9), on
// uncertainty budgets by the GUM (JCGM 100:2008): a function of inputs, linear and second-order propagation, effective
// degrees of freedom. Does not live here: the quantities (laser/analysis/iso230.hpp).
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "laser/analysis/iso230.hpp"

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

/// What is known of the measurement; 0: no contribution. A range is largest minus smallest possible value.
struct Iso230Conditions {
  double instrument_um_per_m = 0.0;            ///< expanded uncertainty (k = 2) of the calibrated instrument
  double instrument_um = 0.0;                  ///< its part that does not grow with the length, expanded
  double misalignment_mm = 0.0;                ///< lateral offset of beam and axis over the measured length
  double environment_um = 0.0;                 ///< E_VE: range of a drift test as long as the measurement
  double temperature_range_degC = 0.0;         ///< of the error of the machine's measured temperature
  double off_20_degC = 0.0;                    ///< the machine's temperature less 20 degC
  double expansion_um_per_m_degC = 11.7;       ///< with which lengths were brought to 20 degC
  double expansion_range_um_per_m_degC = 0.0;  ///< of the expansion coefficient
};

/// A contribution at the whole measured length, expanded.
struct UncertaintyPart {
  std::string name;
  double U_um = 0.0;
};

/// Expanded uncertainties (k = 2) in um; absent where the quantity is, or no condition contributes to it.
struct Iso230Uncertainty {
  double length_mm = 0.0;              ///< between the outermost targets
  std::vector<UncertaintyPart> parts;  ///< that are not 0; "environment" of a single reading
  std::optional<double> B, B_mean, M, E_forward, E_reverse, E, R_forward, R_reverse, R, A_forward, A_reverse, A;
};

/// Nothing for rotary axes and rotations, and where fewer than two targets were measured.
///
/// Rectangular distributions for ranges (U = 0.58 range). Instrument, cosine error offset²/2L, and temperature act in
/// proportion to the length, so on M, E and A whole, on B and R not. The environment acts on every reading
/// independently: with n runs from each side u(mean) = u/√n and u(s) = u/√(n − 1), so that U(R↑) = 2 U_EVE for n = 5.
/// The factors follow from the definitions of ISO 230-2 clause 3 by the GUM; the tables of annex A were not at hand.
[[nodiscard]] std::optional<Iso230Uncertainty> iso230_uncertainty_of(const Iso230& iso,
                                                                     const Iso230Conditions& conditions);

}  // namespace ecs::laser
