// JSON lines: an object with its time and one or more values in each line, as probes and sensors log them.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/channels.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::string_view, 5> kTimeKeys{"ts", "time_s", "time", "timestamp", "t"};
constexpr int kDeepest = 8;

/// The time of a line and the key that holds it.
struct StatedTime {
  std::string key;
  double seconds = 0.0;
};

std::optional<StatedTime> time_in(const Json& object) {
  for (const std::string_view key : kTimeKeys) {
    const auto found = object.find(key);
    if (found == object.end()) continue;
    if (found->is_number()) return StatedTime{std::string(key), found->get<double>()};
    const auto date = found->is_string() ? seconds_in(found->get_ref<const std::string&>()) : std::nullopt;
    if (date) return StatedTime{std::string(key), *date};
  }
  return std::nullopt;
}

/// An entry of a list goes by its "id" or "name", else by its number from 1.
std::string name_in_list(const Json& entry, std::size_t index) {
  for (const char* const key : {"id", "name"})
    if (entry.is_object() && entry.contains(key) && entry[key].is_string()) return entry[key].get<std::string>();
  return fmt::format("{}", index + 1);
}

/// All numbers of a value; a number inside an object or list is named after its way there: "atherms.chamber.temp".
void take_numbers(ChannelLog& log, const Json& value, const std::string& name, const ChannelSample& place, int depth) {
  const auto inside = [&](const std::string& part) { return name.empty() ? part : name + "." + part; };
  if (value.is_number()) {
    ChannelSample sample = place;
    sample.value = value.get<double>();
    log.channels[name].push_back(sample);
  } else if (value.is_object() && depth < kDeepest) {
    for (const auto& [key, member] : value.items()) take_numbers(log, member, inside(key), place, depth + 1);
  } else if (value.is_array() && depth < kDeepest) {
    for (std::size_t i = 0; i < value.size(); ++i)
      take_numbers(log, value[i], inside(name_in_list(value[i], i)), place, depth + 1);
  }
}

void take_line(ChannelLog& log, std::string_view line, int number, Findings& findings) {
  Json object;
  try {
    object = Json::parse(line);
  } catch (const Json::parse_error& error) {
    const auto column = std::clamp<std::size_t>(error.byte, 1, line.size());
    findings.add(number, static_cast<int>(column), "expected a JSON object, found no JSON from here");
    return;
  } catch (const Json::exception&) {
    findings.add(number, 1, "expected finite numbers, found one that is too large");
    return;
  }
  const auto time = object.is_object() ? time_in(object) : std::nullopt;
  if (!time)
    return findings.add(number, 1, "expected a JSON object with its time ({}: a number of seconds or a date)",
                        fmt::join(kTimeKeys, ", "));
  object.erase(time->key);
  take_numbers(log, object, {}, {time->seconds, 0.0, number}, 0);
}

/// Channels that bear the names of fields are those fields.
ColumnMapping by_name(const ChannelLog& log) {
  ColumnMapping mapping;
  for (const auto& [name, samples] : log.channels) {
    if (role_of(name) == Role::other && !is_known_column(name)) continue;
    ColumnRule rule;
    rule.field = rule.heading = name;
    mapping.rules.push_back(std::move(rule));
  }
  return mapping;
}

bool has_value(const ColumnMapping& mapping) {
  return std::ranges::any_of(mapping.rules, [](const ColumnRule& rule) { return is_value(role_of(rule.field)); });
}

Result<MeasurementSet> read_json_lines(std::string_view text, const std::string& file_name,
                                       const ImportOptions& options) {
  ChannelLog log;
  Findings findings(file_name);
  for (const auto& [number, line] : numbered_lines_of(text))
    if (!trimmed(line).empty()) take_line(log, line, number, findings);
  if (findings.empty() && log.channels.empty()) findings.add(0, 0, "expected numbers with the times, found none");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  ImportOptions with_channels = options;
  if (!options.channels) with_channels.channels = by_name(log);
  if (has_value(*with_channels.channels)) return read_channels(std::move(log), file_name, with_channels);
  Problem wanted =
      usage(file_name, fmt::format("the meaning of the channels is not known ({}): give --channels \"EX={}[mm]\" and "
                                   "others, and --axis X --parked x=0 where no channel is the position",
                                   channels_text(log), log.channels.begin()->first));
  wanted.line = 1;
  wanted.column = 1;
  return tl::unexpected(std::move(wanted));
}

/// Objects in single lines, with a time in the first.
Recognition recognises_json_lines(const FileStart& file) {
  const std::string first = lower(file.first_line);
  const bool is_object = first.starts_with('{') && first.ends_with('}');
  const bool has_time = std::ranges::any_of(
      kTimeKeys, [&](std::string_view key) { return first.find(fmt::format("\"{}\"", key)) != std::string::npos; });
  return is_object && has_time ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kJsonLines{
    .id = "json_lines",
    .title = "JSON lines of channels over time",
    .sample = "probe.jsonl",
    .recognises = recognises_json_lines,
    .read = read_json_lines,
    .units = ErrorUnits::fixed,
};

}  // namespace ecs::laser
