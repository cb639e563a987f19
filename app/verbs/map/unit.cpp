// `ecs map receive` and `ecs map verify`: the map in the unit as a file, and against a file.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/map/map_source.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "commissioning/maps/sent.hpp"
#include "commissioning/maps/view.hpp"
#include "commissioning/unit/parameters_view.hpp"
#include "laser/map/csv.hpp"

namespace ecs::app {
namespace {

constexpr std::size_t kMostShown = 20;

struct ReceiveArguments : VerbArguments {
  const std::string& output = output_file("-o,--output", "file to write; without it the CSV goes to stdout");
  const Access access = uses_link();
};

Result<Outcome> receive(VerbContext& context, const ReceiveArguments& arguments) {
  ECS_TRY(found, found_map(context, {}, true));
  if (found.map.tables.empty() && found.map.header.declared_zero.empty())
    return problem(ProblemKind::refused, "the unit holds parameters but no map: send one with `ecs map send`");
  const bool to_stdout = arguments.output.empty();
  const std::string csv = laser::to_map_csv(found.map);
  if (!to_stdout) ECS_DO(write_file(arguments.output, csv));
  return outcome_of(record_cell(to_stdout ? "{csv}" : "map of the unit written to {map}: {count} tables",
                                {{"map", text_cell(arguments.output)},
                                 {"header", header_cell(found.map.header)},
                                 {"tables", tables_cell(found.map.tables, to_stdout)},
                                 {"count", shown_cell(fmt::format("{}", found.map.tables.size()))},
                                 {"csv", shown_cell(csv)}}));
}

struct VerifyArguments : VerbArguments {
  const std::string& file = text("FILE", "map CSV", Need::required);
  const std::string& params = text("--params", "parameter file to compare as well");
  const Access access = uses_link();
};

Cell difference_cell(const MapDifference& d) {
  return record_cell("{message}\n", {{"component", d.component ? word_cell(name_of(*d.component)) : null_cell()},
                                     {"approach", d.component ? word_cell(word_for(d.approach)) : null_cell()},
                                     {"position_mm", {number_or_null(d.position_mm), {}}},
                                     {"expected", {number_or_null(d.expected), {}}},
                                     {"found", {number_or_null(d.found), {}}},
                                     {"message", word_cell(d.message)}});
}

/// All in JSON, the first in the text.
Cell places_cell(const std::vector<MapDifference>& differences) {
  Cell list{Json::array(), {}};
  for (const MapDifference& difference : differences) {
    Cell one = difference_cell(difference);
    if (list.json.size() >= kMostShown) one.text.clear();
    list.add(one);
  }
  if (differences.size() > kMostShown) list.text += fmt::format("… and {} more\n", differences.size() - kMostShown);
  return list;
}

Cell largest_cell(const std::optional<LargestDifference>& largest) {
  if (!largest) return null_cell();
  return record_cell(
      "largest difference from the curves of the file: {difference} {unit} ({component} {approach} at {position_mm} "
      "mm)\n",
      {{"component", word_cell(name_of(largest->component))},
       {"approach", word_cell(word_for(largest->approach))},
       {"position_mm", {number_or_null(largest->position_mm), fmt::format("{:.6g}", largest->position_mm)}},
       {"expected", {number_or_null(largest->expected), {}}},
       {"found", {number_or_null(largest->found), {}}},
       {"difference", shown_cell(fmt::format("{:.3f}", largest->difference()))},
       {"unit", shown_cell(std::string(unit_of(largest->component)))}});
}

Result<Outcome> verify(VerbContext& context, const VerifyArguments& arguments) {
  ECS_DO(laser::read_map_csv(arguments.file));
  ECS_TRY(found, found_map(context, {}, true));
  ECS_TRY(verdict, verdict_on(found, arguments.file, arguments.params));
  const std::size_t count = verdict.differences.size() + verdict.parameters.size();
  return outcome_of(
      record_cell("{differences}{parameters}{largest_difference}{same}",
                  {{"map", word_cell(arguments.file)},
                   {"same", yes_cell(verdict.same(), fmt::format("the unit holds {}", arguments.file),
                                     fmt::format("the unit does not hold {}: {} differences", arguments.file, count))},
                   {"differences", places_cell(verdict.differences)},
                   {"parameters", differences_cell(verdict.parameters, "expected", "found", "file", "unit")},
                   {"largest_difference", largest_cell(verdict.largest)}}),
      verdict.same() ? kDone : kDoesNotHold);
}

}  // namespace

extern const VerbDefinition kMapReceive =
    verb<ReceiveArguments>("map receive", "the map in the unit as a map CSV",
                           "ecs map receive -o from-unit.csv --link tcp:192.168.0.7:502", receive);

extern const VerbDefinition kMapVerify =
    verb<VerifyArguments>("map verify", "whether the unit holds this map, to the resolution of its memory",
                          "ecs map verify map.csv --params mill.toml", verify);

}  // namespace ecs::app
