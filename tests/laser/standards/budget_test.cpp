// GUM example H.1: the calibration of an end gauge of 50 mm (JCGM 100:2008, annex H.1), all numbers from there.
#include "laser/standards/budget.hpp"

#include <cmath>

#include <doctest/doctest.h>

using namespace ecs::laser;
using doctest::Approx;

namespace {

/// l = l_s + d − l_s (δα θ + α_s δθ), lengths in nm (H.1.2). d is the mean of observations with the comparator's random
/// and systematic effects; θ is the mean temperature and its cycle.
Budget end_gauge() {
  const std::vector<BudgetInput> inputs{{"l_s", 50'000'623.0, 25.0, 18},
                                        {"d", 215.0, 5.8, 24},
                                        {"d random", 0.0, 3.9, 5},
                                        {"d systematic", 0.0, 6.7, 8},
                                        {"alpha_s", 11.5e-6, u_of_range(4e-6)},
                                        {"theta mean", -0.1, 0.2},
                                        {"theta cycle", 0.0, u_of_cycle(0.5)},
                                        {"delta alpha", 0.0, u_of_range(2e-6), 50},
                                        {"delta theta", 0.0, u_of_range(0.1), 2}};
  return budget_of(
      [](std::span<const double> x) { return x[0] + x[1] + x[2] + x[3] - x[0] * (x[7] * (x[5] + x[6]) + x[4] * x[8]); },
      inputs);
}

}  // namespace

TEST_CASE("GUM H.1: the end gauge is 50 000 838 nm long, standard uncertainty 32 nm, 16 degrees of freedom") {
  const Budget budget = end_gauge();
  CHECK(budget.value == Approx(50'000'838.0).epsilon(1e-12));
  CHECK(std::round(budget.u) == 32.0);
  CHECK(std::floor(budget.effective_degrees_of_freedom) == 16.0);
}

TEST_CASE("GUM H.1: the lines of its budget") {
  const Budget budget = end_gauge();
  CHECK(budget.lines[0].u == Approx(25.0));
  CHECK(std::sqrt(std::pow(budget.lines[1].u, 2) + std::pow(budget.lines[2].u, 2) + std::pow(budget.lines[3].u, 2)) ==
        Approx(9.7).epsilon(0.01));
  CHECK(budget.lines[4].u < 1e-6);  // alpha_s and theta have no part in the first order
  CHECK(budget.lines[5].u < 1e-6);
  CHECK(budget.lines[7].u == Approx(2.9).epsilon(0.01));
  CHECK(budget.lines[8].u == Approx(16.6).epsilon(0.01));
}

TEST_CASE("GUM H.1.7: the second-order terms make it 34 nm") {
  const Budget budget = end_gauge();
  CHECK(std::round(budget.u_second_order) == 34.0);
  CHECK(budget.u_second_order * budget.u_second_order - budget.u * budget.u ==
        Approx(11.7 * 11.7 + 1.7 * 1.7).epsilon(0.01));
}

TEST_CASE("second-order terms of x squared about 0: u(x^2) = sqrt(2) u^2") {
  const Budget budget = budget_of([](std::span<const double> x) { return x[0] * x[0]; }, {{"x", 0.0, 0.5}});
  CHECK(budget.u == Approx(0.0));
  CHECK(budget.u_second_order == Approx(0.25 * std::sqrt(2.0)));
}
