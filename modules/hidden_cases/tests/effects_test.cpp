// An artefact set up turned, and a bed bent by the difference of two temperatures: the errors file, and the hidden case
// that asks for it.
#include <nlohmann/json.hpp>

#include "modules/hidden_cases/tests/hidden_cases.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

std::string turned(const std::string& keys) {
  return "[[effect]]\nid = 'set_up_rotation'\n" + keys + "\nparameters = { um_per_m = 40 }\n";
}

}  // namespace

TEST_CASE("a turned set-up gives each axis of the plane a straightness in the direction of the other") {
  const TrueErrors errors = errors_of(turned("code = 'EB'"));
  MachineState state;
  state.position_mm = {500.0, 300.0, -250.0};
  const ComponentValues values = errors.at(state);
  CHECK(values[index_of(Component::EZX)] == Approx(-40.0 * 0.5));
  CHECK(values[index_of(Component::EXZ)] == Approx(40.0 * -0.25));
  CHECK(values[index_of(Component::EXX)] == 0.0);
  CHECK(values[index_of(Component::EYX)] == 0.0);
}

TEST_CASE("a turned set-up has a code EA, EB or EC and no place besides") {
  const auto refusal = [](const std::string& keys) {
    return to_text(must_fail(TrueErrors::parse(turned(keys), "errors.toml", ".")));
  };
  CHECK(contains(refusal("code = 'ECX'"), "code: expected EA, EB or EC"));
  CHECK(contains(refusal(""), "code: expected EA, EB or EC"));
  CHECK(contains(refusal("code = 'EC'\naxis = 'X'"), "axis: set_up_rotation has a code alone"));
}

TEST_CASE("a turned set-up is hidden where asked for, in both senses of its plane") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    CAPTURE(seed);
    const HiddenCase c = case_of(request_for(seed, CaseKind::single, "set_up_rotation"));
    const PlacedEffect& effect = c.hidden.at(0).effect;
    const Axis about = direction_of(*effect.sense);
    const auto one = static_cast<Axis>((index_of(about) + 1) % kAxes);
    const auto other = static_cast<Axis>((index_of(about) + 2) % kAxes);
    const auto values = contribution(c.scene, effect);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Stop& stop = c.scene.stops[k];
      const double c_um_per_mm = effect.parameters.at("um_per_m") / 1000.0;
      double expected = 0.0;
      if (stop.sense == static_cast<Sense>(one)) expected = -c_um_per_mm * c.scene.p_mm(stop, other);
      if (stop.sense == static_cast<Sense>(other)) expected = c_um_per_mm * c.scene.p_mm(stop, one);
      REQUIRE(values[k] == Approx(expected));
    }
    const auto truth = nlohmann::json::parse(truth_of(c));
    CHECK(truth["effects"][0]["name"] == name_of(effect));
    CHECK(truth["effects"][0]["code"] == name_of(*effect.sense));
    CHECK(truth["effects"][0]["sense"].is_null());
  }
}

namespace {

const std::string kTemperatures = "[temperature]\ntop = '26 + t/3600'\nfoot = '21'\n";

std::string bend(const std::string& keys) {
  return "[[effect]]\nid = 'thermal_bend'\n" + keys + "\nparameters = { um_per_m2_degC = 2 }\n" + kTemperatures;
}

std::string refusal(const std::string& text) { return to_text(must_fail(TrueErrors::parse(text, "errors.toml", "."))); }

}  // namespace

TEST_CASE("a bed bends with the square of the position and the difference of two temperatures") {
  TrueErrors errors = errors_of(bend("axis = 'X'\nsense = 'EZ'\nsensor = 'top'\nsensor2 = 't_foot_degC'"));
  MachinePlace place;
  place.datum_mm = {-100.0, 0.0, 0.0};
  errors.put_on(place);
  MachineState state;
  state.position_mm = {1400.0, 0.0, 0.0};  // 1.5 m from the datum
  CHECK(errors.at(state)[index_of(Component::EZX)] == Approx(2.0 * 2.25 * 5.0));
  state.time_s = 7200.0;
  CHECK(errors.at(state)[index_of(Component::EZX)] == Approx(2.0 * 2.25 * 7.0));
  CHECK(errors.at(state)[index_of(Component::EXX)] == 0.0);
}

TEST_CASE("a thermal bend needs a sense across its axis and two sensors") {
  const std::string sensors = "\nsensor = 'top'\nsensor2 = 'foot'";
  CHECK(contains(refusal(bend("axis = 'X'\nsense = 'EX'" + sensors)), "sense: thermal_bend acts across its axis"));
  CHECK(contains(refusal(bend("axis = 'X'\nsense = 'EB'" + sensors)), "sense: thermal_bend acts across its axis"));
  CHECK(contains(refusal(bend("sense = 'EY'" + sensors)), "axis: expected X, Y or Z"));
  CHECK(contains(refusal(bend("axis = 'X'\nsense = 'EY'\nsensor = 'top'")), "sensor2: expected a sensor"));
}

TEST_CASE("a thermal bend is hidden where asked for, as its formula says, and drawn nowhere else") {
  const auto& drawn = drawn_effects();
  CHECK(std::find(drawn.begin(), drawn.end(), effect_named("thermal_bend")) == drawn.end());
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    CAPTURE(seed);
    const HiddenCase c = case_of(request_for(seed, CaseKind::single, "thermal_bend"));
    const PlacedEffect& effect = c.hidden.at(0).effect;
    CHECK(effect.sensor != effect.sensor2);
    CHECK(static_cast<std::size_t>(*effect.sense) != index_of(*effect.axis));
    const auto values = contribution(c.scene, effect);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Stop& stop = c.scene.stops[k];
      const double p_m = c.scene.p_mm(stop, *effect.axis) * 1e-3;
      const double difference_degC =
          stop.weather.degC[*c.scene.sensor(effect.sensor)] - stop.weather.degC[*c.scene.sensor(effect.sensor2)];
      const double expected =
          stop.sense == *effect.sense ? effect.parameters.at("um_per_m2_degC") * p_m * p_m * difference_degC : 0.0;
      REQUIRE(values[k] == Approx(expected));
    }
    const auto truth = nlohmann::json::parse(truth_of(c));
    CHECK(truth["effects"][0]["name"] == name_of(effect));
    CHECK(truth["effects"][0]["sensor2"] == effect.sensor2);
  }
}
