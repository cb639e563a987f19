// [[effect]] tables: each against its formula in docs/physics.md, worked out by hand; the list of effects, walked: what
// every definition owes to errors files.
#include <set>

#include <fmt/format.h>

#include "ecs_emulator/effects/effects.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Value of a component with one effect, the datum at −100 on every axis.
double value(const std::string& effect, Component component, const MachineState& state) {
  TrueErrors errors = errors_of("[[effect]]\n" + effect);
  MachinePlace place;
  place.datum_mm = {-100.0, -100.0, -100.0};
  errors.put_on(place);
  return errors.at(state)[index_of(component)];
}

MachineState at_p(double from_datum_mm, Approach approach = Approach::forward) {
  MachineState state;
  state.position_mm = {from_datum_mm - 100.0, 7.0, 9.0};
  state.approach[0] = approach;
  return state;
}

}  // namespace

TEST_CASE("effects of position count from the datum of their axis") {
  CHECK(value("id='offset'\nsense='EX'\nparameters={um=3}", Component::EXX, at_p(500)) == 3.0);
  CHECK(value("id='offset'\nsense='EZ'\naxis='X'\nparameters={um=3}", Component::EZX, at_p(500)) == 3.0);
  CHECK(value("id='scale'\naxis='X'\nparameters={um_per_m=10}", Component::EXX, at_p(500)) == Approx(5.0));
  CHECK(value("id='sag'\naxis='X'\nsense='EY'\nparameters={k2=-8, k3=4}", Component::EYX, at_p(-500)) ==
        Approx(-8.0 * 0.25 + 4.0 * 0.125));
  const std::string step = "id='step'\naxis='X'\nparameters={height_um=2, position_mm=40}";
  CHECK(value(step, Component::EXX, at_p(40)) == 0.0);
  CHECK(value(step, Component::EXX, at_p(41)) == 2.0);
}

TEST_CASE("a cyclic error has two harmonics and may belong to one approach") {
  const std::string cyclic = R"(id = "cyclic"
axis = "X"
sense = "EX"
parameters = { period_mm = 8.0, amplitude_um = 3.0, phase_rad = 0.5, amplitude2_um = 1.0, phase2_rad = -0.2 }
)";
  const double turn = 2.0 * 3.14159265358979 * 13.0 / 8.0;
  const double expected = 3.0 * std::sin(turn + 0.5) + std::sin(2.0 * turn - 0.2);
  CHECK(value(cyclic, Component::EXX, at_p(13.0)) == Approx(expected));
  CHECK(value(cyclic + "approach = \"reverse\"", Component::EXX, at_p(13.0)) == 0.0);
  CHECK(value(cyclic + "approach = \"reverse\"", Component::EXX, at_p(13.0, Approach::reverse)) == Approx(expected));
}

TEST_CASE("effects of approach change sign with it") {
  for (const auto& [approach, d] : {std::pair{Approach::forward, 1.0}, std::pair{Approach::reverse, -1.0}}) {
    MachineState state = at_p(250.0, approach);
    state.feed_mm_min = 3000.0;
    state.travel_since_reversal_mm[0] = 4.0;
    CHECK(value("id='backlash'\naxis='X'\nparameters={um=9}", Component::EXX, state) == Approx(4.5 * d));
    CHECK(value("id='servo_lag'\naxis='X'\nparameters={um_per_m_min=2}", Component::EXX, state) == Approx(6.0 * d));
    CHECK(value("id='reversal_spike'\naxis='X'\nsense='EY'\nparameters={c_um=5, u0_mm=2}", Component::EYX, state) ==
          Approx(5.0 * d * std::exp(-2.0)));
    CHECK(value("id='reversal_curve'\naxis='X'\npoints=[[0, 2], [500, 6]]", Component::EXX, state) == Approx(2.0 * d));
  }
}

TEST_CASE("curves are points or formulas over positions from the datum") {
  CHECK(value("id='progressive'\naxis='X'\nsense='EZ'\npoints=[[0, 1], [1000, 3]]", Component::EZX, at_p(250)) ==
        Approx(1.5));
  CHECK(value("id='progressive'\naxis='X'\nformula='0.01*p + x'", Component::EXX, at_p(300)) == Approx(3.0 + 200.0));
  CHECK(value("id='angular'\ncode='ECX'\nformula='p/10'", Component::ECX, at_p(300)) == Approx(30.0));
  CHECK(value("id='squareness'\ncode='B0Z'\nparameters={um_per_m=-12}", Component::B0Z, at_p(300)) == -12.0);
}

TEST_CASE("effects of time, load and temperature") {
  MachineState state = at_p(500.0);
  state.time_s = 1800.0;
  state.load_kg = 200.0;
  CHECK(value("id='time_drift'\nsense='EY'\naxis='X'\nparameters={um_per_h=4}", Component::EYX, state) == Approx(2.0));
  CHECK(value("id='warm_up'\naxis='X'\nparameters={tau_s=1800, c_um=10, c_um_per_m=6}", Component::EXX, state) ==
        Approx((10.0 + 3.0) * (1.0 - std::exp(-1.0))));
  CHECK(value("id='load'\naxis='X'\nsense='EZ'\nparameters={um_per_kg=0.01, um_per_kg_m=-0.04}", Component::EZX,
              state) == Approx(200.0 * (0.01 - 0.02)));
  const std::string drift = "id='thermal_drift'\nsense='EZ'\nsensor='t_oil_degC'\nparameters={um_per_degC=3}\n";
  CHECK(value(drift + "[temperature]\noil='25 + t/600'", Component::EZZ, state) == Approx(9.0));
}

TEST_CASE("thermal effects follow true temperatures of the machine, not what sensors show") {
  const std::string text = R"([air]
mean_degC = 26.0
[material]
lag_s = 1000.0
start_degC = 30.0
[spindle]
degC_per_1000_rpm = 5.0
lag_s = 600.0
steps = [[0, 2000]]
[sensor.spindle]
of = "spindle"
offset_degC = 2.0
lag_s = 300.0
[[effect]]
id = "thermal_scale"
axis = "X"
parameters = { um_per_m_degC = 11.0 }
[[effect]]
id = "thermal_drift"
sense = "EZ"
sensor = "spindle"
parameters = { um_per_degC = -2.0 }
)";
  Simulation simulation = simulation_of(text);
  REQUIRE(simulation.dwell(1000.0));
  MachineState state = simulation.machine().state();
  state.position_mm = {-400.0, 0.0, 0.0};
  const ComponentValues values = simulation.errors().at(state, simulation.heat());
  const double material_degC = 26.0 + 4.0 * std::exp(-1.0);
  CHECK(simulation.material_degC() == Approx(material_degC));
  CHECK(values[index_of(Component::EXX)] == Approx(11.0 * -0.4 * (material_degC - 20.0)));
  CHECK(values[index_of(Component::EZZ)] == Approx(-2.0 * 10.0 * (1.0 - std::exp(-1000.0 / 600.0))));
}

TEST_CASE("effects that do not sit in the machine are refused with where they belong") {
  const auto refused = [](const std::string& id) { return refused_errors("[[effect]]\nid = \"" + id + "\"\n"); };
  check_holds(refused("cosine"),
              {"errors.toml:2:6: cosine: an effect of the instrument: set misalignment_mrad in [emulator.laser]"});
  check_holds(refused("dead_path"), {"set dead_path_m in [emulator.laser]"});
  check_holds(refused("air_refraction"), {"the air is set in [air] of this file"});
  check_holds(refused("measurement_line"), {"parked_mm of the plan"});
  for (const char* id : {"map_polarity", "map_gain", "map_shift", "map_direction_swap"})
    check_holds(refused(id), {"a fault of the unit's map"});
  check_holds(refused("ciclic"), {"did you mean \"cyclic\"?"});
}

TEST_CASE("every wrong key of an effect is refused with its line") {
  const std::string text = refused_errors(R"([[effect]]
id = "scale"
sense = "EX"
parameters = { um_per_m = 1 }
[[effect]]
id = "cyclic"
axis = "X"
parameters = { period_mm = 0, amplitude_um = 1, amplitud2_um = 3 }
[[effect]]
id = "offset"
axis = "X"
parameter = { um = 1 }
[[effect]]
id = "angular"
code = "EXX"
points = [[0, 1]]
[[effect]]
id = "backlash"
axis = "Q"
parameters = { um = 1 }
[[effect]]
id = "progressive"
axis = "X"
[[effect]]
id = "thermal_drift"
sense = "EZ"
sensor = "t_oil_degC"
parameters = { um_per_degC = 1 }
[[effect]]
id = "sag"
axis = "X"
approach = "up"
parameters = {}
[[effect]]
id = "squareness"
code = "C0Y"
axis = "X"
parameters = { um_per_m = 1 }
[[effect]]
id = "backlash"
axis = "X"
code = "EXX"
parameters = { um = 1 }
)");
  for (const int line : {1, 8, 9, 12, 15, 19, 21, 27, 32, 33, 37, 42})
    check_holds(text, {"errors.toml:" + std::to_string(line) + ":"});
  check_holds(text, {"did you mean \"amplitude_um\"", "did you mean \"parameters\""});
}

TEST_CASE("an effect on an axis that the machine lacks is refused with its line") {
  const TrueErrors errors = errors_of("\n[[effect]]\nid='scale'\naxis='Y'\nparameters={um_per_m=1}\n");
  std::string machine = small_machine("TXZ");
  machine.erase(machine.find("[axis.Y]"), std::string("[axis.Y]\ntravel_mm = [-400.0, 0.0]\n").size());
  const auto checked = must_fail(errors.checked_for(machine_of(machine).machine));
  check_holds(to_text(checked), {"errors.toml:2: effect scale: this machine has no Y"});
}

namespace {

/// Everything at a value that no formula takes for zero.
Conditions plain_at(double at_mm) {
  return {.p_mm = at_mm,
          .curve = 2.0,
          .time_s = 1800.0,
          .feed_mm_min = 3000.0,
          .load_kg = 250.0,
          .travel_since_reversal_mm = 12.0,
          .material_degC = 23.0,
          .degC = {26.0, 21.0},
          .first_degC = 20.5};
}

PlacedEffect with_parameters(const EffectDefinition& kind) {
  PlacedEffect effect{.kind = &kind, .sensor = "first", .sensor2 = "second"};
  double value = 2.0;
  for (const ParameterDefinition& parameter : kind.parameters) effect.parameters[std::string(parameter.name)] = value++;
  return effect;
}

/// The table of an errors file that says the same.
std::string table_of(const PlacedEffect& effect) {
  const EffectDefinition& kind = *effect.kind;
  std::string text = fmt::format("[[effect]]\nid = \"{}\"\n", kind.id);
  if (kind.placed_by == PlacedBy::code_of_rotation)
    text += "code = \"ECX\"\n";
  else if (kind.placed_by == PlacedBy::code_of_squareness)
    text += "code = \"B0Z\"\n";
  else if (kind.placed_by == PlacedBy::code_of_set_up)
    text += "code = \"EC\"\n";
  else
    text += "axis = \"X\"\nsense = \"EY\"\n";
  if (kind.sensors > 0) text += "sensor = \"first\"\n";
  if (kind.sensors > 1) text += "sensor2 = \"t_second_degC\"\n";
  if (kind.curve) return text + "formula = \"2\"\n";
  text += "[effect.parameters]\n";
  for (const auto& [name, value] : effect.parameters) text += fmt::format("{} = {}\n", name, value);
  return text;
}

Component component_in_table(const EffectDefinition& kind) {
  if (kind.placed_by == PlacedBy::code_of_rotation) return Component::ECX;
  return kind.placed_by == PlacedBy::code_of_squareness ? Component::B0Z : Component::EYX;
}

}  // namespace

TEST_CASE("every effect has an id of its own and is found by it") {
  std::set<std::string_view> ids;
  for (const EffectDefinition& kind : effects()) {
    CAPTURE(kind.id);
    CHECK(ids.insert(kind.id).second);
    CHECK(effect_named(kind.id) == &kind);
  }
  CHECK(effect_named("no_such_effect") == nullptr);
}

TEST_CASE("every effect has a value or says where it has its place, and parameters with units or a curve") {
  for (const EffectDefinition& kind : effects()) {
    CAPTURE(kind.id);
    CHECK((kind.value != nullptr) == kind.elsewhere.empty());
    CHECK((kind.curve != !kind.parameters.empty() || !kind.elsewhere.empty()));
    bool optional = false;
    for (const ParameterDefinition& parameter : kind.parameters) {
      CAPTURE(parameter.name);
      CHECK(!parameter.name.empty());
      CHECK(!parameter.unit.empty());
      CHECK((!optional || parameter.optional));  // those that an errors file must give come first
      optional = parameter.optional;
    }
  }
}

TEST_CASE("every value of an effect is finite, and not nothing") {
  for (const EffectDefinition& kind : effects()) {
    if (kind.value == nullptr) continue;
    CAPTURE(kind.id);
    for (const double p_mm : {-700.0, 0.0, 300.0, 1250.0})
      CHECK(std::isfinite(kind.value(with_parameters(kind), plain_at(p_mm))));
    CHECK(kind.value(with_parameters(kind), plain_at(1250.0)) != 0.0);
  }
}

TEST_CASE("every effect of the machine reads from an errors file what its definition computes") {
  MachineState state{.position_mm = {300.0, 0.0, 0.0}, .feed_mm_min = 3000.0, .load_kg = 250.0, .time_s = 1800.0};
  state.travel_since_reversal_mm[0] = 12.0;
  Conditions expected = plain_at(300.0);
  expected.material_degC = 20.0;
  expected.first_degC = 20.0;
  for (const EffectDefinition& kind : effects()) {
    CAPTURE(kind.id);
    const PlacedEffect effect = with_parameters(kind);
    const std::string text = table_of(effect) + "[temperature]\nfirst = '20 + t/300'\nsecond = '21'\n";
    const auto errors = TrueErrors::parse(text, "errors.toml", ".");
    CHECK(errors.has_value() == kind.elsewhere.empty());
    if (!errors) {
      CHECK(contains(to_text(errors.error()), kind.elsewhere));
      continue;
    }
    CHECK(errors->at(state)[index_of(component_in_table(kind))] == Approx(kind.value(effect, expected)));
  }
}

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
  const auto refusal = [](const std::string& keys) { return refused_errors(turned(keys)); };
  CHECK(contains(refusal("code = 'ECX'"), "code: expected EA, EB or EC"));
  CHECK(contains(refusal(""), "code: expected EA, EB or EC"));
  CHECK(contains(refusal("code = 'EC'\naxis = 'X'"), "axis: set_up_rotation has a code alone"));
}

namespace {

const std::string kTemperatures = "[temperature]\ntop = '26 + t/3600'\nfoot = '21'\n";

std::string bend(const std::string& keys) {
  return "[[effect]]\nid = 'thermal_bend'\n" + keys + "\nparameters = { um_per_m2_degC = 2 }\n" + kTemperatures;
}

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
  CHECK(
      contains(refused_errors(bend("axis = 'X'\nsense = 'EX'" + sensors)), "sense: thermal_bend acts across its axis"));
  CHECK(
      contains(refused_errors(bend("axis = 'X'\nsense = 'EB'" + sensors)), "sense: thermal_bend acts across its axis"));
  CHECK(contains(refused_errors(bend("sense = 'EY'" + sensors)), "axis: expected X, Y or Z"));
  CHECK(contains(refused_errors(bend("axis = 'X'\nsense = 'EY'\nsensor = 'top'")), "sensor2: expected a sensor"));
}
