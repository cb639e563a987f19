// `ecs laser stats`: accuracy and repeatability by ISO 230-2 of every measurement line in the files.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/json.hpp"
#include "commissioning/measurements/json.hpp"
#include "commissioning/measurements/quantities.hpp"
#include "laser/analysis/iso230.hpp"

namespace ecs::app {
namespace {

struct StatsArguments : VerbArguments {
  const std::vector<std::string>& files = texts("FILE", "measurement files", Need::required);
  ImportOptions import{*this};
};

std::string iso230_text(const laser::Iso230& iso, const std::string& file) {
  const laser::Group line{iso.axis, iso.sense, iso.parked_mm, iso.compensated, {}};
  std::string text = fmt::format("{}: {} ({} along {}), parked at {} mm, {} targets, compensated: {}\n", file,
                                 name_of(curve_of(iso.sense, iso.axis)), name_of(iso.sense), letter_of(iso.axis),
                                 parked_text(line), iso.targets.size(), compensated_text(line));
  const auto unit = laser::unit_of(iso.sense);
  for (const LaserQuantity& q : kLaserQuantities) {
    const auto& value = iso.*q.value;
    text +=
        fmt::format("  {:<8} {:>12} {:<5} {}\n", q.symbol, value ? fmt::format("{:.3f}", *value) : "-", unit, q.name);
  }
  text += fmt::format("  {:<8} {:>12.3f} {:<5} largest minus smallest reading\n", "range", iso.range, unit);
  for (const std::string& note : iso.notes) text += fmt::format("  note: {}\n", note);
  return text;
}

Json target_json(const laser::Iso230Target& t) {
  return {{"position_mm", number_or_null(t.position_mm)},
          {"n_forward", t.n_forward},
          {"n_reverse", t.n_reverse},
          {"mean_forward", number_or_null(t.mean_forward)},
          {"mean_reverse", number_or_null(t.mean_reverse)},
          {"mean", number_or_null(t.mean)},
          {"s_forward", number_or_null(t.s_forward)},
          {"s_reverse", number_or_null(t.s_reverse)},
          {"s_undirected", number_or_null(t.s_undirected)},
          {"B", number_or_null(t.B)},
          {"R_forward", number_or_null(t.R_forward)},
          {"R_reverse", number_or_null(t.R_reverse)},
          {"R", number_or_null(t.R)}};
}

Json iso230_json(const laser::Iso230& iso, const std::string& file) {
  Json object{{"file", file}};
  object.update(json_of_line(iso.axis, iso.sense, iso.parked_mm, iso.compensated));
  for (const LaserQuantity& q : kLaserQuantities) object[q.key] = number_or_null(iso.*q.value);
  object["range"] = number_or_null(iso.range);
  object["merge_tolerance_mm"] = number_or_null(iso.merge_tolerance_mm);
  object["targets"] = Json::array();
  for (const laser::Iso230Target& target : iso.targets) object["targets"].push_back(target_json(target));
  object["notes"] = iso.notes;
  return object;
}

Result<Outcome> stats(VerbContext& context, const StatsArguments& arguments) {
  std::string text;
  Json lines = Json::array();
  for (const std::string& file : arguments.files) {
    const auto imported = read_with_notes(context, file, arguments.import);
    if (!imported) return tl::unexpected(imported.error());
    if (imported->set.readings.empty())
      return tl::unexpected(Problem{ProblemKind::bad_input, "expected readings, found none", file, 0, 0, {}});
    const auto all = laser::iso230_of(imported->set);
    if (!all) return tl::unexpected(all.error());
    for (const laser::Iso230& iso : *all) {
      text += (text.empty() ? "" : "\n") + iso230_text(iso, file);
      lines.push_back(iso230_json(iso, file));
    }
  }
  return Outcome{text, one_line(Json{{"lines", std::move(lines)}}), kDone};
}

}  // namespace

extern const VerbDefinition kLaserStats = verb<StatsArguments>(
    "laser stats", "accuracy and repeatability by ISO 230-2, the 3-sigma band, the conditions not met",
    "ecs laser stats x_axis.csv y_axis.rtl --json", stats);

}  // namespace ecs::app
