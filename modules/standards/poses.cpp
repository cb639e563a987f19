#include "modules/standards/poses.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "laser/findings.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastPoints = 3, kLeastVisits = 3;
/// Nominal positions this close are one point.
constexpr double kSamePoint_mm = 1e-6;
/// Chance that is none: of a false answer in a thousand comparisons.
constexpr double kByChance = 1e-3;
constexpr double kRigidFreedoms = 6.0;

struct Visited {
  std::vector<Vector3> nominal_mm;
  std::map<int, std::vector<Vector3>> error_um;  ///< by visit, of each point
  std::map<int, std::vector<int>> seen;          ///< bits of the directions that were read
};

Visited visited_points(const MeasurementSet& set, Findings& findings) {
  Visited all;
  for (const Reading& reading : set.readings) {
    if (is_rotation(reading.sense) || reading.rotary) {
      findings.add(reading.line, 0, "sense: expected EX, EY or EZ of a point, found {}", name_of(reading.sense));
      return all;
    }
    const auto is_here = [&](const Vector3& point) {
      return std::hypot(point[0] - reading.position_mm[0], point[1] - reading.position_mm[1],
                        point[2] - reading.position_mm[2]) < kSamePoint_mm;
    };
    const auto found = std::ranges::find_if(all.nominal_mm, is_here);
    const auto number = static_cast<std::size_t>(found - all.nominal_mm.begin());
    if (found == all.nominal_mm.end()) all.nominal_mm.push_back(reading.position_mm);
    auto& errors = all.error_um[reading.run];
    auto& seen = all.seen[reading.run];
    errors.resize(std::max(errors.size(), number + 1));
    seen.resize(errors.size());
    errors[number][index_of(direction_of(reading.sense))] = reading.error;
    seen[number] |= 1 << index_of(direction_of(reading.sense));
  }
  if (all.nominal_mm.size() < kLeastPoints || all.seen.size() < kLeastVisits)
    findings.add(0, 0, "expected {} points or more in {} visits (runs) or more, found {} point{} in {} visit{}",
                 kLeastPoints, kLeastVisits, all.nominal_mm.size(), all.nominal_mm.size() == 1 ? "" : "s",
                 all.seen.size(), all.seen.size() == 1 ? "" : "s");
  for (const auto& [visit, seen] : all.seen)
    if (seen.size() != all.nominal_mm.size() || std::ranges::any_of(seen, [](int bits) { return bits != 7; }))
      findings.add(0, 0, "visit {}: expected EX, EY and EZ of all {} points", visit, all.nominal_mm.size());
  return all;
}

/// The points lie along one line, but for this share of its length: no turn about it can be found.
bool are_on_line(const std::vector<Vector3>& points) {
  constexpr double kShare = 0.01;
  const auto difference = [](const Vector3& a, const Vector3& b) {
    return Vector3{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  };
  const auto length = [](const Vector3& v) { return std::hypot(v[0], v[1], v[2]); };
  Vector3 along{};
  for (const Vector3& a : points)
    for (const Vector3& b : points)
      if (const Vector3 d = difference(b, a); length(d) > length(along)) along = d;
  const double whole = length(along);
  return std::ranges::all_of(points, [&](const Vector3& point) {
    const Vector3 d = difference(point, points.front());
    const Vector3 across{d[1] * along[2] - d[2] * along[1], d[2] * along[0] - d[0] * along[2],
                         d[0] * along[1] - d[1] * along[0]};
    return length(across) <= kShare * whole * whole;
  });
}

Vector3 sum_of(const Vector3& a, double factor, const Vector3& b) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

double squares(const Vector3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// Of the larger of two variances over the smaller, either way round.
double chance_of(double ratio, double k, double v) {
  const double tail = ratio >= 1.0 ? model::ln_f_tail(ratio, k, v) : model::ln_f_tail(1.0 / ratio, v, k);
  return std::min(1.0, 2.0 * std::exp(tail));
}

}  // namespace

bool PoseTest::moves_as_a_whole() const { return ratio > 1.0 && probability < kByChance; }

bool PoseComparison::is_way_of_approach() const { return probability < kByChance && rest_probability >= kByChance; }

Result<PoseTest> pose_test_of(const MeasurementSet& set) {
  Findings findings(set.source);
  const Visited all = visited_points(set, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (are_on_line(all.nominal_mm))
    return problem_at(set.source, 0, 0, "expected points that are not all on one line: a motion needs three");
  const std::size_t points = all.nominal_mm.size(), visits = all.error_um.size();
  const double count = static_cast<double>(points * visits), per_visit = static_cast<double>(visits);
  PoseTest test{.file = set.source, .visits = static_cast<int>(visits)};
  std::vector<Vector3> mean_um(points);
  for (const auto& [visit, errors] : all.error_um)
    for (std::size_t p = 0; p < points; ++p) mean_um[p] = sum_of(mean_um[p], 1.0 / per_visit, errors[p]);
  for (std::size_t p = 0; p < points; ++p) {
    std::vector<double> distance_mm;
    double mean = 0.0, spread = 0.0;
    for (const auto& [visit, errors] : all.error_um) {
      distance_mm.push_back(std::sqrt(squares(sum_of(errors[p], -1.0, mean_um[p]))) / kUmPerMm);
      mean += distance_mm.back() / per_visit;
    }
    for (const double one : distance_mm) spread += (one - mean) * (one - mean) / (per_visit - 1.0);
    test.points.push_back({sum_of(all.nominal_mm[p], 1.0 / kUmPerMm, mean_um[p]), mean + 3.0 * std::sqrt(spread)});
    if (std::sqrt(squares(mean_um[p])) / kUmPerMm > kSamePoint_mm)
      test.points.back().off_mm = sum_of({}, 1.0 / kUmPerMm, mean_um[p]);
  }
  double before = 0.0, after = 0.0, shifts = 0.0, turns = 0.0;
  for (const auto& [visit, errors] : all.error_um) {
    std::vector<Vector3> moved_mm;
    for (std::size_t p = 0; p < points; ++p)
      moved_mm.push_back(sum_of(all.nominal_mm[p], 1.0 / kUmPerMm, sum_of(errors[p], -1.0, mean_um[p])));
    const RigidSetUp motion = rigid_set_up(all.nominal_mm, moved_mm).value();  // of three points or more there is one
    test.motions[visit] = motion;
    shifts += squares(motion.shift_um);
    turns += squares(motion.rotation_um_m);
    for (std::size_t p = 0; p < points; ++p) {
      const Vector3 off = sum_of(errors[p], -1.0, mean_um[p]);
      before += squares(off);
      after += squares(sum_of(off, -1.0, set_up_error_um(motion, all.nominal_mm[p])));
    }
  }
  test.rms_um = std::sqrt(before / (3.0 * count));
  test.rms_after_um = std::sqrt(after / (3.0 * count));
  test.shift_um = std::sqrt(shifts / (3.0 * per_visit));
  test.turn_um_per_m = std::sqrt(turns / (3.0 * per_visit));
  test.of_motions = static_cast<int>(kRigidFreedoms * (per_visit - 1.0));
  test.of_rest = static_cast<int>((3.0 * static_cast<double>(points) - kRigidFreedoms) * (per_visit - 1.0));
  test.ratio = (before - after) / test.of_motions / (after / test.of_rest);
  test.probability = std::exp(model::ln_f_tail(test.ratio, test.of_motions, test.of_rest));
  return test;
}

MeasurementSet without_motions(MeasurementSet set, const PoseTest& test) {
  for (Reading& reading : set.readings)
    reading.error -=
        set_up_error_um(test.motions.at(reading.run), reading.position_mm)[index_of(direction_of(reading.sense))];
  set.metadata.push_back({"removed", "the rigid motion of each visit (run)"});
  return set;
}

PoseComparison comparison_of(const PoseTest& first, const PoseTest& second) {
  const auto sums = [](const PoseTest& test) {
    const double count = 3.0 * static_cast<double>(test.points.size()) * test.visits;
    const double rest = count * test.rms_after_um * test.rms_after_um;
    return std::pair{(count * test.rms_um * test.rms_um - rest) / test.of_motions, rest / test.of_rest};
  };
  const auto [motions, rest] = sums(first);
  const auto [other_motions, other_rest] = sums(second);
  PoseComparison comparison{.ratio = other_motions / motions};
  comparison.probability = chance_of(comparison.ratio, second.of_motions, first.of_motions);
  comparison.rest_probability = chance_of(other_rest / rest, second.of_rest, first.of_rest);
  if (first.points.size() == second.points.size()) {
    double largest = 0.0;
    for (std::size_t p = 0; p < first.points.size(); ++p)
      largest = std::max(largest, squares(sum_of(second.points[p].mean_mm, -1.0, first.points[p].mean_mm)));
    comparison.largest_shift_mm = std::sqrt(largest);
  }
  return comparison;
}

}  // namespace ecs::laser
