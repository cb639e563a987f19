// Kinematics at constant feed; no method of its own.
#include "model/planning/run.hpp"

#include <algorithm>
#include <cmath>

#include "model/planning/circles.hpp"

namespace ecs::model {

double to_micrometre(double mm) {
  constexpr double kMicrometres = 1000.0;
  return std::round(mm * kMicrometres) / kMicrometres;
}

std::vector<int> pass_senses(const MeasurementProposal& proposal) {
  const int first = proposal.approach < 0 ? -1 : 1;
  return proposal.bidirectional ? std::vector<int>{first, -first} : std::vector<int>{first};
}

std::vector<Stop> stops_of(const MeasurementProposal& proposal, double rapid_mm_min) {
  if (proposal.circle) return stops_on_circle(proposal, rapid_mm_min);
  std::vector<Stop> stops;
  if (proposal.targets_mm.empty()) return stops;
  double now_s = 0.0;
  double at_mm = proposal.targets_mm.front();
  const auto move = [&](double to_mm, double feed_mm_min) {
    now_s += kSecondsAMinute * std::abs(to_mm - at_mm) / feed_mm_min;
    at_mm = to_mm;
  };
  int run = proposal.first_run;
  const auto one_run = [&](double feed_mm_min) {
    for (const int d : pass_senses(proposal)) {
      std::vector<double> targets = proposal.targets_mm;
      if (d < 0) std::reverse(targets.begin(), targets.end());
      const double start_mm = targets.front() - d * proposal.overrun_mm;
      move(start_mm, rapid_mm_min);
      for (const double target : targets) {
        if (proposal.short_overrun) {
          move(target + d * proposal.overrun_mm, rapid_mm_min);
          move(target - d * proposal.overrun_mm, rapid_mm_min);
        }
        move(target, feed_mm_min);
        now_s += proposal.dwell_s + proposal.trigger_s;
        const double since_mm = proposal.short_overrun ? proposal.overrun_mm : std::abs(target - start_mm);
        stops.push_back({target, d, run, feed_mm_min, since_mm, now_s});
      }
    }
    ++run;
  };
  for (int i = 0; i < proposal.runs; ++i) one_run(proposal.feed_mm_min);
  if (proposal.second_feed_mm_min)
    for (int i = 0; i < proposal.runs; ++i) one_run(*proposal.second_feed_mm_min);
  return stops;
}

double minutes_of(const MeasurementProposal& proposal, const MeasuringTimes& times) {
  const std::vector<Stop> stops = stops_of(proposal, times.rapid_mm_min);
  const double program_s = stops.empty() ? 0.0 : stops.back().after_s;
  return proposal.wait_minutes + proposal.set_up_minutes + program_s / kSecondsAMinute;
}

}  // namespace ecs::model
