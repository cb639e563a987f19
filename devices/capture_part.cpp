// The file from which a capture goes on: the readings so far, and in its metadata the stops, the rules and where it
// was.
#include <fmt/format.h>

#include "base/text.hpp"
#include "devices/capture_record.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::devices {
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

bool of_capture(std::string_view key) { return key == kBegin || key.starts_with("capture "); }

/// The stops as the lines of a measurement set of their own.
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
  return {ProblemKind::bad_input,
          fmt::format("{}: this is no capture to go on with, or it was changed; the readings in it are still a "
                      "measurement set",
                      what),
          part.source,
          0,
          0,
          {}};
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
  record.shown_ = shown;
  record.doubts_.resize(read.size());
  record.taken_ = part.readings;
  for (std::size_t k = 0; k < read.size(); ++k) {
    laser::Reading& reading = record.taken_[k];
    if (!same_pass(reading, record.plan_.stops[record.stop_of_[k]]))
      return tl::unexpected(
          broken(part, fmt::format("reading {} is not what stop {} asked for", k + 1, record.stop_of_[k])));
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
