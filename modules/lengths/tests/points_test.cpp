// All components from deviations of points: a grid in space, a ball plate in several places. Each placement lies
// anyhow.
#include <fmt/format.h>

#include "modules/lengths/tests/support/made_lengths.hpp"

namespace ecs::test {
namespace {

using model::Identification;
using model::LengthInstrument;

/// Deviations of points as a probe finds them.
struct MadePoints : MadeLengths {
  std::vector<std::array<Vector3, 2>> lies;  ///< of each set-up: translation [um], rotation [um/m]

  explicit MadePoints(const std::string& configuration, std::vector<model::LengthTool> tools = {{"A", {0, 0, 0}}})
      : MadeLengths(configuration) {
    test.tools = std::move(tools);
  }
  std::size_t placement() {
    test.set_ups.push_back({fmt::format("P{}", test.set_ups.size() + 1), LengthInstrument::points, {}, 0});
    const double n = static_cast<double>(lies.size()) + 1.0;
    lies.push_back({Vector3{30.0 * n, -12.0, 7.0 * n}, Vector3{40.0 * n, -25.0 * n, 60.0}});
    return test.set_ups.size() - 1;
  }
  /// All three deviations at a point. @param directions  fewer of them
  void point(std::size_t set_up, std::size_t tool, const Vector3& at, const PerAxis<int>& approach,
             const PerAxis<bool>& directions = {true, true, true}) {
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (!directions[a]) continue;
      model::LengthReading reading{.line = static_cast<int>(test.readings.size()) + 10, .set_up = set_up, .tool = tool};
      reading.position_mm = at;
      reading.approach = approach;
      reading.along[a] = 1.0;
      test.readings.push_back(reading);
    }
  }
  /// Every point twice: once with every axis forward, once with a mixture, so that the axes do not reverse together.
  /// @param counts  along each axis
  void grid(std::size_t set_up, std::size_t tool, const PerAxis<int>& counts,
            const PerAxis<bool>& directions = {true, true, true}, const Vector3& low = {0, 0, 0},
            const Vector3& high = {500, 400, 300}, bool together = false) {
    for (const bool mixed : {false, true})
      for (int z = 0; z < counts[2]; ++z)
        for (int y = 0; y < counts[1]; ++y)
          for (int x = 0; x < counts[0]; ++x) {
            Vector3 at{};
            PerAxis<int> approach{1, 1, 1};
            const PerAxis<int> place{x, y, z};
            for (std::size_t a = 0; a < kAxes; ++a) {
              at[a] = counts[a] < 2 ? low[a] : std::lerp(low[a], high[a], place[a] / (counts[a] - 1.0));
              if (mixed && (together || (x + 2 * y + z + static_cast<int>(a)) % 3 != 0)) approach[a] = -1;
            }
            point(set_up, tool, at, approach, directions);
          }
  }
  void measure_points(const MadeComponents& made, double noise_um = 0.0, unsigned seed = 1) {
    std::mt19937 generator(seed);
    NormalDraws normal;
    std::vector<std::optional<Vector3>> first(lies.size());
    for (model::LengthReading& r : test.readings) {
      const Vector3 error = made.error_um(machine, r.position_mm, r.approach, test.tools[r.tool].offset_mm);
      const Vector3 point = model::point_of(test, r);
      if (!first[r.set_up]) first[r.set_up] = point;
      Vector3 lever{};
      for (std::size_t a = 0; a < kAxes; ++a) lever[a] = (point[a] - (*first[r.set_up])[a]) / 1000.0;
      const auto& [shift, turn] = lies[r.set_up];
      const Vector3 rigid{shift[0] + turn[1] * lever[2] - turn[2] * lever[1],
                          shift[1] + turn[2] * lever[0] - turn[0] * lever[2],
                          shift[2] + turn[0] * lever[1] - turn[1] * lever[0]};
      r.deviation_um = noise_um > 0.0 ? noise_um * normal(generator) : 0.0;
      for (std::size_t a = 0; a < kAxes; ++a) r.deviation_um += r.along[a] * (error[a] + rigid[a]);
    }
  }
};

const std::vector<model::LengthTool> kThreeTools{{"A", {0, 0, 0}}, {"B", {0, 0, -200}}, {"C", {120, 0, -90}}};

TEST_CASE("an exact grid in space with three tools gives all 21 components back, however it lies") {
  for (const char* configuration : {"TXYZ", "XYTZ", "XYZT"}) {
    CAPTURE(configuration);
    MadePoints points(configuration, kThreeTools);
    const std::size_t grid = points.placement();
    for (std::size_t tool = 0; tool < kThreeTools.size(); ++tool) points.grid(grid, tool, {6, 5, 5});
    const MadeComponents made(31);
    points.measure_points(made);
    const Identification found = identified(points, {.scale_um_per_m = 0.0});
    CHECK(found.whole());
    CHECK(farthest_from(found, made, points.machine) < 1e-5);
    REQUIRE(found.set_ups[0].turned_um_per_m);
  }
}

TEST_CASE("a ball plate in the three planes, at two places of each, gives what acts with one tool") {
  MadePoints plates("XYTZ");
  const auto plate = [&](const PerAxis<int>& counts, const Vector3& low) {
    plates.grid(plates.placement(), 0, counts, {true, true, true}, low);
  };
  for (const double part : {0.0, 1.0}) {
    plate({6, 6, 1}, {0, 0, 300.0 * part});
    plate({6, 1, 6}, {0, 400.0 * part, 0});
    plate({1, 6, 6}, {500.0 * part, 0, 0});
  }
  const MadeComponents made(32);
  plates.measure_points(made);
  const Identification found = identified(plates, {.scale_um_per_m = 0.0});
  for (const auto& curve : found.curves) CHECK_MESSAGE(curve.why_not.empty(), curve.why_not);
  CHECK(found.whole());
  CHECK(farthest_from(found, made, plates.machine) < 1e-5);
  CHECK_FALSE(found.curves[index_of(Component::EAZ)].acts);
}

TEST_CASE("one plate in one plane says nothing of the third axis, and names it") {
  MadePoints plate("XYTZ");
  plate.grid(plate.placement(), 0, {7, 7, 1});
  plate.measure_points(MadeComponents(33));
  const Identification found = identified(plate, {.scale_um_per_m = 0.0});
  CHECK_FALSE(found.whole());
  CHECK(found.curves[index_of(Component::EXX)].determined);
  CHECK(found.curves[index_of(Component::EYY)].determined);
  CHECK(found.squareness[0].determined);
  CHECK(contains(found.curves[index_of(Component::EZZ)].why_not, "Z is at one position in every set-up"));
  CHECK(contains(found.squareness[1].why_not, "B0Z is not determined"));
}

TEST_CASE("a placement that lies anyhow hides a squareness where only one of its two deviations is measured") {
  MadePoints grid("XYTZ");
  grid.grid(grid.placement(), 0, {6, 6, 6}, {true, false, false});
  grid.measure_points(MadeComponents(34));
  const Identification found = identified(grid, {.scale_um_per_m = 0.0});
  CHECK(found.curves[index_of(Component::EXX)].determined);
  CHECK(contains(found.squareness[0].why_not, "C0Y is not determined: no placement has both deviations along X"));
  CHECK(contains(found.curves[index_of(Component::EYX)].why_not, "no deviation along Y is given while X moves"));
}

TEST_CASE("axes that always reverse together leave their reversal errors in one, and the components are named") {
  MadePoints grid("XYTZ");
  grid.grid(grid.placement(), 0, {6, 6, 5}, {true, true, true}, {0, 0, 0}, {500, 400, 300}, true);
  grid.measure_points(MadeComponents(35));
  const Identification found = identified(grid, {.scale_um_per_m = 0.0});
  CHECK(contains(found.curves[index_of(Component::EXX)].why_not, "only together with"));
  CHECK(found.squareness[0].determined);
}

TEST_CASE("the stated 95 % of a grid with noise hold for 95 % of the values") {
  double inside = 0.0, all = 0.0, squares_inside = 0.0, squares = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    MadePoints points("XYTZ");
    points.grid(points.placement(), 0, {6, 6, 5});
    points.grid(points.placement(), 0, {6, 6, 5});
    const MadeComponents made(100 + seed);
    points.measure_points(made, 1.0, seed);
    const Identification found = identified(points, {.scale_um_per_m = 0.0});
    CHECK(found.whole());
    CHECK(found.residual_um == Approx(1.0).epsilon(0.15));
    for (const auto& curve : found.curves) {
      if (!curve.acts) continue;
      const auto& travel = points.machine.axes[index_of(moving_axis(curve.component))]->travel_mm;
      for (std::size_t i = 0; i < curve.position_mm.size(); ++i) {
        const double part = (curve.position_mm[i] - travel[0]) / (travel[1] - travel[0]);
        const double off = curve.forward[i] - made.value(curve.component, part, 1);
        inside += std::abs(off) <= curve.U_forward[i] ? 1.0 : 0.0;
        all += 1.0;
      }
    }
    for (const auto& square : found.squareness) {
      const double off = square.um_per_m - made.value(square.component, 0.0, 0);
      squares_inside += std::abs(off) <= square.U_um_per_m ? 1.0 : 0.0;
      squares += 1.0;
    }
  }
  CAPTURE(inside / all);
  CAPTURE(squares_inside / squares);
  CHECK(inside / all > 0.90);
  CHECK(inside / all < 0.995);
  CHECK(squares_inside >= 0.86 * squares);
}

const std::string kPointsHead =
    "# configuration: XYTZ\n# tool: A 0 0 0\n# set_up: G1 points\n"
    "set_up,run,tool,x_mm,y_mm,z_mm,approach_x,approach_y,approach_z,"
    "deviation_x_um,deviation_y_um,deviation_z_um\n";

TEST_CASE("a file of points gives a reading for every deviation in it, and comes back as it was written") {
  const auto test =
      must(model::parse_lengths(kPointsHead + "G1,1,A,0,0,0,1,1,1,1.5,,-2\nG1,1,A,10,0,0,1,1,1,,0.25,\n", "grid.csv"));
  REQUIRE(test.readings.size() == 3);
  CHECK(test.readings[1].along == Vector3{0.0, 0.0, 1.0});
  CHECK(test.readings[1].deviation_um == -2.0);
  CHECK(test.readings[2].along == Vector3{0.0, 1.0, 0.0});
  const std::string text = model::to_csv(test, false);
  CHECK(model::to_csv(must(model::parse_lengths(text, "again.csv")), false) == text);
}

TEST_CASE("a point without a deviation, another instrument and a plan of points are refused") {
  const auto refusal = [](const std::string& text, bool plan = false) {
    return to_text(must_fail(model::parse_lengths(text, "grid.csv", plan)));
  };
  CHECK(contains(refusal(kPointsHead + "G1,1,A,0,0,0,1,1,1,,,\n"), "grid.csv:5: expected a deviation along one axis"));
  CHECK(contains(refusal("# set_up: S tracker 1 2 3\n" + kPointsHead + "G1,1,A,0,0,0,1,1,1,1,1,1\n"),
                 "set_up: expected NAME points in a file with deviation_x_um"));
  CHECK(contains(refusal(kPointsHead + "G1,1,A,0,0,0,1,1,1,1,1,1\n", true), "expected a plan of lengths"));
  CHECK(contains(refusal("# deviation_x_um\n# tool: A 0 0 0\n# set_up: S tracker 1 2 3\n"
                         "set_up,run,tool,x_mm,y_mm,z_mm,approach_x,approach_y,approach_z\nS,1,A,0,0,0,1,1,1\n"),
                 "expected a column deviation_um"));
}

}  // namespace
}  // namespace ecs::test
