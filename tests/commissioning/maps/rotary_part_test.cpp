// The rotary axes of a map from a file of their errors and the machine file.
#include "commissioning/maps/rotary_part.hpp"

#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

std::string table_machine(const std::string& input = "resolution_deg = 0.001\n") {
  return "configuration = \"XYACTZ\"\n[axis.X]\ntravel_mm = [0, 500]\n[axis.Y]\ntravel_mm = [0, 400]\n[axis.Z]\n"
         "travel_mm = [-300, 0]\n[axis.A]\ntravel_deg = [-95, 30]\npivot_mm = [1, 2, 3]\nresolution_deg = -0.002\n"
         "[axis.C]\ntravel_deg = [0, 360]\npivot_mm = [250, 200, -300]\ntransducer_zero_deg = 15\n" +
         input;
}

/// What the files come to.
struct Part {
  laser::MapHeader header;
  std::vector<std::string> notes;
};
Result<Part> part_of(const std::string& rows, const std::string& machine = table_machine()) {
  const Folder folder;
  Part part;
  ECS_DO(add_rotary(part.header, folder.with("rotary.csv", "component,approach,p_deg,error\n" + rows),
                    machine.empty() ? "" : folder.with("machine.toml", machine), part.notes));
  return part;
}

}  // namespace

TEST_CASE("location errors and curves of the file become those of the unit, curves as compensation over a whole turn") {
  const Part part =
      must(part_of("XOC,,,8\nBOA,,,14\nEXC,0,0,3\nEXC,0,90,1\nEXC,0,180,-3\nEXC,0,270,0\n"
                   "ECC,1,0,2\nECC,1,180,4\nECC,-1,0,-2\nECC,-1,180,-4\n"));
  CHECK(part.notes.empty());
  CHECK(part.header.rotary_configuration == "XYACTZ");
  REQUIRE(part.header.rotary.size() == 2);
  const auto& [a, c] = std::pair(part.header.rotary[0], part.header.rotary[1]);
  CHECK(a.axis == RotaryAxis{'A', -0.002, 0.01, {1.0, 0.0, 0.0}, {1.0, 2.0, 3.0}, {0, 0, 0, 0, 14.0, 0}, 0.0});
  CHECK(a.compensation[0][0].empty());
  CHECK(c.axis == RotaryAxis{'C', 0.001, 0.005, {0.0, 0.0, 1.0}, {250.0, 200.0, -300.0}, {8.0}, 15.0});
  CHECK(c.start_deg == 0.0);
  CHECK(c.increment_deg == 10.0);
  for (std::size_t side = 0; side < 2; ++side) {
    REQUIRE(c.compensation[side][0].size() == 36);
    CHECK(c.compensation[side][0][9] == Approx(-1.0));
    CHECK(c.compensation[side][0][3] == Approx(-(3.0 - 2.0 / 3.0)));
    CHECK(c.compensation[side][0][31] == Approx(-4.0 / 3.0));  // between 270 and 360 deg
  }
  CHECK(c.compensation[1][5][18] == -4.0);
  CHECK(c.compensation[0][5][18] == 4.0);
  CHECK(c.compensation[0][1] == std::vector<double>(36));
  CHECK(contains(only(part.header.processing), "rotary axes from rotary.csv sha256="));
}

TEST_CASE("the increment is the widest on which every point is a value, and covers the travel of a tilting axis") {
  const Part part = must(part_of("EYA,0,-95,1\nEYA,0,-90,2\nEYA,0,30,3\nEXC,0,2.5,1\nEXC,0,10,2\n"));
  const laser::MapRotaryAxis& a = part.header.rotary[0];
  CHECK(a.increment_deg == 5.0);
  CHECK(a.start_deg == -95.0);
  REQUIRE(a.compensation[1][1].size() == 26);
  CHECK(a.compensation[1][1].front() == -1.0);
  CHECK(a.compensation[1][1].back() == -3.0);
  CHECK(part.header.rotary[1].increment_deg == 2.5);
  CHECK(part.notes.empty());
}

TEST_CASE(
    "points between the values of the unit are resampled every half degree, and the note states what that changes") {
  const Part part = must(part_of("EXC,0,0,0\nEXC,0,0.3,5\nEXC,0,0.6,0\nEXC,0,180.07,0\nEXC,0,355,0\n"));
  CHECK(part.header.rotary[1].increment_deg == 0.5);
  CHECK(contains(only(part.notes), "EXC: its points are not spaced as the unit needs them, resampled every 0.5 deg"));
}

TEST_CASE("rotary axes without an input, without a machine file or of another machine are refused with the reason") {
  CHECK(contains(to_text(must_fail(part_of("XOC,,,8\n", ""))), "--rotary needs --machine"));
  CHECK(contains(to_text(must_fail(part_of("XOC,,,8\n", table_machine("")))),
                 "[axis.C]: expected resolution_deg, the angle for each count of the encoder input of "
                 "the unit, found none"));
  CHECK(contains(to_text(must_fail(part_of("XOB,,,8\n"))), "which has no B"));
  CHECK(contains(to_text(must_fail(part_of("XOC,,,8\n", "configuration = \"TX\"\n[axis.X]\ntravel_mm = [0, 1]\n"))),
                 "an axis of the machine"));
}

}  // namespace ecs::commissioning
