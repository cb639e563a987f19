#include "laser/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <tuple>

namespace ecs::laser {
namespace {

constexpr double kSame_mm = 1e-6;

/// Direction of the step to stop `i`: 1, -1, or 0 for none.
int step_to(const std::vector<double>& p, std::size_t i) {
  const double step = p[i] - p[i - 1];
  return std::abs(step) <= kSame_mm ? 0 : step > 0.0 ? 1 : -1;
}

/// For each stop the direction of the next step that is one; 0 where there is none.
std::vector<int> next_steps(const std::vector<double>& p) {
  std::vector<int> next(p.size(), 0);
  for (std::size_t i = p.size() - 1; i-- > 0;) {
    const int step = step_to(p, i + 1);
    next[i] = step != 0 ? step : next[i + 1];
  }
  return next;
}

/// Positions closer than this part of the travel are one stop: encoders read a stop again within less.
constexpr double kSameStop = 1e-5;
/// Targets of a pass follow each other; an axis that turns at more than every second stop moves in no order.
constexpr std::size_t kMovesATurn = 2;

/// Where the axis stood, with the readings taken there.
struct Stop {
  double position = 0.0;
  std::vector<std::size_t> readings;
  int step = 0;  ///< direction of the motion that led here; 0: the first
};

std::vector<Stop> stops_in(const MeasurementSet& set, const std::vector<std::size_t>& readings) {
  const auto position = [&](std::size_t i) { return target_of(set.readings[i]); };
  const auto [least, most] = std::minmax_element(
      readings.begin(), readings.end(), [&](std::size_t a, std::size_t b) { return position(a) < position(b); });
  const double same = std::max(kSame_mm, kSameStop * (position(*most) - position(*least)));
  std::vector<Stop> stops;
  for (const std::size_t i : readings) {
    const double step = stops.empty() ? 0.0 : position(i) - stops.back().position;
    if (stops.empty() || std::abs(step) > same)
      stops.push_back({position(i), {}, step > 0.0 ? 1 : step < 0.0 ? -1 : 0});
    stops.back().readings.push_back(i);
  }
  return stops;
}

bool turns_at(const std::vector<Stop>& stops, std::size_t s) {
  return s > 0 && s + 1 < stops.size() && stops[s + 1].step == -stops[s].step;
}

/// A single step back between two the other way: from where the axis came then is not in the file.
bool is_jump(const std::vector<Stop>& stops, std::size_t s) {
  return s > 1 && turns_at(stops, s - 1) && turns_at(stops, s);
}

/// Readings at a stop where the axis does not turn.
std::size_t usual_count(const std::vector<Stop>& stops) {
  std::vector<std::size_t> counts;
  for (std::size_t s = 0; s < stops.size(); ++s)
    if (!turns_at(stops, s)) counts.push_back(stops[s].readings.size());
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return *middle;
}

/// By reading; empty where the stops go one way, or in no order.
std::map<std::size_t, Approach> approaches_of(const std::vector<Stop>& stops) {
  std::size_t turns = 0;
  for (std::size_t s = 0; s < stops.size(); ++s)
    if (turns_at(stops, s)) ++turns;
  if (turns == 0 || kMovesATurn * turns > stops.size() - 1) return {};
  const std::size_t usual = usual_count(stops);
  std::map<std::size_t, Approach> approaches;
  bool forward = false, reverse = false;
  const auto give = [&](std::size_t reading, int step) {
    approaches[reading] = static_cast<Approach>(step);
    (step > 0 ? forward : reverse) = true;
  };
  for (std::size_t s = 1; s < stops.size(); ++s) {
    if (is_jump(stops, s)) continue;
    const auto& readings = stops[s].readings;
    const bool turns_here = turns_at(stops, s) && !is_jump(stops, s + 1);
    const std::size_t came = turns_here ? std::min(usual, readings.size()) : readings.size();
    for (std::size_t k = 0; k < came; ++k) give(readings[k], stops[s].step);
    if (readings.size() == 2 * usual)
      for (std::size_t k = came; k < readings.size(); ++k) give(readings[k], -stops[s].step);
  }
  if (!forward || !reverse) return {};
  return approaches;
}

bool is_on_path(const Reading& reading) {
  const auto path = reading.text_extras.find("path");
  return path != reading.text_extras.end() &&
         (path->second.starts_with("circle ") || path->second.starts_with("diagonal "));
}

}  // namespace

std::size_t take_approach_from_order(MeasurementSet& set) {
  std::map<std::tuple<Axis, bool, Sense, std::optional<bool>, int>, std::vector<std::size_t>> passes;
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    const Reading& reading = set.readings[i];
    if (!is_on_path(reading))
      passes[{reading.axis, reading.rotary, reading.sense, reading.compensated, reading.run}].push_back(i);
  }
  std::size_t given = 0;
  for (const auto& [pass, readings] : passes)
    for (const auto& [reading, approach] : approaches_of(stops_in(set, readings))) {
      set.readings[reading].approach = approach;
      ++given;
    }
  return given;
}

std::vector<MotionStop> motion_of(const std::vector<double>& positions_mm) {
  std::vector<MotionStop> stops(positions_mm.size());
  if (positions_mm.empty()) return stops;
  const std::vector<int> next = next_steps(positions_mm);
  int direction = next.front();
  int forward = 0;
  int reverse = 0;
  const auto begin_pass = [&] { return direction >= 0 ? ++forward : ++reverse; };
  int run = begin_pass();
  for (std::size_t i = 0; i < positions_mm.size(); ++i) {
    const int step = i == 0 ? direction : step_to(positions_mm, i);
    const bool turns = step == 0 ? next[i] == -direction && next[i] != 0 : step == -direction;
    const bool jumps = turns && step != 0 && next[i] == direction;  // back to the start of another pass the same way
    if (i > 0 && turns) {
      if (!jumps) direction = -direction;
      run = begin_pass();
    }
    stops[i] = {static_cast<Approach>(direction), run};
  }
  return stops;
}

}  // namespace ecs::laser
