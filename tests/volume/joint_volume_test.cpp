// The volume of machines with rotary axes against rigid bodies with exact matrices, and against the three-axis volume.
#include "volume/joint_volume.hpp"

#include "tests/support/exact_joints.hpp"
#include "tests/support/test.hpp"
#include "tests/support/volume_machine.hpp"

namespace ecs::volume {
namespace {

using kinematics::Angles;
using kinematics::Joint;

CompensatedMachine machine_of(const std::string& configuration) {
  CompensatedMachine machine = stated_rotary_machine(configuration);
  machine.tool_offset_mm = machine.parameters.tool_offset_mm = {5.0, -7.0, -120.0};
  machine.errors = errors_of_map(machine.map, machine.parameters, machine.tool_offset_mm);
  return machine;
}

const std::vector<std::string>& chains() {
  static const std::vector<std::string> some{"TXYZCB", "XYACTZ", "XYCTZB", "YXBCTZ", "ZTXYAB", "CXTYBZ", "XYZCT"};
  return some;
}

TEST_CASE("errors over a grid are those of single places, and exact to second order") {
  for (const std::string& chain : chains()) {
    CAPTURE(chain);
    CompensatedMachine machine = machine_of(chain);
    machine.errors.curves = CurveKind::carriage;  // as the exact matrices have them
    machine.errors.kinematics.terms = terms_of_machine(machine.parameters, Convention::iso, CurveKind::carriage);
    machine.rotary->angles_deg = {37.0, -51.0, 128.0};
    const Grid grid = grid_over(machine.travel_mm, 27, {});
    const auto components = *machine.errors.components(grid);
    const Field field = *errors_over(machine, grid)->before.field;

    test::ExactMachine exact{.configuration = chain,
                             .rotary = machine.rotary->machine.rotary,
                             .tool_offset_mm = machine.tool_offset_mm,
                             .location = machine.rotary->errors.location};
    exact.values.squareness = components.squareness;
    const auto error_at = [&](std::size_t side, const GridIndex& index) {
      RotaryErrors motions = machine.rotary->errors;
      motions.location = {};
      exact.values = rotary_values(motions, machine.rotary->angles_deg, kSides[side]);
      exact.values.squareness = components.squareness;
      for (std::size_t c = 0; c < kCurves; ++c)
        exact.values.curve[c / 6][c % 6] = components.curve[side][c][index[c / 6]];
      return test::exact_tool_error(exact, grid.at(index), machine.rotary->angles_deg).error_um;
    };
    // Both are counted from another origin: what differs is the same at every place and side.
    const Vector3 here = field.at(0, {}), there = error_at(0, {});
    for (std::size_t side = 0; side < kSides.size(); ++side)
      for (std::size_t x = 0; x < 3; ++x)
        for (std::size_t y = 0; y < 3; ++y)
          for (std::size_t z = 0; z < 3; ++z) {
            const Vector3 found = field.at(side, {x, y, z}), expected = error_at(side, {x, y, z});
            for (std::size_t d = 0; d < kAxes; ++d)
              CHECK(std::abs(found[d] - here[d] - (expected[d] - there[d])) < 0.02);
          }
  }
}

TEST_CASE("with rotary axes at 0 and without errors of theirs the volume is that of the three axes") {
  for (const std::string& chain : chains()) {
    CAPTURE(chain);
    CompensatedMachine machine = machine_of(chain);
    machine.rotary->errors = {};
    const Grid grid = grid_over(machine.travel_mm, 27, {});
    const BeforeAfter with = *errors_over(machine, grid);
    machine.rotary.reset();
    const BeforeAfter without = *errors_over(machine, grid);
    for (std::size_t side = 0; side < kSides.size(); ++side)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t d = 0; d < kAxes; ++d) {
          CHECK(with.before.at(grid, side, {i, 2 - i, i})[d] ==
                Approx(without.before.at(grid, side, {i, 2 - i, i})[d]));
          CHECK(std::abs(with.after.at(grid, side, {i, 2 - i, i})[d] - without.after.at(grid, side, {i, 2 - i, i})[d]) <
                1e-9);
        }
  }
}

TEST_CASE("what the unit adds along X, Y, Z turns with the table; rotary errors remain") {
  CompensatedMachine machine = straight_machine("XYTZ");  // 20 um of X over 1000 mm
  RotaryAxes rotary;
  rotary.machine.chain = *kinematics::joint_chain_of("XYCTZ");
  rotary.machine.terms = kinematics::terms_of(rotary.machine.chain);
  rotary.travel_deg[2] = {0.0, 360.0};
  rotary.errors.location[2][0] = 10.0;  // XOC
  rotary.angles_deg = {0.0, 0.0, 90.0};
  machine.rotary = rotary;
  const Grid grid = grid_over(machine.travel_mm, 8, {});
  const BeforeAfter errors = *errors_over(machine, grid);
  const Vector3 before = errors.before.at(grid, 1, {1, 0, 0}), after = errors.after.at(grid, 1, {1, 0, 0});
  CHECK(before[0] == Approx(-10.0));  // counted from C 0, where XOC was along the workpiece's X
  CHECK(before[1] == Approx(30.0));
  CHECK(after[0] == Approx(-10.0));
  CHECK(after[1] == Approx(10.0));
}

TEST_CASE("a map with the errors of the rotary axes leaves nothing of them, one with half of them leaves half") {
  for (const char* const chain : {"TXYZCB", "XYACTZ", "XYCTZB"}) {
    CAPTURE(chain);
    CompensatedMachine machine = machine_of(chain);
    RotaryAxes& rotary = *machine.rotary;
    constexpr double kIncrement_deg = 10.0, kTurn_deg = 360.0;
    for (std::size_t r = 0; r < kAxes; ++r) {
      if (!rotary.travel_deg[r]) continue;
      laser::MapRotaryAxis one{.axis = {.letter = "ABC"[r],
                                        .direction = rotary.machine.rotary[r].direction,
                                        .pivot_mm = rotary.machine.rotary[r].pivot_mm,
                                        .location = rotary.errors.location[r]},
                               .increment_deg = kIncrement_deg};
      RotaryErrors motions = rotary.errors;
      motions.location = {};
      for (double angle_deg = 0.0; angle_deg < kTurn_deg; angle_deg += kIncrement_deg) {
        Angles angles{};
        angles[r] = angle_deg;
        for (std::size_t side = 0; side < kSides.size(); ++side)
          for (std::size_t s = 0; s < kSenseNames.size(); ++s)
            one.compensation[side][s].push_back(-rotary_values(motions, angles, kSides[side]).curve[kAxes + r][s]);
      }
      machine.map.header.rotary.push_back(std::move(one));
    }
    rotary.errors = rotary_errors_in(machine.map.header);
    rotary.angles_deg = {37.0, -51.0, 128.0};
    const Grid grid = grid_over(machine.travel_mm, 27, {});
    const auto largest = [&](const VolumeError& error) {
      double most = 0.0;
      for (std::size_t side = 0; side < kSides.size(); ++side)
        for (std::size_t i = 0; i < 3; ++i)
          for (const double e : error.at(grid, side, {i, 2 - i, (i + side) % 3})) most = std::max(most, std::abs(e));
      return most;
    };
    const BeforeAfter whole = *errors_over(machine, grid);
    CHECK(largest(whole.before) > 5.0);
    CHECK(largest(whole.after) < 1e-6);
    CompensatedMachine doubled = machine;  // errors twice as large as the map says: half of them remains
    doubled.rotary->errors = rotary_errors_in(machine.map.header, 2.0);
    const BeforeAfter half = *errors_over(doubled, grid);
    CompensatedMachine none = machine;
    none.rotary->errors = {};
    const BeforeAfter linear = *errors_over(none, grid);
    for (std::size_t side = 0; side < kSides.size(); ++side)
      for (std::size_t d = 0; d < kAxes; ++d)
        CHECK(half.after.at(grid, side, {1, 2, 0})[d] ==
              Approx(whole.before.at(grid, side, {1, 2, 0})[d] - linear.before.at(grid, side, {1, 2, 0})[d]));
  }
}

TEST_CASE("bending shifts the tool along directions of exact matrices; a map that holds it leaves nothing of it") {
  for (const char* const chain : {"TXYZCB", "XYCTZB"}) {
    CAPTURE(chain);
    CompensatedMachine machine = machine_of(chain);
    RotaryAxes& rotary = *machine.rotary;
    const Grid grid = grid_over(machine.travel_mm, 27, {});
    rotary.angles_deg = {0.0, -51.0, 128.0};
    const Vector3 straight = errors_over(machine, grid)->before.at(grid, 0, {1, 2, 0});
    rotary.errors.bending = {{11.0, -7.0, 5.0, 3.0, -2.0, 9.0}, {40.0, 25.0, -30.0, 15.0, 35.0, -20.0}};
    const Vector3 bent = errors_over(machine, grid)->before.at(grid, 0, {1, 2, 0});

    const test::ExactMachine exact{
        .configuration = chain, .rotary = rotary.machine.rotary, .tool_offset_mm = machine.tool_offset_mm};
    const auto at = [&](Vector3 position_mm, Angles angles) { return exact_pose(exact, position_mm, angles); };
    const Angles level{0.0, 0.0, 128.0};
    Eigen::Matrix3d of_slides;
    for (std::size_t d = 0; d < kAxes; ++d) {
      Vector3 unit{};
      unit[d] = 1.0;
      of_slides.col(static_cast<Eigen::Index>(d)) = at(unit, level).translation() - at({}, level).translation();
    }
    const double sine = std::sin(-51.0 * 3.14159265358979 / 180.0),
                 rest = 1.0 - std::cos(51.0 * 3.14159265358979 / 180.0);
    const double length_m = std::sqrt(5.0 * 5.0 + 7.0 * 7.0 + 120.0 * 120.0) / 1000.0;
    const Eigen::Vector3d machine_um{11.0 * sine + 3.0 * rest, -7.0 * sine - 2.0 * rest, 5.0 * sine + 9.0 * rest},
        tool_um{40.0 * sine + 15.0 * rest, 25.0 * sine + 35.0 * rest, -30.0 * sine - 20.0 * rest};
    const Eigen::Vector3d expected = of_slides * machine_um + length_m * (at({}, level).linear() * tool_um);
    for (std::size_t d = 0; d < kAxes; ++d)
      CHECK(bent[d] - straight[d] == Approx(expected[static_cast<Eigen::Index>(d)]).epsilon(1e-6));

    rotary.errors = {};  // what the map holds is all that is wrong with the rotary axes
    for (std::size_t r = 0; r < kAxes; ++r)
      if (rotary.travel_deg[r])
        machine.map.header.rotary.push_back({.axis = {.letter = "ABC"[r],
                                                      .direction = rotary.machine.rotary[r].direction,
                                                      .pivot_mm = rotary.machine.rotary[r].pivot_mm}});
    const Vector3 without = errors_over(machine, grid)->after.at(grid, 1, {0, 1, 2});
    machine.map.header.bending = {{11.0, -7.0, 5.0, 3.0, -2.0, 9.0}, {40.0, 25.0, -30.0, 15.0, 35.0, -20.0}};
    rotary.errors = rotary_errors_in(machine.map.header);
    const Vector3 with = errors_over(machine, grid)->after.at(grid, 1, {0, 1, 2});
    for (std::size_t d = 0; d < kAxes; ++d) CHECK(std::abs(with[d] - without[d]) < 1e-9);
  }
}

TEST_CASE("settings cover the travels; a whole turn does not count its beginning twice") {
  RotaryAxes rotary;
  rotary.travel_deg[0] = {-90.0, 30.0};
  rotary.travel_deg[2] = {0.0, 360.0};
  const std::vector<Angles> settings = settings_over(rotary, 4);
  REQUIRE(settings.size() == 16);
  CHECK(settings.front() == Angles{-90.0, 0.0, 0.0});
  CHECK(settings[3] == Angles{30.0, 0.0, 0.0});
  CHECK(settings.back() == Angles{30.0, 0.0, 270.0});
  rotary.travel_deg[0] = {10.0, 30.0};
  CHECK(reference_angles(rotary) == Angles{10.0, 0.0, 0.0});
}

TEST_CASE("the largest error is found with its place and its angles") {
  CompensatedMachine machine = machine_of("XYACTZ");
  const VolumeAnswer answer = *evaluated(machine, 7776);
  CHECK(answer.settings.size() == 36);
  CHECK(answer.grid.places() == 216);
  CHECK(answer.before.all.places == 7776);
  machine.rotary->angles_deg = answer.settings[answer.before.all.setting];
  const Grid there = grid_at(machine.travel_mm, answer.before.all.at_mm, {});
  const Vector3 error = errors_over(machine, there)->before.at(there, side_of(answer.before.all.approach), {});
  CHECK(std::hypot(error[0], error[1], error[2]) == Approx(answer.before.all.largest_um));
  CHECK(answer.after.all.largest_um > 0.0);
}

}  // namespace
}  // namespace ecs::volume
