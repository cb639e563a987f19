// Small text tables of instruments: Renishaw error compensation table, API report, SIOS environment log.
// Does not live here: run files (renishaw_reader.cpp), assignments (assignment_reader.cpp).
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/renishaw_file.hpp"

namespace ecs::laser {
namespace {

struct Target {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
};

Result<Target> target_of(const ImportOptions& options, const std::string& file_name) {
  const auto axis = axis_wanted(options, file_name);
  if (!axis) return tl::unexpected(axis.error());
  const auto sense = positioning_sense(options, *axis, file_name);
  if (!sense) return tl::unexpected(sense.error());
  return Target{*axis, *sense};
}

Reading reading_at(const ImportOptions& options, const Target& target, double position_mm, double error_um, int line) {
  Reading reading;
  reading.line = line;
  reading.axis = target.axis;
  reading.sense = target.sense;
  reading.position_mm = position_at(options, target.axis, position_mm);
  reading.error = error_um;
  return reading;
}

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
  constexpr double kSame_mm = 1e-3;
  const auto start = announced("Compensation start"), end = announced("Compensation end");
  const double first = target_mm(set.readings.front()), last = target_mm(set.readings.back());
  const bool reversed = start && end && std::abs(first - *end) < kSame_mm && std::abs(last - *start) < kSame_mm;
  if (reversed) return;
  if (start && std::abs(first - *start) > kSame_mm)
    findings.add(set.readings.front().line, 1,
                 fmt::format("expected the first position at {} (Compensation start), found {}", *start, first));
  if (end && std::abs(last - *end) > kSame_mm)
    findings.add(set.readings.back().line, 1,
                 fmt::format("expected the last position at {} (Compensation end), found {}: the file is cut short (it "
                             "can be taken as it is, if so asked)",
                             *end, last));
}

/// The numbers of a row, if it holds `count` of them and nothing else.
std::optional<std::vector<double>> row_of(std::string_view line, std::size_t count) {
  auto numbers = numbers_of(line);
  if (numbers.size() != count || words_of(line).size() != count) return std::nullopt;
  return numbers;
}

bool is_table_heading(std::string_view line) {
  const std::string plain = lower(line);
  return plain.find("axis position") != std::string::npos && plain.find("combined") != std::string::npos;
}

/// The heading of an API block: which mean it holds ("bidirectional", "forward directional", …); nothing if it is none.
std::optional<std::string> block_in(std::string_view line) {
  const std::string plain = lower(trimmed(line));
  if (!plain.starts_with("position") || plain.find("error") == std::string::npos) return std::nullopt;
  return std::string(trimmed(std::string_view(plain).substr(8)));
}

std::optional<Approach> approach_of_block(const std::string& block) {
  if (block.starts_with("bidirectional")) return Approach::unknown;
  if (block.starts_with("forward")) return Approach::forward;
  if (block.starts_with("reverse") || block.starts_with("backward")) return Approach::reverse;
  return std::nullopt;
}

bool has_approach(const std::vector<Reading>& readings, Approach approach) {
  return std::any_of(readings.begin(), readings.end(), [&](const Reading& r) { return r.approach == approach; });
}

/// Both directions each say more than their mean, which would count the same readings again.
void keep_one_account(MeasurementSet& set) {
  const bool both = has_approach(set.readings, Approach::forward) && has_approach(set.readings, Approach::reverse);
  const bool mean = has_approach(set.readings, Approach::unknown);
  if (!mean) return;
  std::erase_if(set.readings, [&](const Reading& r) { return (r.approach == Approach::unknown) == both; });
  set.notes.push_back(both ? "forward and reverse means are taken, their bidirectional mean is left out"
                           : "bidirectional means: approach unknown");
}

}  // namespace

Result<MeasurementSet> parse_renishaw_table(std::string_view text, const std::string& file_name,
                                            const ImportOptions& options) {
  const auto target = target_of(options, file_name);
  if (!target) return tl::unexpected(target.error());
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  bool in_table = false;
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    const std::size_t colon = lines[i].find(':');
    if (is_table_heading(lines[i])) {
      in_table = true;
    } else if (in_table && !trimmed(lines[i]).empty()) {
      const auto row = row_of(lines[i], 3);
      if (row)
        set.readings.push_back(reading_at(options, *target, (*row)[1],
                                          (options.table_holds_errors ? 1.0 : -1.0) * (*row)[2] * kUmPerMm, number));
      else
        findings.add(number, 1, "expected number, position and combined value, found " + in_quotes(trimmed(lines[i])));
    } else if (const auto entry = compensation_entry(lines[i]); !in_table && entry) {
      set.metadata.push_back(*entry);
    } else if (!in_table && colon != std::string_view::npos) {
      set.metadata.push_back(
          {std::string(trimmed(lines[i].substr(0, colon))), std::string(trimmed(lines[i].substr(colon + 1)))});
    }
  }
  if (findings.empty() && set.readings.empty()) findings.add(0, 0, "expected rows below the heading, found none");
  if (findings.empty() && !options.accept_truncated) check_announced(set, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  set.notes.push_back(options.table_holds_errors ? "combined values taken as errors in mm"
                                                 : "combined values taken as compensation in mm: error = -value");
  number_rows(set);
  return set;
}

Result<MeasurementSet> parse_api_pos(std::string_view text, const std::string& file_name,
                                     const ImportOptions& options) {
  const auto target = target_of(options, file_name);
  if (!target) return tl::unexpected(target.error());
  MeasurementSet set;
  set.source = file_name;
  bool in_block = false;
  Approach approach = Approach::unknown;
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (const auto block = block_in(lines[i])) {
      const auto named = approach_of_block(*block);
      approach = named.value_or(Approach::unknown);
      in_block = named.has_value() && !has_approach(set.readings, approach);
      if (!in_block) set.notes.push_back(fmt::format("line {}: block {} is not used", i + 1, in_quotes(*block)));
      continue;
    }
    const auto row = row_of(lines[i], 2);
    if (!row) {
      if (!trimmed(lines[i]).empty()) in_block = false;
      continue;
    }
    if (!in_block) continue;
    set.readings.push_back(reading_at(options, *target, (*row)[0], (*row)[1] * kUmPerMm, static_cast<int>(i) + 1));
    set.readings.back().approach = approach;
  }
  if (set.readings.empty())
    return problem_at(file_name, 0, 0,
                      "expected rows of position and error below a heading Position ... Avg Error, found none");
  keep_one_account(set);
  number_rows(set);
  return set;
}

Result<std::vector<EnvironmentRecord>> parse_sios_environment(std::string_view text, const std::string& file_name) {
  std::vector<EnvironmentRecord> records;
  Findings findings(file_name);
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const auto row = row_of(lines[i], 9);
    if (!row) {
      findings.add(
          static_cast<int>(i) + 1, 1,
          "expected nine numbers (X, Y, Z, three air temperatures, pressure, humidity, sample temperature), found " +
              in_quotes(trimmed(lines[i])));
      continue;
    }
    const auto& n = *row;
    records.push_back(
        {{n[0] * kMmPerM, n[1] * kMmPerM, n[2] * kMmPerM}, {n[3], n[4], n[5]}, n[6] / kPaPerHPa, n[7], n[8]});
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (records.empty()) return problem_at(file_name, 0, 0, "expected environment records, found none");
  return records;
}

}  // namespace ecs::laser
