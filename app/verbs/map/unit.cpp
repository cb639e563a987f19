// `ecs map receive` and `ecs map verify`: the map in the unit as a file, and against a file.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/map/map_source.hpp"
#include "base/file.hpp"
#include "base/json.hpp"
#include "commissioning/maps/sent.hpp"
#include "commissioning/maps/view.hpp"
#include "laser/map/csv.hpp"
#include "params/diff.hpp"

namespace ecs::app {
namespace {

constexpr std::size_t kMostShown = 20;

struct ReceiveArguments : VerbArguments {
  const std::string& output = text("-o,--output", "file to write; without it the CSV goes to stdout");
  const Access access = uses_link();
};

Result<Outcome> receive(VerbContext& context, const ReceiveArguments& arguments) {
  const auto found = found_map(context, {}, true);
  if (!found) return tl::unexpected(found.error());
  if (found->map.tables.empty() && found->map.header.declared_zero.empty())
    return problem(ProblemKind::refused, "the unit holds parameters but no map: send one with `ecs map send`");
  const std::string csv = laser::to_map_csv(found->map);
  Json object{
      {"map", text_or_null(arguments.output)}, {"header", header_json(found->map.header)}, {"tables", Json::array()}};
  for (const laser::MapTable& table : found->map.tables)
    object["tables"].push_back(table_json(table, arguments.output.empty()));
  if (arguments.output.empty()) return Outcome{csv, one_line(object), kDone};
  if (const auto written = write_file(arguments.output, csv); !written) return tl::unexpected(written.error());
  return Outcome{fmt::format("map of the unit written to {}: {} tables", arguments.output, found->map.tables.size()),
                 one_line(object), kDone};
}

struct VerifyArguments : VerbArguments {
  const std::string& file = text("FILE", "map CSV", Need::required);
  const std::string& params = text("--params", "parameter file to compare as well");
  const Access access = uses_link();
};

Json difference_json(const MapDifference& d) {
  return {{"component", d.component ? Json(name_of(*d.component)) : Json(nullptr)},
          {"approach", d.component ? Json(word_for(d.approach)) : Json(nullptr)},
          {"position_mm", number_or_null(d.position_mm)},
          {"expected", number_or_null(d.expected)},
          {"found", number_or_null(d.found)},
          {"message", d.message}};
}

std::string differences_text(const std::vector<MapDifference>& differences) {
  std::string text;
  for (std::size_t i = 0; i < std::min(differences.size(), kMostShown); ++i) text += differences[i].message + "\n";
  if (differences.size() > kMostShown) text += fmt::format("… and {} more\n", differences.size() - kMostShown);
  return text;
}

Result<Outcome> verify(VerbContext& context, const VerifyArguments& arguments) {
  if (const auto readable = laser::read_map_csv(arguments.file); !readable) return tl::unexpected(readable.error());
  const auto found = found_map(context, {}, true);
  if (!found) return tl::unexpected(found.error());
  const auto verdict = verdict_on(*found, arguments.file, arguments.params);
  if (!verdict) return tl::unexpected(verdict.error());
  const auto& differences = verdict->differences;
  const auto& of_parameters = verdict->parameters;
  const bool same = verdict->same();
  Json object{{"map", arguments.file}, {"same", same}, {"differences", Json::array()}, {"parameters", Json::array()}};
  for (const MapDifference& d : differences) object["differences"].push_back(difference_json(d));
  for (const params::Difference& d : of_parameters)
    object["parameters"].push_back({{"key", d.key}, {"unit", text_or_null(d.unit)}, {"expected", d.a}, {"found", d.b}});
  std::string text = differences_text(differences) + params::to_text(of_parameters, "file", "unit");
  object["largest_difference"] = nullptr;
  if (const auto& largest = verdict->largest) {
    object["largest_difference"] = {{"component", name_of(largest->component)},
                                    {"approach", word_for(largest->approach)},
                                    {"position_mm", largest->position_mm},
                                    {"expected", largest->expected},
                                    {"found", largest->found}};
    text += fmt::format("largest difference from the curves of the file: {:.3f} {} ({} {} at {:.6g} mm)\n",
                        largest->difference(), unit_of(largest->component), name_of(largest->component),
                        word_for(largest->approach), largest->position_mm);
  }
  text += same ? fmt::format("the unit holds {}", arguments.file)
               : fmt::format("the unit does not hold {}: {} differences", arguments.file,
                             differences.size() + of_parameters.size());
  return Outcome{text, one_line(object), same ? kDone : kDoesNotHold};
}

}  // namespace

extern const VerbDefinition kMapReceive =
    verb<ReceiveArguments>("map receive", "the map in the unit as a map CSV",
                           "ecs map receive -o from-unit.csv --link tcp:192.168.0.7:502", receive);

extern const VerbDefinition kMapVerify =
    verb<VerifyArguments>("map verify", "whether the unit holds this map, to the resolution of its memory",
                          "ecs map verify map.csv --params mill.toml", verify);

}  // namespace ecs::app
