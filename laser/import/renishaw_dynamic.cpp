// Renishaw .rtx dynamic captures as measurement sets; error compensation tables: combined values by position, as
// readings of one axis.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/renishaw_file.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kSampleBytes = 8;

struct DynamicHead {
  std::vector<MetadataEntry> entries;
  std::size_t data_at = 0;  ///< first byte of the samples
};

/// Lines up to and with `Data:`; nothing if that line or the end of the head is missing.
std::optional<DynamicHead> head_in(std::string_view bytes) {
  DynamicHead head;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = trimmed(bytes.substr(at, end - at));
    at = end + 1;
    if (lower(line) == "data:") {
      head.data_at = at;
      return head;
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || line.ends_with("::")) continue;
    const auto value = decoded(line.substr(colon + 1), "", Encoding::automatic);
    const auto key = decoded(line.substr(0, colon), "", Encoding::automatic);
    if (key) head.entries.push_back({std::string(trimmed(key->text)), value ? std::string(trimmed(value->text)) : ""});
  }
  return std::nullopt;
}

double sample_at(std::string_view bytes, std::size_t at) {
  std::uint64_t bits = 0;
  for (std::size_t k = kSampleBytes; k-- > 0;) bits = (bits << 8u) | static_cast<unsigned char>(bytes[at + k]);
  return std::bit_cast<double>(bits);
}

struct Capture {
  std::size_t count = 0;
  double rate_Hz = 0.0;
  std::optional<double> feed_mm_min;
  bool angular = false;
};

std::optional<double> number_of(const DynamicHead& head, std::string_view key) {
  const auto text = value_of(head.entries, key);
  const auto numbers = text ? numbers_of(*text) : std::vector<double>{};
  return numbers.empty() ? std::nullopt : std::optional(numbers.front());
}

Result<Capture> capture_of(const DynamicHead& head, std::string_view bytes, const std::string& file_name,
                           const ImportOptions& options, std::vector<std::string>& notes) {
  Findings findings(file_name);
  Capture capture;
  const auto count = number_of(head, "Sample no");
  if (!count || *count < 1.0 || *count > 1e12 || *count != std::floor(*count))
    findings.add(0, 0, "Sample no: expected a whole number above 0");
  const auto actual = number_of(head, "Actual sample rate");
  const auto rate = actual && *actual > 0.0 ? actual : number_of(head, "Sample rate");
  if (!rate || *rate <= 0.0) findings.add(0, 0, "Actual sample rate: expected a number of Hz above 0");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  const std::size_t held = (bytes.size() - head.data_at) / kSampleBytes;
  capture.count = static_cast<std::size_t>(*count);
  capture.rate_Hz = *rate;
  if (held < capture.count) {
    if (!options.accept_truncated || held == 0)
      return problem_at(file_name, 0, 0,
                        "Data: expected {} samples (Sample no), found {}: the file is truncated; "
                        "--accept-truncated reads the complete part",
                        capture.count, held);
    notes.push_back(fmt::format("truncated: {} of {} samples", held, capture.count));
    capture.count = held;
  }
  const std::string type = lower(value_of(head.entries, "File Type").value_or(""));
  capture.angular = type.find("ang") != std::string::npos || type == "rta";
  capture.feed_mm_min = number_of(head, "Velocity");
  return capture;
}

std::optional<Axis> axis_named(const DynamicHead& head) {
  const auto text = value_of(head.entries, "Axis");
  return text && text->size() == 1
             ? axis_of(lower(*text) == *text ? static_cast<char>(text->front() - 'a' + 'A') : text->front())
             : std::nullopt;
}

Result<Sense> sense_of_capture(const Capture& capture, const ImportOptions& options, Axis axis,
                               const std::string& file_name) {
  if (options.sense && is_rotation(*options.sense)) return *options.sense;
  if (!capture.angular) return positioning_sense(options, axis, file_name);
  return tl::unexpected(usage(file_name, "an angular capture: give the sense EA, EB or EC"));
}

/// Text head, then little-endian 64-bit floats in mm or mrad at a fixed rate. Readings are displacements from the
/// origin of the capture at `parked_mm`, with `time_s`.
Result<MeasurementSet> read_dynamic(std::string_view bytes, const std::string& file_name,
                                    const ImportOptions& options) {
  const auto head = head_in(bytes);
  if (!head) return problem_at(file_name, 0, 0, "expected a head that ends with a line Data:, found none");
  MeasurementSet set;
  set.source = file_name;
  set.metadata = head->entries;
  ECS_TRY(capture, capture_of(*head, bytes, file_name, options, set.notes));
  ImportOptions known = options;
  if (!known.axis) known.axis = axis_named(*head);
  ECS_TRY(axis, axis_wanted(known, file_name));
  ECS_TRY(sense, sense_of_capture(capture, options, axis, file_name));
  const std::size_t most = std::max<std::size_t>(1, options.most_samples);
  const std::size_t step = (capture.count + most - 1) / most;
  for (std::size_t i = 0; i < capture.count; i += step) {
    const double value = sample_at(bytes, head->data_at + i * kSampleBytes) * kUmPerMm;
    if (!std::isfinite(value))
      return problem_at(file_name, 0, 0, "Data: expected a finite number as sample {}, found none", i + 1);
    Reading reading;
    reading.axis = axis;
    reading.sense = sense;
    reading.position_mm = options.parked_mm;
    reading.error = value;
    reading.time_s = static_cast<double>(i) / capture.rate_Hz;
    set.readings.push_back(std::move(reading));
  }
  if (step > 1) set.notes.push_back(fmt::format("every {}. of {} samples is kept", step, capture.count));
  if (capture.feed_mm_min)
    set.notes.push_back(fmt::format("Velocity {} has no unit in the header: not used as feed", *capture.feed_mm_min));
  set.notes.push_back("readings are displacements from the origin of the capture, not deviations from targets");
  number_rows(set);
  return set;
}

Recognition recognises_dynamic(const FileStart& file) {
  const bool is_capture =
      file.has("header::") && file.has("data:") && !file.has("target data::") && !file.has("deviations::");
  return is_capture ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kRenishawDynamic{
    .id = "renishaw_dynamic",
    .title = "Renishaw dynamic capture (.rtx)",
    .sample = "capture.rtx",
    .recognises = recognises_dynamic,
    .is_binary = true,
    .read = read_dynamic,
    .written_extensions = {".rtx"},
    .write =
        [](const MeasurementSet& set, const std::string& file_name) {
          return to_renishaw_dynamic(set, std::filesystem::path(file_name).filename().string());
        },
};

namespace {

/// "Compensation end 200.000", with a colon, an equals sign or blanks before the number.
std::optional<MetadataEntry> compensation_entry(std::string_view line) {
  const std::string plain = lower(trimmed(line));
  for (const std::string_view name : {"Compensation start", "Compensation end", "Compensation spacing"}) {
    const std::size_t at = plain.find(lower(name));
    if (at == std::string::npos) continue;
    const auto numbers = numbers_of(std::string_view(plain).substr(at + name.size()));
    return MetadataEntry{std::string(name), numbers.empty() ? "" : shortest(numbers.front())};
  }
  return std::nullopt;
}

/// The rows must be those that the head announces.
void check_announced(const MeasurementSet& set, Findings& findings) {
  const auto announced = [&](std::string_view key) {
    const auto text = metadata_value(set, key);
    return text ? number_in(*text) : std::nullopt;
  };
  constexpr double kSamePosition_mm = 1e-3;
  const auto start = announced("Compensation start"), end = announced("Compensation end");
  const double first = target_mm(set.readings.front()), last = target_mm(set.readings.back());
  const bool reversed =
      start && end && std::abs(first - *end) < kSamePosition_mm && std::abs(last - *start) < kSamePosition_mm;
  if (reversed) return;
  if (start && std::abs(first - *start) > kSamePosition_mm)
    findings.add(set.readings.front().line, 1, "expected the first position at {} (Compensation start), found {}",
                 *start, first);
  if (end && std::abs(last - *end) > kSamePosition_mm)
    findings.add(set.readings.back().line, 1,
                 "expected the last position at {} (Compensation end), found {}: the file is truncated; "
                 "--accept-truncated reads the complete part",
                 *end, last);
}

bool is_table_heading(std::string_view line) {
  const std::string plain = lower(line);
  return plain.find("axis position") != std::string::npos && plain.find("combined") != std::string::npos;
}

/// Rows number, position, combined value in mm.
Result<MeasurementSet> read_table(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  ECS_TRY(line, positioning_line(options, file_name));
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  bool in_table = false;
  for (const auto& [number, as_written] : numbered_lines_of(text)) {
    if (is_table_heading(as_written)) {
      in_table = true;
    } else if (in_table && !trimmed(as_written).empty()) {
      if (const auto row = row_of(as_written, 3))
        set.readings.push_back(reading_at(options, line, (*row)[1],
                                          (options.table_holds_errors ? 1.0 : -1.0) * (*row)[2] * kUmPerMm, number));
      else
        findings.add(number, 1,
                     "expected number, position and combined value, found " + in_quotes(trimmed(as_written)));
    } else if (const auto entry = compensation_entry(as_written); !in_table && entry) {
      set.metadata.push_back(*entry);
    } else if (const auto stated = entry_in(as_written); !in_table && stated) {
      set.metadata.push_back(*stated);
    }
  }
  if (findings.empty() && set.readings.empty()) findings.add(0, 0, "expected rows below the heading, found none");
  if (findings.empty() && !options.accept_truncated) check_announced(set, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  set.notes.push_back(options.table_holds_errors ? "combined values read as errors in mm"
                                                 : "combined values read as compensation in mm: error = -value");
  number_rows(set);
  return set;
}

Recognition recognises_table(const FileStart& file) {
  return file.has("axis position") && file.has("combined") ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kRenishawTable{
    .id = "renishaw_table",
    .title = "Renishaw error compensation table (.REN)",
    .sample = "table.REN",
    .recognises = recognises_table,
    .read = read_table,
    .written_extensions = {".ren"},
    .write = [](const MeasurementSet& set, const std::string&) { return to_renishaw_table(set); },
    .writes_means = true,
};

}  // namespace ecs::laser
