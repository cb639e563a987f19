// `ecs laser show`: conditions, measurement lines, and the means at every target.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/measurements/fields.hpp"

namespace ecs::app {
namespace {

struct ShowArguments : VerbArguments {
  const std::string& file = text("FILE", "measurement file", Need::required);
  RotaryImportOptions import{*this};
};

std::optional<double> reversal(const laser::TargetReadings& target) {
  const auto forward = laser::mean_of(target.forward), reverse = laser::mean_of(target.reverse);
  if (!forward || !reverse) return std::nullopt;
  return *forward - *reverse;
}

Cell mean_cell(const std::vector<double>& readings) { return number_cell(laser::mean_of(readings), 3); }
/// All of them in JSON, how many in the text.
Cell readings_cell(const std::vector<double>& readings) { return {readings, fmt::format("{}", readings.size())}; }

Cell target_cell(const laser::TargetReadings& t, bool rotary) {
  const char* const position = rotary ? "position_deg" : "position_mm";
  return record_cell(fmt::format("{{{}:>12}} ", position) +
                         "{mean_forward:>12} {forward:>4} {mean_reverse:>12} {reverse:>4} {mean_undirected:>12} "
                         "{undirected:>4} {reversal:>12}\n",
                     {{position, number_cell(t.position_mm, 4)},
                      {"mean_forward", mean_cell(t.forward)},
                      {"forward", readings_cell(t.forward)},
                      {"mean_reverse", mean_cell(t.reverse)},
                      {"reverse", readings_cell(t.reverse)},
                      {"mean_undirected", mean_cell(t.undirected)},
                      {"undirected", readings_cell(t.undirected)},
                      {"reversal", shown_cell(number_cell(reversal(t), 3).text)}});
}

Cell targets_cell(const std::vector<laser::TargetReadings>& targets, bool rotary) {
  return list_cell(
      targets, [&](const laser::TargetReadings& t) { return target_cell(t, rotary); },
      fmt::format("{:>12} {:>12} {:>4} {:>12} {:>4} {:>12} {:>4} {:>12}\n",
                  fmt::format("target [{}]", laser::target_unit(rotary)), "forward", "n", "reverse", "n", "unknown",
                  "n", "reversal"));
}

Result<Outcome> show(VerbContext&, const ShowArguments& arguments) {
  ECS_TRY(imported, read_measurements(arguments.file, arguments.import));
  const laser::MeasurementSet& set = imported.set;
  AnswerFields fields{{"file", word_cell(arguments.file)}, {"format", word_cell(imported.format->title)}};
  append(fields, set_fields(set));
  const Cell conditions = set.readings.empty() ? conditions_cell(conditions_in(imported.environment), "rows")
                                               : conditions_cell(conditions_in(set), "readings");
  fields.push_back({"conditions", conditions.json.empty() ? shown_cell({}) : conditions});
  Cell answer = record_cell("{file}: {format}, {readings} readings\n{metadata}{notes}{conditions}\n{lines}", fields);
  const auto groups = laser::groups_of(set);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Cell targets =
        targets_cell(laser::targets_of(set, groups[i], laser::target_tolerance_mm(set, groups[i])), groups[i].rotary);
    answer.text += laid_out("\n{component} ({sense} along {axis}), parked at {parked_mm} mm, in {unit}\n",
                            measured_line_fields(groups[i])) +
                   targets.text;
    answer.json["lines"][i]["by_target"] = targets.json;
  }
  return outcome_of(answer);
}

}  // namespace

extern const VerbDefinition kLaserShow =
    verb<ShowArguments>("laser show", "conditions, lines, sensors and the means at every target of a measurement file",
                        "ecs laser show x_axis.csv", show);

}  // namespace ecs::app
