// `ecs laser show`: conditions, measurement lines, and the means at every target.
#include <memory>

#include <fmt/format.h>

#include "app/verbs/laser/import_arguments.hpp"
#include "app/verbs/laser/menu.hpp"
#include "base/numbers.hpp"
#include "commissioning/measurements/json.hpp"

namespace ecs::app {
namespace {

struct ShowArguments {
  std::string file;
  ImportArguments import;
};

std::optional<double> reversal(const laser::TargetReadings& target) {
  const auto forward = laser::mean_of(target.forward), reverse = laser::mean_of(target.reverse);
  if (!forward || !reverse) return std::nullopt;
  return *forward - *reverse;
}

std::string targets_text(const laser::MeasurementSet& set, const laser::Group& group) {
  std::string text = fmt::format(
      "\n{} ({} along {}), parked at {} mm, in {}\n{:>12} {:>12} {:>4} {:>12} {:>4} {:>12} "
      "{:>4} {:>12}\n",
      name_of(curve_of(group.sense, group.axis)), name_of(group.sense), letter_of(group.axis), parked_text(group),
      laser::unit_of(group.sense), "target [mm]", "forward", "n", "reverse", "n", "unknown", "n", "reversal");
  for (const laser::TargetReadings& t : laser::targets_of(set, group, laser::target_tolerance_mm(set, group)))
    text += fmt::format("{:>12.4f} {:>12} {:>4} {:>12} {:>4} {:>12} {:>4} {:>12}\n", t.position_mm,
                        cell_text(laser::mean_of(t.forward)), t.forward.size(), cell_text(laser::mean_of(t.reverse)),
                        t.reverse.size(), cell_text(laser::mean_of(t.undirected)), t.undirected.size(),
                        cell_text(reversal(t)));
  return text;
}

Json targets_json(const laser::MeasurementSet& set, const laser::Group& group) {
  Json targets = Json::array();
  for (const laser::TargetReadings& t : laser::targets_of(set, group, laser::target_tolerance_mm(set, group)))
    targets.push_back({{"position_mm", number_or_null(t.position_mm)},
                       {"mean_forward", number_or_null(laser::mean_of(t.forward))},
                       {"forward", t.forward},
                       {"mean_reverse", number_or_null(laser::mean_of(t.reverse))},
                       {"reverse", t.reverse},
                       {"mean_undirected", number_or_null(laser::mean_of(t.undirected))},
                       {"undirected", t.undirected}});
  return targets;
}

std::string heading(const laser::MeasurementSet& set, const std::string& file, std::string_view format) {
  std::string text = fmt::format("{}: {}, {} readings\n", file, format, set.readings.size());
  for (const laser::MetadataEntry& entry : set.metadata)
    text += entry.key.empty() ? fmt::format("  {}\n", entry.value) : fmt::format("  {}: {}\n", entry.key, entry.value);
  for (const std::string& note : set.notes) text += fmt::format("  assumed: {}\n", note);
  for (const ConditionSummary& c : conditions_in(set))
    text += fmt::format("  {:<28} {:>10.6g} ... {:<10.6g} in {} readings\n", c.name, c.least, c.most, c.readings);
  return text + "\n";
}

Result<Outcome> show(VerbContext&, const ShowArguments& arguments) {
  const auto imported = read_measurements(arguments.file, arguments.import);
  if (!imported) return tl::unexpected(imported.error());
  const laser::MeasurementSet& set = imported->set;
  Json object{{"file", arguments.file}, {"format", imported->format->title}};
  object.update(json_of(set));
  std::string text = heading(set, arguments.file, imported->format->title);
  text += lines_table(lines_in(set));
  const auto groups = laser::groups_of(set);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    text += targets_text(set, groups[i]);
    object["lines"][i]["by_target"] = targets_json(set, groups[i]);
  }
  for (const ConditionSummary& c : conditions_in(set))
    object["conditions"].push_back({{"name", c.name},
                                    {"readings", c.readings},
                                    {"least", number_or_null(c.least)},
                                    {"most", number_or_null(c.most)}});
  return Outcome{text, one_line(object), kDone};
}

}  // namespace

void add_laser_show(Menu& menu) {
  const auto arguments = std::make_shared<ShowArguments>();
  Verb verb = menu.verb("show", "conditions, lines, sensors and the means at every target of a measurement file",
                        "ecs laser show x_axis.csv");
  verb.text("FILE", arguments->file, "measurement file", Need::required);
  take_import_options(verb, arguments->import);
  verb.runs([arguments](VerbContext& context) { return show(context, *arguments); });
}

}  // namespace ecs::app
