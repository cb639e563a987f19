// Predicted over the volume, beside what was achieved on the lines that were measured.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/sections.hpp"

namespace ecs::app {
namespace {

constexpr int kDecimals = 1;  ///< um
constexpr const char* kVolumeTitle = "Volumetric error, predicted";

/// The largest band measured in that direction, and where.
struct Achieved {
  std::optional<double> band;
  std::string line;
};
Achieved achieved_along(const ReportContent& content, Axis direction, std::optional<MeasuredPhase> TableRow::*phase) {
  Achieved out;
  for (const TableRow& row : content.rows) {
    if (row.planned.sense != static_cast<Sense>(direction) || !(row.*phase)) continue;
    const double band = (row.*phase)->readings.band;
    if (out.band && *out.band >= band) continue;
    out = {band, row.planned.name};
  }
  return out;
}

Markup named_cell(const Achieved& achieved) {
  if (!achieved.band) return text("\u2013");
  return text(fmt::format("{} ({})", number_text(*achieved.band, decimals_for(*achieved.band)), achieved.line));
}

Markup volume_table(const ReportContent& content, const ReportedVolume& volume) {
  TableMarkup table({{"along"},
                     {"predicted before: largest", true},
                     {"rms", true},
                     {fmt::format("predicted after, of {}: largest", volume.prepared.errors_from), true},
                     {"rms", true},
                     {"after, at most (95 %)", true},
                     {"achieved before: largest band", true},
                     {"achieved after: largest band", true},
                     {"unit"}});
  struct Sizes {
    double largest_um, rms_um;
  };
  const auto row = [&](const std::string& name, const Sizes& before, const Sizes& after,
                       const std::optional<double>& at_most_um, const Achieved& achieved_before,
                       const Achieved& achieved_after) {
    table.row({element("strong", name), cell(before.largest_um, kDecimals), cell(before.rms_um, kDecimals),
               cell(after.largest_um, kDecimals), cell(after.rms_um, kDecimals),
               element("strong", cell(at_most_um, kDecimals)), named_cell(achieved_before), named_cell(achieved_after),
               text("µm")});
  };
  const auto along = [](const volume::ErrorSize& size, Axis axis) {
    return Sizes{size.largest_along_um[index_of(axis)], size.rms_along_um[index_of(axis)]};
  };
  const volume::ErrorSize &before = volume.answer.before.all, &after = volume.answer.after.all;
  for (const Axis axis : kAllAxes)
    if (volume.answer.grid.exists[index_of(axis)])
      row(std::string(1, letter_of(axis)), along(before, axis), along(after, axis), std::nullopt,
          achieved_along(content, axis, &TableRow::before), achieved_along(content, axis, &TableRow::after));
  row("error vector", {before.largest_um, before.rms_um}, {after.largest_um, after.rms_um},
      volume.uncertainty.largest_95_um, {}, {});
  return table.markup();
}

}  // namespace

std::string volume_sentence(const ReportedVolume& volume) {
  const auto size = [](double value) { return quantity_text(value, kDecimals, "um"); };
  const std::string before = fmt::format(
      "Predicted from {}: the largest error vector in the volume is {} before "
      "compensation (rms {})",
      volume.prepared.errors_from, size(volume.answer.before.all.largest_um), size(volume.answer.before.all.rms_um));
  const std::string after =
      fmt::format("{} (rms {})", size(volume.answer.after.all.largest_um), size(volume.answer.after.all.rms_um));
  std::vector<std::string_view> unmeasured;
  for (const Component component : volume.declared_zero) unmeasured.push_back(name_of(component));
  return fmt::format(
      "{0}. The unit puts out all that {1} holds but {2}{3}. After compensation this stays, and what {1} does not "
      "hold: "
      "with the uncertainty of the map at most {4} anywhere (95 %).{5}",
      before, volume.prepared.errors_from, after, volume.from_map() ? ": that is interpolation" : "",
      size(volume.uncertainty.largest_95_um),
      unmeasured.empty() ? ""
                         : fmt::format(" This assumes that what was not measured but declared zero ({} of {} "
                                       "components: {}) is zero within a standard uncertainty of {:g} µm or µm/m each.",
                                       unmeasured.size(), volume.components, fmt::join(unmeasured, ", "),
                                       volume::UncertaintySettings{}.declared_zero));
}

ReportSection volume_section(const ReportContent& content) {
  if (!content.volume) return {"volume", kVolumeTitle, {}, content.no_volume};
  const ReportedVolume& volume = *content.volume;
  Markup body = paragraph_of(volume_sentence(volume));
  std::string how = fmt::format(
      "{} in {}{}, each with all axes arriving forward, then all in reverse; counted from the reference point, as a "
      "work offset "
      "is. After: what the unit puts out with these parameters and the whole map. Nothing was measured across the "
      "volume: the achieved figures are bands on the measured lines alone.",
      counted(volume.answer.grid.places(), "place", "places"), travels_in_words(volume.prepared.machine.travel_mm),
      volume.prepared.travels_of_machine ? "" : " (as far as the map reaches: no machine file was given)");
  how += fmt::format(" What {} does not hold counts as zero before compensation; scatter and drift are not in it.",
                     volume.prepared.errors_from);
  if (content.machine && !content.machine->rotary_configuration.empty())
    how += fmt::format(
        " The machine has rotary axes ({}), which the unit does not compensate: these figures hold with their angles "
        "at 0 and without their errors.",
        content.machine->rotary_configuration);
  body += paragraph_of(how, "class=\"small intro\"");
  if (!volume.prepared.remark.empty())
    body += paragraph_of(without_commands(volume.prepared.remark), "class=\"small intro\"");
  return {"volume", kVolumeTitle, body + volume_table(content, volume)};
}

}  // namespace ecs::app
