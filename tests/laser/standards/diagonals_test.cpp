// Diagonal tests against machines of which only squareness, scale or the beam is wrong.
#include "laser/standards/diagonals.hpp"

#include <array>
#include <functional>

#include <fmt/format.h>

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

const std::string kVolume = "# x_mm: 800\n# y_mm: 600\n# z_mm: 500\n";

using Point = std::array<double, 3>;
/// Error vector [um] at a point [mm] from the middle of the volume.
using ErrorAt = std::function<Point(const Point&)>;

std::array<int, 3> signs_of(const std::string& name) {
  std::array<int, 3> signs{};
  for (std::size_t i = 0; i < 3; ++i) signs[i] = name[i] == 'P' ? 1 : name[i] == 'N' ? -1 : 0;
  return signs;
}

std::string diagonal_rows(const std::string& name, const ErrorAt& error) {
  const Point span{800.0, 600.0, 500.0};
  const auto signs = signs_of(name);
  double length = 0.0;
  for (std::size_t i = 0; i < 3; ++i) length = std::hypot(length, signs[i] * span[i]);
  std::string text;
  for (int run = 1; run <= 2; ++run)
    for (const int approach : {1, -1})
      for (int k = 0; k <= 10; ++k) {
        Point point{};
        for (std::size_t i = 0; i < 3; ++i) point[i] = signs[i] * span[i] * (k / 10.0 - 0.5);
        const Point e = error(point);
        double along = 0.0;
        for (std::size_t i = 0; i < 3; ++i) along += signs[i] * span[i] / length * e[i];
        text += fmt::format("{},{:.6f},{:.6f},{},{}\n", name, length * k / 10.0, along, approach, run);
      }
  return text;
}

std::string file_of(const std::vector<std::string>& names, const ErrorAt& error) {
  std::string text = kVolume + "diagonal,position_mm,deviation_um,approach,run\n";
  for (const std::string& name : names) text += diagonal_rows(name, error);
  return text;
}

const std::vector<std::string> kBody{"PPP", "NPP", "PNP", "PPN"};

DiagonalResults results_of(const std::string& text) {
  return must(diagonal_results_of(must(parse_diagonals(text, "diagonals.csv"))));
}

std::string diagonal_refusal(const std::string& text) {
  return to_text(must_fail(parse_diagonals(text, "diagonals.csv")));
}

Point nothing_wrong(const Point&) { return {}; }

}  // namespace

TEST_CASE("C0Y, B0Z and A0Z alone come back from four body diagonals") {
  const auto results = results_of(file_of(kBody, [](const Point& p) {
    return Point{(-16.0 * p[1] - 38.8 * p[2]) / 1000.0, 66.9 * p[2] / 1000.0, 0.0};
  }));
  REQUIRE(results.squareness.size() == 3);
  CHECK(results.squareness[0].um_per_m == Approx(16.0).epsilon(1e-4));
  CHECK(results.squareness[1].um_per_m == Approx(-38.8).epsilon(1e-4));
  CHECK(results.squareness[2].um_per_m == Approx(-66.9).epsilon(1e-4));
  CHECK(results.notes.size() == 1);
}

TEST_CASE("a common scale error of 10 um/m is the growth of every diagonal and no squareness") {
  const auto results = results_of(file_of(kBody, [](const Point& p) {
    return Point{p[0] / 100.0, p[1] / 100.0, p[2] / 100.0};
  }));
  for (const DiagonalValues& values : results.diagonals) CHECK(values.growth_um_per_m == Approx(10.0).epsilon(1e-4));
  CHECK(std::abs(results.squareness[0].um_per_m) < 1e-3);
  CHECK(*results.body_difference_um < 1e-3);
  CHECK(*results.E_body_um == Approx(11.18).epsilon(1e-3));  // 10 um/m over 1118 mm
}

TEST_CASE("two face diagonals of XY show C0Y and nothing else") {
  const auto results = results_of(file_of({"PP0", "NP0"}, [](const Point& p) {
    return Point{-20.0 * p[1] / 1000.0, 0.0, 0.0};
  }));
  CHECK(only(results.squareness).name == "C0Y");
  CHECK(results.squareness[0].um_per_m == Approx(20.0).epsilon(1e-4));
  CHECK(!results.E_body_um);
}

TEST_CASE("step diagonals: a beam 0.1 mrad out of line moves 50 um between perfect axes, and the diagonal shows none") {
  const Point span{800.0, 600.0, 500.0};
  const double length = std::sqrt(800.0 * 800.0 + 600.0 * 600.0 + 500.0 * 500.0);
  // The beam is tilted towards (600, −800, 0)/1000, across the diagonal.
  const Point beam{span[0] / length + 1e-4 * 0.6, span[1] / length - 1e-4 * 0.8, span[2] / length};
  std::string text = kVolume + "# kind: step\ndiagonal,position_mm,deviation_um,moved\n";
  for (const std::string name : {"PPP", "NPP", "PNP", "PPN"}) {
    const auto signs = signs_of(name);
    double deviation = 0.0, position = 0.0;
    text += fmt::format("{},0,0,Z\n", name);
    for (int step = 1; step <= 10; ++step)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        deviation += (signs[0] > 0 && signs[1] > 0 && signs[2] > 0 ? beam[axis] - span[axis] / length : 0.0) *
                     span[axis] / 10.0 * 1000.0;
        position += span[axis] / length * span[axis] / 10.0;
        text += fmt::format("{},{:.6f},{:.6f},{}\n", name, position, deviation, "XYZ"[axis]);
      }
  }
  const auto test = must(parse_diagonals(text, "step.csv"));
  CHECK(*test.diagonals[0].while_moving_um[0] == Approx(48.0));  // 0.1 mrad × 0.6 × 800 mm
  CHECK(*test.diagonals[0].while_moving_um[1] == Approx(-48.0));
  CHECK(*test.diagonals[0].while_moving_um[2] == Approx(0.0));
  const auto results = must(diagonal_results_of(test));
  CHECK(*results.E_body_um < 1e-3);
  check_holds(results.notes.back(), {"the errors of the axes are not separated", "Chapman 2003"});
}

TEST_CASE("what a diagonal test lacks is said in words") {
  CHECK(contains(diagonal_refusal(file_of({"PPP", "NPP", "PPN"}, nothing_wrong)),
                 "expected the 4 diagonals of the body, found 3; missing: PNP"));
  CHECK(contains(diagonal_refusal(file_of({"PP0"}, nothing_wrong)),
                 "expected the 2 diagonals of the face, found 1; missing: PN0"));
  CHECK(contains(diagonal_refusal(file_of({"PPP", "NPP", "PNP", "PPN", "NNP"}, nothing_wrong)),
                 "diagonal: NNP is PPN from its other end"));
  CHECK(contains(diagonal_refusal("# x_mm: 800\ndiagonal,position_mm,deviation_um\nPP0,0,0\nPN0,0,0\n"),
                 "diagonal PP0: expected `# y_mm: ` with the length of the volume along Y [mm], found none"));
  CHECK(contains(diagonal_refusal(kVolume + "diagonal,position_mm,deviation_um\nXY,0,0\n"),
                 "expected P, N or 0 for each of X, Y and Z, such as PPN or PN0, found \"XY\""));
  CHECK(contains(diagonal_refusal(kVolume + "# kind: step\ndiagonal,position_mm,deviation_um\nPPP,0,0\n"),
                 "expected a column moved"));
}

TEST_CASE("numbers of a diagonal test that no measurement has are refused") {
  const std::string head = "diagonal,position_mm,deviation_um,run\n";
  CHECK(contains(diagonal_refusal("# x_mm: 1e300\n# y_mm: 600\n" + head + "PP0,0,0,1\nNP0,0,0,1\n"),
                 "x_mm: expected a length above 0, at most 1e+06, found \"1e300\""));
  for (const char* row : {"PP0,1e300,0,1", "PP0,0,1e300,1", "PP0,0,0,1e300"}) {
    CAPTURE(row);
    CHECK(contains(diagonal_refusal(kVolume + head + row + "\n"), "expected a number within 1e+06, found \"1e300\""));
  }
}
