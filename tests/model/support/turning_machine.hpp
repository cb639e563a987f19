// A machine with rotary axes for the model and for exact matrices, and readings of a ball on it by those matrices.
#pragma once

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/exact_joints.hpp"
#include "tests/support/test.hpp"

namespace ecs::model::test {

using kinematics::Angles;

/// A machine for the model and for exact matrices.
struct TurningMachine {
  params::Machine machine = mill("XYTZ");
  ecs::test::ExactMachine exact;

  TurningMachine(const char* configuration, const std::vector<std::pair<char, params::MachineRotaryAxis>>& rotary) {
    std::string linear;
    for (const char letter : std::string(configuration))
      if (letter < 'A' || letter > 'C') linear += letter;
    machine = mill(linear.c_str());
    machine.rotary_configuration = exact.configuration = configuration;
    for (const auto& [letter, axis] : rotary) {
      const auto r = static_cast<std::size_t>(letter - 'A');
      machine.rotary[r] = axis;
      exact.rotary[r] = {axis.direction, axis.pivot_mm};
    }
  }
};

inline TurningMachine trunnion() {
  return {"XYACTZ",
          {{'A', {{-100.0, 30.0}, {1.0, 0.0, 0.0}, {600.0, 300.0, -560.0}}},
           {'C', {{0.0, 360.0}, {0.0, 0.0, 1.0}, {605.0, 298.0, -500.0}}}}};
}

/// A head with C and B beyond X, Y, Z.
inline TurningMachine head() {
  return {"TXYZCB",
          {{'B', {{-100.0, 100.0}, {0.0, 1.0, 0.0}, {0.7, 26.7, 309.0}}},
           {'C', {{-360.0, 360.0}, {0.0, 0.0, 1.0}, {0.6, 26.7, 579.0}}}}};
}

/// Directions of the machine's X, Y, Z in the frame of the workpiece: of linear axes between bed and tool, or that
/// carry the rotary ones.
inline Eigen::Matrix3d bed_of(ecs::test::ExactMachine exact, const Angles& angles) {
  exact.values = {};
  exact.location = {};
  Eigen::Matrix3d bed;
  const Eigen::Vector3d from = exact_pose(exact, {}, angles).translation();
  for (int l = 0; l < 3; ++l) {
    Vector3 one{};
    one[static_cast<std::size_t>(l)] = 1.0;
    bed.col(l) = exact_pose(exact, one, angles).translation() - from;
  }
  return bed;
}

struct Ball {
  Eigen::Vector3d off_um{0.0, 0.0, 0.0};
  double noise_um = 0.0;
  bool on_workpiece = false;
  Vector3 touched_at_mm{800.0, 340.0, -450.0};  ///< linear axes at the ball, angles at 0
};

/// C over a turn at A 0 and A -60, A over its travel at C 0 and C 90, two runs there and back.
inline laser::MeasurementSet ball_set(const TurningMachine& made, const Ball& ball, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  ecs::test::ExactMachine ideal = made.exact;
  ideal.values = {};
  ideal.location = {};
  const Eigen::Vector3d at = exact_pose(ideal, ball.touched_at_mm, {}).translation();
  laser::MeasurementSet set;
  double time_s = 0.0;
  const auto take = [&](Axis moving, const Angles& angles, Approach approach, int run) {
    time_s += 5.0;
    const Eigen::Matrix3d bed = bed_of(made.exact, angles);
    const Eigen::Vector3d p = bed.transpose() * (at - exact_pose(ideal, {}, angles).translation());
    const Vector3 position{p.x(), p.y(), p.z()};
    const Vector3 e = exact_tool_error(made.exact, position, angles).error_um;
    const Eigen::Vector3d error = Eigen::Vector3d(e[0], e[1], e[2]) - ball.off_um;
    const Eigen::Vector3d read = ball.on_workpiece ? error : Eigen::Vector3d(bed.transpose() * error);
    for (int d = 0; d < 3; ++d) {
      Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                .axis = moving,
                .rotary = true,
                .position_mm = position,
                .angle_deg = angles,
                .sense = static_cast<Sense>(d),
                .error = read[d] + ball.noise_um * normal(random),
                .approach = approach,
                .run = run,
                .time_s = time_s};
      if (ball.on_workpiece) r.extras["on_workpiece"] = 1.0;
      set.readings.push_back(r);
    }
  };
  for (const double parked : {0.0, -60.0})
    for (int run = 1; run <= 2; ++run)
      for (const Approach approach : {Approach::forward, Approach::reverse})
        for (int i = 0; i < 12; ++i)
          take(Axis::Z, {parked, 0.0, 30.0 * (approach == Approach::forward ? i : 11 - i)}, approach, run);
  for (const double parked : {0.0, 90.0})
    for (int run = 1; run <= 2; ++run)
      for (const Approach approach : {Approach::forward, Approach::reverse})
        for (int i = 0; i < 10; ++i)
          take(Axis::X, {-96.0 + 14.0 * (approach == Approach::forward ? i : 9 - i), 0.0, parked}, approach, run);
  return set;
}

}  // namespace ecs::model::test
