#include "commissioning/volume/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

std::string_view word_for(volume::RepeatabilityFrom from) {
  switch (from) {
    case volume::RepeatabilityFrom::header:
      return "header of the map";
    case volume::RepeatabilityFrom::option:
      return "option";
    case volume::RepeatabilityFrom::roughness:
      return "roughness of the table";
    case volume::RepeatabilityFrom::nothing:
      break;
  }
  return "nothing";
}

Json vector_json(const Vector3& v) { return {number_or_null(v[0]), number_or_null(v[1]), number_or_null(v[2])}; }

Cell vector_cell(const Vector3& v) { return {vector_json(v), fmt::format("{:.1f} {:.1f} {:.1f}", v[0], v[1], v[2])}; }

/// Angles of the rotary axes by letter; null where there is none.
Json angles_json(const std::optional<volume::RotaryAxes>& rotary, const kinematics::Angles& angles_deg) {
  if (!rotary) return nullptr;
  Json angles = Json::object();
  for (std::size_t r = 0; r < kAxes; ++r)
    if (rotary->travel_deg[r]) angles[std::string(1, "ABC"[r])] = number_or_null(angles_deg[r]);
  return angles;
}

/// "X 100  Y 0  Z -50"; with rotary axes, whose letters stand in the heading, "100 0 -50 90".
std::string place_text(const volume::ErrorSize& size, const VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  std::vector<std::string> words;
  for (const Axis axis : kAllAxes)
    if (work.answer.grid.exists[index_of(axis)])
      words.push_back(
          fmt::format("{}{:.0f}", rotary ? "" : fmt::format("{} ", letter_of(axis)), size.at_mm[index_of(axis)]));
  for (std::size_t r = 0; rotary && r < kAxes; ++r)
    if (rotary->travel_deg[r]) words.push_back(fmt::format("{:.0f}", work.answer.settings[size.setting][r]));
  return fmt::format("{}", fmt::join(words, rotary ? " " : "  "));
}

std::string place_heading(const VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  if (!rotary) return "largest at, mm";
  std::string heading = "largest at";
  for (const Axis axis : kAllAxes)
    if (work.answer.grid.exists[index_of(axis)]) heading += fmt::format(" {}", letter_of(axis));
  for (std::size_t r = 0; r < kAxes; ++r)
    if (rotary->travel_deg[r]) heading += fmt::format(" {}", "ABC"[r]);
  return heading + ", mm, deg";
}

Cell size_cell(std::string_view name, const volume::ErrorSize& size, const VolumeWork& work) {
  Json along = Json::object();
  for (const Axis axis : kAllAxes)
    if (const std::size_t a = index_of(axis); work.answer.grid.exists[a])
      along[std::string(1, letter_of(axis))] =
          object_of("largest_um"_is(size.largest_along_um[a]), "rms_um"_is(size.rms_along_um[a]));
  const auto& settings = work.answer.settings;
  const bool is_nothing = size.largest_um < 0.05, forward = size.approach == Approach::forward;  // shown as 0.0
  return record_cell(
      "{name:<16} {largest_um:>8.1f} {p95_um:>8.1f} {rms_um:>8.1f}{place}\n", "name"_shown(name),
      "place"_shown(is_nothing ? ""
                               : fmt::format("   {}, {}", place_text(size, work), forward ? "forward" : "reverse")),
      "largest_um"_is(size.largest_um),
      "at_deg"_is(settings.empty() ? Json(nullptr) : angles_json(work.prepared.machine.rotary, settings[size.setting])),
      "p95_um"_is(size.p95_um), "rms_um"_is(size.rms_um), "at"_is(vector_json(size.at_mm)),
      "approach"_is(static_cast<int>(size.approach)), "error_um"_is(vector_json(size.error_um)),
      "points"_is(size.places), "along"_is(std::move(along)));
}

Cell size_cell(std::string_view name, const volume::VolumeSize& size, const VolumeWork& work) {
  const auto axes = static_cast<std::size_t>(std::ranges::count(work.answer.grid.exists, true));
  Cell all = size_cell(name, size.all, work);
  const Cell edges = size_cell("  edges", size.edges, work), faces = size_cell("  faces", size.faces, work),
             diagonals = size_cell(axes == kAxes ? "  body diagonals" : "  diagonals", size.diagonals, work);
  all.json.update(object_of("edges"_is(edges), "faces"_is(faces), "diagonals"_is(diagonals)));
  if (axes == kAxes) all.text += faces.text;
  if (axes > 1) all.text += edges.text + diagonals.text;  // of a rectangle; a single axis has neither
  return all;
}

/// True errors that the uncertainty of the map does not cover.
bool exceeds_bound(const VolumeWork& work) {
  return work.prepared.errors_from == "the errors file" &&
         (work.answer.after.all.largest_um > work.uncertainty.largest_95_um ||
          work.answer.after.all.rms_um > work.uncertainty.rms_95_um);
}

/// Below the sizes of what is left: what may be there, by the uncertainty of the map.
std::string bound_row(const VolumeWork& work) {
  return fmt::format("{:<16} {:>8.1f} {:>8} {:>8.1f}   with 95 % confidence{}\n", "remaining, bound",
                     work.uncertainty.largest_95_um, "-", work.uncertainty.rms_95_um,
                     exceeds_bound(work)       ? ", exceeded"
                     : work.unmeasured.empty() ? ""
                                               : ", see below");
}

Json budget_json(const VolumeWork& work) {
  Json list = Json::array();
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    const auto share = std::find_if(work.shares.begin(), work.shares.end(), [&](const ComponentShare& one) {
      return one.rotary.empty() && one.component == component;
    });
    if (share == work.shares.end()) continue;
    Json one = object_of("component"_is(name_of(component)), "unit"_is(unit_of(component)), "share"_is(share->share));
    if (is_squareness(component)) {
      one["value"] = number_or_null(work.budget.squareness_um_per_m[c]);
    } else {
      const volume::CurveUncertainty& u = work.budget.curves[c];
      one.update(object_of("repeatability_from"_is(word_for(u.from)), "value"_is(u.value), "pass"_is(u.pass),
                           "between"_is(u.between), "per_m"_is(u.per_m), "unmeasured"_is(u.unmeasured)));
    }
    list.push_back(std::move(one));
  }
  for (const ComponentShare& one : work.shares) {
    if (one.rotary.empty()) continue;
    const bool is_angle = one.rotary[one.rotary[0] == 'E' ? 1 : 0] < 'X';
    list.push_back(object_of("component"_is(one.rotary), "unit"_is(is_angle ? "um/m" : "um"), "share"_is(one.share)));
  }
  return list;
}

Json uncertainty_json(const VolumeWork& work) {
  const volume::VolumeUncertainty& u = work.uncertainty;
  const volume::UncertaintySettings& s = work.settings;
  return object_of("largest_50_um"_is(u.largest_50_um), "rms_50_um"_is(u.rms_50_um),
                   "linear_rms_um"_is(u.linear_rms_um), "monte_carlo_rms_um"_is(u.drawn_rms_um), "draws"_is(s.draws),
                   "seed"_is(s.seed), "instrument_um_per_m"_is(s.instrument_um_per_m),
                   "temperature_degC"_is(s.temperature_degC), "expansion_um_per_m_degC"_is(s.expansion_um_per_m_degC),
                   "declared_zero"_is(s.declared_zero), "squareness_um_per_m"_is(s.squareness_um_per_m),
                   "components"_is(budget_json(work)));
}

/// "" within the bound.
std::string exceeded_text(const VolumeWork& work) {
  if (!exceeds_bound(work)) return {};
  return paragraph(fmt::format(
      "THE BOUND IS EXCEEDED: the true error is {0:.1f} um at the worst position and {1:.1f} um rms. Compare "
      "the components that are declared zero or missing with the errors file: the bound assumes a standard "
      "uncertainty of {2:g} um or {2:g} um/m for each. Change it with --zero-uncertainty.",
      work.answer.after.all.largest_um, work.answer.after.all.rms_um, work.settings.declared_zero));
}

std::string bound_text(const VolumeWork& work) {
  const volume::VolumeUncertainty& u = work.uncertainty;
  std::vector<std::string> shares;
  for (const ComponentShare& one : work.shares)
    if (shares.size() < 3)
      shares.push_back(
          fmt::format("{} {:.0f} %", one.rotary.empty() ? name_of(one.component) : one.rotary, 100.0 * one.share));
  const std::string missing =
      work.unmeasured.empty()
          ? ""
          : fmt::format(
                "NO BOUND ON THE WHOLE ERROR: {} {} neither in the map nor declared zero, and can have any size. "
                "The following bound is valid only if {} within the uncertainty assumed. ",
                fmt::join(work.unmeasured, ", "), work.unmeasured.size() == 1 ? "is" : "are",
                work.unmeasured.size() == 1 ? "it is zero" : "they are zero");
  return paragraph(fmt::format(
             "{}With 95 % confidence the remaining error is at most {:.1f} um anywhere and {:.1f} um rms, with 50 % "
             "confidence {:.1f} and {:.1f} um. These figures include the errors that the map is known to leave, the "
             "uncertainty of the map{}, and the uncertainty assumed for components that were not measured. Not "
             "included are other errors, such as periodic errors with a short period and the effects of heat and load. "
             "{} to "
             "this uncertainty: {}.",
             missing, u.largest_95_um, u.rms_95_um, u.largest_50_um, u.rms_50_um,
             work.prepared.machine.rotary ? " and of the rotary axes" : "",
             shares.size() == 1 ? "Largest contribution" : "Largest contributions", fmt::join(shares, ", "))) +
         exceeded_text(work);
}

Cell side_of_place_cell(const PlaceAnswer& at, std::size_t side) {
  AnswerFields fields =
      described("approach"_is(static_cast<int>(volume::kSides[side]), side == 1 ? "forward" : "reverse"),
                "before_um"_is(vector_cell(at.before_um[side])), "after_um"_is(vector_cell(at.after_um[side])));
  if (at.orientation_um_per_m)
    fields.push_back("orientation_um_per_m"_is(vector_cell((*at.orientation_um_per_m)[side])));
  return record_cell(at.orientation_um_per_m
                         ? "  {approach}  X, Y, Z before {before_um}  after {after_um} um\n           tool turned by "
                           "{orientation_um_per_m} um/m about X, Y, Z\n"
                         : "  {approach}  X, Y, Z before {before_um}  after {after_um} um\n",
                     fields);
}

Cell at_cell(const std::optional<PlaceAnswer>& at, const std::optional<volume::RotaryAxes>& rotary) {
  if (!at) return null_cell();
  std::string heading =
      fmt::format("at {:g}, {:g}, {:g} mm", at->position_mm[0], at->position_mm[1], at->position_mm[2]);
  for (std::size_t r = 0; rotary && r < kAxes; ++r)
    if (rotary->travel_deg[r]) heading += fmt::format(", {} {:g} deg", "ABC"[r], at -> angles_deg[r]);
  const Vector3& u = at->standard_uncertainty_um;
  return record_cell(
      "{sides}  expanded uncertainty of the compensation (k = 2): {expanded_uncertainty_um} um\n",
      "position_mm"_is(vector_json(at->position_mm)),
      "sides"_is(list_cell(
          std::array{1U, 0U}, [&](std::size_t side) { return side_of_place_cell(*at, side); }, heading + ":\n")),
      "expanded_uncertainty_um"_is(vector_cell({2.0 * u[0], 2.0 * u[1], 2.0 * u[2]})),
      "position_deg"_is(rotary ? Cell{angles_json(rotary, at->angles_deg), {}} : shown_cell()));
}

Json slice_json(const VolumeSlice& slice, const volume::VolumeError& error) {
  Json rows = Json::array();
  volume::GridIndex index{};
  for (index[slice.up] = 0; index[slice.up] < slice.grid.mm[slice.up].size(); ++index[slice.up]) {
    Json row = Json::array();
    for (index[slice.across] = 0; index[slice.across] < slice.grid.mm[slice.across].size(); ++index[slice.across])
      row.push_back(vector_json(mean_error(slice.grid, error, index)));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Sizes of the errors as numbers, the greatest coordinate on top; before, and after in brackets.
std::string slice_text(const VolumeSlice& slice) {
  const auto letter = [](std::size_t a) { return letter_of(static_cast<Axis>(a)); };
  const auto size = [&](const volume::VolumeError& error, const volume::GridIndex& index) {
    const Vector3 e = mean_error(slice.grid, error, index);
    return std::hypot(e[0], e[1], e[2]);
  };
  std::string at;
  for (std::size_t a = 0; a < kAxes; ++a)
    if (slice.grid.exists[a] && a != slice.across && a != slice.up)
      at = fmt::format(" at {} {:g} mm", letter(a), slice.grid.mm[a].front());
  std::string text = fmt::format("slice {}{}{}: um before (after), mean of both approaches\n", letter(slice.across),
                                 letter(slice.up), at);
  volume::GridIndex index{};
  for (std::size_t row = slice.grid.mm[slice.up].size(); row-- > 0;) {
    index[slice.up] = row;
    text += fmt::format("{:>7.0f}", slice.grid.mm[slice.up][row]);
    for (index[slice.across] = 0; index[slice.across] < slice.grid.mm[slice.across].size(); ++index[slice.across])
      text += fmt::format(
          " {:>7}", fmt::format("{:.0f}({:.0f})", size(slice.errors.before, index), size(slice.errors.after, index)));
    text += "\n";
  }
  text += fmt::format("{} mm {}  ", letter(slice.up), letter(slice.across));
  for (const double mm : slice.grid.mm[slice.across]) text += fmt::format("{:>7.0f} ", mm);
  text.back() = '\n';
  return text;
}

Cell slice_cell(const std::optional<VolumeSlice>& slice) {
  if (!slice) return null_cell();
  const auto letter = [](std::size_t a) { return std::string(1, letter_of(static_cast<Axis>(a))); };
  Json through = Json::object();
  for (std::size_t a = 0; a < kAxes; ++a)
    if (slice->grid.exists[a] && a != slice->across && a != slice->up)
      through[letter(a)] = number_or_null(slice->grid.mm[a].front());
  return {object_of("across"_is(letter(slice->across)), "up"_is(letter(slice->up)), "at_mm"_is(std::move(through)),
                    "across_mm"_is(slice->grid.mm[slice->across]), "up_mm"_is(slice->grid.mm[slice->up]),
                    "before_um"_is(slice_json(*slice, slice->errors.before)),
                    "after_um"_is(slice_json(*slice, slice->errors.after))),
          slice_text(*slice)};
}

Cell between_cell(const VolumeWork& work) {
  if (!work.between) return null_cell();
  const auto json = [](const volume::ErrorSize& size) {
    return object_of("largest_um"_is(size.largest_um), "at"_is(vector_json(size.at_mm)),
                     "approach"_is(static_cast<int>(size.approach)));
  };
  const volume::ErrorSize &before = work.between->before, &after = work.between->after;
  return {{{"before", json(before)}, {"after", json(after)}},
          paragraph(
              fmt::format("Between the positions, on lines along each axis through the position of the largest error: "
                          "{:.1f} um before ({}), {:.1f} um after ({}).",
                          before.largest_um, place_text(before, work), after.largest_um, place_text(after, work)))};
}

Json travel_json(const volume::Travels& travel_mm) {
  Json travels = Json::object();
  for (const Axis axis : kAllAxes)
    if (const auto& travel = travel_mm[index_of(axis)])
      travels[std::string(1, letter_of(axis))] = {number_or_null((*travel)[0]), number_or_null((*travel)[1])};
  return travels;
}

/// Chain, settings and what the unit compensates; null: no rotary axes.
Json rotary_json(const VolumeWork& work) {
  const auto& rotary = work.prepared.machine.rotary;
  if (!rotary) return nullptr;
  Json travels = Json::object();
  for (std::size_t r = 0; r < kAxes; ++r)
    if (const auto& travel = rotary->travel_deg[r])
      travels[std::string(1, "ABC"[r])] = {number_or_null((*travel)[0]), number_or_null((*travel)[1])};
  Json compensated = Json::array();
  for (const Axis axis : kAllAxes)
    if (work.answer.grid.exists[index_of(axis)]) compensated.push_back(std::string(1, letter_of(axis)));
  return object_of("chain"_is(kinematics::iso_notation(rotary->machine.chain)), "travel_deg"_is(std::move(travels)),
                   "settings"_is(work.answer.settings.size()),
                   "shown_at_deg"_is(angles_json(rotary, rotary->angles_deg)),
                   "compensated"_is(std::move(compensated)));
}

std::string heading_of(const VolumeWork& work) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  const std::string rotary = rotary_in_words(work);
  const std::size_t settings = std::max<std::size_t>(1, work.answer.settings.size());
  return paragraph(fmt::format("{} ({}): {}{}, {} positions in both approaches",
                               work.machine_name.empty() ? "machine" : work.machine_name,
                               configuration_of(machine.parameters), travels_in_words(machine.travel_mm),
                               work.prepared.travels_of_machine ? "" : " (as far as the map reaches)",
                               settings * work.answer.grid.places())) +
         (rotary.empty() ? "" : paragraph(rotary)) +
         fmt::format("errors from {}; P95: at 95 % of the positions the error is no larger\n",
                     work.prepared.errors_from) +
         fmt::format("{:<16} {:>8} {:>8} {:>8}   {}\n", "error vector, um", "largest", "P95", "rms",
                     place_heading(work));
}

}  // namespace

Cell volume_cell(const VolumeWork& work, const std::string& picture, const std::string& values) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  const std::size_t settings = std::max<std::size_t>(1, work.answer.settings.size());
  return record_cell(
      "{heading}{before}{after}{at_most}{between}{bound}{slice}{at}{notes}{picture}{values}",
      "points"_is(settings * work.answer.grid.places()), "heading"_shown(heading_of(work)),
      "before"_is(size_cell("uncompensated", work.answer.before, work)),
      "after"_is(size_cell(work.prepared.errors_from == "the errors file" ? "remaining" : "remaining, known",
                           work.answer.after, work)),
      "at_most"_shown(bound_row(work)), "between"_is(between_cell(work)),
      "uncertainty_95_um"_is(
          object_of("largest"_is(work.uncertainty.largest_95_um), "rms"_is(work.uncertainty.rms_95_um))),
      "bound"_shown(bound_text(work)), "errors_from"_is(text_cell(work.prepared.errors_from)),
      "travel_mm"_is(travel_json(machine.travel_mm)), "reference_mm"_is(vector_json(work.answer.grid.reference_mm)),
      "tool_offset_mm"_is(vector_json(machine.tool_offset_mm)), "uncertainty"_is(uncertainty_json(work)),
      "slice"_is(slice_cell(work.slice)), "at"_is(at_cell(work.at, machine.rotary)), "rotary"_is(rotary_json(work)),
      "notes"_is(paragraphs_cell(work.notes, "note: ")), "picture"_is(written_cell("picture", picture)),
      "values"_is(written_cell("values", values)));
}

std::string values_csv(const VolumeWork& work) {
  const volume::CompensatedMachine& machine = work.prepared.machine;
  std::string text = "axis,sense,approach,p_mm,value_um,u_um\n";
  for (const laser::MapTable& table : machine.map.tables) {
    const auto u = uncertainties_of(table, machine, work.budget);
    for (std::size_t i = 0; i < u.size(); ++i)
      text += fmt::format("{},{},{},{},{},{:.4f}\n", letter_of(moving_axis(table.component)),
                          name_of(sense_of(table.component)), static_cast<int>(table.approach), table.position_mm[i],
                          table.compensation[i], u[i]);
  }
  return text;
}

}  // namespace ecs::commissioning
