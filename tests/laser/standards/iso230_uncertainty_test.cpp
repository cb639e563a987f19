// Uncertainty of ISO 230-2 quantities, against numbers that a hand can check.
#include "laser/standards/iso230_uncertainty.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "core/axis.hpp"
#include "laser/groups.hpp"

using namespace ecs;
using namespace ecs::laser;
using doctest::Approx;

namespace {

/// Five bidirectional runs over 0, 250 … 1000 mm.
Iso230 metre() {
  MeasurementSet set;
  for (int run = 1; run <= 5; ++run)
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (int k = 0; k <= 4; ++k) {
        Reading reading;
        reading.position_mm = {250.0 * k, 0.0, 0.0};
        reading.error = 0.1 * ((run * 3 + k) % 5) + (approach == Approach::forward ? 2.0 : 0.0);
        reading.approach = approach;
        reading.run = run;
        set.readings.push_back(reading);
      }
  return *iso230_of(set, groups_of(set).front());
}

Iso230Uncertainty with(const Iso230Conditions& conditions) { return *iso230_uncertainty_of(metre(), conditions); }

}  // namespace

TEST_CASE("an instrument of 1 um/m (k = 2) makes 1 um over a metre on M, E and A, nothing on B and R") {
  Iso230Conditions conditions;
  conditions.instrument_um_per_m = 1.0;
  const Iso230Uncertainty U = with(conditions);
  CHECK(U.length_mm == Approx(1000.0));
  CHECK(*U.M == Approx(1.0));
  CHECK(*U.E == Approx(1.0));
  CHECK(*U.A == Approx(1.0));
  CHECK(*U.B == 0.0);
  CHECK(*U.R == 0.0);
}

TEST_CASE("a beam 4 mm aside over 1 m is a cosine range of 8 um: U = 8/sqrt(3) um") {
  Iso230Conditions conditions;
  conditions.misalignment_mm = 4.0;
  CHECK(*with(conditions).E == Approx(8.0 / std::sqrt(3.0)));
}

TEST_CASE("temperature: 1 degC of range at 12 um/m/degC; 2 um/m/degC of range at 25 degC") {
  Iso230Conditions conditions;
  conditions.temperature_range_degC = 1.0;
  conditions.expansion_um_per_m_degC = 12.0;
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
  Iso230Conditions conditions;
  conditions.instrument_um_per_m = 3.0;
  conditions.instrument_um = 4.0;
  CHECK(*with(conditions).M == Approx(5.0));
  Iso230 turning = metre();
  turning.rotary = true;
  CHECK(!iso230_uncertainty_of(turning, conditions));
}
