// `ecs lengths`: from a plan through the emulator to a map that `ecs volume` reads.

#include "base/text.hpp"
#include "laser/map/csv.hpp"
#include "params/parameters_toml.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

constexpr const char* kMachine = R"(name = "small"
configuration = "XYTZ"
[axis.X]
travel_mm = [0.0, 500.0]
measurement_line_mm = { y = 0.0, z = 0.0 }
[axis.Y]
travel_mm = [0.0, 400.0]
measurement_line_mm = { x = 0.0, z = 0.0 }
[axis.Z]
travel_mm = [-300.0, 0.0]
measurement_line_mm = { x = 0.0, y = 0.0 }
)";
constexpr const char* kErrors =
    "[squareness]\nC0Y = 25\n[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p + 3*d\"\n"
    "[[contribution]]\ncomponent = \"EAX\"\nformula = \"0.03*p\"\n[scatter]\nEXX = { pass = 0.1, reading = 0.3 }\n";

struct LengthFiles : Folder {
  std::string machine = with("machine.toml", kMachine);
  std::string errors = with("errors.toml", kErrors);
  std::string plan = *this / "plan.csv";
  std::string lengths = *this / "lengths.csv";
  std::string parameters = *this / "parameters.toml";
  std::string map = *this / "map.csv";
  std::string measured = *this / "measured.toml";

  LengthFiles() {
    const Ran made = ran({"params", "new", "--machine", machine, "-o", parameters});
    REQUIRE_MESSAGE(made.code == 0, made.all());
  }
  Ran planned(const std::string& tools = "0,0,0;0,0,-250;150,0,-120") const {
    return ran({"lengths", "plan", "--machine", machine, "--volume-um", "2", "--knots", "250,200,150", "--scatter-um",
                "0.3", "--tools", tools, "-o", plan, "--json"});
  }
  void measure() const {
    const std::string said = output_of("'" + kEmulator + "' lengths '" + plan + "' --machine '" + machine +
                                       "' --errors '" + errors + "' --seed 4 -o '" + lengths + "'")
                                 .text;
    REQUIRE_MESSAGE(contains(said, "\"ok\":true"), said);
  }
};

TEST_CASE("a plan, its lengths by the emulator, the components, a map that ecs volume takes") {
  const LengthFiles files;
  const Ran planned = files.planned();
  REQUIRE_MESSAGE(planned.code == 0, planned.all());
  CHECK(planned.json()["reached"] == true);
  CHECK(planned.json()["single"]["ratio"].get<double>() < 1.0);
  files.measure();
  const Ran fitted = ran({"lengths", "fit", files.lengths, "--machine", files.machine, "--params", files.parameters,
                          "-o", files.map, "--params-out", files.measured, "--json"});
  REQUIRE_MESSAGE(fitted.code == 0, fitted.all());
  const auto j = fitted.json();
  CHECK(j["determined"] == true);
  CHECK(j["squareness"][0]["um_per_m"].get<double>() == doctest::Approx(25.0).epsilon(0.15));
  const auto unit = params::read_parameters(files.measured);
  REQUIRE(unit.has_value());
  CHECK(unit->parameters.C0Y_um_per_m == doctest::Approx(25.0).epsilon(0.15));
  const auto map = laser::read_map_csv(files.map);
  REQUIRE_MESSAGE(map.has_value(), (map ? "" : to_text(map.error())));
  CHECK(map->header.uncertainty.size() == 21);
  CHECK(laser::compensation_at(*laser::table_of(*map, Component::EXX, Approach::forward), 500.0) ==
        doctest::Approx(-13.0).epsilon(0.1));
  const Ran volume = ran({"volume", files.map, "--params", files.measured, "--machine", files.machine, "--errors",
                          files.errors, "--points", "125", "--json"});
  REQUIRE_MESSAGE(volume.code == 0, volume.all());
  CHECK(volume.json()["after"]["rms_um"].get<double>() < 1.5);
  CHECK(volume.json()["before"]["rms_um"].get<double>() > 5.0);
}

TEST_CASE("with one tool alone what no lever shows is named; with knots too close the lengths are said to be too few") {
  const LengthFiles files;
  REQUIRE(files.planned("0,0,0").code == 0);
  files.measure();
  const Ran r = ran({"lengths", "fit", files.lengths, "--machine", files.machine});
  CHECK(contains(r.all(), "ECX, EAZ, EBZ, ECZ: only a tool offset levers them, and none was used"));
  const Ran few = ran({"lengths", "fit", files.lengths, "--machine", files.machine, "--params", files.parameters, "-o",
                       files.map, "--knots", "10,10,10"});
  CHECK(few.code == 3);
  CHECK(contains(few.messages, "unknowns (knots 10, 10, 10 mm)"));
  CHECK(contains(few.messages, "is not determined"));
  CHECK(!std::filesystem::exists(files.map));
}

TEST_CASE("a map needs parameters, a plan an uncertainty, tools three numbers") {
  const LengthFiles files;
  CHECK(ran({"lengths", "fit", files.errors, "--machine", files.machine, "-o", files.map}).code == 2);
  const Ran tools =
      ran({"lengths", "plan", "--machine", files.machine, "--volume-um", "2", "--tools", "0,0", "-o", files.plan});
  CHECK(tools.code == 2);
  CHECK(contains(tools.messages, "expected X,Y,Z;X,Y,Z in mm"));
  CHECK(ran({"lengths", "plan", "--machine", files.machine}).code == 2);
}

}  // namespace
}  // namespace ecs::app
