#include "params/machine.hpp"

#include "params/check.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::params;

namespace {

Machine sample(const char* path) { return must(read_machine(path)).machine; }

std::string failure(std::string_view text) { return to_text(must_fail(parse_machine(text, "machine.toml"))); }

}  // namespace

TEST_CASE("the mill's file is read completely, and its [emulator] table is ignored") {
  const auto file = must(read_machine("tests/data/params/mill_machine.toml"));
  CHECK(file.warnings.empty());
  const Machine& mill = file.machine;
  CHECK(mill.name == "moving column mill");
  CHECK(mill.configuration == "TXYZ");
  REQUIRE(mill.axes[0].has_value());
  const MachineAxis& x = *mill.axes[0];
  CHECK(x.travel_mm == std::array{-4100.0, 0.0});
  CHECK(x.resolution_um == 1.0);
  CHECK(x.screw_pitch_mm == 10.0);
  CHECK(x.scale_pitch_mm == 0.02);
  CHECK(x.expansion_um_per_m_degC == 11.7);
  CHECK(x.measurement_line_mm == PerAxis<std::optional<double>>{std::nullopt, -1400.0, 0.0});
  CHECK(mill.axes[1]->travel_mm == std::array{-1400.0, 0.0});
  CHECK_FALSE(mill.axes[1]->screw_pitch_mm.has_value());
  CHECK(chain_of(mill) == ecs::chain_of("TXYZ"));
  CHECK(measurement_lines_of(mill)[0] == Vector3{0.0, -1400.0, 0.0});
}

TEST_CASE("the lathe has two axes of a three-axis chain") {
  const Machine lathe = sample("tests/data/params/lathe_machine.toml");
  CHECK_FALSE(lathe.axes[0].has_value());
  CHECK(lathe.axes[1]->transducer == Transducer::resolver);
  CHECK(lathe.axes[2]->datum_mm == -10.0);
  CHECK(chain_of(lathe)->axis_count() == 2);
}

TEST_CASE("default parameters fit their machine: no check has anything to say") {
  for (const char* path : {"tests/data/params/mill_machine.toml", "tests/data/params/lathe_machine.toml"}) {
    const Machine machine = sample(path);
    CHECK(to_text(check(default_parameters_for(machine), &machine)) == "");
  }
}

TEST_CASE("the axis comes onto the switch of its datum from the farther end of its travel") {
  Machine machine = sample("tests/data/params/mill_machine.toml");
  machine.axes[1]->travel_mm = {-1400.0, 0.0};
  machine.axes[1]->datum_mm = -1400.0;
  CHECK(default_parameters_for(machine).axes[1].datum.approach_direction == Approach::reverse);
  machine.axes[1]->datum_mm = 0.0;
  CHECK(default_parameters_for(machine).axes[1].datum.approach_direction == Approach::forward);
}

TEST_CASE("default parameters of the mill are volumetric, those of the lathe planar in Y and Z") {
  const UnitParameters mill = default_parameters_for(sample("tests/data/params/mill_machine.toml"));
  CHECK(configuration_of(mill) == "TXYZ");
  CHECK(mill.scope == Scope::volumetric);
  CHECK(mill.measurement_lines_mm[0] == Vector3{0.0, -1400.0, 0.0});
  const UnitParameters lathe = default_parameters_for(sample("tests/data/params/lathe_machine.toml"));
  CHECK(configuration_of(lathe) == "XTYZ");
  CHECK(lathe.axis_present == PerAxis<bool>{false, true, true});
  CHECK(lathe.scope == Scope::planar);
  CHECK(lathe.plane == Plane{Axis::Y, Axis::Z});
  CHECK(lathe.axes[1].transducer == Transducer::resolver);
  CHECK(lathe.axes[1].position_scale_um_per_count == 0.5);
  CHECK(lathe.axes[1].deadband_um == 2.5);
  CHECK(lathe.axes[2].datum.reference_position_mm == -10.0);
  CHECK(lathe.measurement_lines_mm[2] == Vector3{0.0, 120.0, 0.0});
}

TEST_CASE("a machine of one axis gets the linear scope") {
  const auto file = must(parse_machine("configuration = \"TZ\"\n[axis.Z]\ntravel_mm = [0, 500]\n", "one.toml"));
  CHECK(default_parameters_for(file.machine).scope == Scope::linear);
}

TEST_CASE("every wrong value of a machine file is reported in one pass with line and column") {
  const std::string text = to_text(must_fail(read_machine("tests/data/params/broken_machine.toml")));
  const std::string at = "tests/data/params/broken_machine.toml:";
  CHECK(contains(text, at + "1:8: name: expected a text in quotes, found 7"));
  CHECK(contains(text, at + "2:17: configuration: expected the letter T and one to three of X, Y, Z"));
  CHECK(contains(text, at + "3:10: colour: not a key of a machine file; ignored"));
  CHECK(contains(text, at + "6:13: axis.X.travel_mm: expected two ends in mm, the lower first"));
  CHECK(contains(text, at + "7:14: axis.X.transducer: expected \"encoder\" or \"resolver\", found \"encodr\""));
  CHECK(contains(text, at + "8:17: axis.X.resolution_um: expected a number above 0, at most 10000, found 0"));
  CHECK(contains(text, "did you mean \"axis.X.screw_pitch_mm\"?"));
  CHECK(contains(text, at + "10:12: axis.X.datum_mm: expected a position within 1000000 mm of 0, found nan"));
  CHECK(contains(text, at + "12:1: axis.Y: expected travel_mm"));
  CHECK(contains(text, at + "14:23: axis.Y.measurement_line_mm: expected a table"));
  CHECK(contains(text, at + "16:1: axis.W: not a key of a machine file (did you mean \"axis.X\"?)"));
  CHECK_FALSE(contains(text, "axis.W.travel_mm"));
}

TEST_CASE("unknown keys and a datum outside the travel are warnings, not errors") {
  const auto file =
      must(parse_machine("configuration = \"TX\"\n[axis.X]\ntravel_mm = [0, 10]\ndatum_mm = 11\nscrew_pich_mm = 5\n"
                         "measurement_line_mm = { x = 1 }\n",
                         "m.toml"));
  REQUIRE(file.warnings.size() == 3);
  CHECK(contains(file.warnings[0].message, "outside the travel"));
  CHECK(contains(file.warnings[1].message, "did you mean \"axis.X.screw_pitch_mm\"?"));
  CHECK(contains(file.warnings[2].message, "own measurement line"));
}

TEST_CASE("a machine needs a chain, an axis, and travel in the right order") {
  CHECK(contains(failure(""), "configuration: expected the kinematic chain"));
  CHECK(contains(failure("configuration = \"TX\""), "at least one table such as [axis.X]"));
  CHECK(contains(failure("configuration = \"TX\"\n[axis.X]\n"), "expected travel_mm"));
  CHECK(contains(failure("configuration = \"TX\"\n[axis.Y]\ntravel_mm = [0, 1]\n"), "has no letter Y"));
  for (const char* travel : {"[1, 1]", "[2, 1]", "[0]", "[0, 1, 2]", "[nan, 1]", "[0, inf]", "\"0 1\"", "[\"0\", 1]"})
    CHECK(contains(failure(std::string("configuration = \"TX\"\n[axis.X]\ntravel_mm = ") + travel), "the lower first"));
}

TEST_CASE("axis keys may be dotted and come before their table's other parts") {
  (void)must(parse_machine("configuration = \"TX\"\naxis.X.travel_mm = [0, 1]\n", "m.toml"));
  const auto other = must(parse_machine(
      "configuration = \"TX\"\n[axis.X.measurement_line_mm]\ny = 4\n[axis.X]\ntravel_mm = [0, 1]\n", "m.toml"));
  CHECK(other.machine.axes[0]->measurement_line_mm[1] == 4.0);
}

namespace {

std::string five_axes(std::string_view configuration, std::string_view tables) {
  return "configuration = \"" + std::string(configuration) +
         "\"\n[axis.X]\ntravel_mm = [0, 500]\n[axis.Y]\ntravel_mm = [0, 400]\n[axis.Z]\ntravel_mm = [-300, 0]\n" +
         std::string(tables);
}
constexpr const char* kTableC = "[axis.C]\ntravel_deg = [0, 360]\npivot_mm = [250, 200, -300]\n";

}  // namespace

TEST_CASE("rotary axes have a travel, a pivot and a direction; the unit's chain does without them") {
  const auto file = must(parse_rotary_machine(
      five_axes("XYBCTZ",
                std::string(kTableC) +
                    "[axis.B]\ntravel_deg = [-110, 30.5]\npivot_mm = [250, 200, -250]\ndirection = [0, 1, 1]\n"),
      "machine.toml"));
  const RotaryMachine& machine = file;
  CHECK(machine.machine.configuration == "XYTZ");
  CHECK(machine.configuration == "XYBCTZ");
  CHECK(has_rotary_axes(machine));
  CHECK(joint_chain_of(machine)->count == 5);
  CHECK(machine.rotary[2]->pivot_mm == Vector3{250.0, 200.0, -300.0});
  CHECK(machine.rotary[2]->direction == Vector3{0.0, 0.0, 1.0});
  CHECK(machine.rotary[1]->travel_deg == std::array{-110.0, 30.5});
  CHECK(machine.rotary[1]->direction[2] == Approx(std::sqrt(0.5)));
  CHECK(configuration_of(default_parameters_for(machine.machine)) == "XYTZ");
  CHECK_FALSE(has_rotary_axes(*read_rotary_machine("tests/data/params/mill_machine.toml")));
  CHECK(read_machine("samples/five_axes/machine.toml")->warnings.empty());
}

TEST_CASE("a rotary axis may state the transducer at the unit: its resolution with the wiring, its angle at 0 counts") {
  const auto axis_c = [](const std::string& lines) { return five_axes("XYCTZ", kTableC + lines); };
  CHECK_FALSE(must(parse_machine(axis_c(""), "machine.toml")).machine.rotary[2]->resolution_deg);
  const auto file = must(parse_machine(axis_c("resolution_deg = -0.001\ntransducer_zero_deg = 90\n"), "machine.toml"));
  CHECK(file.warnings.empty());
  CHECK(file.machine.rotary[2]->resolution_deg == -0.001);
  CHECK(file.machine.rotary[2]->transducer_zero_deg == 90.0);
  for (const char* wrong : {"resolution_deg = 0", "resolution_deg = 2.0", "resolution_deg = \"fine\""})
    CHECK(contains(failure(axis_c(wrong)), "resolution_deg: expected an angle for each count, not 0 and within 1 deg"));
  CHECK(contains(failure(axis_c("transducer_zero_deg = 4000")), "expected an angle within 3600 deg of 0"));
}

TEST_CASE("rotary axes that no machine can have are refused with their line and what was expected") {
  CHECK(contains(failure(five_axes("XYUCTZ", kTableC)), "machine.toml:1:17: configuration: expected the letter T and"));
  CHECK(contains(failure(five_axes("XYABCTZ", kTableC)), "configuration: expected at most two rotary axes of A, B, C"));
  CHECK(contains(failure(five_axes("XYACTZ", kTableC)),
                 "machine.toml:1:17: configuration: letter A: expected a table [axis.A] with travel_deg and pivot_mm"));
  CHECK(contains(failure(five_axes("XYTZ", kTableC)), "configuration \"XYTZ\" has no letter C"));
  const std::string empty = failure(five_axes("XYCTZ", "[axis.C]\n"));
  check_holds(empty, {"machine.toml:8:1: axis.C: expected pivot_mm = [x, y, z], a point on its axis",
                      "axis.C: expected travel_deg = [lower end, upper end], found none"});
  const std::string wrong =
      failure(five_axes("XYCTZ", "[axis.C]\ntravel_deg = [0, 4000]\npivot_mm = [1, 2]\ndirection = [0, 0, 0]\n"));
  check_holds(wrong, {"machine.toml:9:14: axis.C.travel_deg: expected two ends in deg",
                      "machine.toml:10:12: axis.C.pivot_mm: expected a point x, y, z",
                      "machine.toml:11:13: axis.C.direction: expected a direction x, y, z that is not 0"});
}

TEST_CASE("[inputs] names the sensors at the unit's inputs, the load and the motion that warms the machine") {
  const std::string axis = "configuration = \"TX\"\n[axis.X]\ntravel_mm = [0, 100]\n";
  const Machine machine =
      must(parse_machine(
               axis + "[inputs]\nt_spindle_degC = 5\nt_air_degC = 16\nload_kg = true\nmotion_X_mm_min = 1200.0\n",
               "machine.toml"))
          .machine;
  CHECK(machine.input_of("t_spindle_degC") == 4);
  CHECK(machine.input_of("t_air_degC") == 15);
  CHECK_FALSE(machine.input_of("t_column_degC"));
  CHECK_FALSE(machine.input_of(""));
  CHECK(machine.states_load);
  CHECK(machine.full_duty_mm_min[0] == 1200.0);
  CHECK_FALSE(must(parse_machine(axis, "machine.toml")).machine.states_load);
  check_holds(failure(axis + "[inputs]\nt_a_degC = 17\nt_b_degC = 2\nt_c_degC = 2\nspindle = 1\nload_kg = 3\n"
                             "motion_X_mm_min = 0\n"),
              {"machine.toml:5:12: inputs.t_a_degC: expected the number of an input of the unit, 1 to 16, found 17",
               "inputs.t_c_degC: expected an input of its own, not that of t_b_degC",
               "inputs.spindle: expected the column of a sensor", "inputs.load_kg: expected true or false",
               "inputs.motion_X_mm_min: expected a number above 0"});
}
