// Bending by the difference of two sensors: found with its size where the difference varies, not named where it does
// not.
#include "model/regression/candidates.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr double kBend_um_per_m2_degC = -6.0;

/// Straightness EY of X, bent by the difference of two sensors of the column; the front is warmed in waves of its own.
laser::MeasurementSet bent(bool difference_varies, double bend) {
  laser::MeasurementSet set;
  measure(set, {.sense = Sense::EY, .runs = 4}, 0.0, nothing);
  std::mt19937_64 random(5);
  NormalDraws noise(0.0, 0.4);
  for (Reading& r : set.readings) {
    const double back = 21.0 + 0.3 * std::sin(*r.time_s / 900.0);
    const double difference = difference_varies ? 1.5 + 1.2 * std::sin(*r.time_s / 500.0) : 1.5;
    r.sensors_degC = {{"t_back_degC", back}, {"t_front_degC", back + difference}};
    const double p_m = p(r) / 1000.0;
    r.error =
        2.0 + 1.5 * p_m - bend * p_m * p_m * difference + noise(random);  // front less back; by name, back comes first
  }
  return set;
}

EffectInstance thermal_bend() {
  EffectInstance bend = effect(effect_named("thermal_bend"), Axis::X, Sense::EY);
  bend.sensor = "t_back_degC";
  bend.sensor2 = "t_front_degC";
  return bend;
}

const Candidate* first_named(const Diagnosis& diagnosis) {
  for (const Candidate& candidate : diagnosis.candidates)
    if (candidate.named) return &candidate;
  return nullptr;
}

}  // namespace

TEST_CASE("a fit recovers the bending per degree of difference") {
  Model model = straight(Axis::X, Sense::EY);
  model.effects.push_back(thermal_bend());
  const auto result = must(fit(model, observations_of(bent(true, kBend_um_per_m2_degC), model, mill())));
  const ParameterEstimate& estimate = result.effects.back().parameters.at(0);
  CHECK(estimate.name == "um_per_m2_degC");
  CHECK(estimate.value == Approx(kBend_um_per_m2_degC).epsilon(0.05));
  REQUIRE(estimate.sigma);
  CHECK(std::abs(estimate.value - kBend_um_per_m2_degC) < 4.0 * *estimate.sigma);
  CHECK(result.rms_um < 0.5);
}

TEST_CASE("a diagnosis names the bending and its two sensors where their difference varies") {
  const Diagnosis diagnosis = diagnosed(straight(Axis::X, Sense::EY), bent(true, kBend_um_per_m2_degC));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  REQUIRE(first_named(diagnosis) != nullptr);
  const EffectInstance& effect = first_named(diagnosis)->effect;
  CHECK(to_text(effect) == "thermal_bend:X:EY");
  CHECK(sensors_text(effect) == "t_back_degC and t_front_degC");
}

TEST_CASE("a constant difference is no bending by temperature") {
  const auto set = bent(false, kBend_um_per_m2_degC);
  for (const EffectInstance& one : candidate_instances(observations_of(set, Model{}, mill())))
    CHECK(to_text(one) != "thermal_bend:X:EY");
  const Diagnosis diagnosis = diagnosed(straight(Axis::X, Sense::EY), set);
  REQUIRE(first_named(diagnosis) != nullptr);
  CHECK(to_text(first_named(diagnosis)->effect) != "thermal_bend:X:EY");
}

TEST_CASE("bending is sought across the moving axis only") {
  Plan along;
  auto set = measured(along, 0.5, nothing);
  for (Reading& r : set.readings) r.sensors_degC = {{"t_back_degC", 20.0}, {"t_front_degC", 20.0 + *r.time_s / 1000.0}};
  for (const EffectInstance& one : candidate_instances(observations_of(set, Model{}, mill())))
    if (one.id == effect_named("thermal_bend")) CHECK(one.axis != Axis::X);
}
