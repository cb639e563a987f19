// The file of a capture that was interrupted holds the readings so far, and in its metadata the stops, the rules and
// where it was.
#include "modules/capture/capture_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/moved_targets.hpp"
#include "base/text.hpp"
#include "laser/groups.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::devices {
namespace {

constexpr double kMostStops = 1'000'000;

std::vector<double> targets_of(const CaptureLine& line) {
  const double way = std::abs(line.to_mm - line.from_mm);
  const double step = std::abs(line.step_mm);
  const double sign = line.to_mm < line.from_mm ? -1.0 : 1.0;
  std::vector<double> targets;
  const auto whole = static_cast<long>(std::floor(way / step + 1e-9));
  for (long k = 0; k <= whole; ++k) targets.push_back(line.from_mm + sign * step * static_cast<double>(k));
  if (way - step * static_cast<double>(whole) > step * 1e-6) targets.push_back(line.to_mm);
  return line.moved ? moved_targets(std::move(targets)) : targets;
}

}  // namespace

Result<std::vector<laser::Reading>> stops_of(const CaptureLine& line) {
  const double step = std::abs(line.step_mm);
  if (line.from_mm == line.to_mm || step == 0.0)
    return problem(ProblemKind::usage, "expected two different ends (--from, --to) and a --step other than 0");
  if (std::abs(line.to_mm - line.from_mm) / step * line.runs * 2.0 > kMostStops)
    return problem(ProblemKind::usage, "a step of {} mm makes more than a million readings", step);
  std::vector<double> targets = targets_of(line);
  const bool rising = line.to_mm > line.from_mm;
  std::vector<laser::Reading> stops;
  for (int run = 1; run <= line.runs; ++run)
    for (int pass = 0; pass < (line.one_way ? 1 : 2); ++pass) {
      laser::Reading stop;
      stop.axis = line.axis;
      stop.sense = line.sense;
      stop.position_mm = line.parked_mm;
      stop.run = run;
      stop.feed_mm_min = line.feed_mm_min;
      stop.approach = rising == (pass == 0) ? Approach::forward : Approach::reverse;
      for (std::size_t k = 0; k < targets.size(); ++k) {
        stop.position_mm[index_of(line.axis)] = targets[pass == 0 ? k : targets.size() - 1 - k];
        stops.push_back(stop);
      }
    }
  return stops;
}

Result<std::vector<laser::Reading>> stops_of_targets(const laser::MeasurementSet& targets) {
  std::vector<laser::Reading> stops = targets.readings;
  for (laser::Reading& stop : stops) {
    if (stop.approach == Approach::unknown)
      return problem_at(targets.source, stop.line, 0,
                        "approach: expected 1 or -1, the side from which to approach the target");
    stop.error = 0.0;
    stop.time_s.reset();
    stop.row = stop.line = 0;
  }
  return stops;
}

bool same_pass(const laser::Reading& a, const laser::Reading& b) {
  return a.axis == b.axis && a.sense == b.sense && a.run == b.run && a.approach == b.approach;
}

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
  const bool backwards = plan_.stops[next_].approach != plan_.stops.front().approach;  // a target keeps its number
  return {backwards ? end - next_ : next_ - begin + 1, end - begin, begin == next_};
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
  return laser::median_of(std::move(intervals));
}

/// What is odd about a reading that an error display gives: nothing in the value says which target it belongs to.
std::string CaptureRecord::doubt(double at_s, double shown) const {
  const auto usual = usual_interval_s();
  if (!judged_ || !usual || taken_.empty() || !same_pass(taken_.back(), plan_.stops[next_])) return {};
  const double took = at_s - taken_.back().time_s.value_or(at_s);
  if (took > rules_.missed_factor * *usual)
    return fmt::format(
        "this reading came {:.1f} s after the last one where {:.1f} s are usual: was a trigger missed? If the machine "
        "is one target further on, undo (u), skip one (s), and trigger again",
        took, *usual);
  if (took < kNearlyTheUsual * *usual && shown == shown_.back())
    return fmt::format(
        "the same value again, {:.1f} s after the last one where {:.1f} s are usual: triggered twice? Then undo it (u)",
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
    return {false, 0,
            fmt::format("not accepted: the display still shows {} mm, the previous target; {} mm is due. The trigger "
                        "was doubled, or the axis has not moved",
                        stands_mm, target_mm(target))};
  for (std::size_t ahead = next_ + 1; ahead < plan_.stops.size() && same_pass(plan_.stops[ahead], target); ++ahead) {
    if (!fits(ahead)) continue;
    const std::size_t missed = ahead - next_;
    const double due_mm = target_mm(target);
    next_ = ahead;
    Verdict verdict = take(error(ahead), at_s, shown, around);
    verdict.missed = static_cast<int>(missed);
    verdict.warning = fmt::format(
        "a trigger was missed: the display shows {} mm where {} mm was due; {} target{} skipped in this pass (press u "
        "to undo)",
        stands_mm, due_mm, missed, missed == 1 ? " is" : "s are");
    doubts_.back() = fmt::format("{} target(s) before it missed", missed);
    return verdict;
  }
  return {false, 0,
          fmt::format("not accepted: the display shows {} mm, {} mm is due, and this pass has no target there",
                      stands_mm, target_mm(target))};
}

std::string CaptureRecord::doubled(double at_s) const {
  if (taken_.empty()) return {};
  const double since_s = at_s - taken_.back().time_s.value_or(at_s);
  if (since_s >= rules_.min_interval_s) return {};
  return fmt::format("not accepted: double trigger, {:.2f} s after the last one (readings are accepted after {} s)",
                     since_s, rules_.min_interval_s);
}

Verdict CaptureRecord::offer(double shown, double at_s, const Values& around) {
  if (next_ >= plan_.stops.size()) return {false, 0, "not accepted: every target has its reading"};
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
  const auto same =
      std::ranges::find_if(plan_.metadata, [&](const laser::MetadataEntry& entry) { return entry.key == key; });
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

namespace {

constexpr std::string_view kBegin = "capture";
constexpr std::string_view kVersion = "unfinished, version 1; go on with `ecs laser capture --resume`";
constexpr std::string_view kStops = "capture stops";
constexpr std::string_view kStop = "capture stop";
constexpr std::string_view kRead = "capture read";
constexpr std::string_view kNext = "capture next";
constexpr std::string_view kRules = "capture rules";
constexpr std::string_view kShown = "capture shown";
constexpr std::string_view kDoubt = "capture doubt";
constexpr std::string_view kLines = "capture lines";

bool of_capture(std::string_view key) { return key == kBegin || key.starts_with("capture "); }

/// The stops as the lines of a measurement file of their own.
void put_stops(const std::vector<laser::Reading>& stops, std::vector<laser::MetadataEntry>& metadata) {
  laser::MeasurementSet set;
  set.readings = stops;
  const std::string text = to_csv(set);
  const auto lines = lines_of(text);
  metadata.push_back({std::string(kStops), std::string(lines.front())});
  for (std::size_t k = 1; k < lines.size(); ++k)
    if (!lines[k].empty()) metadata.push_back({std::string(kStop), std::string(lines[k])});
}

Problem broken(const laser::MeasurementSet& part, const std::string& what) {
  return problem_at(
             part.source, 0, 0,

             "{}: this is not an unfinished capture, or it was changed; its readings are still a measurement file",
             what)
      .value();
}

std::string metadata_text(const laser::MeasurementSet& part, std::string_view key) {
  return metadata_value(part, key).value_or("");
}

std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view each : split(text, ' '))
    if (const auto number = number_in(each)) numbers.push_back(*number);
  return numbers;
}

}  // namespace

laser::MeasurementSet CaptureRecord::part() const {
  laser::MeasurementSet set;
  set.readings = taken_;
  set.metadata = plan_.metadata;
  set.metadata.push_back({std::string(kBegin), std::string(kVersion)});
  set.metadata.push_back(
      {std::string(kRules), fmt::format("{} {} {} {}", rules_.shows == Shows::position ? 1 : 0, shortest(rules_.scale),
                                        shortest(rules_.min_interval_s), shortest(rules_.missed_factor))});
  set.metadata.push_back({std::string(kNext), std::to_string(next_)});
  if (lines_ > 0) set.metadata.push_back({std::string(kLines), fmt::format("{} {}", lines_, source_)});
  std::string read, shown;
  for (std::size_t k = 0; k < taken_.size(); ++k) {
    read += fmt::format("{}{}", k == 0 ? "" : " ", stop_of_[k]);
    shown += fmt::format("{}{}", k == 0 ? "" : " ", shortest(shown_[k]));
    if (!doubts_[k].empty()) set.metadata.push_back({std::string(kDoubt), fmt::format("{} {}", k, doubts_[k])});
  }
  set.metadata.push_back({std::string(kRead), read});
  set.metadata.push_back({std::string(kShown), shown});
  put_stops(plan_.stops, set.metadata);
  return set;
}

Result<CaptureRecord> CaptureRecord::from_part(const laser::MeasurementSet& part) {
  if (metadata_text(part, kBegin) != kVersion) return tl::unexpected(broken(part, "no line \"# capture: unfinished\""));
  CapturePlan plan;
  std::string stops = metadata_text(part, kStops) + "\n";
  for (const laser::MetadataEntry& entry : part.metadata) {
    if (entry.key == kStop) stops += entry.value + "\n";
    if (!of_capture(entry.key)) plan.metadata.push_back(entry);
  }
  const auto targets = laser::parse_measurement_set(stops, part.source);
  if (!targets) return tl::unexpected(broken(part, "capture stops: " + targets.error().message));
  plan.stops = targets->readings;
  for (laser::Reading& stop : plan.stops) stop.row = stop.line = 0;
  const auto rules = numbers_in(metadata_text(part, kRules));
  const auto read = numbers_in(metadata_text(part, kRead));
  const auto shown = numbers_in(metadata_text(part, kShown));
  const auto next = integer_in(metadata_text(part, kNext));
  if (rules.size() != 4) return tl::unexpected(broken(part, "capture rules: expected four numbers"));
  if (read.size() != part.readings.size() || shown.size() != read.size())
    return tl::unexpected(
        broken(part, fmt::format("capture read: {} stops for {} readings", read.size(), part.readings.size())));
  CaptureRecord record(std::move(plan),
                       {rules[0] > 0.5 ? Shows::position : Shows::error, rules[1], rules[2], rules[3]});
  double last = -1.0;
  for (const double stop : read) {
    if (stop <= last || stop >= static_cast<double>(record.plan_.stops.size()))
      return tl::unexpected(broken(part, "capture read: expected rising numbers of stops"));
    last = stop;
    record.stop_of_.push_back(static_cast<std::size_t>(stop));
  }
  if (!next || static_cast<double>(*next) <= last || *next > static_cast<long long>(record.plan_.stops.size()))
    return tl::unexpected(broken(part, "capture next: expected a stop after the last one read"));
  record.next_ = static_cast<std::size_t>(*next);
  const std::string lines = metadata_text(part, kLines);
  if (const auto count = integer_in(std::string_view(lines).substr(0, lines.find(' '))); count && *count > 0)
    record.read_lines(lines.substr(std::min(lines.size(), lines.find(' ') + 1)), static_cast<std::size_t>(*count));
  record.shown_ = shown;
  record.doubts_.resize(read.size());
  record.taken_ = part.readings;
  for (std::size_t k = 0; k < read.size(); ++k) {
    laser::Reading& reading = record.taken_[k];
    if (!same_pass(reading, record.plan_.stops[record.stop_of_[k]]))
      return tl::unexpected(broken(part, fmt::format("reading {} does not match stop {}", k + 1, record.stop_of_[k])));
    reading.row = reading.line = 0;
  }
  for (const laser::MetadataEntry& entry : part.metadata) {
    if (entry.key != kDoubt) continue;
    const std::size_t blank = entry.value.find(' ');
    const auto index = integer_in(std::string_view(entry.value).substr(0, blank));
    if (index && *index >= 0 && blank != std::string::npos && static_cast<std::size_t>(*index) < record.doubts_.size())
      record.doubts_[static_cast<std::size_t>(*index)] = entry.value.substr(blank + 1);
  }
  return record;
}

}  // namespace ecs::devices
