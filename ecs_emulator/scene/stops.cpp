#include <algorithm>
#include <cmath>

#include "ecs_emulator/scene/design.hpp"

namespace ecs::emulator {
namespace {

constexpr double kOverrun_mm = 5.0;
constexpr double kTurn_s = 8.0;  ///< to run past the end and come back

/// Time passing while the axes go from stop to stop.
class Traveller {
 public:
  Traveller(const Travel& travel, std::vector<Stop>& stops) : travel_(travel), stops_(stops) {}

  void pass(const Line& line, int run, bool forward) {
    std::vector<double> targets = travel_.targets_mm[index_of(line.axis)];
    if (!forward) std::reverse(targets.begin(), targets.end());
    const auto turn = static_cast<std::size_t>(run - 1);
    Stop stop;
    stop.axis = line.axis;
    stop.sense = line.sense;
    stop.position_mm = line.parked_mm;
    stop.approach = forward ? 1 : -1;
    stop.run = run;
    stop.feed_mm_min = travel_.feeds_mm_min[turn % travel_.feeds_mm_min.size()];
    stop.load_kg = travel_.loads_kg[turn % travel_.loads_kg.size()];
    clock_s_ += kTurn_s;
    double before_mm = targets.front();
    for (const double target_mm : targets) {
      clock_s_ += std::abs(target_mm - before_mm) / stop.feed_mm_min * 60.0 + travel_.dwell_s;
      before_mm = target_mm;
      stop.position_mm[index_of(line.axis)] = target_mm;
      stop.travel_since_reversal_mm = kOverrun_mm + std::abs(target_mm - targets.front());
      stop.time_s = clock_s_;
      stops_.push_back(stop);
    }
  }
  void wait(double seconds) { clock_s_ += seconds; }

 private:
  const Travel& travel_;
  std::vector<Stop>& stops_;
  double clock_s_ = 0.0;
};

}  // namespace

std::vector<Stop> stops_along(const std::vector<Line>& lines, const Travel& travel) {
  std::vector<Stop> stops;
  Traveller traveller(travel, stops);
  for (int run = 1; run <= travel.runs; ++run) {
    for (const Line& line : lines) {
      traveller.pass(line, run, !travel.backward_first);
      if (travel.bidirectional) traveller.pass(line, run, travel.backward_first);
    }
    traveller.wait(travel.pause_s);
  }
  const double first_s = stops.front().time_s;
  for (Stop& stop : stops) stop.time_s = std::round((stop.time_s - first_s) * 10.0) / 10.0;
  return stops;
}

}  // namespace ecs::emulator
