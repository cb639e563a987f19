#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "model/planning/run.hpp"
#include "modules/lengths/plan_choice.hpp"

namespace ecs::model {
namespace {

constexpr int kTargetsBeyondKnots = 4;

Vector3 between(const Vector3& a, const Vector3& b, double part) {
  return {std::lerp(a[0], b[0], part), std::lerp(a[1], b[1], part), std::lerp(a[2], b[2], part)};
}

LengthReading pose_at(const Vector3& p, const PerAxis<int>& approach) {
  LengthReading reading;
  for (std::size_t a = 0; a < kAxes; ++a) reading.position_mm[a] = to_micrometre(p[a]);
  reading.approach = approach;
  return reading;
}

class PathMaker {
 public:
  PathMaker(const MachineCurves& curves, const LengthPlanSettings& settings)
      : curves_(curves), machine_(curves.machine()), settings_(settings) {}

  [[nodiscard]] Vector3 corner(int bits) const {
    Vector3 out{};
    for (std::size_t a = 0; a < kAxes; ++a) out[a] = machine_.travel_mm[a][(bits >> a) & 1];
    return out;
  }

  /// A part of the travel in quarters.
  [[nodiscard]] double quarter(std::size_t axis, int quarters) const {
    return std::lerp(machine_.travel_mm[axis][0], machine_.travel_mm[axis][1], quarters / 4.0);
  }

  /// From `a` to `b` and back at even targets.
  [[nodiscard]] PlanPath line(const Vector3& a, const Vector3& b, bool in_bundle) const {
    PlanPath path;
    path.in_bundle = in_bundle;
    int intervals = 1;
    PerAxis<int> there{1, 1, 1}, back{1, 1, 1};
    for (std::size_t k = 0; k < kAxes; ++k) {
      if (a[k] == b[k]) continue;
      intervals = std::max(intervals, curves_.intervals(kAllAxes[k]));
      there[k] = b[k] > a[k] ? 1 : -1;
      back[k] = -there[k];
    }
    const int targets = static_cast<int>(std::lround(settings_.targets_an_interval * intervals)) + kTargetsBeyondKnots;
    for (int i = 0; i < targets; ++i) path.readings.push_back(pose_at(between(a, b, i / (targets - 1.0)), there));
    for (int i = targets - 1; i >= 0; --i) path.readings.push_back(pose_at(between(a, b, i / (targets - 1.0)), back));
    path.minutes = minutes_for(path);
    return path;
  }

  /// Along each axis: edges, lines through the middle of faces, one through the middle.
  void add_axis_lines(std::vector<PlanPath>& out) const {
    for (std::size_t a = 0; a < kAxes; ++a) {
      const std::size_t b = (a + 1) % kAxes, c = (a + 2) % kAxes;
      for (int i = 0; i <= 4; i += 2)
        for (int k = 0; k <= 4; k += 2) {
          Vector3 from{}, to{};
          from[a] = quarter(a, 0), to[a] = quarter(a, 4);
          from[b] = to[b] = quarter(b, i);
          from[c] = to[c] = quarter(c, k);
          out.push_back(line(from, to, i == 0 && k == 0));
        }
    }
  }

  void add_diagonals(std::vector<PlanPath>& out) const {
    for (int bits = 0; bits < 4; ++bits) out.push_back(line(corner(bits), corner(7 - bits), true));
    for (std::size_t a = 0; a < kAxes; ++a) {  // faces across this axis
      const int first = 1 << ((a + 1) % kAxes), second = 1 << ((a + 2) % kAxes);
      for (const int side : {0, 1 << a}) {
        out.push_back(line(corner(side), corner(side | first | second), false));
        out.push_back(line(corner(side | first), corner(side | second), false));
      }
    }
  }

  /// From one face to the opposite one, all axes moving: every reading has its own stop of every axis.
  void add_skew_lines(std::vector<PlanPath>& out) const {
    for (std::size_t a = 0; a < kAxes; ++a) {
      const std::size_t b = (a + 1) % kAxes, c = (a + 2) % kAxes;
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          Vector3 from{}, to{};
          from[a] = quarter(a, 0), to[a] = quarter(a, 4);
          from[b] = quarter(b, 2 * i), to[b] = quarter(b, 2 * ((i + 2) % 3));
          from[c] = quarter(c, 2 * k), to[c] = quarter(c, 2 * ((k + 1) % 3));
          out.push_back(line(from, to, false));
        }
    }
  }

  /// From one angle to another and back about the centre; `at` gives the direction of an angle [rad]. Nothing where it
  /// leaves the travel.
  template <class Direction>
  [[nodiscard]] std::optional<PlanPath> arc(const Vector3& centre, double from_deg, double to_deg,
                                            const Direction& at) const {
    constexpr double kStep_deg = 15.0;
    const int steps = static_cast<int>(std::lround((to_deg - from_deg) / kStep_deg));
    const double step_rad = (to_deg - from_deg) / steps * kTurn / 360.0;
    PlanPath path;
    path.in_bundle = true;
    for (const int sense : {1, -1})
      for (int i = 0; i < steps; ++i) {  // midway, where no axis turns at a pose
        const double angle = from_deg * kTurn / 360.0 + (sense > 0 ? i + 0.5 : steps - i - 0.5) * step_rad;
        const Vector3 here = at(angle), before = at(angle - sense * 1e-3);
        Vector3 p{};
        PerAxis<int> approach{1, 1, 1};
        for (std::size_t a = 0; a < kAxes; ++a) {
          p[a] = centre[a] + settings_.ball_bar_mm * here[a];
          if (std::abs(here[a] - before[a]) > 1e-9) approach[a] = here[a] > before[a] ? 1 : -1;
          if (p[a] < machine_.travel_mm[a][0] || p[a] > machine_.travel_mm[a][1]) return std::nullopt;
        }
        path.readings.push_back(pose_at(p, approach));
      }
    path.minutes = minutes_for(path);
    return path;
  }

 private:
  /// By the kinematics of the other plans (model/planning/run.hpp): the targets as places along the path.
  [[nodiscard]] double minutes_for(const PlanPath& path) const {
    MeasurementProposal proposal;
    double along_mm = 0.0;
    for (std::size_t i = 0; i < path.readings.size() / 2; ++i) {
      if (i > 0) along_mm += distance_mm(path.readings[i - 1].position_mm, path.readings[i].position_mm);
      proposal.targets_mm.push_back(along_mm);
    }
    proposal.set_up_minutes = 0.0;
    proposal.feed_mm_min = settings_.feed_mm_min;
    proposal.dwell_s = settings_.dwell_s;
    proposal.trigger_s = settings_.trigger_s;
    double whole_mm = 0.0;  // from the path before, on average half the volume away
    for (const auto& travel : machine_.travel_mm) whole_mm += 0.5 * (travel[1] - travel[0]);
    return minutes_of(proposal, settings_.times) + whole_mm / settings_.times.rapid_mm_min;
  }

  const MachineCurves& curves_;
  const LengthMachine& machine_;
  const LengthPlanSettings& settings_;
};

std::vector<Vector3> ball_places(const LengthMachine& machine, const LengthPlanSettings& settings) {
  std::vector<Vector3> out;
  PerAxis<std::vector<double>> along;
  for (std::size_t a = 0; a < kAxes; ++a) {
    constexpr double kClear_mm = 1.0;
    const double low = machine.travel_mm[a][0] + settings.ball_bar_mm + kClear_mm;
    const double high = machine.travel_mm[a][1] - settings.ball_bar_mm - kClear_mm;
    if (low > high) return out;
    // neighbouring spheres overlap by half
    const int count = 1 + static_cast<int>(std::ceil((high - low) / settings.ball_bar_mm));
    for (int i = 0; i < count; ++i) along[a].push_back(count == 1 ? low : std::lerp(low, high, i / (count - 1.0)));
  }
  for (const double x : along[0])
    for (const double y : along[1])
      for (const double z : along[2]) out.push_back({x, y, z});
  return out;
}

}  // namespace

double distance_mm(const Vector3& a, const Vector3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

std::vector<PlanPath> plan_lines(const MachineCurves& curves, const LengthPlanSettings& settings) {
  const PathMaker make(curves, settings);
  std::vector<PlanPath> out;
  make.add_axis_lines(out);
  make.add_diagonals(out);
  make.add_skew_lines(out);
  return out;
}

std::vector<PlanPath> plan_arcs(const MachineCurves& curves, const LengthPlanSettings& settings,
                                const Vector3& centre_mm) {
  const PathMaker make(curves, settings);
  std::vector<PlanPath> out;
  const auto add = [&](std::optional<PlanPath> path) {
    if (path) out.push_back(std::move(*path));
  };
  const double lowest = settings.bar_lowest_deg;
  for (const double elevation_deg : {0.0, 35.0, 65.0}) {
    const double up = elevation_deg * kTurn / 360.0;
    add(make.arc(centre_mm, 0.0, 360.0, [&](double angle) {
      return Vector3{std::cos(up) * std::cos(angle), std::cos(up) * std::sin(angle), std::sin(up)};
    }));
  }
  for (const double azimuth_deg : {0.0, 90.0, 45.0, 135.0}) {
    const double turn = azimuth_deg * kTurn / 360.0;
    add(make.arc(centre_mm, lowest, 180.0 - lowest, [&](double angle) {
      return Vector3{std::cos(turn) * std::cos(angle), std::sin(turn) * std::cos(angle), std::sin(angle)};
    }));
  }
  return out;
}

std::vector<Vector3> plan_stations(const LengthMachine& machine, const LengthPlanSettings& settings) {
  if (!settings.stations_mm.empty()) return settings.stations_mm;
  if (settings.instrument == LengthInstrument::ball_bar) return ball_places(machine, settings);
  double lowest_tool_mm = 0.0;
  for (const Vector3& tool : settings.tools_mm) lowest_tool_mm = std::min(lowest_tool_mm, tool[2]);
  constexpr double kAside = 0.2, kBelow_mm = 150.0;
  const auto at = [&](std::size_t a, double part) {
    return std::lerp(machine.travel_mm[a][0], machine.travel_mm[a][1], part);
  };
  const double low_mm = at(2, 0.0) - kBelow_mm + lowest_tool_mm, middle_mm = at(2, 0.5) + lowest_tool_mm;
  std::vector<Vector3> out;
  for (const double x : {-kAside, 0.5, 1.0 + kAside})
    for (const double y : {-kAside, 0.5, 1.0 + kAside}) out.push_back({at(0, x), at(1, y), low_mm});
  for (const double x : {-kAside, 1.0 + kAside})
    for (const double y : {-kAside, 1.0 + kAside}) out.push_back({at(0, x), at(1, y), middle_mm});
  return out;
}

}  // namespace ecs::model
