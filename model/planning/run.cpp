// Kinematics at constant feed, circles at their places; no method of its own.
#include "model/planning/run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "model/fit/statistics.hpp"

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
      if (d < 0) std::ranges::reverse(targets);
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
  const auto all_runs = [&](double feed_mm_min) {
    for (int i = 0; i < proposal.runs; ++i) {
      if (proposal.warming && i > 0) now_s += kSecondsAMinute * proposal.warming->minutes;
      one_run(feed_mm_min);
    }
  };
  all_runs(proposal.feed_mm_min);
  if (proposal.second_feed_mm_min) all_runs(*proposal.second_feed_mm_min);
  return stops;
}

double minutes_of(const MeasurementProposal& proposal, const MeasuringTimes& times) {
  if (proposal.ball)
    return proposal.wait_minutes + proposal.set_up_minutes +
           proposal.runs * proposal.ball->readings.back().time_s.value_or(0.0) / kSecondsAMinute;
  const std::vector<Stop> stops = stops_of(proposal, times.rapid_mm_min);
  const double program_s = stops.empty() ? 0.0 : stops.back().after_s;
  return proposal.wait_minutes + proposal.set_up_minutes + program_s / kSecondsAMinute;
}

namespace {

constexpr double kRad_per_deg = std::numbers::pi / 180.0;
/// Lengths of ball bars [mm], and the share of the shorter travel that a circle may take at the utmost.
constexpr std::array kBars_mm{300.0, 150.0, 100.0, 50.0};
constexpr double kMostOfTravel = 0.9;
/// Feeds worth trying, of the present one; readings how much closer, and no closer than this [deg].
constexpr double kSlowerFeed = 0.25, kFasterFeed = 2.0, kCloser = 3.0, kClosest_deg = 0.1;
/// Of a circle not measured yet [mm/min]: usual of ball bars.
constexpr double kUsualFeed_mm_min = 1000.0;
constexpr std::array<std::array<Axis, 2>, 3> kPlanes{{{Axis::X, Axis::Y}, {Axis::Y, Axis::Z}, {Axis::Z, Axis::X}}};

MeasurementProposal on_circle(const Observations& data, const Path& circle, const MeasuringTimes& times) {
  MeasurementProposal one;
  one.circle = circle;
  one.axis = circle.plane[0];
  one.sense = static_cast<Sense>(index_of(one.axis));
  one.parked_mm = circle.from_mm;
  one.first_run = 1 + *std::ranges::max_element(data.run);
  one.dwell_s = one.trigger_s = one.overrun_mm = 0.0;
  one.feed_mm_min = kUsualFeed_mm_min;
  one.set_up_minutes = times.circle_minutes;
  if (data.map) one.compensated = data.compensated.back();
  return one;
}

/// As people type it: in hundredths.
double readable_step_deg(double deg) {
  constexpr double kHundredths = 100.0;
  return std::max(kClosest_deg, std::round(kHundredths * deg) / kHundredths);
}

/// The circle number `path` of the data, as it is measured now.
MeasurementProposal circle_as_now(const Observations& data, std::size_t path, const MeasuringTimes& times) {
  MeasurementProposal now = on_circle(data, data.paths[path - 1], times);
  now.set_up_minutes = times.start_minutes;
  std::vector<double> feeds;
  std::map<std::pair<int, int>, double> readings;  // of a pass
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.path[k] != path) continue;
    readings[{data.run[k], data.approach[k]}] += 1.0;
    if (const double feed = cell(data.feed_mm_min, k); feed > 0.0) feeds.push_back(feed);
  }
  double most = 1.0;
  for (const auto& pass : readings) most = std::max(most, pass.second);
  now.circle_step_deg = readable_step_deg(kTurn_deg / most);
  if (!feeds.empty()) now.feed_mm_min = upper_median(std::move(feeds));
  return now;
}

void add(std::vector<MeasurementProposal>& all, MeasurementProposal one, const std::string& how) {
  one.condition = fmt::format("{}, {}", name_of(*one.circle), how);
  all.push_back(std::move(one));
}

/// @param feed  what the feed of `now` is called
void add_at_feeds(std::vector<MeasurementProposal>& all, const MeasurementProposal& now, const std::string& how,
                  std::string_view feed, const MeasuringTimes& times) {
  add(all, now, how);
  MeasurementProposal slower = now, faster = now;
  slower.feed_mm_min = kSlowerFeed * now.feed_mm_min;
  add(all, std::move(slower), fmt::format("{}, but at a quarter of {}", how, feed));
  faster.feed_mm_min = kFasterFeed * now.feed_mm_min;
  if (faster.feed_mm_min <= times.greatest_feed_mm_min)
    add(all, std::move(faster), fmt::format("{}, but at twice {}", how, feed));
}

/// The largest circle of a ball bar in the middle of both travels, of another radius than the present ones.
std::optional<Path> free_circle(const Observations& data, const std::array<Axis, 2>& plane) {
  Path circle;
  circle.plane = plane;
  circle.name = {letter_of(plane[0]), letter_of(plane[1])};
  for (const Axis axis : kAllAxes) {
    const auto& facts = data.machine.axes[index_of(axis)];
    if (facts) circle.from_mm[index_of(axis)] = 0.5 * (facts->travel_mm[0] + facts->travel_mm[1]);
    if (!facts && (axis == plane[0] || axis == plane[1])) return std::nullopt;
  }
  for (const double bar_mm : kBars_mm) {
    bool fits = true;
    for (const Axis axis : plane) {
      const auto& travel_mm = data.machine.axes[index_of(axis)]->travel_mm;
      fits = fits && 2.0 * bar_mm <= kMostOfTravel * (travel_mm[1] - travel_mm[0]);
    }
    const bool measured = std::ranges::any_of(data.paths, [&](const Path& present) {
      return present.kind == PathKind::circle && present.name == circle.name && present.radius_mm == bar_mm;
    });
    if (!fits || measured) continue;
    circle.radius_mm = bar_mm;
    return circle;
  }
  return std::nullopt;
}

}  // namespace

bool has_circles(const Observations& data) {
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.on_path(k) && data.path_of(k).kind == PathKind::circle) return true;
  return false;
}

std::vector<MeasurementProposal> circle_options(const Observations& data, const MeasuringTimes& times) {
  std::vector<MeasurementProposal> all;
  std::optional<double> feed_mm_min;  // of the circles measured, where they state it
  for (std::size_t path = 1; path <= data.paths.size(); ++path) {
    if (data.paths[path - 1].kind != PathKind::circle) continue;
    const MeasurementProposal now = circle_as_now(data, path, times);
    add_at_feeds(all, now, "with the present set-up", "the feed", times);
    if (now.feed_mm_min != kUsualFeed_mm_min) feed_mm_min = now.feed_mm_min;
    MeasurementProposal closer = now;
    closer.circle_step_deg = readable_step_deg(now.circle_step_deg / kCloser);
    if (closer.circle_step_deg < now.circle_step_deg) add(all, std::move(closer), "readings three times as close");
  }
  for (const auto& plane : kPlanes)
    if (const auto circle = free_circle(data, plane)) {
      MeasurementProposal one = on_circle(data, *circle, times);
      one.feed_mm_min = feed_mm_min.value_or(one.feed_mm_min);
      add_at_feeds(all, one, fmt::format("radius {:g} mm", circle->radius_mm),
                   feed_mm_min ? "the present feed" : "the usual feed", times);
    }
  return all;
}

std::vector<Stop> stops_on_circle(const MeasurementProposal& proposal, double rapid_mm_min) {
  std::vector<Stop> stops;
  const double radius_mm = proposal.circle->radius_mm;
  const auto readings = static_cast<int>(std::round(kTurn_deg / proposal.circle_step_deg));
  double now_s = kSecondsAMinute * radius_mm / rapid_mm_min;
  int run = proposal.first_run;
  const auto run_at = [&](double feed_mm_min) {
    const double second_per_deg = kSecondsAMinute * radius_mm * kRad_per_deg / feed_mm_min;
    for (const int d : {1, -1}) {
      now_s += kOverlap_deg * second_per_deg;
      for (int i = 0; i < readings; ++i) {
        const double turned_deg = (i + 0.5) * kTurn_deg / readings;
        stops.push_back({d > 0 ? turned_deg : kTurn_deg - turned_deg, d, run, feed_mm_min, 0.0,
                         now_s + turned_deg * second_per_deg});
      }
      now_s += (kTurn_deg + kOverlap_deg) * second_per_deg;
    }
    ++run;
  };
  for (int i = 0; i < proposal.runs; ++i) run_at(proposal.feed_mm_min);
  return stops;
}

Vector3 point_on_circle(const Path& circle, double angle_deg) {
  Vector3 place = circle.from_mm;
  place[index_of(circle.plane[0])] += circle.radius_mm * std::cos(angle_deg * kRad_per_deg);
  place[index_of(circle.plane[1])] += circle.radius_mm * std::sin(angle_deg * kRad_per_deg);
  return place;
}

}  // namespace ecs::model
