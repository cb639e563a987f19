// What compensation would leave, in two sums: what the machine keeps, and what belongs to the measurement.
#include <cmath>

#include <doctest/doctest.h>

#include "model/diagnosis/ladder.hpp"
#include "tests/model/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using doctest::Approx;

TEST_CASE("a drift of the readout belongs to the measurement, a drift with temperature to the machine") {
  Model model = straight();
  model.effects.push_back(effect(time_drift, Axis::X, Sense::EX));
  EffectInstance growth = effect(thermal_drift, Axis::X, Sense::EX);
  growth.sensor = "t_material_degC";
  model.effects.push_back(growth);
  const auto set = measured({}, 0.0, [](const laser::Reading& r) {
    return 40.0 * p(r) / 1000.0 + 5.0 * *r.time_s / 3600.0 + 2.0 * (r.sensors_degC.at("t_material_degC") - 20.0);
  });
  const Observations data = observations_of(set, model, mill());
  const auto what = what_if(model, data);
  REQUIRE(what);
  double machine = 0.0;
  for (const WhatIf::Share& share : what->shares) {
    const EffectId id = effect_named(share.effect.substr(0, share.effect.find(':')));
    CHECK(share.of_measurement == (id == time_drift));
    CHECK(share.carried == (id == offset || id == scale));
    if (id == thermal_drift) machine = share.rms_um;
    if (id == time_drift) CHECK(what->measurement_um == Approx(share.rms_um));
  }
  CHECK(what->machine_um == Approx(machine).epsilon(1e-3));  // no noise in these readings
  CHECK(what->measurement_um > 0.5);
  CHECK(what->rms_after_um < what->rms_now_um);
}

TEST_CASE("without an effect of the measurement the machine keeps all that is left") {
  const Model model = straight();
  const auto set = measured({}, kNoise_um, [](const laser::Reading& r) { return 40.0 * p(r) / 1000.0; });
  const auto what = what_if(model, observations_of(set, model, mill()));
  REQUIRE(what);
  CHECK(what->measurement_um == 0.0);
  CHECK(what->machine_um == Approx(what->rms_after_um));
  CHECK(what->machine_um == Approx(kNoise_um).epsilon(0.2));
}
