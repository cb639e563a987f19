// Aerotech calibration files: tables of one and of two axes by hand, units, signs, and what is refused.
#include "modules/controllers/format.hpp"
#include "tests/support/test.hpp"

namespace ecs::controllers {
namespace {

Result<ControllerTables> read_cal(const std::string& text, const std::string& axes = {}) {
  const ControllerFormat& format = *controller_format("aerotech");
  CHECK(format.recognises(text));
  OptionValues options(format.read_options);
  if (!axes.empty()) options.set("axes", axes);
  return format.read({"chuck.cal", text, text, true, options});
}

const laser::MapTable& table_for(const ControllerTables& read, Component component) {
  const auto at = std::find_if(read.tables.begin(), read.tables.end(),
                               [&](const laser::MapTable& table) { return table.component == component; });
  REQUIRE(at != read.tables.end());
  return *at;
}

TEST_CASE("a table of one axis, its units and its sign") {
  const auto read = must(read_cal(":START 2 SAMPLEDIST=10 CORUNIT=PRIMARY/1000 NEGCOR\n; made\n0 1.5\n2\n:END\n"));
  const laser::MapTable& y = table_for(read, Component::EYY);
  CHECK(y.position_mm == std::vector<double>{0.0, 10.0, 20.0});
  CHECK(y.compensation == std::vector<double>{0.0, -1.5, -2.0});
  const auto inch = must(read_cal(":START 1 SAMPLEDIST=1 POSUNIT=ENGLISH CORUNIT=ENGLISH\n0 0.001\n:END\n"));
  CHECK(table_for(inch, Component::EXX).position_mm[1] == Approx(25.4));
  CHECK(table_for(inch, Component::EXX).compensation[1] == Approx(25.4));
}

TEST_CASE("a table of two axes is taken apart into a curve along each, and what is left is reported") {
  // Z by X (rows, descending) and Y (columns): 1 um a row, 2 um a column, and 0.5 um that only the table holds
  const auto read =
      must(read_cal("' made\n:START2D 1 2 4 6 -5 10 2\n:START2D OFFSETROW=100 OFFSETCOL=50\n"
                    "0.0045 0 0.0065 0\n0.0055 0 0.0075 0\n0.0065 0 0.0095 0\n:END\n",
                    "X=1,Y=2,Z=4"));
  const laser::MapTable& by_y = table_for(read, Component::EZY);
  const laser::MapTable& by_x = table_for(read, Component::EZX);
  CHECK(by_y.position_mm == std::vector<double>{50.0, 60.0});
  CHECK(by_x.position_mm == std::vector<double>{90.0, 95.0, 100.0});
  CHECK(by_y.compensation[1] - by_y.compensation[0] == Approx(7.0 / 3.0));
  CHECK(by_x.compensation[2] - by_x.compensation[1] == Approx(-1.0));
  REQUIRE(read.notes.size() == 2);
  CHECK(contains(read.notes[0], "the part that needs a two-axis table is ignored: rms 0.236 um, 0.333 um at most"));
  CHECK(contains(read.notes[1], "axis number 6 are ignored"));
}

TEST_CASE("bad files are refused with line and column") {
  const auto word = must_fail(read_cal(":START 1 SAMPLEDIST=10\n0 x\n:END\n"));
  CHECK(word.line == 2);
  CHECK(word.column == 3);
  CHECK(must_fail(read_cal(":START2D 1 2 1 2 5 5 2\n0 0 0\n:END\n")).line == 2);
  const auto axis = must_fail(read_cal("\n:START2D 7 2 1 2 5 5 2\n0 0 0 0\n:END\n"));
  CHECK(axis.line == 2);
  CHECK(contains(axis.message, "--axes"));
  for (const std::string number : {"5.5e25", "-1", "1.5", "1001"}) {
    CAPTURE(number);
    const auto along = must_fail(read_cal(":START " + number + " SAMPLEDIST=10\n0 1\n:END\n"));
    CHECK(contains(along.message, "expected an axis number from 0 to 1000"));
    CHECK_FALSE(read_cal(":START2D 1 2 1 2 5 5 1 OUTAXIS3=" + number + "\n0 0 1\n0 0 1\n:END\n"));
  }
  CHECK_FALSE(read_cal(":START 1 SAMPLEDIST=10 CORUNIT=FURLONG\n0 1\n:END\n"));
  CHECK(read_cal(":START 1 SAMPLEDIST=10\n0 1\n", "X=one").error().kind == ProblemKind::usage);
}

}  // namespace
}  // namespace ecs::controllers
