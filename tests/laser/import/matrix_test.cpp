// Matrices of values by their layout, as the shipped profiles describe bed meshes and height maps.
#include "laser/import/matrix.hpp"

#include "laser/import/import.hpp"
#include "tests/support/readings.hpp"

namespace ecs::laser {
namespace {

ImportOptions by(const char* axes, const char* section, const char* line_prefix) {
  return {.axis = Axis::X,
          .sense = Sense::EZ,
          .reading_unit = unit_named("mm"),
          .matrix = MatrixLayout{matrix_axes(axes).value(), section, line_prefix, "0", ','}};
}

ImportOptions bed_mesh() { return by("x=min_x..max_x*x_count,y=min_y..max_y*y_count", "[bed_mesh ", "#*#"); }

ImportOptions height_map() {
  return by("x=xmin|min0+xspacing|spacing0|spacing*xnum|num0,y=ymin|min1+yspacing|spacing1|spacing*ynum|num1", "", "");
}

MeasurementSet read(const std::string& text, const ImportOptions& options) {
  return must(parse_any(text, "matrix.txt", options)).set;
}

std::string refusal(const std::string& text, const ImportOptions& options) {
  return to_text(must_fail(parse_any(text, "matrix.txt", options)));
}

TEST_CASE("places of a height map that were not probed are left out, in every version of its head") {
  const std::string rows = "  0.043,  0, -0.050\n  0.041,  0.000,  0.057\n";
  for (const char* head :
       {"xmin,xmax,ymin,ymax,radius,spacing,xnum,ynum\n25,75,10,35,-1,25,3,2\n",
        "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n25,75,10,35,-1,25,25,3,2\n",
        "axis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1\nX,Y,25,75,10,35,-1,25,25,3,2\n"}) {
    const auto set =
        read("RepRapFirmware height map file v2 generated at noon\n" + std::string(head) + rows, height_map());
    REQUIRE(set.readings.size() == 5);
    CHECK(set.readings[1].position_mm == Vector3{75.0, 10.0, 0.0});
    CHECK(set.readings[3].error == 0.0);
    REQUIRE(set.notes.size() == 1);
    CHECK(contains(set.notes[0], "1 cell \"0\" left out"));
  }
  CHECK(refusal("RepRapFirmware height map file v1\nxmin,xmax,ymin,ymax,radius,spacing,xnum,ynum\n"
                "25,75,10,35,-1,25,3,2\n1,2,3\n",
                height_map())
            .find("expected 2 rows") != std::string::npos);
}

TEST_CASE("a bed mesh lies between its corners, rows along X") {
  const auto set = read(sample_text("bed_mesh.cfg"), bed_mesh());
  REQUIRE(set.readings.size() == 6);
  CHECK(set.readings[1].position_mm == Vector3{112.0, 10.0, 0.0});
  CHECK(set.readings[5].position_mm == Vector3{214.0, 190.0, 0.0});
  CHECK(set.readings[5].error == Approx(-30.0));
  CHECK(set.readings[5].sense == Sense::EZ);
}

TEST_CASE("a spoiled cell, a short row and a missing position are named with their place") {
  const std::string text = sample_text("bed_mesh.cfg");
  const auto spoiled = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return refusal(changed, bed_mesh());
  };
  CHECK(contains(spoiled("0.0725", "0.07x5"), "matrix.txt:4:"));
  CHECK(contains(spoiled("0.0225, ", ""), "expected 3 values in the row, found 2"));
  CHECK(contains(spoiled("min_x", "min_q"), "X: expected the first position (min_x)"));
}

TEST_CASE("a layout that is none is refused with its form") {
  for (const char* text : {"", "x=1", "x=1..2", "x=1..2,x=1..2", "q=1..2,y=1..2", "x=1,y=2"})
    CHECK(matrix_axes(text).error().kind == ProblemKind::usage);
}

}  // namespace
}  // namespace ecs::laser
