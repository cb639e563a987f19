#include "devices/capture_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace ecs::devices {
namespace {

constexpr std::size_t kIntervalsForUsual = 3;
constexpr double kNearlyTheUsual = 0.5;  ///< of the usual interval: the same value so soon is a doubled trigger

void put(std::optional<double>& into, const Values& values, Quantity quantity) {
  if (const auto found = values.find(quantity); found != values.end()) into = found->second;
}

void put_sensor(laser::Reading& reading, const char* column, const Values& values, Quantity quantity) {
  if (const auto found = values.find(quantity); found != values.end()) reading.sensors_degC[column] = found->second;
}

std::string place_text(const laser::Reading& stop) {
  return fmt::format("{} {} {} mm, run {}", letter_of(stop.axis),
                     stop.approach == Approach::forward ? "forward" : "reverse", target_mm(stop), stop.run);
}

}  // namespace

const laser::Reading* CaptureRecord::due() const { return next_ < plan_.stops.size() ? &plan_.stops[next_] : nullptr; }

CaptureRecord::Place CaptureRecord::place() const {
  if (next_ >= plan_.stops.size()) return {};
  std::size_t begin = next_;
  while (begin > 0 && same_pass(plan_.stops[begin - 1], plan_.stops[next_])) --begin;
  std::size_t end = next_ + 1;
  while (end < plan_.stops.size() && same_pass(plan_.stops[end], plan_.stops[next_])) ++end;
  return {next_ - begin + 1, end - begin, begin == next_};
}

int CaptureRecord::runs() const {
  int runs = 0;
  for (const laser::Reading& stop : plan_.stops) runs = std::max(runs, stop.run);
  return runs;
}

/// Half the way to the nearest other target of the pass.
double CaptureRecord::window_mm(std::size_t stop) const {
  double nearest = 0.0;
  for (const std::size_t other : {stop - 1, stop + 1}) {
    if (other >= plan_.stops.size() || !same_pass(plan_.stops[other], plan_.stops[stop])) continue;
    const double way = std::abs(target_mm(plan_.stops[other]) - target_mm(plan_.stops[stop]));
    if (way > 0.0 && (nearest == 0.0 || way < nearest)) nearest = way;
  }
  return nearest == 0.0 ? 1.0 : nearest / 2.0;
}

/// Median time between readings of the same pass; nothing as long as there are few.
std::optional<double> CaptureRecord::usual_interval_s() const {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < taken_.size(); ++k)
    if (same_pass(taken_[k - 1], taken_[k]) && stop_of_[k] == stop_of_[k - 1] + 1)
      intervals.push_back(taken_[k].time_s.value_or(0.0) - taken_[k - 1].time_s.value_or(0.0));
  if (intervals.size() < kIntervalsForUsual) return std::nullopt;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// What is odd about a reading that an error display gives: nothing in the value says which target it belongs to.
std::string CaptureRecord::doubt(double at_s, double shown) const {
  const auto usual = usual_interval_s();
  if (!judged_ || !usual || taken_.empty() || !same_pass(taken_.back(), plan_.stops[next_])) return {};
  const double took = at_s - taken_.back().time_s.value_or(at_s);
  if (took > rules_.missed_factor * *usual)
    return fmt::format(
        "this reading came {:.1f} s after the last one where {:.1f} s are usual: was a trigger missed? If "
        "the machine stands a target further on, take it back (u), skip one (s), and trigger again",
        took, *usual);
  if (took < kNearlyTheUsual * *usual && shown == shown_.back())
    return fmt::format(
        "the same value again, {:.1f} s after the last one where {:.1f} s are usual: triggered twice? Then "
        "take it back (u)",
        took, *usual);
  return {};
}

Verdict CaptureRecord::take(double error, double at_s, double shown, const Values& around) {
  laser::Reading reading = plan_.stops[next_];
  reading.error = error;
  reading.time_s = at_s;
  put_sensor(reading, "t_air_degC", around, Quantity::air_degC);
  put_sensor(reading, "t_material_degC", around, Quantity::material_degC);
  put(reading.pressure_hPa, around, Quantity::pressure_hPa);
  put(reading.humidity_pct, around, Quantity::humidity_pct);
  std::string odd = rules_.shows == Shows::error ? doubt(at_s, shown) : std::string();
  taken_.push_back(std::move(reading));
  stop_of_.push_back(next_);
  shown_.push_back(shown);
  judged_ = true;
  doubts_.push_back(odd);
  ++next_;
  return {true, 0, std::move(odd)};
}

Verdict CaptureRecord::by_position(double shown, double at_s, const Values& around) {
  const double stands_mm = shown * rules_.scale;
  const auto fits = [&](std::size_t stop) {
    return std::abs(stands_mm - target_mm(plan_.stops[stop])) <= window_mm(stop);
  };
  const auto error = [&](std::size_t stop) { return (stands_mm - target_mm(plan_.stops[stop])) * 1e3; };
  if (fits(next_)) return take(error(next_), at_s, shown, around);
  const laser::Reading& target = plan_.stops[next_];
  if (!stop_of_.empty() && fits(stop_of_.back()))
    return {
        false, 0,
        fmt::format("not taken: the display still shows {} mm, the target before; {} mm is due. A doubled trigger, or "
                    "the axis has not moved",
                    stands_mm, target_mm(target))};
  for (std::size_t ahead = next_ + 1; ahead < plan_.stops.size() && same_pass(plan_.stops[ahead], target); ++ahead) {
    if (!fits(ahead)) continue;
    const std::size_t missed = ahead - next_;
    const double due_mm = target_mm(target);
    next_ = ahead;
    Verdict verdict = take(error(ahead), at_s, shown, around);
    verdict.missed = static_cast<int>(missed);
    verdict.warning = fmt::format(
        "a trigger was missed: the display shows {} mm where {} mm was due; {} target{} left "
        "without a reading in this pass (u takes it back)",
        stands_mm, due_mm, missed, missed == 1 ? " is" : "s are");
    doubts_.back() = fmt::format("{} target(s) before it missed", missed);
    return verdict;
  }
  return {false, 0,
          fmt::format("not taken: the display shows {} mm, {} mm is due, and no target of this pass is there",
                      stands_mm, target_mm(target))};
}

std::string CaptureRecord::doubled(double at_s) const {
  if (taken_.empty()) return {};
  const double since_s = at_s - taken_.back().time_s.value_or(at_s);
  if (since_s >= rules_.min_interval_s) return {};
  return fmt::format("not taken: a doubled trigger, {:.2f} s after the last one (readings count from {} s)", since_s,
                     rules_.min_interval_s);
}

Verdict CaptureRecord::offer(double shown, double at_s, const Values& around) {
  if (next_ >= plan_.stops.size()) return {false, 0, "not taken: every target has its reading"};
  if (std::string why = doubled(at_s); !why.empty()) return {false, 0, std::move(why)};
  if (rules_.shows == Shows::position) return by_position(shown, at_s, around);
  return take(shown * rules_.scale, at_s, shown, around);
}

bool CaptureRecord::undo() {
  judged_ = false;
  const std::size_t after_last = stop_of_.empty() ? 0 : stop_of_.back() + 1;
  if (next_ > after_last) {
    next_ = after_last;
    return true;
  }
  if (taken_.empty()) return false;
  taken_.pop_back();
  stop_of_.pop_back();
  doubts_.pop_back();
  shown_.pop_back();
  next_ = stop_of_.empty() ? 0 : stop_of_.back() + 1;
  return true;
}

bool CaptureRecord::skip() {
  if (next_ >= plan_.stops.size()) return false;
  judged_ = false;
  ++next_;
  return true;
}

void CaptureRecord::note(const std::string& key, const std::string& value) {
  const auto same = std::find_if(plan_.metadata.begin(), plan_.metadata.end(),
                                 [&](const laser::MetadataEntry& entry) { return entry.key == key; });
  if (same != plan_.metadata.end())
    same->value = value;
  else
    plan_.metadata.push_back({key, value});
}

std::optional<std::string> CaptureRecord::noted(std::string_view key) const {
  for (const laser::MetadataEntry& entry : plan_.metadata)
    if (entry.key == key) return entry.value;
  return std::nullopt;
}

laser::MeasurementSet CaptureRecord::result() const {
  laser::MeasurementSet set;
  set.metadata = plan_.metadata;
  set.readings = taken_;
  std::vector<bool> read(plan_.stops.size(), false);
  for (const std::size_t stop : stop_of_) read[stop] = true;
  for (std::size_t stop = 0; stop < next_; ++stop)
    if (!read[stop]) set.metadata.push_back({"left out", place_text(plan_.stops[stop])});
  for (std::size_t k = 0; k < taken_.size(); ++k)
    if (!doubts_[k].empty())
      set.metadata.push_back({"in doubt", fmt::format("{}: {}", place_text(taken_[k]), doubts_[k])});
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k + 1);
  return set;
}

}  // namespace ecs::devices
