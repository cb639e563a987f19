// Time-stamped logs of a control system's channels (EPICS camonitor), one channel at a time.
#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/renishaw_file.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

struct Sample {
  std::string_view channel;
  double time_s = 0.0;
  std::optional<double> value;  ///< nothing: a word, or disconnected
};

std::optional<Sample> sample_in(std::string_view line) {
  const auto words = words_of(line);
  if (words.size() < 4 || integer_in(words[0])) return std::nullopt;
  const auto time_s = seconds_in(std::string(words[1]) + " " + std::string(words[2]));
  if (!time_s || words[1].find('-') == std::string_view::npos) return std::nullopt;
  return Sample{words[0], *time_s, number_in(words[3])};
}

/// A block heading "12mm": the gauge distance of the samples that follow.
std::optional<double> gauge_mm_in(std::string_view line) {
  const std::string plain = lower(trimmed(line));
  if (!plain.ends_with("mm")) return std::nullopt;
  return number_in(std::string_view(plain).substr(0, plain.size() - 2));
}

Result<std::string> channel_of(const std::vector<std::string_view>& lines, const std::string& file_name,
                               const ImportOptions& options) {
  std::map<std::string, std::size_t, std::less<>> channels;
  for (const std::string_view line : lines)
    if (const auto sample = sample_in(line)) ++channels[std::string(sample->channel)];
  if (!options.channel.empty() && channels.contains(options.channel)) return options.channel;
  if (options.channel.empty() && channels.size() == 1) return channels.begin()->first;
  std::vector<std::string> names;
  for (const auto& [name, count] : channels) names.push_back(fmt::format("{} ({} values)", name, count));
  if (names.empty())
    return tl::unexpected(usage(file_name, "expected channel, date, time and value, found no such line"));
  return tl::unexpected(
      usage(file_name, fmt::format("{}: give one of {}",
                                   options.channel.empty() ? "the log holds several channels"
                                                           : "no channel " + in_quotes(options.channel) + " in the log",
                                   fmt::join(names, ", "))));
}

/// One channel of a log, values in mm: readings over time, or, where headings such as `3mm` stand between the values,
/// deviations from them.
Result<MeasurementSet> read_channel_log(std::string_view text, const std::string& file_name,
                                        const ImportOptions& options) {
  const auto lines = lines_of(text);
  const auto channel = channel_of(lines, file_name, options);
  if (!channel) return tl::unexpected(channel.error());
  const auto axis = axis_wanted(options, file_name);
  if (!axis) return tl::unexpected(axis.error());
  const auto sense = positioning_sense(options, *axis, file_name);
  if (!sense) return tl::unexpected(sense.error());
  MeasurementSet set;
  set.source = file_name;
  std::optional<double> gauge_mm;
  int strange = 0;
  int wordy = 0;
  int run = 0;
  double first_s = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (const auto gauge = gauge_mm_in(lines[i])) {
      gauge_mm = gauge;
      run = 0;
      continue;
    }
    const auto sample = sample_in(lines[i]);
    if (!sample && !trimmed(lines[i]).empty()) ++strange;
    if (!sample || sample->channel != *channel) continue;
    if (!sample->value) {
      ++wordy;
      continue;
    }
    Reading reading;
    reading.line = static_cast<int>(i) + 1;
    reading.axis = *axis;
    reading.sense = *sense;
    reading.position_mm = gauge_mm ? position_at(options, *axis, *gauge_mm) : options.parked_mm;
    reading.error = (*sample->value - gauge_mm.value_or(0.0)) * kUmPerMm;
    reading.time_s = sample->time_s;
    if (gauge_mm) reading.run = ++run;
    first_s = std::min(first_s, sample->time_s);
    set.readings.push_back(std::move(reading));
  }
  if (set.readings.empty())
    return problem_at(file_name, 0, 0, fmt::format("{}: expected numbers, found none", *channel));
  for (Reading& reading : set.readings) *reading.time_s -= first_s;
  set.metadata.push_back({"channel", *channel});
  set.notes.push_back("values taken as mm, times from the first value of the channel");
  set.notes.push_back(gauge_mm ? "headings such as 3mm are the targets: error = value - heading"
                               : "readings are the channel's values, not deviations from targets");
  if (strange > 0) set.notes.push_back(fmt::format("{} lines that hold no value are passed over", strange));
  if (wordy > 0) set.notes.push_back(fmt::format("{} values of the channel are no numbers: left out", wordy));
  number_rows(set);
  return set;
}

bool is_channel_sample(std::string_view line) {
  const auto words = words_of(line);
  return words.size() >= 4 && words[1].find('-') != std::string_view::npos &&
         seconds_in(std::string(words[1]) + " " + std::string(words[2])) && !number_in(words[0]);
}

Recognition recognises_channel_log(const FileStart& file) {
  const auto lines = lines_of(file.text.substr(0, file.head.size()));
  return std::count_if(lines.begin(), lines.end(), is_channel_sample) >= 2 ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kChannelLog{
    .id = "channel_log",
    .title = "log of channels (camonitor)",
    .sample = "sensor.log",
    .recognises = recognises_channel_log,
    .read = read_channel_log,
};

}  // namespace ecs::laser
