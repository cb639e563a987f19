#include "laser/writers/renishaw_dynamic_writer.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"

namespace ecs::laser {
namespace {

constexpr int kSampleBytes = 8;

/// Why the readings are no capture; empty if they are.
std::string fault_of(const MeasurementSet& set) {
  if (set.readings.size() < 2) return "expected at least two samples";
  const Reading& first = set.readings.front();
  if (!is_rotation(first.sense) && first.sense != static_cast<Sense>(index_of(first.axis)))
    return "expected a displacement along the axis or a rotation";
  if (!first.time_s || !set.readings[1].time_s) return "expected a time with every sample";
  const double step_s = *set.readings[1].time_s - *first.time_s;
  if (!(step_s > 0.0)) return "expected times that go on";
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    const Reading& reading = set.readings[i];
    if (reading.axis != first.axis || reading.sense != first.sense) return "expected one axis and one sense";
    const double due_s = *first.time_s + static_cast<double>(i) * step_s;
    if (!reading.time_s || std::abs(*reading.time_s - due_s) > 0.01 * step_s)
      return fmt::format("expected a constant rate, sample {} is not where it should be", i + 1);
  }
  return {};
}

/// Samples a second: over the whole capture, so that rounded times do not count; to a millionth.
double rate_Hz(const MeasurementSet& set) {
  const double whole_s = *set.readings.back().time_s - *set.readings.front().time_s;
  return std::round(static_cast<double>(set.readings.size() - 1) / whole_s * 1e6) / 1e6;
}

std::string head(const MeasurementSet& set, const std::string& file_name) {
  const Reading& first = set.readings.front();
  const auto text = [&](std::string_view key) { return metadata_value(set, key).value_or(""); };
  const std::string rate = shortest(rate_Hz(set));
  std::string lines = "HEADER::\r\n";
  const auto add = [&](std::string_view key, std::string_view value) {
    lines += fmt::format("{}: {}\r\n", key, value);
  };
  add("File name", file_name);
  add("Owner", "ECS");
  add("Version no", "20.02.02");
  add("File Type", is_rotation(first.sense) ? "Angular" : "Linear");
  add("Velocity", text("Velocity"));
  add("Sample rate", rate);
  add("Sample no", std::to_string(set.readings.size()));
  add("Trigger point", "0");
  add("Trigger interval", "0");
  add("Actual sample rate", rate);
  add("Flags", "0 0 0 0 0");
  for (const std::string_view key : {"Machine", "Serial No", "Date", "By"}) add(key, text(key));
  add("Axis", std::string(1, letter_of(first.axis)));
  add("Location", text("Location"));
  return lines + "Data:\r\n";
}

void append_sample(std::string& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int k = 0; k < kSampleBytes; ++k) bytes.push_back(static_cast<char>((bits >> (8 * k)) & 0xFFu));
}

}  // namespace

Result<std::string> to_renishaw_dynamic(const MeasurementSet& set, const std::string& file_name) {
  if (const std::string fault = fault_of(set); !fault.empty()) return problem(ProblemKind::refused, fault);
  std::string bytes = head(set, file_name);
  for (const Reading& reading : set.readings) append_sample(bytes, reading.error / kUmPerMm);
  return bytes + "\r\nEOF::\r\n";
}

}  // namespace ecs::laser
