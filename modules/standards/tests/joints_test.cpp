// Axes of joints from points around them: exact circles, noise, lost motion, full turns, an arm with known dimensions.
#include "modules/standards/joints.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "base/random.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;

struct Joint {
  Eigen::Vector3d through{100.0, -50.0, 700.0}, along{0.0, 0.0, 1.0}, point{400.0, 0.0, 750.0};
  double noise_mm = 0.0;
  double reversal_deg = 0.0;  ///< of the angle, upwards less downwards
};

/// The point, turned about the axis by Rodrigues' rotation.
JointReading reading_at(const Joint& joint, double commanded_deg, double actual_deg, std::mt19937_64& random,
                        NormalDraws& normal) {
  const Eigen::Vector3d point =
      joint.through +
      Eigen::AngleAxisd(actual_deg * kRadPerDegree, joint.along.normalized()) * (joint.point - joint.through);
  JointReading reading{commanded_deg, {}};
  for (std::size_t a = 0; a < 3; ++a)
    reading.point_mm[a] = point[static_cast<Eigen::Index>(a)] + joint.noise_mm * normal(random);
  return reading;
}

JointSweep sweep_of(const Joint& joint, const std::vector<double>& angles_deg, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  JointSweep sweep{"1", {}};
  double before = -HUGE_VAL;
  for (const double angle : angles_deg) {
    const double half = (angle > before ? 0.5 : -0.5) * joint.reversal_deg;
    sweep.readings.push_back(reading_at(joint, angle, angle + half, random, normal));
    before = angle;
  }
  return sweep;
}

std::vector<double> angles(double from_deg, double to_deg, double step_deg) {
  std::vector<double> all;
  for (double angle = from_deg; angle <= to_deg + 1e-9; angle += step_deg) all.push_back(angle);
  return all;
}

double off_axis_mm(const JointAxis& axis, const Joint& joint) {
  const Eigen::Vector3d apart = Eigen::Map<const Eigen::Vector3d>(axis.centre_mm.data()) - joint.through;
  return apart.cross(joint.along.normalized()).norm();
}

double tilt_um_per_m(const JointAxis& axis, const Joint& joint) {
  return Eigen::Map<const Eigen::Vector3d>(axis.direction.data()).cross(joint.along.normalized()).norm() * 1e6;
}

TEST_CASE("points exactly on a circle give its axis, radius and sense of turning, whichever way the axis points") {
  for (const Eigen::Vector3d& along :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 2, -2)}) {
    const Joint joint{.along = along};
    const auto axis = joint_axis_of(sweep_of(joint, angles(-70.0, 50.0, 15.0)), "arm.csv");
    REQUIRE(axis);
    CHECK(off_axis_mm(*axis, joint) < 1e-7);
    CHECK(tilt_um_per_m(*axis, joint) < 1e-3);
    CHECK(Eigen::Map<const Eigen::Vector3d>(axis->direction.data()).dot(joint.along) > 0.0);
    CHECK(axis->radius_mm ==
          Approx((joint.point - joint.through).cross(joint.along.normalized()).norm()).epsilon(1e-9));
    CHECK(axis->radial_rms_um < 1e-4);
    CHECK(axis->axial_rms_um < 1e-4);
    CHECK(axis->angle_rms_um_per_m < 1e-3);
    CHECK_FALSE(axis->reversal_um_per_m.has_value());
    CHECK_FALSE(axis->closure_um.has_value());
  }
}

TEST_CASE("under noise the axis is within two stated uncertainties in about as many cases as it should be") {
  const Joint joint{.along = {0.3, -0.2, 1.0}, .noise_mm = 0.01};
  int centre = 0, tilt = 0;
  constexpr int kCases = 400;
  for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
    const auto axis = joint_axis_of(sweep_of(joint, angles(0.0, 120.0, 10.0), seed), "arm.csv");
    REQUIRE(axis);
    if (off_axis_mm(*axis, joint) < 2.0 * axis->centre_u_mm) ++centre;
    if (tilt_um_per_m(*axis, joint) < 2.0 * axis->direction_u_um_per_m) ++tilt;
  }
  // Two directions with unlike uncertainties: between 95 % (one dominates) and 98 % (equal, of their root sum).
  CHECK(centre >= kCases * 90 / 100);
  CHECK(centre <= kCases * 995 / 1000);
  CHECK(tilt >= kCases * 90 / 100);
  CHECK(tilt <= kCases * 995 / 1000);
}

TEST_CASE("lost motion of a joint is its reversal, and a joint that does not come back shows at a whole turn") {
  Joint joint{.reversal_deg = 0.01};
  std::vector<double> there_and_back = angles(0.0, 90.0, 10.0);
  for (double angle = 90.0; angle >= 0.0; angle -= 10.0) there_and_back.push_back(angle);
  const auto axis = joint_axis_of(sweep_of(joint, there_and_back), "arm.csv");
  REQUIRE(axis);
  REQUIRE(axis->reversal_um_per_m);
  CHECK(*axis->reversal_um_per_m == Approx(0.01 * kRadPerDegree * 1e6).epsilon(1e-3));

  JointSweep turns = sweep_of(Joint{}, angles(-180.0, 180.0, 30.0));
  turns.readings.back().point_mm[2] += 0.025;
  const auto turned = joint_axis_of(turns, "arm.csv");
  REQUIRE(turned);
  REQUIRE(turned->closure_um);
  CHECK(*turned->closure_um == Approx(25.0).epsilon(1e-6));
}

TEST_CASE("the axes of two joints lie to each other as the arm was built") {
  const Joint base{.through = {0, 0, 0}, .along = {0, 0, 1}, .point = {800, 0, 400}};
  const Joint shoulder{.through = {25, 7, 400},
                       .along = {0, std::cos(0.2 * kRadPerDegree), std::sin(0.2 * kRadPerDegree)},
                       .point = {600, 7, 500}};
  const Joint elbow{.through = {25, 7, 855}, .along = shoulder.along, .point = {600, 7, 700}};
  const auto a = joint_axis_of(sweep_of(base, angles(-60.0, 60.0, 15.0)), "arm.csv");
  const auto b = joint_axis_of(sweep_of(shoulder, angles(-40.0, 40.0, 10.0)), "arm.csv");
  const auto c = joint_axis_of(sweep_of(elbow, angles(0.0, 80.0, 10.0)), "arm.csv");
  REQUIRE((a && b && c));
  const AxesOfJoints first = between(*a, *b), second = between(*b, *c);
  CHECK(first.angle_deg == Approx(89.8).epsilon(1e-9));
  CHECK(first.distance_mm == Approx(25.0).epsilon(1e-7));
  CHECK_FALSE(first.is_parallel);
  CHECK(second.is_parallel);
  CHECK(second.distance_mm == Approx(455.0 * std::cos(0.2 * kRadPerDegree)).epsilon(1e-7));
}

TEST_CASE("points on a line, points that do not follow the angles and incomplete files are refused with a reason") {
  JointSweep line{"2", {}};
  for (int i = 0; i < 6; ++i) line.readings.push_back({10.0 * i, {1.0 * i, 2.0 * i, 0.0}});
  const auto on_line = joint_axis_of(line, "arm.csv");
  REQUIRE_FALSE(on_line);
  CHECK(to_text(on_line.error()).find("on a line") != std::string::npos);

  JointSweep shuffled = sweep_of(Joint{}, angles(0.0, 120.0, 10.0));
  std::swap(shuffled.readings[1].angle_deg, shuffled.readings[8].angle_deg);
  const auto other_order = joint_axis_of(shuffled, "arm.csv");
  REQUIRE_FALSE(other_order);
  CHECK(to_text(other_order.error()).find("do not turn by the angles") != std::string::npos);

  const std::string head = "joint,angle_deg,x_mm,y_mm,z_mm\n";
  for (const auto& [rows, words] : {std::pair("1,0,1,2,3\n1,a,1,2,3\n", "angle_deg: expected"),
                                    {"", "expected rows of readings, found none"},
                                    {"1,0,1,2,3\n1,5,1,2,3\n", "expected 5 angles or more, found 2"},
                                    {"1,0,1,2,3\n1,1,1,2,3\n1,2,1,2,3\n1,3,1,2,3\n1,4,1,2,3\n",
                                     "expected angles over 10 degrees or more, found 4"}}) {
    const auto read = parse_joints(head + rows, "arm.csv");
    REQUIRE_FALSE(read);
    CHECK(to_text(read.error()).find(words) != std::string::npos);
  }
}

}  // namespace
