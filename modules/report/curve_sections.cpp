// Curves and figures: each component before and after, circular tests, the volume.

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/measurements/fields.hpp"
#include "laser/map/recipe.hpp"
#include "modules/report/page.hpp"
#include "modules/standards/circle_work.hpp"

namespace ecs::app {
namespace {

struct Quantity {
  const char* symbol;
  std::optional<double> laser::Iso230::*value;
};
constexpr Quantity kQuantities[] = {{"A", &laser::Iso230::A},
                                    {"A↑", &laser::Iso230::A_forward},
                                    {"A↓", &laser::Iso230::A_reverse},
                                    {"E", &laser::Iso230::E},
                                    {"E↑", &laser::Iso230::E_forward},
                                    {"E↓", &laser::Iso230::E_reverse},
                                    {"M", &laser::Iso230::M},
                                    {"R", &laser::Iso230::R},
                                    {"R↑", &laser::Iso230::R_forward},
                                    {"R↓", &laser::Iso230::R_reverse},
                                    {"B", &laser::Iso230::B},
                                    {"B\u0304", &laser::Iso230::B_mean},
                                    {"±3s", &laser::Iso230::three_sigma_band},
                                    {"6s", &laser::Iso230::non_repeatability}};

std::vector<Markup> iso_cells(const MeasuredPhase& phase, std::string_view name, int decimals) {
  std::vector<Markup> cells{text(name), element("strong", cell(phase.readings.band, decimals))};
  for (const Quantity& q : kQuantities) cells.push_back(cell(phase.iso.*(q.value), decimals));
  return cells;
}

std::optional<double> ratio_of(const std::optional<double>& before, const std::optional<double>& after) {
  if (!before || !after || *after <= 0.0) return std::nullopt;
  return *before / *after;
}

std::vector<Markup> ratio_cells(const TableRow& row) {
  std::vector<Markup> cells{text("ratio"), cell(row.ratio(), 1)};
  for (const Quantity& q : kQuantities)
    cells.push_back(std::string_view(q.symbol) == "B\u0304"
                        ? text("")
                        : cell(ratio_of(row.before->iso.*(q.value), row.after->iso.*(q.value)), 1));
  return cells;
}

Markup iso_table(const TableRow& row) {
  std::vector<TableColumn> columns{{std::string(unit_text(laser::unit_of(row.planned.sense)))}, {"band", true}};
  for (const Quantity& q : kQuantities) columns.push_back({q.symbol, true});
  TableMarkup table(columns, "iso");
  const int decimals = decimals_of(row);
  if (row.before) table.row(iso_cells(*row.before, "before", decimals));
  if (row.after) table.row(iso_cells(*row.after, "after", decimals));
  if (row.before && row.after) table.row(ratio_cells(row));
  return table.markup();
}

std::string slope_of(const MeasuredPhase& phase) { return number_text(phase.readings.level.removed.slope_per_m, 1); }

/// "slope removed (least squares): before −22.4, after 0.3 µm/m"
std::string slope_text(const TableRow& row) {
  const auto method = row.planned.slope;
  if (method == laser::SlopeMethod::none) return "no slope removed";
  const std::string values = row.before && row.after
                                 ? fmt::format("before {}, after {}", slope_of(*row.before), slope_of(*row.after))
                                 : slope_of(row.before ? *row.before : *row.after);
  return fmt::format("slope removed ({2}): {0} {1}", values, is_rotation(row.planned.sense) ? "µm/m per m" : "µm/m",
                     method == laser::SlopeMethod::end_points ? "end points" : "least squares");
}

std::string how_measured(const TableRow& row, const params::PositionUnit& shown_in) {
  const MeasuredPhase& phase = row.before ? *row.before : *row.after;
  const auto lines = lines_in(phase.readings.before);
  std::vector<std::string> parts;
  if (!lines.empty()) {
    const LineSummary& line = lines.front();
    laser::Group group = line.group;
    for (double& parked_mm : group.parked_mm) parked_mm /= shown_in.mm;
    if (const std::string parked = parked_text(group); !parked.empty())
      parts.push_back(fmt::format("{} moves, {} {}", letter_of(row.planned.axis), worded(parked), shown_in.length));
    parts.push_back(fmt::format("{}, {}{}", counted(line.targets, "target", "targets"),
                                counted(line.runs, "run", "runs"), line.forward && line.reverse ? " both ways" : ""));
  }
  if (const auto instrument = laser::metadata_value(phase.readings.before, "instrument")) parts.push_back(*instrument);
  parts.push_back(slope_text(row));
  return fmt::format("{}", fmt::join(parts, " · "));
}

/// What the map did with this component, by the lines of its header.
std::vector<std::string> processing_of(const ReportContent& content, const TableRow& row) {
  std::vector<std::string> lines;
  if (!content.map) return lines;
  const std::string code(name_of(curve_of(row.planned.sense, row.planned.axis)));
  const std::string& name = row.planned.name;
  const std::string& wanted = component_of(name) ? name : code;
  if (wanted != name) return lines;
  for (const std::string& line : content.map->map.header.processing)
    if (line.starts_with(wanted + " ")) lines.push_back(worded(line.substr(wanted.size() + 1)));
  return lines;
}

Markup unmeasured(const ReportContent& content, const TableRow& row) {
  Markup out;
  for (const Problem& problem : row.problems)
    out += paragraph_of(without_commands(to_text(problem)), "class=\"problem\"");
  if (row.problems.empty() && !row.after)
    out += absence(content.has_after && content.planned ? "Measured before compensation only, as planned."
                                                        : "Measured before compensation only.");
  if (row.problems.empty() && !row.before) out += absence("Measured after compensation only.");
  return out;
}

Markup component(const ReportContent& content, const TableRow& row, const std::string& id) {
  const RowVerdict verdict = verdict_of(row);
  Markup body =
      element("h3", element("span", row.planned.name, "class=\"code\"") + text(" " + row.planned.title) +
                        element("span", word_for(verdict),
                                verdict == RowVerdict::above || verdict == RowVerdict::missing ? "class=\"badge open\""
                                                                                               : "class=\"badge\""));
  if (row.before || row.after) {
    body += paragraph_of(how_measured(row, position_unit_of(content)), "class=\"how\"");
    body += unmeasured(content, row);
    body += figure_of_row(row, position_unit_of(content)) + iso_table(row);
    if (const auto steps = processing_of(content, row); !steps.empty())
      body += paragraph_of(fmt::format("For the map: {}.", fmt::join(steps, "; ")), "class=\"how\"");
  } else {
    body += unmeasured(content, row);
  }
  return element("article", body, fmt::format("id=\"{}\"", id)) + Markup::literal("\n");
}

/// Conditions of the standard that are not met: each once, with the measurements.
Markup notes_of(const std::vector<TableRow>& rows) {
  std::vector<std::pair<std::string, std::vector<std::string>>> notes;
  for (const TableRow& row : rows)
    for (const auto* phase : {&row.before, &row.after}) {
      if (!*phase || !is_positioning(row)) continue;
      for (const std::string& note : (*phase)->iso.notes) {
        auto at = std::find_if(notes.begin(), notes.end(), [&](const auto& n) { return n.first == note; });
        if (at == notes.end()) at = notes.insert(notes.end(), {note, {}});
        if (std::find(at->second.begin(), at->second.end(), row.planned.name) == at->second.end())
          at->second.push_back(row.planned.name);
      }
    }
  if (notes.empty()) return {};
  std::vector<std::string> items;
  for (const auto& [note, names] : notes) items.push_back(fmt::format("{}: {}", note, fmt::join(names, ", ")));
  return element("article",
                 element("h3", "Where the conditions of ISO 230-2 are not met") + list_of(without_commands(items)));
}

}  // namespace

ReportSection components_section(const ReportContent& content, const std::vector<std::string>& ids) {
  Markup body = paragraph_of(
      "Grey bars: from the smallest to the largest reading at each target. Before and after have the same scale. "
      "Symbols of ISO 230-2: A accuracy, E systematic error, M range of the mean, R repeatability, B reversal "
      "error and its mean; ↑ forward, ↓ reverse. ±3s: band of mean ± 3 standard deviations, 6s: largest 6 standard "
      "deviations (BS 4656 Part 16).",
      "class=\"small intro\"");
  for (std::size_t i = 0; i < content.rows.size(); ++i) body += component(content, content.rows[i], ids[i]);
  body += notes_of(content.rows);
  return {"components", "Components before and after", std::move(body)};
}

namespace {

constexpr int kCircleDecimals = 1;  ///< um
constexpr const char* kCirclesTitle = "Circular tests (ISO 230-4)";

Markup centre_cell(const std::array<double, 2>& centre_um) {
  return text(
      fmt::format("{}, {}", number_text(centre_um[0], kCircleDecimals), number_text(centre_um[1], kCircleDecimals)));
}

Markup values_table(const CircleWork& circle) {
  TableMarkup table(columns("path|>run|>G|>F max|>F min|>H|>D|>centre|unit"));
  for (const laser::CirclePass& pass : circle.values.passes)
    table.row({text(pass.clockwise ? "clockwise" : "counter-clockwise"), text(fmt::format("{}", pass.run)),
               cell(pass.G_um, kCircleDecimals), cell(pass.F_max_um, kCircleDecimals),
               cell(pass.F_min_um, kCircleDecimals), cell(std::nullopt, 0), cell(std::nullopt, 0),
               centre_cell(pass.centre_um), text("µm")});
  for (const laser::CirclePair& pair : circle.values.pairs)
    table.row({text("both"), text(fmt::format("{}", pair.clockwise_run)), cell(pair.G_um, kCircleDecimals),
               cell(std::nullopt, 0), cell(std::nullopt, 0), cell(pair.H_um, kCircleDecimals),
               cell(pair.D_um, kCircleDecimals), centre_cell(pair.centre_um), text("µm")});
  return table.markup();
}

/// Of spikes how long they are, with twice its standard uncertainty as in the column beside.
std::string decay_text(const model::CircleFaultFound& fault) {
  if (!fault.nonlinear_sigma_mm) return {};
  return fmt::format(", decay {:.3g} ± {:.2g} mm", fault.nonlinear_mm, 2.0 * *fault.nonlinear_sigma_mm);
}

Markup causes_table(const model::CircleDiagnosis& diagnosis) {
  TableMarkup table(columns("cause|>share|>size|>±|unit|cannot be distinguished from"));
  for (const model::CircleFaultFound& fault : diagnosis.faults)
    table.row({element("strong", fault.title) + text(decay_text(fault)),
               text(fmt::format("{:.0f} %", 100.0 * fault.share)), text(number_text(fault.value, kCircleDecimals)),
               text(number_text(2.0 * fault.sigma, kCircleDecimals)), text(unit_text(fault.unit)),
               text(first_few(fault.indistinguishable_from))});
  return table.markup();
}

Markup circle_markup(const CircleWork& circle) {
  const model::CircleDiagnosis& diagnosis = circle.diagnosis;
  std::string head = fmt::format("{}, plane {}, radius {} mm", circle.file.filename().string(),
                                 laser::plane_name(circle.test.plane), plain_number(circle.test.radius_mm));
  if (circle.test.feed_mm_min) head += fmt::format(", {} mm/min", plain_number(*circle.test.feed_mm_min));
  Markup body = element("h3", head) + Markup::literal("\n");
  body += element("figure", inline_svg(polar_figure(circle.test, circle.values))) + values_table(circle);
  if (diagnosis.faults.empty()) return body + paragraph_of("No fault of a circle exceeds the noise.");
  return body + causes_table(diagnosis) +
         paragraph_of(fmt::format("Deviations of {} rms about the centre, residual {}; noise of a reading {}. ± is "
                                  "twice the standard uncertainty.",
                                  quantity_text(diagnosis.rms_um, 2, "um"), quantity_text(diagnosis.left_um, 2, "um"),
                                  quantity_text(diagnosis.noise_um, 2, "um")),
                      "class=\"small\"") +
         list_of(without_commands(diagnosis.notes));
}

}  // namespace

ReportSection circles_section(const ReportContent& content) {
  Markup body;
  for (const CircleWork& circle : content.circles) body += circle_markup(circle);
  return {"circles", kCirclesTitle, body, "no circular test was given"};
}

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
  TableMarkup table(
      columns(fmt::format("along|>predicted before: largest|>rms|>predicted after, of {}: largest|>rms|>after, at most "
                          "(95 %)|>achieved before: largest band|>achieved after: largest band|unit",
                          volume.prepared.errors_from)));
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
      "Predicted from {}: the largest error vector in the volume is {} before compensation (rms {})",
      volume.prepared.errors_from, size(volume.answer.before.all.largest_um), size(volume.answer.before.all.rms_um));
  const std::string after =
      fmt::format("{} (rms {})", size(volume.answer.after.all.largest_um), size(volume.answer.after.all.rms_um));
  std::vector<std::string_view> unmeasured;
  for (const Component component : volume.declared_zero) unmeasured.push_back(name_of(component));
  return fmt::format(
      "{0}. After compensation, {2} of these errors remains{3}. With a probability of 95 %, at most {4} remains "
      "anywhere; this figure includes the known remaining errors and the uncertainty of the map. Errors that {1} does "
      "not contain add to this.{5}",
      before, volume.prepared.errors_from, after,
      volume.from_map() ? "; it comes from the interpolation between the points of the tables" : "",
      size(volume.uncertainty.largest_95_um),
      unmeasured.empty() ? ""
                         : fmt::format(" For the components declared zero ({0} of {1}: {2}), a standard uncertainty of "
                                       "{3:g} µm ({3:g} µm/m for angles) is assumed.",
                                       unmeasured.size(), volume.components, fmt::join(unmeasured, ", "),
                                       volume::UncertaintySettings{}.declared_zero));
}

ReportSection volume_section(const ReportContent& content) {
  if (!content.volume) return {"volume", kVolumeTitle, {}, content.no_volume};
  const ReportedVolume& volume = *content.volume;
  Markup body = paragraph_of(volume_sentence(volume));
  std::string how = fmt::format(
      "{} in {}{}, each with all axes arriving forward, then all in reverse; relative to the reference point, as with "
      "a work offset. After: with the output of the unit for these parameters and the whole map. The volume itself was "
      "not measured: the achieved figures are bands on the measured lines alone.",
      counted(volume.answer.grid.places(), "place", "places"), travels_in_words(volume.prepared.machine.travel_mm),
      volume.prepared.travels_of_machine ? "" : " (as far as the map reaches: no machine file was given)");
  how += fmt::format(
      " Errors that are not in {} are taken as zero before compensation; scatter and drift are not included.",
      volume.prepared.errors_from);
  if (content.machine && !content.machine->rotary_configuration.empty())
    how += fmt::format(
        " The machine has rotary axes ({}): these figures apply with their angles at 0 and without their errors.",
        content.machine->rotary_configuration);
  body += paragraph_of(how, "class=\"small intro\"");
  if (!volume.prepared.remark.empty())
    body += paragraph_of(without_commands(volume.prepared.remark), "class=\"small intro\"");
  return {"volume", kVolumeTitle, body + volume_table(content, volume)};
}

}  // namespace ecs::app
