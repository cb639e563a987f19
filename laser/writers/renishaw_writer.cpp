#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

constexpr double kNoSensor_degC = -10.0;

/// Readings by pass and target.
struct Passes {
  std::vector<double> targets_mm;                        ///< in the direction of odd passes
  std::map<std::pair<int, std::size_t>, double> errors;  ///< (pass from 1, target index) → error
  int count = 0;                                         ///< passes, filled ones included
  bool one_way = false;
};

std::string one_parameter_fault(const MeasurementSet& set) {
  if (set.readings.empty()) return "expected readings, found none";
  const Reading& first = set.readings.front();
  for (const Reading& reading : set.readings) {
    Vector3 here = reading.position_mm;
    Vector3 there = first.position_mm;
    here[index_of(reading.axis)] = there[index_of(reading.axis)] = 0.0;
    if (reading.axis != first.axis || reading.sense != first.sense || here != there)
      return "expected one axis, one sense and one parked position, found several";
    if (reading.approach == Approach::unknown) return "expected an approach with every reading, found one without";
    if (reading.run < 1) return fmt::format("expected runs numbered from 1, found {}", reading.run);
  }
  return {};
}

Result<Passes> passes_of(const MeasurementSet& set) {
  if (const std::string fault = one_parameter_fault(set); !fault.empty()) return problem(ProblemKind::refused, fault);
  std::set<double> targets;
  std::set<Approach> approaches;
  int runs = 0;
  for (const Reading& reading : set.readings) {
    targets.insert(target_mm(reading));
    approaches.insert(reading.approach);
    runs = std::max(runs, reading.run);
  }
  Passes passes;
  passes.one_way = approaches.size() == 1;
  const Approach odd = passes.one_way ? *approaches.begin() : Approach::forward;
  passes.targets_mm.assign(targets.begin(), targets.end());
  if (odd == Approach::reverse) std::ranges::reverse(passes.targets_mm);
  passes.count = 2 * runs;
  for (const Reading& reading : set.readings) {
    const auto place = std::ranges::find(passes.targets_mm, target_mm(reading));
    const auto target = static_cast<std::size_t>(place - passes.targets_mm.begin());
    const int pass = 2 * reading.run - (reading.approach == odd ? 1 : 0);
    if (!passes.errors.emplace(std::pair{pass, target}, reading.error).second)
      return problem(ProblemKind::refused, "expected each target once in run {}, found {} mm again", reading.run,
                     target_mm(reading));
  }
  const std::size_t expected = passes.targets_mm.size() * static_cast<std::size_t>(passes.one_way ? runs : 2 * runs);
  if (passes.errors.size() != expected)
    return problem(ProblemKind::refused, "expected complete runs ({} readings), found {}", expected,
                   passes.errors.size());
  return passes;
}

std::string user_text(const MeasurementSet& set) {
  std::string text = "USER-TEXT::\r\n";
  for (const std::string_view key : {"Machine", "Serial No", "Date", "By", "Axis", "Location", "TITLE"}) {
    const std::string value =
        key == "Axis" ? std::string(1, letter_of(set.readings.front().axis)) : metadata_value(set, key).value_or("");
    text += fmt::format("{}: {}\r\n", key, value);
  }
  return text + "\r\n";
}

std::string target_data(const Passes& passes) {
  std::string text =
      fmt::format("TARGET DATA::\r\nFiletype  : ISO\r\nTarget-count: {}\r\nTargets :\r\n", passes.targets_mm.size());
  for (std::size_t i = 0; i < passes.targets_mm.size(); ++i)
    text +=
        fmt::format("{:.6f}{}", passes.targets_mm[i], i % 5 == 4 || i + 1 == passes.targets_mm.size() ? "\r\n" : "  ");
  return text + (passes.one_way ? "Flags: 0 1 2 0\r\n\r\n" : "Flags: 0 0 2 0\r\n\r\n");
}

std::string deviations(const Passes& passes, double factor) {
  std::string text = fmt::format("RUNS::\r\nRun-count: {}\r\n\r\nDEVIATIONS::\r\nRun Target Data: \r\n", passes.count);
  const std::size_t last = passes.targets_mm.size() - 1;
  for (int pass = 1; pass <= passes.count; ++pass) {
    for (std::size_t i = 0; i <= last; ++i) {
      const std::size_t target = pass % 2 == 1 ? i : last - i;
      const auto found = passes.errors.find({pass, target});
      const double value = found == passes.errors.end() ? 0.0 : found->second * factor;
      text += fmt::format("{:3} {:3} {:14.6f}\r\n", pass, target + 1, value);
    }
  }
  return text + "\r\n";
}

using Value = std::optional<double>;

Value sensor(const Reading& reading, std::string_view name) {
  const auto found = reading.sensors_degC.find(name);
  return found == reading.sensors_degC.end() ? Value{} : Value{found->second};
}

std::string environment(const MeasurementSet& set) {
  const Reading& start = set.readings.front();
  const Reading& end = set.readings.back();
  std::string text = "ENVIRONMENT::\r\n";
  const auto line = [&](std::string_view key, Value at_start, Value at_end, std::string_view after) {
    if (at_start || at_end)
      text += fmt::format("{} : {:.6f} {:.6f}{}\r\n", key, at_start.value_or(at_end.value_or(0.0)),
                          at_end.value_or(at_start.value_or(0.0)), after);
  };
  const auto kilo = [](Value hPa) { return hPa ? Value{*hPa / kHPaPerKPa} : hPa; };
  line("Air temp  ", sensor(start, "t_air_degC"), sensor(end, "t_air_degC"), " 0");
  line("Air press ", kilo(start.pressure_hPa), kilo(end.pressure_hPa), " 1");
  line("Air humid ", start.humidity_pct, end.humidity_pct, "");
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kMaterial{
      {{"Mat temp 1", "t_material_degC"}, {"Mat temp 2", "t_material2_degC"}, {"Mat temp 3", "t_material3_degC"}}};
  for (const auto& [key, name] : kMaterial)
    line(key, sensor(start, name).value_or(kNoSensor_degC), sensor(end, name).value_or(kNoSensor_degC), " 0");
  return text + "\r\n";
}

}  // namespace

std::string renishaw_extension(const MeasurementSet& set) {
  const Reading& first = set.readings.front();
  if (is_rotation(first.sense)) return ".rta";
  return first.sense == static_cast<Sense>(index_of(first.axis)) ? ".rtl" : ".rts";
}

Result<std::string> to_renishaw_run(const MeasurementSet& set) {
  ECS_TRY(passes, passes_of(set));
  const std::string extension = renishaw_extension(set);
  const double factor = extension == ".rta" ? 1.0 / kUmPerMPerMrad : 1.0;
  return fmt::format("HEADER::\r\nFile type  : {}\r\nOwner      : ECS\r\nVersion no : 20.02.02\r\n\r\n",
                     extension.substr(1)) +
         target_data(passes) + user_text(set) + deviations(passes, factor) + environment(set) + "EOF::\r\n";
}

namespace {

constexpr int kSampleBytes = 8;

/// Why the readings are no capture; empty if they are.
std::string fault_of(const MeasurementSet& set) {
  if (set.readings.size() < 2) return "expected at least two samples";
  const Reading& first = set.readings.front();
  if (!is_rotation(first.sense) && first.sense != static_cast<Sense>(index_of(first.axis)))
    return "expected a displacement along the axis or a rotation";
  if (!first.time_s || !set.readings[1].time_s) return "expected the time of each reading (time_s), found none";
  const double step_s = *set.readings[1].time_s - *first.time_s;
  if (!(step_s > 0.0)) return "expected increasing times";
  for (std::size_t i = 0; i < set.readings.size(); ++i) {
    const Reading& reading = set.readings[i];
    if (reading.axis != first.axis || reading.sense != first.sense) return "expected one axis and one sense";
    const double due_s = *first.time_s + static_cast<double>(i) * step_s;
    if (!reading.time_s || std::abs(*reading.time_s - due_s) > 0.01 * step_s)
      return fmt::format("expected a constant rate, sample {} is not at its expected time", i + 1);
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
  if (const std::string fault = fault_of(set); !fault.empty())
    return problem(ProblemKind::refused,
                   "a capture (.rtx) consists of samples at a constant rate: {}. Write another format, such as .csv",
                   fault);
  std::string bytes = head(set, file_name);
  for (const Reading& reading : set.readings) append_sample(bytes, reading.error / kUmPerMm);
  return bytes + "\r\nEOF::\r\n";
}

}  // namespace ecs::laser
