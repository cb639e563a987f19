#include "commissioning/unit/datum_recording.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::chrono::milliseconds kRecordLimit{30'000};
constexpr double kSpeedWindow_s = 0.02;
constexpr double kShortestPeriod_us = 0.001, kLongestPeriod_us = 1e9, kMost_um_per_count = 1e6;  ///< choices
constexpr double kStillCounts = 2.5;  ///< fewer counts within the window are no motion
constexpr std::string_view kColumns = "time_s,counts,position_mm,speed_mm_min,switch_closed,marker";

std::size_t half_window(const DatumRecording& recording) {
  const double samples = kSpeedWindow_s * 0.5e6 / recording.sample_period_us;
  return static_cast<std::size_t>(
      std::clamp(samples, 1.0, std::max(1.0, static_cast<double>(recording.samples.size()))));
}

double still_mm_min(const DatumRecording& recording) {
  return kStillCounts * std::abs(recording.um_per_count) * 1e-3 / (kSpeedWindow_s / 60.0);
}

Problem bad_row(const std::string& name, int line, std::string message) {
  return {ProblemKind::bad_input, std::move(message), name, line, 0, {}};
}

/// `key: value` of a header line into the recording; what is wrong with it, or nothing.
std::optional<std::string> take_header(std::string_view key, std::string_view value, DatumRecording& recording) {
  const auto number = number_in(value);
  if (key == "axis") {
    const auto axis = value.size() == 1 ? axis_of(value.front()) : std::nullopt;
    if (!axis) return fmt::format("axis: expected X, Y or Z, found \"{}\"", value);
    recording.axis = *axis;
  } else if (key == "sample_period_us") {
    if (!number || *number < kShortestPeriod_us || *number > kLongestPeriod_us)
      return fmt::format("sample_period_us: expected {} to {}, found \"{}\"", kShortestPeriod_us, kLongestPeriod_us,
                         value);
    recording.sample_period_us = *number;
  } else if (key == "um_per_count") {
    if (!number || *number == 0.0 || std::abs(*number) > kMost_um_per_count)
      return fmt::format("um_per_count: expected a number within {}, not 0, found \"{}\"", kMost_um_per_count, value);
    recording.um_per_count = *number;
  } else if (key == "taken") {
    recording.taken = value;
  } else if (key == "serial_number") {
    recording.serial_number = value;
  }
  return std::nullopt;
}

std::optional<DatumSample> sample_in(std::string_view row) {
  const auto cells = split(row, ',');
  if (cells.size() != 6) return std::nullopt;
  const auto counts = integer_in(cells[1]);
  const auto closed = integer_in(cells[4]);
  const auto marker = integer_in(cells[5]);
  const auto is_flag = [](const std::optional<long long>& flag) { return flag && (*flag == 0 || *flag == 1); };
  if (!counts || *counts < INT32_MIN || *counts > INT32_MAX || !is_flag(closed) || !is_flag(marker))
    return std::nullopt;
  return DatumSample{static_cast<std::int32_t>(*counts), *closed == 1, *marker == 1};
}

}  // namespace

std::vector<double> speeds_mm_min(const DatumRecording& recording) {
  const std::size_t n = recording.samples.size();
  const std::size_t half = half_window(recording);
  std::vector<double> speeds(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = i > half ? i - half : 0;
    const std::size_t to = std::min(n - 1, i + half);
    const double minutes = (recording.time_s(to) - recording.time_s(from)) / 60.0;
    if (minutes > 0.0) speeds[i] = (recording.position_mm(to) - recording.position_mm(from)) / minutes;
  }
  return speeds;
}

Result<DatumRecording> read_recording(protocol::UnitClient& client, Address address,
                                      const protocol::ProgressCallback& progress) {
  ECS_TRY(head, client.read_memory(address, kDatumRecordHeaderBytes));
  const auto header = decode_datum_header(head);
  if (!header) return problem(ProblemKind::link, "no datum record at 0x{:06X}", address);
  DatumRecording recording{header->axis, header->sample_period_us, header->um_per_count, {}, {}, {}};
  ECS_TRY(bytes, client.read_memory(address + kDatumRecordHeaderBytes, header->samples * kDatumSampleBytes, progress));
  for (std::size_t i = 0; i < header->samples; ++i)
    recording.samples.push_back(decode_datum_sample(ByteView(bytes).subspan(i * kDatumSampleBytes)));
  return recording;
}

Result<DatumRecording> record_datum(protocol::UnitClient& client, Axis axis, const protocol::CommandCallback& busy,
                                    const protocol::ProgressCallback& fetching) {
  ECS_TRY(identity, client.identity());
  ECS_TRY(result, client.record_datum(axis, kRecordLimit, busy));
  ECS_TRY(recording, read_recording(client, result.value, fetching));
  recording.taken = now_utc();
  recording.serial_number = identity.serial_number;
  return recording;
}

std::string to_csv(const DatumRecording& recording) {
  std::string text = fmt::format("# axis: {}\n# sample_period_us: {}\n# um_per_count: {}\n", letter_of(recording.axis),
                                 recording.sample_period_us, recording.um_per_count);
  if (!recording.taken.empty()) text += fmt::format("# taken: {}\n", recording.taken);
  if (!recording.serial_number.empty())
    text += fmt::format("# serial_number: {}\n", shown_line(recording.serial_number));
  text += fmt::format("{}\n", kColumns);
  const auto speeds = speeds_mm_min(recording);
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    const DatumSample& sample = recording.samples[i];
    text += fmt::format("{:.6f},{},{:.6f},{:.3f},{:d},{:d}\n", recording.time_s(i), sample.counts,
                        recording.position_mm(i), speeds[i], sample.switch_closed, sample.marker);
  }
  return text;
}

Result<DatumRecording> parse_recording(std::string_view text, const std::string& name) {
  if (auto why = why_no_text(text, name)) return tl::unexpected(std::move(*why));
  DatumRecording recording;
  std::vector<Problem> problems;
  bool in_rows = false;
  int line = 0;
  for (const std::string_view raw : lines_of(text)) {
    ++line;
    const std::string_view row = trimmed(raw);
    if (row.empty()) continue;
    if (!in_rows && row.front() == '#') {
      const std::size_t colon = row.find(':');
      if (colon == std::string_view::npos) continue;
      if (auto wrong = take_header(trimmed(row.substr(1, colon - 1)), trimmed(row.substr(colon + 1)), recording))
        problems.push_back(bad_row(name, line, *wrong));
    } else if (!in_rows) {
      if (row != kColumns) return problem_at(name, line, 1, "expected the columns {}", kColumns);
      in_rows = true;
    } else if (const auto sample = sample_in(row)) {
      recording.samples.push_back(*sample);
    } else {
      problems.push_back(
          bad_row(name, line,
                  fmt::format("expected six numbers ({}), of which the last two are 0 or 1, found \"{}\"", kColumns,
                              row.substr(0, 80))));
    }
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  if (recording.samples.empty())
    return problem_at(name, 0, 0, "expected a datum record written by `ecs utility datum record -o`, found no samples");
  return recording;
}

Result<DatumRecording> read_recording_file(const std::filesystem::path& path) {
  ECS_TRY(text, read_file(path));
  return parse_recording(text, path.string());
}

std::vector<DatumEvent> events_of(const DatumRecording& recording) {
  const auto speeds = speeds_mm_min(recording);
  std::vector<DatumEvent> events;
  bool moving = false;
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    const DatumSample& sample = recording.samples[i];
    const auto add = [&](const char* what) {
      events.push_back({what, recording.time_s(i), recording.position_mm(i), speeds[i]});
    };
    const bool moves = std::abs(speeds[i]) > still_mm_min(recording);
    if (moves != moving) add(moves ? "motion begins" : "motion ends");
    moving = moves;
    if (i > 0 && sample.switch_closed != recording.samples[i - 1].switch_closed)
      add(sample.switch_closed ? "switch closes" : "switch opens");
    if (sample.marker) add("marker");
  }
  return events;
}

Cell datum_event_cell(const DatumEvent& event) {
  return record_cell("{time_s:>8} {position_mm:>12} {speed_mm_min:>15}  {what}\n", "what"_is(event.what),
                     "time_s"_is(event.time_s, 3), "position_mm"_is(event.position_mm, 4),
                     "speed_mm_min"_is(event.speed_mm_min, 1));
}

std::string graph_of(const DatumRecording& recording) {
  constexpr std::size_t kWide = 70;
  constexpr int kHigh = 7;  // rows above and below zero
  const auto speeds = speeds_mm_min(recording);
  double most = still_mm_min(recording);
  for (const double speed : speeds) most = std::max(most, std::abs(speed));
  std::vector<std::string> rows(2 * kHigh + 1, std::string(kWide, ' '));
  rows[kHigh] = std::string(kWide, '-');
  std::string closed(kWide, '_');
  std::string marker(kWide, ' ');
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const std::size_t x = i * kWide / speeds.size();
    const int y = kHigh - static_cast<int>(std::lround(speeds[i] / most * kHigh));
    rows[static_cast<std::size_t>(y)][x] = '*';
    if (recording.samples[i].switch_closed) closed[x] = '#';
    if (recording.samples[i].marker) marker[x] = '|';
  }
  std::string text;
  for (int y = 0; y <= 2 * kHigh; ++y) {
    const std::string label =
        y % kHigh == 0 ? fmt::format("{:>8.0f}", most * (kHigh - y) / kHigh) : std::string(8, ' ');
    text += fmt::format("{} {}\n", label, rows[static_cast<std::size_t>(y)]);
  }
  const double end_s = recording.time_s(speeds.size() - 1);
  return text +
         fmt::format(
             "  switch {}\n  marker {}\n  speed in mm/min against time, 0 to {:.2f} s; # switch closed, | marker\n",
             closed, marker, end_s);
}

}  // namespace ecs::commissioning
