// Two monotonic queues give largest and smallest of every window in one pass (D. Lemire, Nordic J. Computing 13 (2006)
// 328). Drift: ranges of the curves of one set of readings; what is missing is named all at once. Warming up: separable
// least squares: for a time constant the rest is linear (G. Golub, V. Pereyra, Inverse Problems 19 (2003) R1); the time
// constant is the best of a logarithmic grid, then by golden sections.
#include "modules/standards/warm_up.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>

#include <Eigen/Core>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/groups.hpp"
#include "modules/standards/thermal_law.hpp"

namespace ecs::laser {

WindowRanges window_ranges(std::span<const double> time_h, std::span<const double> value, double window_h) {
  const auto [least, most] = std::ranges::minmax_element(value);
  WindowRanges ranges{.whole = *most - *least};
  std::deque<std::size_t> rising, falling;  // candidates for the smallest and the largest
  std::size_t begin = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    while (!rising.empty() && value[rising.back()] >= value[i]) rising.pop_back();
    while (!falling.empty() && value[falling.back()] <= value[i]) falling.pop_back();
    rising.push_back(i);
    falling.push_back(i);
    while (time_h[i] - time_h[begin] > window_h) ++begin;
    while (rising.front() < begin) rising.pop_front();
    while (falling.front() < begin) falling.pop_front();
    ranges.last = value[falling.front()] - value[rising.front()];
    if (time_h[i] - time_h.front() <= window_h) ranges.first = ranges.last;
    if (ranges.last <= ranges.largest) continue;
    ranges.largest = ranges.last;
    ranges.largest_from_h = time_h[begin];
  }
  return ranges;
}

namespace {

constexpr std::size_t kLeastDriftReadings = 10;

struct TimedValue {
  double time_h = 0.0, value = 0.0;
};

Drift drift_of(Sense sense, std::vector<TimedValue> values, double window_h) {
  std::ranges::stable_sort(values, [](const TimedValue& a, const TimedValue& b) { return a.time_h < b.time_h; });
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
      findings.add(reading.line, 0, kTimeIsNeeded);
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
    const bool twice = std::ranges::any_of(test.senses, [&](const Drift& drift) { return drift.sense == group.sense; });
    if (places != 1 || twice)
      findings.add(0, 0, "{}: expected readings at one position over time, found several positions", name);
    else if (values.size() < kLeastDriftReadings)
      findings.add(0, 0, "{}: expected {} readings or more, found {}", name, kLeastDriftReadings, values.size());
    else
      test.senses.push_back(drift_of(group.sense, std::move(values), window_h));
  }
  for (const Drift& drift : test.senses)
    if (drift.hours < 2.0 * window_h)
      findings.add(0, 0, "{}: expected a test of {:.2f} h or more, twice the window, found {:.2f} h",
                   name_of(drift.sense), 2.0 * window_h, drift.hours);
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

namespace {

constexpr std::size_t kLeastWarmUpReadings = 10;
/// Evidence that there is a change, and that it comes to an end: 3.5 standard deviations, squared.
constexpr double kEvident = 12.0;
/// Time constants tried: a fiftieth of the test to three times the test. Beyond, an exponential is a straight line.
constexpr double kShortestShare = 0.02, kLongestShare = 3.0;
constexpr int kGridSteps = 60, kGoldenSteps = 40;

/// Sizes a and c.
LeastSquares fitted_with(const Eigen::VectorXd& time_h, const Eigen::VectorXd& value, double tau_h) {
  Eigen::MatrixXd columns(time_h.size(), 2);
  columns.col(0).setOnes();
  columns.col(1) = 1.0 - (-time_h.array() / tau_h).exp();
  return least_squares(columns, value);
}

std::optional<Settling> settling_of(const WarmUpCurve& curve) {
  const auto n = static_cast<Eigen::Index>(curve.value.size());
  const Eigen::VectorXd time_h =
      Eigen::Map<const Eigen::VectorXd>(curve.time_h.data(), n).array() - curve.time_h.front();
  const Eigen::VectorXd value = Eigen::Map<const Eigen::VectorXd>(curve.value.data(), n);
  const double span_h = time_h[n - 1];
  const auto lack = [&](double log_tau) { return fitted_with(time_h, value, std::exp(log_tau)).squares_left; };
  const double least = std::log(kShortestShare * span_h), most = std::log(kLongestShare * span_h);
  const double step = (most - least) / kGridSteps;
  double best = least;
  for (int i = 1; i <= kGridSteps; ++i)
    if (lack(least + i * step) < lack(best)) best = least + i * step;
  double from = std::max(best - step, least), to = std::min(best + step, most);
  const double golden = (std::sqrt(5.0) - 1.0) / 2.0;
  for (int i = 0; i < kGoldenSteps; ++i) {
    const double left = to - golden * (to - from), right = from + golden * (to - from);
    (lack(left) < lack(right) ? to : from) = lack(left) < lack(right) ? right : left;
  }
  const double tau_h = std::exp((from + to) / 2.0);
  const LeastSquares fit = fitted_with(time_h, value, tau_h);
  const double variance = fit.squares_left / static_cast<double>(n - 3);
  const double constant = (value.array() - value.mean()).matrix().squaredNorm();
  if (constant - fit.squares_left <= 2.0 * kEvident * variance || lack(most) - fit.squares_left <= kEvident * variance)
    return std::nullopt;
  Eigen::MatrixXd jacobian(n, 3);
  const Eigen::ArrayXd decay = (-time_h.array() / tau_h).exp();
  jacobian.col(0).setOnes();
  jacobian.col(1) = 1.0 - decay;
  jacobian.col(2) = -fit.sizes[1] * decay * time_h.array() / (tau_h * tau_h);
  const Eigen::MatrixXd covariance = variance * inverse_gram(jacobian);
  return Settling{fit.sizes[1], std::sqrt(covariance(1, 1)), tau_h, std::sqrt(covariance(2, 2)), decay[n - 1]};
}

void evaluate_warm_up(WarmUpCurve& curve, double window_h) {
  const double first = curve.value.front();
  for (double& value : curve.value) value -= first;
  const WindowRanges ranges = window_ranges(curve.time_h, curve.value, window_h);
  curve.range = ranges.whole;
  curve.first_range = ranges.first;
  curve.last_range = ranges.last;
  curve.settled = ranges.last <= kSettledShare * ranges.first;
  curve.settling = settling_of(curve);
}

/// Straight between the readings; nothing outside them.
std::optional<double> value_at(const WarmUpCurve& curve, double time_h) {
  const auto above = std::lower_bound(curve.time_h.begin(), curve.time_h.end(), time_h);
  if (above == curve.time_h.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(above - curve.time_h.begin());
  if (*above == time_h) return curve.value[i];
  if (i == 0) return std::nullopt;
  const double part = (time_h - curve.time_h[i - 1]) / (curve.time_h[i] - curve.time_h[i - 1]);
  return curve.value[i - 1] + part * (curve.value[i] - curve.value[i - 1]);
}

/// Nothing where the two curves have too few times in common.
std::optional<WarmUpDifference> difference_of(const WarmUpCurve& from, const WarmUpCurve& to, double window_h) {
  WarmUpDifference difference;
  difference.curve.sense = from.sense;
  difference.curve.position_mm = from.position_mm;
  difference.curve.approach = from.approach;
  difference.to_mm = to.position_mm;
  std::vector<double> times_h = from.time_h;
  times_h.insert(times_h.end(), to.time_h.begin(), to.time_h.end());
  std::ranges::sort(times_h);
  times_h.erase(std::unique(times_h.begin(), times_h.end()), times_h.end());
  for (const double time_h : times_h) {
    const auto near = value_at(from, time_h), far = value_at(to, time_h);
    if (!near || !far) continue;
    difference.curve.time_h.push_back(time_h);
    difference.curve.value.push_back(*far - *near);
  }
  if (difference.curve.value.size() < kLeastWarmUpReadings) return std::nullopt;
  evaluate_warm_up(difference.curve, window_h);
  if (!is_rotation(from.sense))
    difference.range_um_per_m = difference.curve.range / (to.position_mm - from.position_mm) * kMmPerM;
  return difference;
}

void check_times_and_axis(const MeasurementSet& set, Findings& findings) {
  if (set.readings.empty()) findings.add(0, 0, "expected readings, found none");
  for (const Reading& reading : set.readings) {
    if (!reading.time_s)
      findings.add(reading.line, 0, kTimeIsNeeded);
    else if (reading.rotary)
      findings.add(reading.line, 0, "expected a linear axis, found {}", letter_of(reading.axis, true));
    else if (reading.axis != set.readings.front().axis)
      findings.add(reading.line, 0, "expected readings of one moving axis, found {} and {}",
                   letter_of(set.readings.front().axis, false), letter_of(reading.axis, false));
    else
      continue;
    return;
  }
}

/// The curves of one sense, ascending by place.
void add_curves(const MeasurementSet& set, const Group& group, double start_s, WarmUpTest& test, Findings& findings) {
  const double tolerance_mm = target_tolerance_mm(set, group);
  const auto targets = targets_of(set, group, tolerance_mm);
  const std::string name(name_of(group.sense));
  if (targets.size() < 2)
    return findings.add(0, 0, "{}: expected two or more positions, found one (use `ecs test drift`)", name);
  std::map<std::pair<std::size_t, Approach>, WarmUpCurve> curves;
  for (const std::size_t i : group.readings) {
    const Reading& reading = set.readings[i];
    const auto nearest = std::ranges::min_element(targets, [&](const auto& a, const auto& b) {
      return std::abs(a.position_mm - target_mm(reading)) < std::abs(b.position_mm - target_mm(reading));
    });
    WarmUpCurve& curve = curves[{static_cast<std::size_t>(nearest - targets.begin()), reading.approach}];
    curve.sense = group.sense;
    curve.position_mm = nearest->position_mm;
    curve.approach = reading.approach;
    curve.time_h.push_back((*reading.time_s - start_s) / kSecondsPerHour);
    curve.value.push_back(reading.error);
  }
  for (auto& [place, curve] : curves) {
    if (!std::ranges::is_sorted(curve.time_h, std::less_equal<>())) {
      findings.add(0, 0, "{} at {:g} mm: expected rising times, found one that does not rise", name, curve.position_mm);
      continue;
    }
    const double hours = curve.time_h.back() - curve.time_h.front();
    if (curve.value.size() < kLeastWarmUpReadings) {
      findings.add(0, 0, "{} at {:g} mm: expected {} readings or more, found {}", name, curve.position_mm,
                   kLeastWarmUpReadings, curve.value.size());
    } else if (hours < 2.0 * test.window_h) {
      findings.add(0, 0, "{} at {:g} mm: expected a test of {:.2f} h or more, twice the window, found {:.2f} h", name,
                   curve.position_mm, 2.0 * test.window_h, hours);
    } else {
      evaluate_warm_up(curve, test.window_h);
      test.curves.push_back(curve);
    }
  }
}

void add_differences(WarmUpTest& test) {
  for (const WarmUpCurve& from : test.curves) {
    const WarmUpCurve* last = nullptr;
    bool is_first = true;
    for (const WarmUpCurve& other : test.curves) {
      if (other.sense != from.sense || other.approach != from.approach) continue;
      if (other.position_mm < from.position_mm) is_first = false;
      if (!last || other.position_mm > last->position_mm) last = &other;
    }
    if (!is_first || last == &from) continue;
    if (auto difference = difference_of(from, *last, test.window_h)) test.differences.push_back(*difference);
  }
}

}  // namespace

Result<WarmUpTest> warm_up_test_of(const MeasurementSet& set, double window_h) {
  Findings findings(set.source);
  check_times_and_axis(set, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  const auto [first, last] = std::ranges::minmax_element(
      set.readings, [](const Reading& a, const Reading& b) { return *a.time_s < *b.time_s; });
  WarmUpTest test;
  test.axis = first->axis;
  test.window_h = window_h;
  test.hours = (*last->time_s - *first->time_s) / kSecondsPerHour;
  for (const Group& group : groups_of(set)) add_curves(set, group, *first->time_s, test, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  add_differences(test);
  return test;
}

}  // namespace ecs::laser
