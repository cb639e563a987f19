// Gravity against numbers worked out by hand from the beam formulas, and against the exact chain of matrices.
#include "ecs_emulator/errors/gravity.hpp"

#include "ecs_emulator/errors/kinematics.hpp"
#include "tests/support/workshop_machines.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

MachinePlace place_of(const char* configuration) {
  MachinePlace place;
  place.chain = *chain_of(configuration);
  return place;
}

/// E of the tool, by the exact chain.
Vector3 error_um(const GravitySettings& gravity, const MachinePlace& place, const Vector3& position_mm, double load_kg,
                 const Vector3& tool_offset_mm = {}) {
  ComponentValues values{};
  add_gravity(gravity, place, position_mm, load_kg, values);
  return tool_pose({place.chain, place.lines_mm, tool_offset_mm}, values, position_mm).error_um;
}

}  // namespace

TEST_CASE(
    "a ram of 1 m with 100 kg/m and 50 kg at its nose droops by wL^4/8EI + PL^3/3EI and slopes by its derivative") {
  // EI = 2e7 N m2; w = 980.665 N/m, P = 490.3325 N:
  // 980.665/(8*2e7) = 6.12915625 um, 490.3325/(3*2e7) = 8.17220833 um; 980.665/(6*2e7) = 8.17220833 um/m,
  // 490.3325/(2*2e7) = 12.2583125 um/m
  const Cantilever beam{2e7, 100.0, 50.0};
  const Bending one = at_the_end(beam, 1.0);
  CHECK(one.sag_um == Approx(14.30136458).epsilon(1e-8));
  CHECK(one.slope_um_per_m == Approx(20.43052083).epsilon(1e-8));
  // At half the length: a sixteenth and an eighth, an eighth and a quarter.
  const Bending half = at_the_end(beam, 0.5);
  CHECK(half.sag_um == Approx(6.12915625 / 16.0 + 8.17220833 / 8.0).epsilon(1e-8));
  CHECK(half.slope_um_per_m == Approx(8.17220833 / 8.0 + 12.2583125 / 4.0).epsilon(1e-8));
}

TEST_CASE("a ram that comes out along -Z in gravity -Y puts its droop into EYZ and its slope into EAZ") {
  GravitySettings gravity{Axis::Y, -1, {{Axis::Z, 0.0, -1, 0.0, {2e7, 100.0, 50.0}}}, {}, {}};
  ComponentValues values{};
  add_gravity(gravity, place_of("TXYZ"), {0.0, 0.0, -1000.0}, 0.0, values);
  CHECK(values[index_of(Component::EYZ)] == Approx(-14.30136458));
  CHECK(values[index_of(Component::EAZ)] == Approx(-20.43052083));
  for (std::size_t c = 0; c < kComponents; ++c)
    if (c != index_of(Component::EYZ) && c != index_of(Component::EAZ)) CHECK(values[c] == 0.0);
  // A tool 200 mm in front of the nose goes down by 0.2 m of slope more: 14.301 + 4.086 um.
  CHECK(error_um(gravity, place_of("TXYZ"), {0.0, 0.0, -1000.0}, 0.0, {0.0, 0.0, -200.0})[1] ==
        Approx(-14.30136458 - 0.2 * 20.43052083).epsilon(1e-6));
  // In: nothing hangs out.
  CHECK(error_um(gravity, place_of("TXYZ"), {0.0, 0.0, 0.0}, 0.0)[1] == 0.0);
}

TEST_CASE("a ram bends the way gravity pulls, whatever way it comes out") {
  for (const int extends : {-1, 1})
    for (const int sign : {-1, 1})
      for (const Axis down : {Axis::X, Axis::Y}) {
        GravitySettings gravity{down, sign, {{Axis::Z, 0.0, extends, 100.0, {1e6, 80.0, 20.0}}}, {}, {}};
        const Vector3 at{0.0, 0.0, extends * 400.0};
        Vector3 longer{};
        longer[2] = extends * 300.0;
        const auto d = index_of(down);
        const double nose = error_um(gravity, place_of("TXYZ"), at, 0.0)[d];
        const double tool = error_um(gravity, place_of("TXYZ"), at, 0.0, longer)[d];
        CHECK(nose * sign > 1.0);
        CHECK((tool - nose) * sign > 1.0);
      }
}

TEST_CASE("a carriage in the middle of a bed sags it by PL^3/48EI, level; elsewhere it slopes by the derivative") {
  const Bending middle = under_the_load(5e7, 4.0, 2.0, 1e4);
  CHECK(middle.sag_um == Approx(1e4 * 64.0 / (48.0 * 5e7) * 1e6));
  CHECK(middle.slope_um_per_m == Approx(0.0));
  // a = 1 m, b = 3 m: Pa2b2/3LEI = 1e4*9/(12*5e7) = 150 um; Pab(b-a)/3LEI = 1e4*3*2/(12*5e7) = 100 um/m
  const Bending quarter = under_the_load(5e7, 4.0, 1.0, 1e4);
  CHECK(quarter.sag_um == Approx(150.0));
  CHECK(quarter.slope_um_per_m == Approx(100.0));
  CHECK(under_the_load(5e7, 4.0, 3.0, 1e4).slope_um_per_m == Approx(-100.0));
  CHECK(under_the_load(5e7, 4.0, -0.1, 1e4).sag_um == 0.0);
}

TEST_CASE("a column on its bed goes down and nods towards the middle: EZX and EBX") {
  const double mass_kg = 1e4 / kGravity_m_s2;
  GravitySettings gravity{Axis::Z, -1, {}, {{Axis::X, {-4000.0, 0.0}, 5e7, mass_kg, -2000.0}}, {}};
  ComponentValues values{};
  add_gravity(gravity, place_of("TXYZ"), {-3000.0, 0.0, 0.0}, 0.0, values);
  CHECK(values[index_of(Component::EZX)] == Approx(-150.0));
  CHECK(values[index_of(Component::EBX)] == Approx(100.0));
  // The head 1 m above the carriage comes forward, towards the sag: +X by 100 um.
  CHECK(error_um(gravity, place_of("TXZ"), {-3000.0, 0.0, 1000.0}, 0.0)[0] == Approx(100.0).epsilon(1e-4));
}

TEST_CASE("a table on its bed: the tool rises against it by the sag below the tool, wherever the measurement line is") {
  const double mass_kg = 1e4 / kGravity_m_s2;
  GravitySettings gravity{Axis::Z, -1, {}, {{Axis::X, {-2000.0, 2000.0}, 5e7, mass_kg, 0.0}}, {}};
  for (const double line_mm : {0.0, -500.0}) {
    MachinePlace place = place_of("XTYZ");
    place.lines_mm[0][0] = line_mm;
    // p = -1000: the carriage's middle is 1 m from a support, sag 150 um. The bed slopes by 100 um/m towards its
    // middle; the tool stands over the table 1 m from its middle, towards the middle of the bed: 100 um deeper.
    CHECK(error_um(gravity, place, {-1000.0, 0.0, 0.0}, 0.0)[2] == Approx(150.0 + 100.0).epsilon(1e-6));
    CHECK(error_um(gravity, place, {0.0, 0.0, 0.0}, 0.0)[2] == Approx(1e4 * 64.0 / (48.0 * 5e7) * 1e6));
  }
}

TEST_CASE("a workpiece adds to the weight of the carriage that carries it, and only to that") {
  const auto sag = [](const char* configuration, double load_kg) {
    GravitySettings gravity{Axis::Z, -1, {}, {{Axis::X, {-2000.0, 2000.0}, 5e7, 1000.0, 0.0}}, {}};
    return std::abs(error_um(gravity, place_of(configuration), {0.0, 0.0, 0.0}, load_kg)[2]);
  };
  CHECK(sag("XTYZ", 500.0) == Approx(1.5 * sag("XTYZ", 0.0)));
  CHECK(sag("TXYZ", 500.0) == Approx(sag("TXYZ", 0.0)));
}

TEST_CASE("a workpiece sinks the table in proportion and tilts it by its place over the saddle") {
  // 400 N/um, ends 600 mm apart, the workpiece's middle under the tool at X = -250.
  GravitySettings gravity{Axis::Z, -1, {}, {}, {{Axis::X, 400.0, 600.0, -250.0, 0.0}}};
  const double load_kg = 4000.0 / kGravity_m_s2;
  const auto values_at = [&](double x_mm, double kg) {
    ComponentValues values{};
    add_gravity(gravity, place_of("XTYZ"), {x_mm, 0.0, 0.0}, kg, values);
    return values;
  };
  // Over the middle of the saddle: 4000 N / 400 N/um = 10 um, no tilt.
  CHECK(error_um(gravity, place_of("XTYZ"), {-250.0, 0.0, 0.0}, load_kg)[2] == Approx(10.0));
  CHECK(values_at(-250.0, load_kg)[index_of(Component::EBX)] == Approx(0.0));
  // At X = 0 the table has gone 250 mm towards -X: 4000 N * 0.25 m / (2 * 200e6 N/m * (0.3 m)^2) = 27.78 um/m, the -X
  // end down: the table turns about -Y, the tool against it about +Y.
  const double tilt = 4000.0 * 0.25 / (2.0 * 200e6 * 0.09) * 1e6;
  CHECK(tilt == Approx(27.7778).epsilon(1e-4));
  CHECK(values_at(0.0, load_kg)[index_of(Component::EBX)] == Approx(tilt));
  // The tool stands over the middle of the saddle: the sink there does not depend on the tilt.
  for (const double x_mm : {-500.0, -100.0, 0.0, 300.0})
    CHECK(error_um(gravity, place_of("XTYZ"), {x_mm, 0.0, 0.0}, load_kg)[2] == Approx(10.0).epsilon(1e-6));
  // Twice the workpiece, twice the tilt.
  CHECK(values_at(0.0, 2.0 * load_kg)[index_of(Component::EBX)] == Approx(2.0 * tilt));
  CHECK(values_at(0.0, 0.0)[index_of(Component::EBX)] == 0.0);
}

TEST_CASE("a table whose saddle is 100 mm behind the tool shows its tilt at the tool") {
  GravitySettings gravity{Axis::Z, -1, {}, {}, {{Axis::X, 400.0, 600.0, -250.0, 100.0}}};
  const double load_kg = 4000.0 / kGravity_m_s2;
  // At X = 0 the workpiece stands 350 mm from the saddle, towards -X: 38.89 um/m; the tool is 100 mm from the saddle on
  // that side: 3.889 um deeper.
  CHECK(error_um(gravity, place_of("XTYZ"), {0.0, 0.0, 0.0}, load_kg)[2] == Approx(10.0 + 3.8889).epsilon(1e-4));
}

TEST_CASE("gravity is read from the errors file and works in the machine that it is put on") {
  const auto height_um = [](const std::string& errors) {
    Simulation simulation = simulation_of(errors);
    REQUIRE(simulation.move_to({0.0, 0.0, -300.0}, 5000.0));
    REQUIRE(simulation.dwell(1.0));
    return simulation.tool_now(false).error_um[1];
  };
  const double droop_um = height_um(R"(
[gravity]
direction = "-Y"
[ram.Z]
retracted_mm = 0.0
extends = -1
stiffness_N_m2 = 1e6
mass_kg_m = 100.0
tip_kg = 50.0
)") - height_um("");
  // 0.3 m: 980.665*0.0081/8e6 + 490.3325*0.027/3e6
  CHECK(droop_um == Approx(-(0.99292 + 4.41299)).epsilon(1e-4));
}

TEST_CASE("every wrong word about gravity is refused with its line") {
  const auto refused = [](const char* text) { return to_text(must_fail(TrueErrors::parse(text, "errors.toml", "."))); };
  check_holds(refused("\n[ram.Z]\nstiffness_N_m2 = 1\nmass_kg_m = 1\n"), {"errors.toml:2"});
  check_holds(refused("[gravity]\ndirection = \"down\"\n"), {"errors.toml:2"});
  const std::string wrong = refused_errors(R"([gravity]
direction = "-Y"
[ram.Z]
stiffness_N_m2 = 0
mass_kg_m = 1
legth = 3
[ram.Y]
stiffness_N_m2 = 1
mass_kg_m = 1
[bed.X]
supports_mm = [0, -4000]
stiffness_N_m2 = 1
carriage_kg = 1
[table.Q]
base_mm = 1
)");
  check_holds(wrong, {"errors.toml:4", "errors.toml:6", "errors.toml:7", "errors.toml:11", "errors.toml:14"});
}

TEST_CASE("an errors file is held against its machine: axis, side and supports") {
  const TrueErrors errors = errors_of(R"([gravity]
direction = "-Z"
[bed.X]
supports_mm = [-400.0, 0.0]
stiffness_N_m2 = 1e6
carriage_kg = 100.0
[table.Y]
stiffness_N_um = 100.0
base_mm = 300.0
load_at_mm = 0.0
)");
  const auto refused = must_fail(errors.checked_for(machine_of(small_machine("TXYZ")).machine));
  check_holds(to_text(refused), {"errors.toml:3: bed.X: expected supports on both sides",
                                 "errors.toml:7: table.Y: expected an axis on the workpiece side"});
  CHECK(errors_of("").checked_for(machine_of(small_machine()).machine).has_value());
}
