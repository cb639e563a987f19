// Lengths of the emulated machine: what hand computation and the true errors say.
#include "base/text.hpp"
#include "ecs_emulator/workshop/procedures.hpp"
#include "tests/support/workshop_machines.hpp"

namespace ecs::emulator::test {
namespace {

const std::string kPlanHead =
    "# tool: A 0 0 0\n# tool: B 0 0 -200\n# set_up: L interferometer 1 0 0\n# set_up: S tracker 300 0 0\n"
    "set_up,run,tool,x_mm,y_mm,z_mm,approach_x,approach_y,approach_z\n";

LengthInstrumentSettings perfect() { return {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, false}; }

std::vector<double> deviations(const std::string& errors, const std::string& rows,
                               const LengthInstrumentSettings& settings, std::uint64_t seed = 1) {
  Simulation simulation = simulation_of(errors, small_machine(), seed);
  const auto measured = must(measured_lengths(simulation, kPlanHead + rows, "plan.csv", settings));
  std::vector<double> out;
  for (const auto line : lines_of(measured.csv)) {
    const auto cells = split(line, ',');
    if (cells.size() == 10)
      if (const auto value = number_in(cells.back())) out.push_back(*value);
  }
  return out;
}

TEST_CASE("a line along X reads EXX with its reversal; a station ahead of it reads the same with the sign turned") {
  const std::string errors = "[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.02*p + 3*d\"\n";
  const auto read = deviations(errors,
                               "L,1,A,-100,0,0,1,1,1\nL,1,A,-500,0,0,-1,1,1\nS,1,A,-100,0,0,1,1,1\n"
                               "S,1,A,-500,0,0,-1,1,1\n",
                               perfect());
  REQUIRE(read.size() == 4);
  CHECK(read[0] == Approx(1.0));
  CHECK(read[1] == Approx(-13.0));
  CHECK(read[2] == Approx(-1.0));
  CHECK(read[3] == Approx(13.0));
}

TEST_CASE("a longer tool shows the pitch: EBX of 10 um/m moves a tool of -200 mm by -2 um") {
  const std::string errors = "[[contribution]]\ncomponent = \"EBX\"\nformula = \"10\"\n";
  const auto read = deviations(errors, "L,1,A,-100,0,0,1,1,1\nL,1,B,-100,0,0,1,1,1\n", perfect());
  REQUIRE(read.size() == 2);
  CHECK(read[0] == Approx(0.0));
  CHECK(read[1] == Approx(-2.0).epsilon(1e-3));
}

TEST_CASE(
    "a ball bar of known length is off by the same in all set-ups, one of unknown length by another zero each run") {
  const std::string rows = "S1,1,A,-100,0,0,1,1,1\nS2,1,A,-100,0,0,1,1,1\n";
  const std::string head = "# tool: A 0 0 0\n# set_up: S1 ball_bar -200 0 0\n# set_up: S2 ball_bar -100 100 0\n";
  LengthInstrumentSettings settings = perfect();
  settings.zero_um = 100.0, settings.bar_um = 2.0;
  for (const bool known : {true, false}) {
    Simulation simulation = simulation_of("", small_machine(), 3);
    const auto measured =
        must(measured_lengths(simulation,
                              (known ? "# bar_um: 2\n" : "") + head +
                                  "set_up,run,tool,x_mm,y_mm,z_mm,approach_x,approach_y,approach_z\n" + rows,
                              "plan.csv", settings));
    std::vector<std::string> last;
    for (const auto line : lines_of(measured.csv))
      if (line.starts_with("S")) last.emplace_back(split(line, ',').back());
    REQUIRE(last.size() == 2);
    CHECK((last[0] == last[1]) == known);
    CHECK((std::abs(*number_in(last[0])) < 12.0) == known);
  }
}

TEST_CASE("the same seed gives the same lengths, another seed others") {
  const std::string rows = "S,1,A,-100,0,0,1,1,1\nS,1,A,-200,0,0,1,1,1\n";
  CHECK(deviations("", rows, {}, 5) == deviations("", rows, {}, 5));
  CHECK(deviations("", rows, {}, 5) != deviations("", rows, {}, 6));
}

TEST_CASE("a plan is refused with all its faults") {
  Simulation simulation = simulation_of("");
  const std::string said = to_text(must_fail(measured_lengths(
      simulation, kPlanHead + "L,1,C,0,0,0,1,1,1\nL,1,A,900,0,0,1,1,1\nL,1,A,0,0,0,0,1,1\n", "plan.csv", {})));
  check_holds(said, {"plan.csv:6: set_up L, tool C: expected names of the head",
                     "plan.csv:7: expected X within -500 to 0 mm, found 900",
                     "plan.csv:8: expected numbers as coordinates, 1 or -1 as approaches"});
}

}  // namespace
}  // namespace ecs::emulator::test
