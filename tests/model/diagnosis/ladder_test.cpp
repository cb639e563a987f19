// What compensation would leave, in two sums: what the machine keeps, and what belongs to the measurement. A tie that
// former readings left open: new ones rule alternatives out, speak for one of them, or say nothing.
#include "model/diagnosis/ladder.hpp"

#include "model/fit/model_file.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

TEST_CASE("a drift of the readout belongs to the measurement, a drift with temperature to the machine") {
  Model model = straight();
  model.effects.push_back(effect(time_drift, Axis::X, Sense::EX));
  EffectInstance growth = effect(thermal_drift, Axis::X, Sense::EX);
  growth.sensor = "t_material_degC";
  model.effects.push_back(growth);
  const auto set = measured({}, 0.0, [](const Reading& r) {
    return 40.0 * p(r) / 1000.0 + 5.0 * *r.time_s / 3600.0 + 2.0 * (r.sensors_degC.at("t_material_degC") - 20.0);
  });
  const Observations data = observations_of(set, model, mill());
  const auto what = must(what_if(model, data));
  double machine = 0.0;
  for (const WhatIf::Share& share : what.shares) {
    const EffectId id = effect_named(share.effect.substr(0, share.effect.find(':')));
    CHECK(share.of_measurement == (id == time_drift));
    CHECK(share.carried == (id == offset || id == scale));
    if (id == thermal_drift) machine = share.rms_um;
    if (id == time_drift) CHECK(what.measurement_um == Approx(share.rms_um));
  }
  CHECK(what.machine_um == Approx(machine).epsilon(1e-3));  // no noise in these readings
  CHECK(what.measurement_um > 0.5);
  CHECK(what.rms_after_um < what.rms_now_um);
}

TEST_CASE("a wave keeps the periods that even targets cannot distinguish from its own, until other targets do") {
  const auto wave = [](const Reading& r) { return 5.0 * std::sin(2.0 * std::numbers::pi * p(r) / 170.0); };
  const auto added_to = [&](const laser::MeasurementSet& set) {
    return must(add_effect(straight(), observations_of(set, straight(), mill()), must(parse_add_request("cyclic:X:EX")),
                           "data.csv"))
        .model;
  };
  const laser::MeasurementSet uneven = measured({}, kNoise_um, wave);
  laser::MeasurementSet even = uneven;
  for (Reading& r : even.readings) {
    r.error -= wave(r);
    r.position_mm[0] = 25.0 * std::round(r.position_mm[0] / 25.0);
    r.error += wave(r);
  }
  const Model model = added_to(even);
  const std::string tied = model.effects.back().tied_with;
  CHECK(tied.starts_with("cyclic:X:EX@"));
  CHECK(contains(to_toml(model), "# or " + tied));
  CHECK(must(decided_ties(model, observations_of(even, model, mill()))).model.effects.back().tied_with == tied);
  const auto decided = must(decided_ties(model, observations_of(uneven, model, mill())));
  CHECK(decided.model.effects.back().tied_with.empty());
  CHECK(contains(decided.notes.front(), "these readings rule out " + tied));
  CHECK(added_to(uneven).effects.back().tied_with.empty());
}

TEST_CASE("without an effect of the measurement the machine keeps all that is left") {
  const Model model = straight();
  const auto set = measured({}, kNoise_um, [](const Reading& r) { return 40.0 * p(r) / 1000.0; });
  const auto what = must(what_if(model, observations_of(set, model, mill())));
  CHECK(what.measurement_um == 0.0);
  CHECK(what.machine_um == Approx(what.rms_after_um));
  CHECK(what.machine_um == Approx(kNoise_um).epsilon(0.2));
}

namespace {

/// Offset, scale and a backlash that could be a following error as well.
Model backlash_or_lag() {
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  model.effects.back().tied_with = "servo_lag:X:EX";
  return model;
}

/// Readings on the fly; the third run at `last_feed_mm_min`, the others at 2,000 mm/min.
Observations at_feeds(const Model& model, double last_feed_mm_min, const Truth& truth) {
  const auto set = session({}, truth, [&](Reading& r) { r.feed_mm_min = r.run == 3 ? last_feed_mm_min : 2000.0; });
  return observations_of(set, model, mill());
}

double lost_motion(const Reading& r) { return 2.0 * d(r); }
double following_error(const Reading& r) { return 1e-3 * *r.feed_mm_min * d(r); }

}  // namespace

TEST_CASE("readings at one feed leave backlash and following error tied") {
  const Model model = backlash_or_lag();
  const auto decided = must(decided_ties(model, at_feeds(model, 2000.0, lost_motion)));
  CHECK(decided.notes.empty());
  CHECK(decided.model.effects.back().tied_with == "servo_lag:X:EX");
}

TEST_CASE("readings at two feeds rule the following error out where the reversal stays the same") {
  const Model model = backlash_or_lag();
  const auto decided = must(decided_ties(model, at_feeds(model, 500.0, lost_motion)));
  CHECK(only(decided.notes) == "these readings rule out servo_lag:X:EX: it is backlash:X:EX");
  CHECK(decided.model.effects.back().tied_with.empty());
}

TEST_CASE("an alternative that fits better is told, and the model stays as it is") {
  const Model model = backlash_or_lag();
  const auto decided = must(decided_ties(model, at_feeds(model, 500.0, following_error)));
  CHECK(only(decided.notes) ==
        "these readings favour servo_lag:X:EX over backlash:X:EX: remove backlash:X:EX, then add it");
  CHECK(decided.model.effects == model.effects);
}

TEST_CASE("an effect is requested by the name with which answers state it, with its approach and sensors") {
  const AddRequest drift = must(parse_add_request("thermal_drift:X:EX with t_bed_degC"));
  CHECK(drift.sensor == "t_bed_degC");
  CHECK_FALSE(drift.approach);
  const AddRequest bend = must(parse_add_request("thermal_bend:X:EY, reverse with t_a_degC and t_b_degC"));
  CHECK(bend.approach == ApproachMode::reverse);
  CHECK(bend.sensor == "t_a_degC");
  CHECK(bend.sensor2 == "t_b_degC");
  CHECK(contains(must_fail(parse_add_request("cyclic:X:EX, backwards")).message, "forward or reverse"));
  CHECK(must(parse_add_request("user:play, with slack")).name == "play, with slack");
  CHECK(alternatives_in("cyclic:X:EX, reverse, thermal_drift:X:EX with t_bed_degC, scale:X:EX") ==
        std::vector<std::string>{"cyclic:X:EX, reverse", "thermal_drift:X:EX with t_bed_degC", "scale:X:EX"});
}

TEST_CASE("of several alternatives those that are ruled out go, with approach and sensor in their names") {
  Model model = backlash_or_lag();
  model.effects.back().tied_with =
      "servo_lag:X:EX, sag:X:EX, cyclic:X:EX, reverse, thermal_drift:X:EX with t_no_such_degC";
  const auto decided = must(decided_ties(model, at_feeds(model, 500.0, lost_motion)));
  // a wave of the reverse readings alone, longer than the line, is a backlash; a sensor that is not there shows nothing
  CHECK(decided.model.effects.back().tied_with == "cyclic:X:EX, reverse, thermal_drift:X:EX with t_no_such_degC");
}

TEST_CASE("a model without ties is returned as it is") {
  const Model model = straight();
  const auto decided = must(decided_ties(model, at_feeds(model, 500.0, lost_motion)));
  CHECK(decided.notes.empty());
  CHECK(decided.model.effects == model.effects);
}
