// API laser reports: blocks of position and mean error, both directions together or each.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/writers/writers.hpp"

namespace ecs::laser {
namespace {

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
  return std::ranges::any_of(readings, [&](const Reading& r) { return r.approach == approach; });
}

/// Both directions each say more than their mean, which would count the same readings again.
void keep_one_account(MeasurementSet& set) {
  const bool both = has_approach(set.readings, Approach::forward) && has_approach(set.readings, Approach::reverse);
  const bool mean = has_approach(set.readings, Approach::unknown);
  if (!mean) return;
  std::erase_if(set.readings, [&](const Reading& r) { return (r.approach == Approach::unknown) == both; });
  set.notes.push_back(both ? "forward and reverse means are read, their bidirectional mean is ignored"
                           : "bidirectional means: approach unknown");
}

/// Position and mean error in mm.
Result<MeasurementSet> read_report(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  ECS_TRY(line, positioning_line(options, file_name));
  MeasurementSet set;
  set.source = file_name;
  bool in_block = false;
  Approach approach = Approach::unknown;
  for (const auto& [number, as_written] : numbered_lines_of(text)) {
    if (const auto block = block_in(as_written)) {
      const auto named = approach_of_block(*block);
      approach = named.value_or(Approach::unknown);
      in_block = named.has_value() && !has_approach(set.readings, approach);
      if (!in_block) set.notes.push_back(fmt::format("line {}: block {} is not used", number, in_quotes(*block)));
      continue;
    }
    const auto row = row_of(as_written, 2);
    if (!row) {
      if (!trimmed(as_written).empty()) in_block = false;
      continue;
    }
    if (!in_block) continue;
    set.readings.push_back(reading_at(options, line, (*row)[0], (*row)[1] * kUmPerMm, number));
    set.readings.back().approach = approach;
  }
  if (set.readings.empty())
    return problem_at(file_name, 0, 0,
                      "expected rows of position and error below a heading Position ... Avg Error, found none");
  keep_one_account(set);
  number_rows(set);
  return set;
}

Recognition recognises_report(const FileStart& file) {
  return file.has("avg error") && file.has("position") ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kApiReport{
    .id = "api_pos",
    .title = "API laser report (.pos)",
    .sample = "report.pos",
    .recognises = recognises_report,
    .read = read_report,
    .written_extensions = {".pos"},
    .write = [](const MeasurementSet& set, const std::string&) { return to_api_pos(set); },
    .writes_means = true,
};

}  // namespace ecs::laser
