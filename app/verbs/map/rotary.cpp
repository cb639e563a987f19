#include "app/verbs/map/rotary.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "volume/rotary_errors.hpp"

namespace ecs::app {
namespace {

Cell rotary_table_cell(const volume::RotaryTable& table) {
  const auto [least, greatest] = std::minmax_element(table.error.begin(), table.error.end());
  double mean = 0.0;
  for (const double error : table.error) mean += error / static_cast<double>(table.error.size());
  return record_cell(
      "{component:<9} {approach:>8} {unit:<4} {first_deg:>8} {last_deg:>8} {points:>6} {mean:>8} {band:>8}\n",
      {{"component", word_cell(volume::rotary_name(table.joint, table.sense))},
       {"approach", {static_cast<int>(table.approach), fmt::format("{}", static_cast<int>(table.approach))}},
       {"unit", word_cell(laser::unit_of(table.sense))},
       {"first_deg", number_cell(table.p_deg.front(), 1)},
       {"last_deg", number_cell(table.p_deg.back(), 1)},
       {"points", count_cell(table.p_deg.size())},
       {"mean", number_cell(mean, 2)},
       {"band", number_cell(*greatest - *least, 2)}});
}

}  // namespace

bool measures_rotary_axes(const std::vector<std::string>& files, ImportArguments import) {
  if (files.empty() || lower(files.front()).ends_with(".toml")) return false;
  import.takes_rotary = true;
  const auto first = read_measurements(files.front(), import);
  return first && std::any_of(first->set.readings.begin(), first->set.readings.end(),
                              [](const laser::Reading& reading) { return reading.rotary; });
}

Result<Outcome> rotary_errors_built(VerbContext& context, const std::vector<std::string>& files, ImportArguments import,
                                    const std::string& output) {
  import.takes_rotary = true;
  std::vector<laser::MeasurementSet> sets;
  for (const std::string& file : files) {
    ECS_TRY(read, read_with_notes(context, file, import));
    sets.push_back(std::move(read.set));
    sets.back().source = file;
  }
  ECS_TRY(set, joined(sets));
  ECS_TRY(errors, volume::measured_rotary_errors(set));
  if (!output.empty())
    ECS_DO(write_file(output, volume::rotary_csv(errors, metadata_value(set, "machine").value_or(""))));
  return outcome_of(record_cell(
      "{tables}errors, not compensation: the unit compensates X, Y, Z and takes no table of a\nrotary axis; `ecs "
      "volume "
      "--rotary` does\n{rotary}",
      {{"rotary", written_cell("errors of rotary axes", output, "nothing written: give -o rotary.csv to keep it\n")},
       {"tables", list_cell(errors.tables, rotary_table_cell,
                            fmt::format("{:<9} {:>8} {:<4} {:>8} {:>8} {:>6} {:>8} {:>8}\n", "", "approach", "unit",
                                        "from deg", "to deg", "points", "mean", "band"))}}));
}

}  // namespace ecs::app
