// ISO 230-2 inputs as shell-style assignments (ecmc FAT/SAT tests).
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/units.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

/// Shell scripts may quote a value and write a comment after it.
std::string_view unquoted(std::string_view value) {
  if (const std::size_t comment = value.find(" #"); comment != std::string_view::npos)
    value = trimmed(value.substr(0, comment));
  if (value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front())
    value = value.substr(1, value.size() - 2);
  return trimmed(value);
}

/// `NAME[i]=value` or `NAME[i,j]=value`.
struct Assignment {
  std::string_view name;
  std::vector<long long> indices;
  std::string_view value;
};

std::optional<Assignment> assignment_in(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  Assignment found{trimmed(line.substr(0, equals)), {}, trimmed(line.substr(equals + 1))};
  const std::size_t open = found.name.find('[');
  if (open == std::string_view::npos) return found;
  if (!found.name.ends_with(']')) return std::nullopt;
  const std::string_view inside = found.name.substr(open + 1, found.name.size() - open - 2);
  found.name = found.name.substr(0, open);
  for (const std::string_view index : split(inside, ',')) {
    const auto number = integer_in(index);
    if (!number || *number < 1 || *number > 1'000'000) return std::nullopt;
    found.indices.push_back(*number);
  }
  return found;
}

struct Stop {
  double position_mm = 0.0;
  int line = 0;
};
using Key = std::pair<long long, long long>;  ///< cycle, target

struct Contents {
  std::map<long long, double> targets_mm;
  std::map<Key, Stop> forward;
  std::map<Key, Stop> reverse;
  std::vector<MetadataEntry> metadata;
};

void take_number(Contents& contents, const Assignment& found, int line, Findings& findings) {
  const auto value = number_or_comma(unquoted(found.value));
  const std::size_t expected = found.name == "TGT_DATA" ? 1 : 2;
  if (!value || found.indices.size() != expected) {
    findings.add(line, 1, "{}: expected {} and a number, found {}", found.name,
                 expected == 1 ? "one index" : "target and cycle index", in_quotes(found.value));
    return;
  }
  const bool fresh = found.name == "TGT_DATA"
                         ? contents.targets_mm.emplace(found.indices[0], *value).second
                         : (found.name == "REF_DATA_FWD" ? contents.forward : contents.reverse)
                               .emplace(Key{found.indices[1], found.indices[0]}, Stop{*value, line})
                               .second;
  if (!fresh) findings.add(line, 1, "{}: expected each index once, found it again", found.name);
}

Contents contents_of(std::string_view text, Findings& findings) {
  Contents contents;
  for (const auto& [number, as_written] : numbered_lines_of(text)) {
    const std::string_view line = trimmed(as_written);
    if (line.empty() || line.starts_with('#')) continue;
    const auto found = assignment_in(line);
    if (!found) {
      findings.add(number, 1, "expected NAME=value or NAME[i,j]=value with indices from 1, found " + in_quotes(line));
    } else if (found->name == "TGT_DATA" || found->name == "REF_DATA_FWD" || found->name == "REF_DATA_BWD") {
      take_number(contents, *found, number, findings);
    } else {
      contents.metadata.push_back({std::string(found->name), std::string(found->value)});
    }
  }
  return contents;
}

std::optional<long long> count_of(const Contents& contents, std::string_view key) {
  for (const MetadataEntry& entry : contents.metadata)
    if (entry.key == key) return integer_in(entry.value);
  return std::nullopt;
}

std::optional<Unit> unit_in(const MetadataEntry& entry) {
  const auto unit = unit_named(unquoted(entry.value));
  return unit && unit->kind == UnitKind::length ? unit : std::nullopt;
}

/// Millimetres of a unit of the file.
double mm_per_unit(const Contents& contents) {
  for (const MetadataEntry& entry : contents.metadata)
    if (entry.key == "UNIT")
      if (const auto unit = unit_in(entry)) return unit->factor;
  return 1.0;
}

void check(const Contents& contents, bool accept_truncated, Findings& findings) {
  for (const MetadataEntry& entry : contents.metadata)
    if (entry.key == "UNIT" && !unit_in(entry))
      findings.add(0, 0, "UNIT: expected a unit of length (mm, um, in), found " + in_quotes(entry.value));
  if (contents.targets_mm.empty()) findings.add(0, 0, "expected targets TGT_DATA[i], found none");
  if (contents.forward.empty() && contents.reverse.empty())
    findings.add(0, 0, "expected positions REF_DATA_FWD[i,j] or REF_DATA_BWD[i,j], found none");
  for (const auto* const stops : {&contents.forward, &contents.reverse}) {
    for (const auto& [key, stop] : *stops)
      if (!contents.targets_mm.contains(key.second))
        findings.add(stop.line, 1, "expected an index with a target TGT_DATA, found {}", key.second);
    const auto targets = count_of(contents, "POSITIONS").value_or(static_cast<long long>(contents.targets_mm.size()));
    const auto cycles = count_of(contents, "CYCLES");
    const bool plausible = targets > 0 && targets <= 1'000'000 && cycles && *cycles > 0 && *cycles <= 1'000'000;
    if (!accept_truncated && plausible && !stops->empty() && static_cast<long long>(stops->size()) != targets * *cycles)
      findings.add(0, 0,
                   "expected {} positions in a direction (POSITIONS times CYCLES), found {}: the file is truncated; "
                   "--accept-truncated reads the complete part",
                   targets * *cycles, stops->size());
  }
}

/// TGT_DATA[i], REF_DATA_FWD[i,j], REF_DATA_BWD[i,j]: absolute positions in mm, or in UNIT.
Result<MeasurementSet> read_assignments(std::string_view text, const std::string& file_name,
                                        const ImportOptions& options) {
  ECS_TRY(line, positioning_line(options, file_name));
  Findings findings(file_name);
  const Contents contents = contents_of(text, findings);
  if (findings.empty()) check(contents, options.accept_truncated, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  const double factor = mm_per_unit(contents);
  MeasurementSet set;
  set.source = file_name;
  set.metadata = contents.metadata;
  for (const auto& [stops, approach] :
       {std::pair{&contents.forward, Approach::forward}, std::pair{&contents.reverse, Approach::reverse}}) {
    for (const auto& [key, stop] : *stops) {
      const double target = contents.targets_mm.at(key.second);
      Reading reading =
          reading_at(options, line, target * factor, (stop.position_mm - target) * factor * kUmPerMm, stop.line);
      reading.approach = approach;
      reading.run = static_cast<int>(key.first);
      set.readings.push_back(std::move(reading));
    }
  }
  set.notes.push_back(
      "FWD is read as forward and BWD as reverse. Some instruments use FWD for the reverse approach. With lost "
      "motion and a motor encoder, `B mean` of `ecs laser stats` (forward minus reverse) is negative. If it is "
      "positive, "
      "exchange the names FWD and BWD in the file and import it again");
  number_rows(set);
  return set;
}

Recognition recognises_assignments(const FileStart& file) {
  const auto has = [&](std::string_view name) { return file.text.find(name) != std::string_view::npos; };
  return has("REF_DATA_FWD[") || has("REF_DATA_BWD[") ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kIso230Assignments{
    .id = "iso230_assignments",
    .title = "ISO 230-2 file with lines `name = value` (.dat)",
    .sample = "axis.dat",
    .recognises = recognises_assignments,
    .read = read_assignments,
    .written_extensions = {".dat"},
    .write = [](const MeasurementSet& set, const std::string&) { return to_iso230_assignments(set); },
    .units = ErrorUnits::positions,
};

}  // namespace ecs::laser
