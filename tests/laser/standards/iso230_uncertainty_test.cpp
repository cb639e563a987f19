// GUM example H.1: the calibration of an end gauge of 50 mm (JCGM 100:2008, annex H.1), all numbers from there.
// Uncertainty of ISO 230-2 quantities, against numbers that a hand can check.
#include "laser/standards/iso230_uncertainty.hpp"

#include <numbers>

#include "core/axis.hpp"
#include "laser/groups.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

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
                                        {"theta cycle", 0.0, 0.5 / std::numbers::sqrt2},
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

using namespace ecs;

namespace {

/// Five bidirectional runs over 0, 250 … 1000 mm.
Iso230 metre() {
  MeasurementSet set;
  for (int run = 1; run <= 5; ++run)
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (int k = 0; k <= 4; ++k) {
        Reading reading{.position_mm = {250.0 * k, 0.0, 0.0},
                        .error = 0.1 * ((run * 3 + k) % 5) + (approach == Approach::forward ? 2.0 : 0.0),
                        .approach = approach,
                        .run = run};
        set.readings.push_back(reading);
      }
  return *iso230_of(set, groups_of(set).front());
}

Iso230Uncertainty with(const Iso230Conditions& conditions) { return *iso230_uncertainty_of(metre(), conditions); }

}  // namespace

TEST_CASE("an instrument of 1 um/m (k = 2) makes 1 um over a metre on M, E and A, and states none of B and R") {
  Iso230Conditions conditions;
  conditions.instrument_um_per_m = 1.0;
  const Iso230Uncertainty U = with(conditions);
  CHECK(U.length_mm == Approx(1000.0));
  CHECK(*U.M == Approx(1.0));
  CHECK(*U.E == Approx(1.0));
  CHECK(*U.A == Approx(1.0));
  CHECK_FALSE(U.B.has_value());  // not stated, rather than 0
  CHECK_FALSE(U.R.has_value());
}

TEST_CASE("a beam 4 mm aside over 1 m is a cosine range of 8 um: U = 8/sqrt(3) um") {
  Iso230Conditions conditions;
  conditions.misalignment_mm = 4.0;
  CHECK(*with(conditions).E == Approx(8.0 / std::sqrt(3.0)));
}

TEST_CASE("temperature: 1 degC of range at 12 um/m/degC; 2 um/m/degC of range at 25 degC") {
  Iso230Conditions conditions{.temperature_range_degC = 1.0, .expansion_um_per_m_degC = 12.0};
  CHECK(*with(conditions).A == Approx(12.0 / std::sqrt(3.0)));
  conditions = {};
  conditions.off_20_degC = 5.0;
  conditions.expansion_range_um_per_m_degC = 2.0;
  CHECK(*with(conditions).A == Approx(10.0 / std::sqrt(3.0)));
}

TEST_CASE("environment: with five runs U(R forward) is twice U of a reading, U(B) sqrt(2/5) of it") {
  Iso230Conditions conditions;
  conditions.environment_um = std::sqrt(3.0);  // U of a reading is 1
  const Iso230Uncertainty U = with(conditions);
  CHECK(*U.R_forward == Approx(2.0));
  CHECK(*U.B == Approx(std::sqrt(0.4)));
  CHECK(*U.E == Approx(std::sqrt(0.4)));
  CHECK(*U.A == Approx(std::sqrt(2.4)));
  CHECK(U.parts.size() == 1);
}

TEST_CASE("contributions add as squares; angles have none of this") {
  Iso230Conditions conditions{.instrument_um_per_m = 3.0, .instrument_um = 4.0};
  CHECK(*with(conditions).M == Approx(5.0));
  Iso230 turning = metre();
  turning.rotary = true;
  CHECK(!iso230_uncertainty_of(turning, conditions));
}
