#include "laser/import/set_up.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "laser/csv_columns.hpp"
#include "laser/groups.hpp"
#include "laser/import/readers.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

Eigen::Vector3d vector_of(const Vector3& v) { return {v[0], v[1], v[2]}; }
Vector3 array_of(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// That turns one direction into another; none where the other has no length.
Eigen::Matrix3d shortest_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  const Eigen::Vector3d axis = across.norm() > 0.0 ? across.normalized() : from.unitOrthogonal();
  return Eigen::AngleAxisd(std::atan2(across.norm(), from.dot(to)), axis).toRotationMatrix();
}

Eigen::Vector3d centre_of(const std::vector<Vector3>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Vector3& point : points) sum += vector_of(point);
  return sum / static_cast<double>(points.size());
}

/// The readings of one row, by direction.
struct MeasuredPoint {
  Vector3 nominal_mm{};
  PerAxis<Reading*> errors{};
  [[nodiscard]] Vector3 measured_mm() const {
    Vector3 measured = nominal_mm;
    for (std::size_t i = 0; i < kAxes; ++i)
      if (errors[i]) measured[i] += errors[i]->error / kUmPerMm;
    return measured;
  }
};

std::vector<MeasuredPoint> points_in(MeasurementSet& set) {
  std::map<int, MeasuredPoint> by_line;
  for (Reading& reading : set.readings) {
    if (is_rotation(reading.sense)) continue;
    MeasuredPoint& point = by_line[reading.line];
    point.nominal_mm = reading.position_mm;
    point.errors[index_of(direction_of(reading.sense))] = &reading;
  }
  std::vector<MeasuredPoint> points;
  for (const auto& [line, point] : by_line) points.push_back(point);
  return points;
}

double rms_of(const std::vector<MeasuredPoint>& points) {
  double squares = 0.0, count = 0.0;
  for (const MeasuredPoint& point : points)
    for (const Reading* reading : point.errors)
      if (reading) {
        squares += reading->error * reading->error;
        count += 1.0;
      }
  return std::sqrt(squares / std::max(1.0, count));
}

}  // namespace

std::optional<RigidSetUp> rigid_set_up(const std::vector<Vector3>& nominal_mm,
                                       const std::vector<Vector3>& measured_mm) {
  constexpr double kFlat = 1e-6;  // of the largest extent: the points have none in that direction
  if (nominal_mm.size() < 2) return std::nullopt;
  const Eigen::Vector3d centre = centre_of(nominal_mm), measured_centre = centre_of(measured_mm);
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero(), extent = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < nominal_mm.size(); ++i) {
    const Eigen::Vector3d nominal = vector_of(nominal_mm[i]) - centre;
    product += nominal * (vector_of(measured_mm[i]) - measured_centre).transpose();
    extent += nominal * nominal.transpose();
  }
  const SingularValues svd = singular_values_of(product);
  const Eigen::Matrix3d u = svd.u, v = svd.v;
  Eigen::Matrix3d keeps_hand = Eigen::Matrix3d::Identity();
  keeps_hand(2, 2) = u.determinant() * v.determinant() < 0.0 ? -1.0 : 1.0;
  Eigen::Matrix3d rotation = v * keeps_hand * u.transpose();
  const Spectrum spread = spectrum_of(extent);  // least first
  const Eigen::Vector3d sizes = spread.values.reverse();
  RigidSetUp set_up;
  if (!(sizes[0] > 0.0)) {
    rotation = Eigen::Matrix3d::Identity();
    set_up.rotations = 0;
  } else if (sizes[1] < kFlat * kFlat * sizes[0]) {
    // points on a line tell nothing about the rotation round it: the shortest rotation of the line itself
    const Eigen::Vector3d line = spread.vectors.col(2);
    Eigen::Vector3d turned = product.transpose() * line;
    rotation = shortest_rotation(line, turned);
    set_up.rotations = 2;
  }
  const Eigen::AngleAxisd turn(rotation);
  set_up.centre_mm = array_of(centre);
  set_up.shift_um = array_of((measured_centre - centre) * kUmPerMm);
  set_up.rotation_um_m = array_of(turn.axis() * turn.angle() * 1e6);
  for (std::size_t i = 0; i < kAxes; ++i) set_up.matrix[i] = array_of(rotation.row(static_cast<Eigen::Index>(i)));
  return set_up;
}

Vector3 set_up_error_um(const RigidSetUp& set_up, const Vector3& nominal_mm) {
  const Eigen::Vector3d from_centre = vector_of(nominal_mm) - vector_of(set_up.centre_mm);
  Vector3 error{};
  for (std::size_t i = 0; i < kAxes; ++i)
    error[i] = set_up.shift_um[i] +
               (vector_of(set_up.matrix[i]).dot(from_centre) - from_centre[static_cast<Eigen::Index>(i)]) * kUmPerMm;
  return error;
}

void take_out_set_up(MeasurementSet& set) {
  const auto points = points_in(set);
  std::vector<Vector3> nominal, measured;
  for (const MeasuredPoint& point : points) {
    nominal.push_back(point.nominal_mm);
    measured.push_back(point.measured_mm());
  }
  const auto set_up = rigid_set_up(nominal, measured);
  if (!set_up) return;
  const double before = rms_of(points);
  for (const MeasuredPoint& point : points) {
    const Vector3 error = set_up_error_um(*set_up, point.nominal_mm);
    for (std::size_t i = 0; i < kAxes; ++i)
      if (point.errors[i]) point.errors[i]->error -= error[i];
  }
  const Vector3& shift = set_up->shift_um;
  const Vector3& turn = set_up->rotation_um_m;
  set.notes.push_back(
      fmt::format("set-up removed: shift X {:+.2f}, Y {:+.2f}, Z {:+.2f} um, rotation about X {:+.2f}, Y {:+.2f}, Z "
                  "{:+.2f} um/m; rms of the errors {:.3g} -> {:.3g} um (--keep-set-up keeps it)",
                  shift[0], shift[1], shift[2], turn[0], turn[1], turn[2], before, rms_of(points)));
  if (set_up->rotations < 3)
    set.notes.push_back(set_up->rotations == 2 ? "set-up: the points lie on a line, the rotation round it is not known"
                                               : "set-up: the points are at one position, no rotation is known");
}

namespace {

constexpr std::size_t kLeastAtRest = 3;
constexpr int kTextDigits = 4;

using Stretch = std::vector<const Reading*>;

/// What tells one stretch from the next besides the place.
bool goes_on(const Reading& first, const Reading& next, double within_mm) {
  if (first.run != next.run || first.approach != next.approach || first.compensated != next.compensated) return false;
  for (std::size_t i = 0; i < kAxes; ++i)
    if (!(std::abs(first.position_mm[i] - next.position_mm[i]) <= within_mm) ||
        !(std::abs(first.angle_deg[i] - next.angle_deg[i]) <= within_mm))
      return false;
  return true;
}

std::vector<Stretch> stretches_in(const std::vector<Reading>& readings, double within_mm) {
  std::vector<Stretch> stretches;
  std::map<std::pair<Axis, Sense>, std::size_t> open;
  for (const Reading& reading : readings) {
    const auto [at, is_new] = open.try_emplace({reading.axis, reading.sense}, 0);
    if (is_new || !goes_on(*stretches[at->second].front(), reading, within_mm)) {
      at->second = stretches.size();
      stretches.emplace_back();
    }
    stretches[at->second].push_back(&reading);
  }
  return stretches;
}

template <class Value>
std::optional<double> mean_over(const Stretch& stretch, Value value_of) {
  std::vector<double> values;
  for (const Reading* reading : stretch)
    if (const std::optional<double> value = value_of(*reading)) values.push_back(*value);
  return mean_of(values);
}

using Numbers = std::map<std::string, double, std::less<>>;

Numbers means_of(const Stretch& stretch, Numbers Reading::*member) {
  Numbers means;
  for (const Reading* reading : stretch)
    for (const auto& [name, first] : reading->*member)
      if (!means.contains(name))
        means[name] = *mean_over(stretch, [&, &key = name](const Reading& one) {
          const auto found = (one.*member).find(key);
          return found == (one.*member).end() ? std::nullopt : std::optional(found->second);
        });
  return means;
}

Reading mean_reading(const Stretch& stretch) {
  Reading mean = *stretch.front();
  std::vector<double> errors;
  for (const Reading* reading : stretch) errors.push_back(reading->error);
  mean.error = *mean_of(errors);
  for (std::size_t i = 0; i < kAxes; ++i)
    for (const auto place : {&Reading::position_mm, &Reading::angle_deg})
      (mean.*place)[i] = *mean_over(stretch, [&](const Reading& one) { return std::optional((one.*place)[i]); });
  for (const NumberColumn& column : kNumberColumns)
    mean.*column.member = mean_over(stretch, [&](const Reading& one) { return one.*column.member; });
  mean.sensors_degC = means_of(stretch, &Reading::sensors_degC);
  mean.extras = means_of(stretch, &Reading::extras);
  mean.extras["readings_averaged"] = static_cast<double>(stretch.size());
  if (const auto scatter = deviation_of(errors)) mean.extras["scatter"] = *scatter;
  return mean;
}

}  // namespace

void keep_at_rest(MeasurementSet& set, std::optional<double> at_rest_mm, bool average) {
  const auto stretches = stretches_in(set.readings, at_rest_mm.value_or(kSamePlace_mm));
  std::vector<Reading> kept;
  std::size_t averaged = 0, moving = 0;
  for (const Stretch& stretch : stretches) {
    if (at_rest_mm && stretch.size() < kLeastAtRest) {
      moving += stretch.size();
      continue;
    }
    if (average) {
      averaged += stretch.size();
      kept.push_back(mean_reading(stretch));
    } else {
      for (const Reading* reading : stretch) kept.push_back(*reading);
    }
  }
  if (at_rest_mm)
    set.notes.push_back(
        fmt::format("{} readings during motion are ignored: fewer than {} consecutive ones within {:.{}g} mm", moving,
                    kLeastAtRest, *at_rest_mm, kTextDigits));
  if (average) {
    set.notes.push_back(fmt::format("{} readings at rest averaged to {}", averaged, kept.size()));
    for (const char* const column : {"readings_averaged", "scatter"})
      if (!set.columns.empty()) set.columns.emplace_back(column);
  } else {
    std::ranges::stable_sort(kept, [](const Reading& a, const Reading& b) { return a.row < b.row; });
  }
  set.readings = std::move(kept);
  number_rows(set);
}

namespace {

constexpr double kTurn_deg = 360.0;

using Scan = std::vector<Reading*>;

/// The way of the moving axis from one reading to another.
double way_of(const Reading& from, const Reading& to) {
  const double way = target_of(to) - target_of(from);
  return from.rotary ? std::remainder(way, kTurn_deg) : way;
}

/// A scan from one reversal to the next: readings [first, last), which come from one side, by their way from its first.
struct Stroke {
  std::size_t first = 0, last = 0;
};

std::vector<Stroke> strokes_of(const Scan& scan) {
  std::vector<Stroke> strokes;
  double direction = 0.0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const double way = i == 0 ? 0.0 : way_of(*scan[i - 1], *scan[i]);
    const bool turns = std::abs(way) > kSamePlace_mm && way * direction < 0.0;
    if (std::abs(way) > kSamePlace_mm) direction = way;
    if (strokes.empty() || turns) strokes.push_back({i, i});
    ++strokes.back().last;
  }
  return strokes;
}

/// Slope at its middle of a parabola through readings around one of them, by least squares: waves bend it, and the
/// readings of an end lie on one side of it.
class LocalSlope {
 public:
  void add(double way, double error) {
    const Eigen::Vector3d powers(1.0, way, way * way);
    products_ += powers * powers.transpose();
    sums_ += error * powers;
    ++readings_;
  }
  /// @param noise  of one reading; nothing where it changes the slope by more than `most`
  [[nodiscard]] std::optional<double> within(double noise, double most) const {
    if (readings_ < 3) return std::nullopt;
    const Eigen::LDLT<Eigen::Matrix3d> solver(products_);
    const Eigen::Vector3d of_slope = solver.solve(Eigen::Vector3d::UnitY());
    if (!solver.isPositive() || !(of_slope[1] > 0.0) || noise * std::sqrt(of_slope[1]) > most) return std::nullopt;
    return of_slope.dot(sums_);
  }

 private:
  std::size_t readings_ = 0;
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sums_ = Eigen::Vector3d::Zero();
};

/// Of one reading less those around it: third differences, for waves bend slowly.
double noise_of(const Scan& scan) {
  std::vector<double> bends;
  for (std::size_t i = 1; i + 2 < scan.size(); ++i)
    bends.push_back(
        std::abs(scan[i + 2]->error - 3.0 * scan[i + 1]->error + 3.0 * scan[i]->error - scan[i - 1]->error));
  if (bends.empty()) return std::numeric_limits<double>::infinity();
  constexpr double kMedianOfNormal = 0.6745, kThirdDifference = 20.0;  // variance of 1, -3, 3, -1
  return median_of(std::move(bends)) / kMedianOfNormal / std::sqrt(kThirdDifference);
}

/// From as few readings around each as noise allows to change it by at most a tenth, so that regressions on it are
/// wrong by a hundredth; never from those beyond a reversal, which lost motion displaces. Else it is 1.
void take_slope(const Scan& scan) {
  constexpr double kMostNoise = 0.1;
  constexpr std::size_t kMostAround = 100;  // on each side: further away noise drowns the readings anyway
  const Reading& one = *scan.front();
  if (is_rotation(one.sense) != one.rotary || direction_of(one.sense) != one.axis) return;
  const double in_um = one.rotary ? kUmPerMPerDegree : kUmPerMm, noise = noise_of(scan);
  for (const Stroke& stroke : strokes_of(scan)) {
    for (std::size_t i = stroke.first; i < stroke.last; ++i) {
      LocalSlope around;
      std::optional<double> slope;
      const auto take = [&](std::size_t j) { around.add(way_of(*scan[i], *scan[j]), scan[j]->error); };
      take(i);
      for (std::size_t far = 1; far <= kMostAround && !slope; ++far) {
        if (i >= stroke.first + far) take(i - far);
        if (i + far < stroke.last) take(i + far);
        slope = around.within(noise, kMostNoise * in_um);
      }
      scan[i]->extras[std::string(kReadingSlopeColumn)] = 1.0 + slope.value_or(0.0) / in_um;
    }
  }
}

std::vector<Scan> scans_of(MeasurementSet& set) {
  std::map<std::tuple<Axis, bool, Sense>, Scan> scans;
  for (Reading& reading : set.readings) scans[{reading.axis, reading.rotary, reading.sense}].push_back(&reading);
  std::vector<Scan> list;
  for (auto& [of, scan] : scans) list.push_back(std::move(scan));
  return list;
}

/// Readings that tell a delay from lost motion wrongly: while the axis starts or stops within an interval its speed is
/// not known, and just behind a reversal lost motion is still being taken up. A delay may last an interval.
std::vector<bool> misleading(MeasurementSet& set) {
  constexpr double kJump = 0.25;     // of the usual speed: that of the reading is then known to an eighth of it
  constexpr double kTakenUp = 0.01;  // of the stroke: more than any axis has of lost motion
  std::vector<bool> list(set.readings.size(), false);
  const auto leave_out = [&](const Reading* reading) {
    list[static_cast<std::size_t>(reading - set.readings.data())] = true;
  };
  for (const Scan& scan : scans_of(set)) {
    std::vector<double> speeds, moving;
    for (std::size_t i = 1; i < scan.size(); ++i) {
      speeds.push_back(way_of(*scan[i - 1], *scan[i]) / (*scan[i]->time_s - *scan[i - 1]->time_s));
      if (std::abs(way_of(*scan[i - 1], *scan[i])) > kSamePlace_mm) moving.push_back(std::abs(speeds.back()));
    }
    if (moving.empty()) continue;
    const double usual = median_of(std::move(moving));
    for (std::size_t i = 1; i + 1 < scan.size(); ++i)
      if (std::abs(speeds[i] - speeds[i - 1]) > kJump * usual)
        for (const std::size_t j : {i - 1, i, i + 1}) leave_out(scan[j]);
    for (const Stroke& stroke : strokes_of(scan)) {
      std::vector<double> ways;  // from the turning point
      for (std::size_t i = stroke.first; i < stroke.last; ++i)
        ways.push_back((ways.empty() ? 0.0 : ways.back()) + (i == 0 ? 0.0 : std::abs(way_of(*scan[i - 1], *scan[i]))));
      for (std::size_t i = stroke.first; i < stroke.last; ++i)
        if (ways[i - stroke.first] < kTakenUp * ways.back()) leave_out(scan[i]);
    }
  }
  return list;
}

}  // namespace

void take_speed(MeasurementSet& set, double longest_interval_s) {
  constexpr double kSecondsPerMinute = 60.0;
  const auto has_speed = [](const Reading& reading) { return reading.extras.contains(speed_column(reading.rotary)); };
  if (std::ranges::any_of(set.readings, [&](const Reading& r) { return !r.time_s || has_speed(r); })) return;
  const std::vector<Scan> scans = scans_of(set);
  std::vector<double> intervals_s;
  for (const Scan& scan : scans)
    for (std::size_t i = 1; i < scan.size(); ++i) intervals_s.push_back(*scan[i]->time_s - *scan[i - 1]->time_s);
  if (intervals_s.empty() || median_of(std::move(intervals_s)) > longest_interval_s) return;
  bool any = false;
  for (const Scan& scan : scans) {
    take_slope(scan);
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const Reading& before = *scan[i == 0 ? 0 : i - 1];
      const Reading& behind = *scan[std::min(i + 1, scan.size() - 1)];
      const double time_s = *behind.time_s - *before.time_s;
      if (time_s <= 0.0) continue;
      scan[i]->extras[std::string(speed_column(scan[i]->rotary))] = way_of(before, behind) / time_s * kSecondsPerMinute;
      any = true;
    }
  }
  if (!any) return;
  const std::string column(speed_column(set.readings.front().rotary));
  if (!set.columns.empty()) set.columns.push_back(column);
  set.notes.push_back(fmt::format("{}: the speed of the axis, from its positions and times", column));
}

void keep_in_motion(MeasurementSet& set) {
  constexpr double kUsual = 0.5, kSlowest = 0.05;
  take_speed(set, std::numeric_limits<double>::infinity());
  const bool has_speed = std::ranges::all_of(
      set.readings, [](const Reading& reading) { return reading.extras.contains(speed_column(reading.rotary)); });
  const double share = has_speed ? kSlowest : kUsual;
  std::map<std::pair<Axis, Sense>, double> last;
  std::vector<double> step(set.readings.size(), 0.0), moved;
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    const Reading& reading = set.readings[i];
    const auto [before, is_new] = last.try_emplace({reading.axis, reading.sense}, target_of(reading));
    step[i] = std::abs(target_of(reading) - before->second);
    before->second = target_of(reading);
    if (step[i] > kSamePlace_mm) moved.push_back(step[i]);
  }
  const bool has_times = std::ranges::all_of(set.readings, [](const Reading& r) { return r.time_s.has_value(); });
  const std::vector<bool> misleads =
      has_speed && has_times ? misleading(set) : std::vector<bool>(set.readings.size(), false);
  std::vector<Reading> kept;
  if (!moved.empty()) {
    std::nth_element(moved.begin(), moved.begin() + static_cast<std::ptrdiff_t>(moved.size() / 2), moved.end());
    const double least = share * moved[moved.size() / 2];
    for (std::size_t i = 0; i < set.readings.size(); ++i)
      if (step[i] >= least && !misleads[i]) kept.push_back(std::move(set.readings[i]));
  }
  set.notes.push_back(fmt::format("{} readings at rest{} below {} the usual speed{} are ignored",
                                  set.readings.size() - kept.size(), has_times ? "," : " or",
                                  has_speed ? "a twentieth of" : "half",
                                  has_times ? ", at an abrupt start or stop, or just behind a reversal" : ""));
  set.readings = std::move(kept);
  if (has_times && !set.readings.empty() && set.readings.front().extras.contains(kReadingSlopeColumn))
    for (const Scan& scan : scans_of(set)) take_slope(scan);
  number_rows(set);
}

}  // namespace ecs::laser
