// The file of lengths: what is read, what is refused with its line.
#include "modules/lengths/length_test.hpp"
#include "tests/support/test.hpp"

namespace ecs::model {
namespace {

const std::string kHead =
    "# machine: made\n# configuration: XYTZ\n# tool: A 0 0 -100\n# set_up: S1 tracker -100 -100 -300\n"
    "# set_up: L1 interferometer 2 0 0\n";
const std::string kColumns = "set_up,run,tool,x_mm,y_mm,z_mm,approach_x,approach_y,approach_z,deviation_um\n";

std::string refusal(const std::string& text) { return to_text(must_fail(parse_lengths(text, "lengths.csv"))); }

TEST_CASE("a file comes back as it was written") {
  const std::string rows = "S1,1,A,0,0,0,1,1,1,1.5000\nL1,1,A,0,5,0,1,-1,1,0.0000\nL1,2,A,10,5,0,1,-1,1,-2.2500\n";
  const auto test = must(parse_lengths(kHead + kColumns + rows, "lengths.csv"));
  CHECK(test.set_ups[1].place == Vector3{1.0, 0.0, 0.0});
  CHECK(test.readings[1].approach == PerAxis<int>{1, -1, 1});
  CHECK(test.readings[2].run == 2);
  CHECK(point_of(test, test.readings[0]) == Vector3{0.0, 0.0, -100.0});
  CHECK(to_csv(must(parse_lengths(to_csv(test, false), "again.csv")), false) == to_csv(test, false));
  CHECK(must(parse_lengths(to_csv(test, true), "plan.csv", true)).readings.size() == 3);
}

TEST_CASE("every fault at once, with line and column") {
  const std::string said =
      refusal(kHead + kColumns + "S1,1,B,0,0,0,1,1,1,0\nS1,1,A,0,zero,0,1,0,1,0\nS9,1,A,0,0,0,1,1,1,9e9\n");
  check_holds(said,
              {"lengths.csv:7:6: tool: expected a name from a line `# tool: ` at the top of the file, found \"B\"",
               "lengths.csv:8:10: y_mm: expected a number, found \"zero\"",
               "approach_y: expected 1 or -1, the direction of the last motion, found 0",
               "lengths.csv:9:1: set_up: expected a name", "deviation_um: expected measured minus nominal length"});
}

TEST_CASE("a run is a whole number, a name holds no separator, a ball bar's uncertainty is above 0") {
  CHECK(contains(refusal(kHead + kColumns + "S1,1.5,A,0,0,0,1,1,1,0\nL1,1e30,A,0,0,0,1,1,1,0\n"),
                 "lengths.csv:7:4: run: expected a whole number from 1, found 1.5"));
  CHECK(contains(refusal("# tool: A,B 0 0 0\n" + kHead + kColumns), "tool: expected NAME X Y Z in mm"));
  CHECK(contains(refusal("# bar_um: 0\n" + kHead + kColumns), "bar_um: expected the standard uncertainty"));
}

TEST_CASE("what the head lacks is named") {
  const std::string said = refusal(kColumns + "S1,1,A,0,0,0,1,1,1,0\n");
  check_holds(said,
              {"expected a line `# tool: NAME X Y Z`", "expected a line `# set_up: NAME interferometer DX DY DZ`"});
  CHECK(contains(refusal("# set_up: S1 laser 1 2 3\n" + kColumns), "one of interferometer, tracker, ball_bar"));
  CHECK(contains(refusal(kHead + kColumns), "expected readings below the header, found none"));
  CHECK(contains(refusal(kHead + kColumns + "S1,1,A,0,0,0,1,1,1,0\n"), "set_up L1: expected readings of it"));
  CHECK(contains(refusal(kHead + "set_up,run,tool\nS1,1,A\n"), "x_mm"));
}

TEST_CASE("a step diagonal is no line: poses of an interferometer beside its line are refused") {
  const std::string said = refusal(kHead + kColumns +
                                   "S1,1,A,0,0,0,1,1,1,0\nL1,1,A,0,0,0,1,1,1,0\n"
                                   "L1,1,A,10,0,0,1,1,1,0\nL1,1,A,10,10,0,1,1,1,0\n");
  check_holds(said, {"lengths.csv:10: set-up L1: expected a pose on the line of line 8", "10.000 mm off it"});
}

TEST_CASE("a station at the tool is refused") {
  CHECK(contains(refusal(kHead + kColumns + "S1,1,A,-100,-100,-199,1,1,1,0\nL1,1,A,0,0,0,1,1,1,0\n"),
                 "nearer than 10 mm"));
}

}  // namespace
}  // namespace ecs::model
