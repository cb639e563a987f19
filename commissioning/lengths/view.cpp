#include "commissioning/lengths/view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/answer_table.hpp"

namespace ecs::commissioning {
namespace {

double greatest_in(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (const auto* list : {&a, &b})
    for (const double value : *list) most = std::max(most, std::abs(value));
  return most;
}

template <class Identified>
std::optional<double> freedom_of(const Identified& one) {
  return one.determined ? std::optional(one.degrees_of_freedom) : std::nullopt;
}

Cell curve_cell(const model::IdentifiedCurve& curve) {
  const std::string unit(unit_of(curve.component));
  Json points{{"position_mm", curve.position_mm},
              {"forward", curve.forward},
              {"reverse", curve.reverse},
              {"U_forward", curve.U_forward},
              {"U_reverse", curve.U_reverse}};
  if (!curve.determined) points = nullptr;
  const auto number = [&](double value) {
    return number_cell(curve.determined ? std::optional(value) : std::nullopt, 2);
  };
  return record_cell("  {component:<4} {description:<38} {unit:<4} {largest:>8} {reversal:>8} {U_largest:>8}\n",
                     {{"component", word_cell(name_of(curve.component))},
                      {"description", word_cell(laser::description_of(curve.component))},
                      {"unit", word_cell(unit)},
                      {"determined", yes_cell(curve.determined, "", "")},
                      {"largest", number(greatest_in(curve.forward, curve.reverse))},
                      {"reversal",
                       [&] {
                         std::vector<double> reversal;
                         for (std::size_t i = 0; i < curve.forward.size(); ++i)
                           reversal.push_back(curve.forward[i] - curve.reverse[i]);
                         return number(greatest_in(reversal, {}));
                       }()},
                      {"U_largest", number(greatest_in(curve.U_forward, curve.U_reverse))},
                      {"degrees_of_freedom", number_cell(freedom_of(curve), 1)},
                      {"points", {std::move(points), {}}}});
}

Cell square_cell(const model::IdentifiedSquareness& square) {
  const auto number = [&](double value) {
    return number_cell(square.determined ? std::optional(value) : std::nullopt, 2);
  };
  return record_cell("  {component:<4} {description:<38} {unit:<4} {um_per_m:>8} {none:>8} {U:>8}\n",
                     {{"component", word_cell(name_of(square.component))},
                      {"description", word_cell(laser::description_of(square.component))},
                      {"unit", word_cell("um/m")},
                      {"determined", yes_cell(square.determined, "", "")},
                      {"um_per_m", number(square.um_per_m)},
                      {"none", shown_cell("")},
                      {"U", number(square.U_um_per_m)},
                      {"degrees_of_freedom", number_cell(freedom_of(square), 1)}});
}

Cell set_up_cell(const model::IdentifiedSetUp& set_up) {
  return record_cell(
      "  set-up {name}: {readings} readings, residuals {rms_um} um, station off by {shown} mm\n",
      {{"name", word_cell(set_up.name)},
       {"readings", count_cell(set_up.readings)},
       {"rms_um", number_cell(set_up.rms_um, 3)},
       {"station_correction_mm", {Json(set_up.station_correction_mm), {}}},
       {"shown", shown_cell(fmt::format("{:.3f}, {:.3f}, {:.3f}", set_up.station_correction_mm[0],
                                        set_up.station_correction_mm[1], set_up.station_correction_mm[2]))}});
}

Cell outlier_cell(const model::LengthOutlier& outlier) {
  return record_cell("  left out: line {line}, residual {residual_um} um, {sigmas} sigma\n",
                     {{"line", integer_cell(outlier.line)},
                      {"residual_um", number_cell(outlier.residual_um, 2)},
                      {"sigmas", number_cell(outlier.sigmas, 1)}});
}

std::vector<std::string> missing_in(const model::Identification& found) {
  std::vector<std::string> out;
  for (const auto& curve : found.curves)
    if (!curve.why_not.empty()) out.push_back(curve.why_not);
  for (const auto& square : found.squareness)
    if (!square.why_not.empty()) out.push_back(square.why_not);
  return out;
}

std::vector<std::string> without_effect(const model::Identification& found) {
  std::vector<std::string> out;
  for (const auto& curve : found.curves)
    if (!curve.acts) out.emplace_back(name_of(curve.component));
  return out;
}

std::string idle_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? text : fmt::format("  {}: only a tool offset levers them, and none was used\n", text);
}

Cell single_cell(const model::SingleSetUps& single, double U_um, double minutes) {
  return record_cell(
      "single set-ups for {wanted} um: {set_ups} of {runs} runs of {targets} targets{not_reached}, {minutes} minutes; "
      "ratio {ratio}\n",
      {{"wanted", shown_cell(number_cell(U_um, 3).text)},
       {"set_ups", integer_cell(single.set_ups)},
       {"runs", integer_cell(single.runs)},
       {"targets", integer_cell(single.targets)},
       {"minutes", number_cell(single.minutes, 1)},
       {"volume_U_um", number_cell(single.volume_U_um, 3)},
       {"reached", yes_cell(single.reached, "", "")},
       {"ratio", number_cell(minutes / single.minutes, 3)},
       {"not_reached", shown_cell(single.reached ? "" : " (not reached)")}});
}

}  // namespace

Cell lengths_cell(const LengthsWork& work, const std::string& map, const std::string& params_out) {
  const model::Identification& found = work.found;
  std::vector<model::IdentifiedCurve> acting;
  for (const auto& curve : found.curves)
    if (curve.acts) acting.push_back(curve);
  const std::string none = found.whole() ? "map not written: give --params and -o map.csv\n"
                                         : "map not written: something is not determined\n";
  return record_cell(
      "{file}: {readings} lengths, {unknowns} unknowns, {degrees_of_freedom} degrees of freedom\n"
      "{components}{squareness}{without_effect}{not_determined}"
      "  single reading {residual_um} um (by itself {white_um}, a stop {stop_um} um and {stop_um_per_m} um/m, a pass "
      "{pass_um} um and {pass_um_per_m} um/m; repeats {repeat_um})\n"
      "  error vector over the volume: U = {volume_U_um} um (root mean square, 95 %)\n"
      "{set_ups}{outliers}{notes}{map}{params_out}",
      {{"file", word_cell(work.test.source)},
       {"machine", word_cell(work.machine_name)},
       {"readings", count_cell(found.readings)},
       {"unknowns", integer_cell(found.unknowns)},
       {"degrees_of_freedom", integer_cell(found.degrees_of_freedom)},
       {"knots_mm", {Json(found.knots_mm), {}}},
       {"determined", yes_cell(found.whole(), "", "")},
       {"components", list_cell(acting, curve_cell,
                                fmt::format("  {:<4} {:<38} {:<4} {:>8} {:>8} {:>8}\n", "", "component", "unit",
                                            "largest", "reversal", "U (95 %)"))},
       {"squareness", list_cell(found.squareness, square_cell)},
       {"without_effect", {Json(without_effect(found)), idle_text(without_effect(found))}},
       {"not_determined", lines_cell(missing_in(found), "  ")},
       {"residual_um", number_cell(found.residual_um, 3)},
       {"white_um", number_cell(found.white_um, 3)},
       {"stop_um", number_cell(found.stop_um, 3)},
       {"stop_um_per_m", number_cell(found.stop_um_per_m, 3)},
       {"pass_um", number_cell(found.pass_um, 3)},
       {"pass_um_per_m", number_cell(found.pass_um_per_m, 3)},
       {"repeat_um", number_cell(found.repeat_um, 3)},
       {"volume_U_um", number_cell(found.volume_U_um, 3)},
       {"set_ups", list_cell(found.set_ups, set_up_cell)},
       {"outliers", list_cell(found.outliers, outlier_cell)},
       {"notes", lines_cell(found.notes, "  note: ")},
       {"map", written_cell("map", map, none)},
       {"params_out", written_cell("parameters", params_out)}});
}

Cell lengths_plan_cell(const model::LengthPlan& plan, double wanted_U_um, const std::string& file) {
  const auto set_up = [&](const model::LengthSetUp& one) {
    return record_cell(
        "  {name}: {instrument} {place}\n",
        {{"name", word_cell(one.name)},
         {"instrument", word_cell(model::word_of(one.instrument))},
         {"place",
          {Json(one.place), fmt::format("{:.6g}, {:.6g}, {:.6g}", one.place[0], one.place[1], one.place[2])}}});
  };
  return record_cell(
      "{reached_text}: U = {volume_U_um} um over the volume and the tools (wanted {wanted_U_um}), {first_tool_U_um} um "
      "with the first tool\n"
      "{minutes} minutes, {set_up_minutes} of them set-ups: {set_ups} set-ups, {paths} paths, {readings} poses\n"
      "{stations}{notes}{single}  with the first tool alone: {single_first_tool}{plan}",
      {{"reached_text", shown_cell(plan.reached ? "reached" : "NOT REACHED with three runs of every path")},
       {"reached", yes_cell(plan.reached, "", "")},
       {"wanted_U_um", number_cell(wanted_U_um, 3)},
       {"volume_U_um", number_cell(plan.volume_U_um, 3)},
       {"first_tool_U_um", number_cell(plan.first_tool_U_um, 3)},
       {"minutes", number_cell(plan.minutes, 1)},
       {"set_up_minutes", number_cell(plan.set_up_minutes, 1)},
       {"set_ups", count_cell(plan.set_ups)},
       {"paths", count_cell(plan.paths)},
       {"readings", count_cell(plan.test.readings.size())},
       {"stations", list_cell(plan.test.set_ups, set_up)},
       {"not_determined", {Json(plan.undetermined), {}}},
       {"notes", lines_cell(plan.notes, "note: ")},
       {"single", single_cell(plan.single, plan.volume_U_um, plan.minutes)},
       {"single_first_tool", single_cell(plan.single_first_tool, plan.first_tool_U_um, plan.minutes)},
       {"plan", written_cell("plan", file, "plan not written: give -o plan.csv\n")}});
}

}  // namespace ecs::commissioning
