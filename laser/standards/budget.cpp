// Propagation by the GUM, 5.1.2 with its note on second-order terms, and Welch-Satterthwaite, G.4.1.
#include "laser/standards/budget.hpp"

#include <algorithm>
#include <cmath>

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
double u_of_cycle(double half_width) { return std::abs(half_width) / std::sqrt(2.0); }

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

}  // namespace ecs::laser
