// Predicted over the volume, beside what was achieved on the lines that were measured.
#include <fmt/format.h>

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

Markup volume_table(const ReportContent& content, const PredictedVolume& volume) {
  TableMarkup table({{"along"},
                     {"predicted before: largest", true},
                     {"rms", true},
                     {volume.from_map() ? "predicted after, of the map: largest" : "predicted after: largest", true},
                     {"rms", true},
                     {"achieved before: largest band", true},
                     {"achieved after: largest band", true},
                     {"unit"}});
  const auto row = [&](const std::string& name, std::size_t d, const Achieved& before, const Achieved& after) {
    const Markup after_um = cell(volume.after.largest_um[d], kDecimals);
    table.row({element("strong", name), cell(volume.before.largest_um[d], kDecimals),
               cell(volume.before.rms_um[d], kDecimals), volume.from_map() ? after_um : element("strong", after_um),
               cell(volume.after.rms_um[d], kDecimals), named_cell(before), named_cell(after), text("µm")});
  };
  for (const Axis axis : kAllAxes)
    if (volume.present[index_of(axis)])
      row(std::string(1, letter_of(axis)), index_of(axis), achieved_along(content, axis, &TableRow::before),
          achieved_along(content, axis, &TableRow::after));
  row("error vector", kAxes, {}, {});
  return table.markup();
}

}  // namespace

std::string volume_sentence(const PredictedVolume& volume) {
  const auto size = [](double value) { return quantity_text(value, kDecimals, "um"); };
  const std::string before = fmt::format(
      "Predicted from {}: the largest error vector in the volume is {} before "
      "compensation (rms {})",
      volume.from, size(volume.before.largest_um[kAxes]), size(volume.before.rms_um[kAxes]));
  const std::string after =
      fmt::format("{} (rms {})", size(volume.after.largest_um[kAxes]), size(volume.after.rms_um[kAxes]));
  if (volume.from_map())
    return fmt::format(
        "{}. The unit puts out all that the map holds but {}: that is rounding and interpolation. What stays after "
        "compensation is what the map does not hold; an error model or a measurement tells it.",
        before, after);
  return fmt::format("{} and {} after.", before, after);
}

ReportSection volume_section(const ReportContent& content) {
  if (!content.volume) return {"volume", kVolumeTitle, {}, content.no_volume};
  const PredictedVolume& volume = *content.volume;
  Markup body = paragraph_of(volume_sentence(volume), volume.from_map() ? "" : "class=\"lead\"");
  std::string how = fmt::format(
      "{} in {}{}, all axes arriving forward, then all in reverse; counted from the reference point, as a work offset "
      "is. After: what the unit puts out with these parameters and the whole map. Nothing was measured across the "
      "volume: the achieved figures are bands on the measured lines alone.",
      counted(volume.places, "place", "places"), volume.travels,
      volume.travels_of_machine ? "" : " (as far as the map reaches: no machine file was given)");
  if (volume.from_map()) how += " What the map does not hold counts as zero; scatter and drift are not in it.";
  body += paragraph_of(how, "class=\"small intro\"");
  if (!volume.remark.empty()) body += paragraph_of(volume.remark, "class=\"small intro\"");
  return {"volume", kVolumeTitle, body + volume_table(content, volume)};
}

}  // namespace ecs::app
