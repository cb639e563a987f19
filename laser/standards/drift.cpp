// Ranges of the curves of one set of readings (windows.hpp); what is missing is named all at once.
#include "laser/standards/drift.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/groups.hpp"
#include "laser/standards/windows.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastDriftReadings = 10;

struct TimedValue {
  double time_h = 0.0, value = 0.0;
};

Drift drift_of(Sense sense, std::vector<TimedValue> values, double window_h) {
  std::stable_sort(values.begin(), values.end(),
                   [](const TimedValue& a, const TimedValue& b) { return a.time_h < b.time_h; });
  Drift drift;
  drift.sense = sense;
  for (const TimedValue& one : values) {
    drift.time_h.push_back(one.time_h);
    drift.value.push_back(one.value - values.front().value);
  }
  drift.hours = drift.time_h.back() - drift.time_h.front();
  const WindowRanges ranges = window_ranges(drift.time_h, drift.value, window_h);
  drift.range = ranges.whole;
  drift.window_range = ranges.largest;
  drift.window_from_h = ranges.largest_from_h;
  drift.last_window_range = ranges.last;
  return drift;
}

}  // namespace

Result<DriftTest> drift_test_of(const MeasurementSet& set, double window_h) {
  Findings findings(set.source);
  double start_s = 0.0;
  bool any = false;
  for (const Reading& reading : set.readings) {
    if (!reading.time_s) {
      findings.add(reading.line, 0, "time_s: expected the time of each reading, found none");
      break;
    }
    start_s = any ? std::min(start_s, *reading.time_s) : *reading.time_s;
    any = true;
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  const auto hours = [&](const Reading& reading) { return (*reading.time_s - start_s) / kSecondsPerHour; };
  DriftTest test{window_h, {}, {}};
  for (const Group& group : groups_of(set)) {
    const auto places = targets_of(set, group, target_tolerance_mm(set, group)).size();
    std::vector<TimedValue> values;
    for (const std::size_t i : group.readings) values.push_back({hours(set.readings[i]), set.readings[i].error});
    const std::string name(name_of(group.sense));
    const bool twice = std::any_of(test.senses.begin(), test.senses.end(),
                                   [&](const Drift& drift) { return drift.sense == group.sense; });
    if (places != 1 || twice)
      findings.add(0, 0, fmt::format("{}: expected readings at one place over time, found several places", name));
    else if (values.size() < kLeastDriftReadings)
      findings.add(0, 0,
                   fmt::format("{}: expected {} readings or more, found {}", name, kLeastDriftReadings, values.size()));
    else
      test.senses.push_back(drift_of(group.sense, std::move(values), window_h));
  }
  for (const Drift& drift : test.senses)
    if (drift.hours < 2.0 * window_h)
      findings.add(0, 0,
                   fmt::format("{}: expected a test of {:.2f} h or more, twice the window, found {:.2f} h",
                               name_of(drift.sense), 2.0 * window_h, drift.hours));
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  for (const std::string& name : sensor_names_of(set)) {
    DriftSensor sensor{name, {}, {}};
    for (const Reading& reading : set.readings)
      if (const auto found = reading.sensors_degC.find(name); found != reading.sensors_degC.end()) {
        sensor.time_h.push_back(hours(reading));
        sensor.degC.push_back(found->second);
      }
    test.sensors.push_back(std::move(sensor));
  }
  return test;
}

}  // namespace ecs::laser
