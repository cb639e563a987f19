// Propagation by the GUM, 5.1.2 with its note on second-order terms, and Welch-Satterthwaite, G.4.1. Each quantity of
// ISO 230-2 as a function of instrument, alignment, temperature and environment.
#include "laser/standards/iso230_uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"

namespace ecs::laser {
namespace {

/// Steps of the differences as a share of u: small against curvature, large against the digits of a double.
constexpr double kShareOfU = 1.0 / 3.0;

/// The function and its differences about the estimates.
class AboutEstimates {
 public:
  AboutEstimates(const BudgetFunction& f, const std::vector<BudgetInput>& inputs) : f_(f) {
    for (const BudgetInput& input : inputs) {
      at_.push_back(input.estimate);
      step_.push_back(kShareOfU * input.u);
    }
  }

  [[nodiscard]] double value() const { return f_(at_); }
  [[nodiscard]] double step(std::size_t i) const { return step_[i]; }
  /// ∂f/∂x_i, with x_j moved by `moved` steps.
  [[nodiscard]] double slope(std::size_t i, std::size_t j = 0, double moved = 0.0) const {
    return (at(i, 1.0, j, moved) - at(i, -1.0, j, moved)) / (2.0 * step_[i]);
  }
  /// ∂²f/∂x_i∂x_j
  [[nodiscard]] double mixed(std::size_t i, std::size_t j) const {
    if (i == j) return (at(i, 1.0, i, 0.0) - 2.0 * value() + at(i, -1.0, i, 0.0)) / (step_[i] * step_[i]);
    return (slope(i, j, 1.0) - slope(i, j, -1.0)) / (2.0 * step_[j]);
  }
  /// ∂³f/∂x_i∂x_j²
  [[nodiscard]] double third(std::size_t i, std::size_t j) const {
    if (i == j)
      return (at(i, 2.0, i, 0.0) - 2.0 * at(i, 1.0, i, 0.0) + 2.0 * at(i, -1.0, i, 0.0) - at(i, -2.0, i, 0.0)) /
             (2.0 * std::pow(step_[i], 3.0));
    return (slope(i, j, 1.0) - 2.0 * slope(i) + slope(i, j, -1.0)) / (step_[j] * step_[j]);
  }

 private:
  [[nodiscard]] double at(std::size_t i, double by_i, std::size_t j, double by_j) const {
    std::vector<double> place = at_;
    place[i] += by_i * step_[i];
    place[j] += by_j * step_[j];
    return f_(place);
  }

  const BudgetFunction& f_;
  std::vector<double> at_, step_;
};

}  // namespace

double u_of_range(double width) { return std::abs(width) / std::sqrt(12.0); }

Budget budget_of(const BudgetFunction& f, const std::vector<BudgetInput>& inputs) {
  const AboutEstimates about(f, inputs);
  Budget budget;
  budget.value = about.value();
  double first = 0.0, second = 0.0, per_freedom = 0.0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double sensitivity = inputs[i].u > 0.0 ? about.slope(i) : 0.0;
    const double u = std::abs(sensitivity) * inputs[i].u;
    budget.lines.push_back({inputs[i].name, sensitivity, u, inputs[i].degrees_of_freedom});
    first += u * u;
    per_freedom += std::pow(u, 4.0) / inputs[i].degrees_of_freedom;
    for (std::size_t j = 0; j < inputs.size() && inputs[i].u > 0.0; ++j) {
      if (inputs[j].u <= 0.0) continue;
      const double mixed = about.mixed(i, j);
      second += (0.5 * mixed * mixed + sensitivity * about.third(i, j)) * std::pow(inputs[i].u * inputs[j].u, 2.0);
    }
  }
  budget.u = std::sqrt(first);
  budget.u_second_order = std::sqrt(std::max(0.0, first + second));
  if (per_freedom > 0.0) budget.effective_degrees_of_freedom = std::pow(budget.u, 4.0) / per_freedom;
  return budget;
}

namespace {

/// Contributions in um at the whole length; the environment at a single reading.
std::vector<BudgetInput> inputs_of(const Iso230Conditions& c, double length_mm) {
  const double length_m = length_mm / kMmPerM;
  const double cosine_um = c.misalignment_mm * c.misalignment_mm / (2.0 * length_mm) * kUmPerMm;
  return {
      {"instrument, length-proportional part", 0.0, c.instrument_um_per_m / kCoverage * length_m},
      {"instrument, constant part", 0.0, c.instrument_um / kCoverage},
      {"misalignment", 0.0, u_of_range(cosine_um)},
      {"temperature of the machine", 0.0, u_of_range(c.temperature_range_degC) * c.expansion_um_per_m_degC * length_m},
      {"expansion coefficient", 0.0, u_of_range(c.expansion_range_um_per_m_degC) * std::abs(c.off_20_degC) * length_m},
      {"environment", 0.0, u_of_range(c.environment_um)}};
}

/// @param of_length  share of what grows with the length  @param readings  factor of a single reading's uncertainty
double expanded(const std::vector<BudgetInput>& inputs, double of_length, double readings) {
  const auto f = [&](std::span<const double> x) {
    double sum = readings * x.back();
    for (std::size_t i = 0; i + 1 < x.size(); ++i) sum += of_length * x[i];
    return sum;
  };
  return budget_of(f, inputs).expanded();
}

/// Fewest readings of a target from that side, of those that repeat there; 1 where none does.
double fewest(const Iso230& iso, int Iso230Target::*count) {
  int n = 0;
  for (const Iso230Target& target : iso.targets)
    if (target.*count > 1) n = n == 0 ? target.*count : std::min(n, target.*count);
  return static_cast<double>(std::max(n, 1));
}

}  // namespace

std::optional<Iso230Uncertainty> iso230_uncertainty_of(const Iso230& iso, const Iso230Conditions& conditions) {
  if (iso.rotary || is_rotation(iso.sense) || iso.targets.size() < 2) return std::nullopt;
  Iso230Uncertainty result;
  result.length_mm = iso.targets.back().position_mm - iso.targets.front().position_mm;
  const auto inputs = inputs_of(conditions, result.length_mm);
  for (const BudgetInput& input : inputs)
    if (input.u > 0.0) result.parts.push_back({input.name, kCoverage * input.u});
  const double n_forward = fewest(iso, &Iso230Target::n_forward), n_reverse = fewest(iso, &Iso230Target::n_reverse);
  const auto give = [&](std::optional<double>& U, const std::optional<double>& value, double of_length,
                        double variance) {
    if (!value || !std::isfinite(variance)) return;
    if (const double stated = expanded(inputs, of_length, std::sqrt(variance)); stated > 0.0) U = stated;
  };
  // Variances in those of a single reading: of a mean, and of the standard deviation of n readings.
  const double mean_f = 1.0 / n_forward, mean_r = 1.0 / n_reverse;
  const double s_f = 1.0 / (n_forward - 1.0), s_r = 1.0 / (n_reverse - 1.0);
  const double worst_mean = std::max(mean_f, mean_r), worst_end = std::max(mean_f + 4.0 * s_f, mean_r + 4.0 * s_r);
  give(result.B, iso.B, 0.0, mean_f + mean_r);
  give(result.B_mean, iso.B_mean, 0.0, (mean_f + mean_r) / static_cast<double>(iso.targets.size()));
  give(result.M, iso.M, 1.0, (mean_f + mean_r) / 2.0);
  give(result.E_forward, iso.E_forward, 1.0, 2.0 * mean_f);
  give(result.E_reverse, iso.E_reverse, 1.0, 2.0 * mean_r);
  give(result.E, iso.E, 1.0, 2.0 * worst_mean);
  give(result.R_forward, iso.R_forward, 0.0, 16.0 * s_f);
  give(result.R_reverse, iso.R_reverse, 0.0, 16.0 * s_r);
  give(result.R, iso.R, 0.0, std::max({4.0 * s_f + 4.0 * s_r + mean_f + mean_r, 16.0 * s_f, 16.0 * s_r}));
  give(result.A_forward, iso.A_forward, 1.0, 2.0 * (mean_f + 4.0 * s_f));
  give(result.A_reverse, iso.A_reverse, 1.0, 2.0 * (mean_r + 4.0 * s_r));
  give(result.A, iso.A, 1.0, 2.0 * worst_end);
  return result;
}

}  // namespace ecs::laser
