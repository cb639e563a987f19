#include "modules/standards/joints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "laser/csv_table.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::string_view, 5> kJointColumns{"joint", "angle_deg", "x_mm", "y_mm", "z_mm"};
constexpr std::size_t kLeastAngles = 5;  ///< a circle in space has six numbers, and a residual must remain
constexpr double kLeastArc_deg = 10.0;   ///< a choice: the centre is then uncertain by 500 times the noise
constexpr double kSameAngle_deg = 1e-3;  ///< of commanded angles
constexpr double kTurn_deg = 360.0, kMost_deg = 1e5, kMost_mm = 1e5;
constexpr double kParallel_deg = 1.0;
constexpr double kFollows_deg = 30.0;  ///< points further off their angle are in another order
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kUmPerM = 1e6;  ///< um/m in a radian
constexpr int kMostSteps = 50;

Eigen::Vector3d vector_of(const Vector3& v) { return {v[0], v[1], v[2]}; }
Vector3 triple_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

std::size_t angles_in(const JointSweep& sweep) {
  std::vector<double> angles;
  for (const JointReading& reading : sweep.readings) angles.push_back(reading.angle_deg);
  std::ranges::sort(angles);
  const auto same = [](double a, double b) { return b - a < kSameAngle_deg; };
  return static_cast<std::size_t>(std::unique(angles.begin(), angles.end(), same) - angles.begin());
}

/// Coordinates of the points in their plane of least squares, and normal to it.
struct Plane {
  Eigen::Vector3d centre, across, up, normal;
  Eigen::MatrixX2d in_plane;
  Eigen::VectorXd off_plane;
  double second_size = 0.0;  ///< rms extent along the narrower direction of the plane
};

Plane plane_of(const JointSweep& sweep) {
  const auto n = static_cast<Eigen::Index>(sweep.readings.size());
  Eigen::MatrixX3d points(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    points.row(i) = vector_of(sweep.readings[static_cast<std::size_t>(i)].point_mm).transpose();
  Plane plane;
  plane.centre = points.colwise().mean().transpose();
  points.rowwise() -= plane.centre.transpose();
  const SingularValues parts = singular_values_of(points.transpose() * points);
  plane.across = parts.u.col(0);
  plane.up = parts.u.col(1);
  plane.normal = plane.across.cross(plane.up);
  plane.in_plane.resize(n, 2);
  plane.in_plane << points * plane.across, points * plane.up;
  plane.off_plane = points * plane.normal;
  plane.second_size = std::sqrt(std::max(0.0, parts.values[1]) / static_cast<double>(n));
  return plane;
}

/// Least squares of the radial distances (Gauss and Newton), from the circle that is linear in its three numbers
/// (Kasa 1976).
struct PlaneCircle {
  Eigen::Vector2d centre;
  double radius = 0.0;
  Eigen::VectorXd radial;      ///< residuals
  Eigen::Matrix3d covariance;  ///< of centre and radius for residuals of variance 1
};

PlaneCircle circle_through(const Eigen::MatrixX2d& points) {
  const Eigen::Index n = points.rows();
  Eigen::MatrixXd columns(n, 3);
  columns << 2.0 * points, Eigen::VectorXd::Ones(n);
  const Eigen::VectorXd start = PivotedQr(columns).solve(points.rowwise().squaredNorm());
  PlaneCircle circle{start.head<2>(), std::sqrt(std::max(0.0, start[2] + start.head<2>().squaredNorm())), {}, {}};
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::MatrixX2d arms = points.rowwise() - circle.centre.transpose();
    const Eigen::VectorXd distance = arms.rowwise().norm();
    circle.radial = distance.array() - circle.radius;
    columns << arms.array().colwise() / distance.array(), Eigen::VectorXd::Ones(n);
    const Eigen::VectorXd change = PivotedQr(columns).solve(circle.radial);
    circle.centre += change.head<2>();
    circle.radius += change[2];
    if (change.norm() < 1e-12 * circle.radius) break;
  }
  circle.covariance = inverse_gram(columns);
  return circle;
}

/// Error of each angle in one sense of turning, without its mean [deg].
Eigen::VectorXd angle_errors(const JointSweep& sweep, const Eigen::MatrixX2d& arms, double sense) {
  Eigen::VectorXd errors(arms.rows());
  double sine = 0.0, cosine = 0.0;
  for (Eigen::Index i = 0; i < arms.rows(); ++i) {
    errors[i] =
        sense * std::atan2(arms(i, 1), arms(i, 0)) - sweep.readings[static_cast<std::size_t>(i)].angle_deg / kDegPerRad;
    sine += std::sin(errors[i]);
    cosine += std::cos(errors[i]);
  }
  const double mean = std::atan2(sine, cosine);
  for (double& error : errors) error = std::remainder(error - mean, 2.0 * std::numbers::pi) * kDegPerRad;
  return errors.array() - errors.mean();
}

/// Of angles reached from below and from above: the mean of the differences [deg].
std::optional<double> reversal_deg_of(const JointSweep& sweep, const Eigen::VectorXd& errors) {
  const auto& readings = sweep.readings;
  const auto direction = [&](std::size_t i) {
    return i == 0 ? 0.0 : readings[i].angle_deg - readings[i - 1].angle_deg;
  };
  double sum = 0.0;
  int pairs = 0;
  for (std::size_t i = 0; i < readings.size(); ++i)
    for (std::size_t j = 0; j < readings.size(); ++j)
      if (direction(i) > kSameAngle_deg && direction(j) < -kSameAngle_deg &&
          std::abs(readings[i].angle_deg - readings[j].angle_deg) < kSameAngle_deg) {
        sum += errors[static_cast<Eigen::Index>(i)] - errors[static_cast<Eigen::Index>(j)];
        ++pairs;
      }
  return pairs == 0 ? std::nullopt : std::optional(sum / pairs);
}

std::optional<double> closure_um_of(const JointSweep& sweep) {
  std::optional<double> largest;
  for (const JointReading& a : sweep.readings)
    for (const JointReading& b : sweep.readings)
      if (const double turns = (b.angle_deg - a.angle_deg) / kTurn_deg;
          turns > 0.5 && std::abs(turns - std::round(turns)) * kTurn_deg < kSameAngle_deg)
        largest = std::max(largest.value_or(0.0), (vector_of(b.point_mm) - vector_of(a.point_mm)).norm() * kUmPerMm);
  return largest;
}

}  // namespace

Result<std::vector<JointSweep>> parse_joints(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kJointColumns, findings));
  TableReader reader(table, findings);
  std::vector<JointSweep> sweeps;
  for (const CsvRow& row : table.rows) {
    reader.take(row);
    const std::string& name = reader.text("joint");
    if (name.empty()) reader.wrong("joint", "a name or number");
    JointReading reading{reader.number("angle_deg", kMost_deg).value_or(0.0), {}};
    for (std::size_t a = 0; a < kAxes; ++a)
      reading.point_mm[a] = reader.number(kJointColumns[2 + a], kMost_mm).value_or(0.0);
    auto found = std::ranges::find(sweeps, name, &JointSweep::joint);
    if (found == sweeps.end()) found = sweeps.insert(found, {name, {}});
    found->readings.push_back(reading);
  }
  if (sweeps.empty()) findings.add(0, 0, "expected rows of readings, found none");
  for (const JointSweep& sweep : sweeps) {
    const auto [least, most] =
        std::minmax_element(sweep.readings.begin(), sweep.readings.end(),
                            [](const JointReading& a, const JointReading& b) { return a.angle_deg < b.angle_deg; });
    if (const std::size_t angles = angles_in(sweep); angles < kLeastAngles)
      findings.add(0, 0, "joint {}: expected {} angles or more, found {}", in_quotes(sweep.joint), kLeastAngles,
                   angles);
    else if (most->angle_deg - least->angle_deg < kLeastArc_deg)
      findings.add(0, 0, "joint {}: expected angles over {:g} degrees or more, found {:g}", in_quotes(sweep.joint),
                   kLeastArc_deg, most->angle_deg - least->angle_deg);
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return sweeps;
}

Result<JointAxis> joint_axis_of(const JointSweep& sweep, const std::string& file_name) {
  const Plane plane = plane_of(sweep);
  const Eigen::Index n = plane.in_plane.rows();
  const double off_plane = root_mean_square(plane.off_plane);
  if (!(plane.second_size > 3.0 * off_plane) || plane.second_size < 1.0 / kUmPerMm)
    return problem_at(
        file_name, 0, 0,
        "joint {}: expected points on an arc, found points in one place, on a line or scattered; choose a "
        "point further from the axis, or a longer arc",
        in_quotes(sweep.joint));
  const PlaneCircle circle = circle_through(plane.in_plane);
  const Eigen::MatrixX2d arms = plane.in_plane.rowwise() - circle.centre.transpose();
  const Eigen::VectorXd right = angle_errors(sweep, arms, 1.0), left = angle_errors(sweep, arms, -1.0);
  const bool is_right = right.squaredNorm() <= left.squaredNorm();
  const Eigen::VectorXd& errors_deg = is_right ? right : left;
  if (errors_deg.cwiseAbs().maxCoeff() > kFollows_deg)
    return problem_at(file_name, 0, 0,
                      "joint {}: the points do not turn by the angles: one is {:.0f} degrees from its place. Check the "
                      "column angle_deg and that no other joint moved",
                      in_quotes(sweep.joint), errors_deg.cwiseAbs().maxCoeff());
  JointAxis axis{.joint = sweep.joint, .points = sweep.readings.size()};
  axis.from_deg = axis.to_deg = sweep.readings.front().angle_deg;
  for (const JointReading& reading : sweep.readings) {
    axis.from_deg = std::min(axis.from_deg, reading.angle_deg);
    axis.to_deg = std::max(axis.to_deg, reading.angle_deg);
  }
  axis.centre_mm = triple_of(plane.centre + circle.centre[0] * plane.across + circle.centre[1] * plane.up);
  axis.direction = triple_of(is_right ? plane.normal : Eigen::Vector3d(-plane.normal));
  axis.radius_mm = circle.radius;
  axis.radial_rms_um = root_mean_square(circle.radial) * kUmPerMm;
  axis.axial_rms_um = off_plane * kUmPerMm;
  const auto freedoms = static_cast<double>(n - 3);  // three numbers of the circle in its plane, three of the plane
  const double radial_mm = std::sqrt(circle.radial.squaredNorm() / freedoms);
  const double axial_mm = std::sqrt(plane.off_plane.squaredNorm() / freedoms);
  Eigen::MatrixXd level(n, 3);
  level << plane.in_plane, Eigen::VectorXd::Ones(n);
  const Eigen::MatrixXd tilts = inverse_gram(level);
  axis.radius_u_mm = radial_mm * std::sqrt(circle.covariance(2, 2));
  axis.centre_u_mm = radial_mm * std::sqrt(circle.covariance(0, 0) + circle.covariance(1, 1));
  axis.direction_u_um_per_m = axial_mm * std::sqrt(tilts(0, 0) + tilts(1, 1)) * kUmPerM;
  axis.angle_rms_um_per_m = root_mean_square(errors_deg) / kDegPerRad * kUmPerM;
  Eigen::Index at = 0;
  errors_deg.cwiseAbs().maxCoeff(&at);
  axis.largest_angle_um_per_m = errors_deg[at] / kDegPerRad * kUmPerM;
  axis.largest_at_deg = sweep.readings[static_cast<std::size_t>(at)].angle_deg;
  if (const auto reversal_deg = reversal_deg_of(sweep, errors_deg))
    axis.reversal_um_per_m = *reversal_deg / kDegPerRad * kUmPerM;
  axis.closure_um = closure_um_of(sweep);
  return axis;
}

AxesOfJoints between(const JointAxis& first, const JointAxis& second) {
  const Eigen::Vector3d a = vector_of(first.direction), b = vector_of(second.direction), normal = a.cross(b);
  const Eigen::Vector3d apart = vector_of(second.centre_mm) - vector_of(first.centre_mm);
  const double angle_deg = std::atan2(normal.norm(), a.dot(b)) * kDegPerRad;
  const bool parallel = std::min(angle_deg, kTurn_deg / 2.0 - angle_deg) < kParallel_deg;
  return {first.joint, second.joint, angle_deg,
          parallel ? apart.cross(a).norm() : std::abs(apart.dot(normal)) / normal.norm(), parallel};
}

}  // namespace ecs::laser
