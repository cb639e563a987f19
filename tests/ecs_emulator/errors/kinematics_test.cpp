#include "ecs_emulator/errors/kinematics.hpp"

#include "ecs_emulator/random/random.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

ComponentValues random_errors(Random& random, double size) {
  ComponentValues errors{};
  for (double& e : errors) e = size * (2.0 * random.uniform() - 1.0);
  return errors;
}

Vector3 random_position(Random& random) {
  return {2000.0 * random.uniform() - 1500.0, 2000.0 * random.uniform() - 700.0, 1000.0 * random.uniform() - 900.0};
}

/// Largest difference between the exact machine and the term table [um], over random poses.
double largest_difference_um(const std::string& configuration, double error_size) {
  Random random(42);
  const Chain chain = *chain_of(configuration);
  const TermTable terms = *terms_of(chain, Convention::iso, CurveKind::carriage);
  double largest = 0.0;
  for (int i = 0; i < 50; ++i) {
    ChainGeometry geometry{chain, {}, random_position(random)};
    for (auto& line : geometry.lines_mm) line = random_position(random);
    const ComponentValues errors = random_errors(random, error_size);
    const Vector3 position = random_position(random);
    const Vector3 exact = tool_pose(geometry, errors, position).error_um;
    const Vector3 table = tool_error_um(terms, errors, position, geometry.lines_mm, geometry.tool_offset_mm);
    for (const Axis a : kAllAxes) {
      if (!chain.has(a)) continue;
      largest = std::max(largest, std::abs(exact[index_of(a)] - table[index_of(a)]));
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("the exact machine agrees with the term table to first order, on every chain") {
  for (const std::string configuration :
       {"TXYZ", "TYXZ", "TZYX", "XTYZ", "YTXZ", "XYTZ", "YXTZ", "ZXTY", "XYZT", "ZYXT", "TXY", "XTZ", "XT", "TZ"}) {
    CAPTURE(configuration);
    const double at_100 = largest_difference_um(configuration, 100.0);  // 100 um, um/m over metres
    CHECK(at_100 < 0.5);
    // What is left is of second order: a tenth of the errors leaves about a hundredth of it.
    CHECK(largest_difference_um(configuration, 10.0) < 0.011 * at_100 + 1e-6);
  }
}

TEST_CASE("a machine without errors is where it should be") {
  const ChainGeometry geometry{*chain_of("XYTZ"), {}, {1.0, 2.0, 3.0}};
  const ToolPose pose = tool_pose(geometry, {}, {-100.0, 200.0, -300.0});
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(pose.error_um[i] == Approx(0.0).epsilon(1e-9));
    CHECK(pose.rotation_um_per_m[i] == 0.0);
  }
}

TEST_CASE("a rotation of the workpiece carriage acts through its own travel, that of a tool carriage does not") {
  ComponentValues errors{};
  errors[index_of(Component::ECX)] = 50.0;  // um/m
  const Vector3 at{1000.0, 0.0, 0.0};
  CHECK(tool_pose({*chain_of("XTYZ"), {}, {}}, errors, at).error_um[1] == Approx(50.0).epsilon(1e-4));
  CHECK(tool_pose({*chain_of("TXYZ"), {}, {}}, errors, at).error_um[1] == Approx(0.0));
}

TEST_CASE("the tool turns by the product of all rotations") {
  ComponentValues errors{};
  errors[index_of(Component::ECX)] = 30.0;
  errors[index_of(Component::ECY)] = -10.0;
  errors[index_of(Component::EAZ)] = 7.0;
  const ToolPose pose = tool_pose({*chain_of("XYTZ"), {}, {}}, errors, {100.0, 100.0, 100.0});
  CHECK(pose.rotation_um_per_m[2] == Approx(20.0).epsilon(1e-3));
  CHECK(pose.rotation_um_per_m[0] == Approx(7.0).epsilon(1e-3));
}

TEST_CASE("equation (19) of the thesis: the pitch of a Y table on X moves the tool in Y by ECY times X") {
  ComponentValues errors{};
  errors[index_of(Component::ECY)] = 20.0;
  CHECK(tool_pose({*chain_of("XYTZ"), {}, {}}, errors, {500.0, 0.0, 0.0}).error_um[1] == Approx(10.0).epsilon(1e-4));
}
