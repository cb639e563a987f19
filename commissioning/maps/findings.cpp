#include "commissioning/maps/findings.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/maps/rotary_part.hpp"
#include "laser/map/csv.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {

laser::Travels travels_of(const params::Machine& machine) {
  laser::Travels travels{};
  for (const Axis axis : kAllAxes)
    if (const auto& known = machine.axes[index_of(axis)]) travels[index_of(axis)] = known->travel_mm;
  return travels;
}

laser::Travels travels_beside(const std::string& params_file, const params::ParametersFile& parameters) {
  const auto file = std::filesystem::path(params_file).parent_path() / "machine.toml";
  if (params_file.empty() || !is_there(file)) return {};
  const auto read = params::read_machine(file);
  if (!read) return {};
  const params::Machine& machine = read->machine;
  const std::string& owner = parameters.identity.machine;
  const bool same =
      machine.configuration == configuration_of(parameters.parameters) && (owner.empty() || owner == machine.name);
  return same ? travels_of(machine) : laser::Travels{};
}

Result<laser::Travels> travels_given(const std::string& machine_file, const std::string& params_file,
                                     const params::ParametersFile& parameters) {
  if (machine_file.empty()) return travels_beside(params_file, parameters);
  ECS_TRY(machine, params::read_machine(machine_file));
  return travels_of(machine.machine);
}

bool has_objections(const std::vector<laser::MapFinding>& findings) {
  return std::ranges::any_of(findings, &laser::MapFinding::objection);
}

std::vector<std::string> remarks_in(const std::vector<laser::MapFinding>& findings) {
  std::vector<std::string> remarks;
  for (const laser::MapFinding& finding : findings)
    if (!finding.objection) remarks.push_back(finding.message);
  return remarks;
}

std::string remarks_counted(std::size_t remarks) {
  return fmt::format("{} remark{}", remarks, remarks == 1 ? "" : "s");
}

std::string completeness(const std::vector<laser::MapFinding>& findings) {
  if (has_objections(findings)) return "not complete";
  return findings.empty() ? "complete" : "complete, " + remarks_counted(findings.size());
}

namespace {

/// Of a map with components declared zero: how many have values, how many have not and why; else "".
std::string coverage_text(const laser::ErrorMap& map) {
  const std::vector<laser::DeclaredZero>& zero = map.header.declared_zero;
  if (zero.empty()) return {};
  std::set<Component> with_values;
  for (const laser::MapTable& table : map.tables) with_values.insert(table.component);
  for (const laser::DeclaredZero& one : zero) with_values.erase(one.component);
  std::set<Component> live;
  for (const auto& row : map.header.thermal) live.insert(row.component);
  const auto has_row = [&](const auto& one) { return live.contains(one.component); };
  const bool one_reason = std::ranges::all_of(zero, [&](const auto& one) { return one.reason == zero.front().reason; });
  return fmt::format("{} curve{} with values, {} declared zero{}. The unit does not correct {}{}.", with_values.size(),
                     with_values.size() == 1 ? "" : "s", zero.size(),
                     one_reason ? fmt::format(" ({})", zero.front().reason) : "",
                     zero.size() == 1 ? "the component declared zero" : "the components declared zero",
                     std::ranges::any_of(zero, has_row) ? ", except by the thermal rows of the map" : "");
}

}  // namespace

std::string verdict_text(const laser::ErrorMap& map, const std::vector<laser::MapFinding>& findings,
                         bool of_two_machines, bool enter_squareness) {
  if (of_two_machines)
    return fmt::format("the map is {}{} map and parameters belong to different machines: `ecs map send` refuses it\n",
                       completeness(findings), has_objections(findings) ? ", and" : ", but");
  const std::string coverage = coverage_text(map);
  const std::string sent =
      fmt::format("can be sent{}{}", enter_squareness ? " after the squareness above has been entered" : "",
                  laser::change_by_resampling(map).empty() ? "" : " only with --accept-resampling");
  if (findings.empty() && coverage.empty()) return fmt::format("the map is complete and {}\n", sent);
  if (findings.empty()) return paragraph(fmt::format("the map {}: {}", sent, coverage));
  if (has_objections(findings)) return "the map is not complete: `ecs map send` refuses it until this is corrected\n";
  return fmt::format("the map contains every component of its scope and {}. Read the {} first\n{}", sent,
                     findings.size() == 1 ? "remark" : remarks_counted(findings.size()),
                     coverage.empty() ? "" : paragraph(coverage));
}

bool squareness_differs(const UnitParameters& a, const UnitParameters& b) {
  const auto differs = [&](Component c) { return squareness_um_per_m(a, c) != squareness_um_per_m(b, c); };
  return differs(Component::C0Y) || differs(Component::B0Z) || differs(Component::A0Z);
}

Result<laser::DeclaredZero> declared_zero_in(const std::string& word) {
  const std::size_t sign = word.find('=');
  const auto component = component_of(trimmed(std::string_view(word).substr(0, sign)));
  const std::string reason = sign == std::string::npos ? "" : std::string(trimmed(word.substr(sign + 1)));
  if (!component && !reason.empty())
    return problem(ProblemKind::usage, "--zero: expected the code of a component, such as EBY or C0Y, got \"{}\"",
                   word.substr(0, sign));
  if (!component || reason.empty())
    return problem(
        ProblemKind::usage,
        fmt::format("--zero: expected CODE=\"reason\", as in EBY=\"too small to measure\", got \"{}\"", word));
  return laser::DeclaredZero{*component, reason};
}

std::vector<laser::MapFinding> findings_before_sending(const laser::ErrorMap& map, const UnitParameters& parameters,
                                                       const laser::Travels& travels) {
  auto findings = laser::findings_for(map, parameters, travels);
  if (const std::string change = laser::change_by_resampling(map); !change.empty() && !has_objections(findings))
    findings.push_back({false, change + ": " + kEvenly});
  return findings;
}

Result<MadeMap> made_map(const laser::MapRecipe& recipe, const params::ParametersFile& parameters,
                         const laser::Travels& travels, const laser::FileReader& read) {
  ECS_TRY(built, laser::build_map(recipe, parameters.parameters, read));
  laser::MapHeader& header = built.map.header;
  if (header.machine.empty()) header.machine = parameters.identity.machine;
  if (header.serial_number.empty()) header.serial_number = parameters.identity.serial_number;
  auto findings = findings_before_sending(built.map, built.parameters, travels);
  return MadeMap{std::move(built), std::move(findings)};
}

Result<void> write_map(const std::string& file, const laser::ErrorMap& map, const std::string& params_file,
                       const UnitParameters& parameters, const params::Identity& identity) {
  if (!file.empty()) ECS_DO(write_file(file, laser::to_map_csv(map)));
  return params_file.empty() ? Result<void>() : params::write_parameters(params_file, parameters, identity);
}

Result<MadeMap> opened_map(const std::string& file, const std::vector<laser::DeclaredZero>& zero,
                           const params::ParametersFile& parameters, const laser::Travels& travels) {
  ECS_TRY(map, laser::read_map_csv(file));
  map.header.declared_zero.insert(map.header.declared_zero.end(), zero.begin(), zero.end());
  auto findings = findings_before_sending(map, parameters.parameters, travels);
  return MadeMap{{std::move(map), parameters.parameters, {}, {}}, std::move(findings)};
}

namespace {

constexpr double kSameIncrement_mm = 1e-6;

std::optional<double> increment_mm(const laser::MapTable& table) {
  const auto& p = table.position_mm;
  if (p.size() < 2) return std::nullopt;
  const double step_mm = (p.back() - p.front()) / static_cast<double>(p.size() - 1);
  for (std::size_t i = 1; i < p.size(); ++i)
    if (std::abs(p[i] - p[i - 1] - step_mm) > kSameIncrement_mm) return std::nullopt;
  return step_mm;
}

struct Extremes {
  double least = 0.0;
  double most = 0.0;
};
Extremes extremes_of(const laser::MapTable& table) {
  if (table.compensation.empty()) return {};
  const auto [least, most] = std::minmax_element(table.compensation.begin(), table.compensation.end());
  return {*least, *most};
}

/// Without the sign of a zero.
std::string hundredths(double value) { return fmt::format("{:.2f}", std::round(100.0 * value) / 100.0 + 0.0); }

Cell table_cell(const laser::MapTable& table, bool with_values) {
  const auto& p = table.position_mm;
  const auto step_mm = increment_mm(table);
  const Extremes extremes = extremes_of(table);
  return record_cell(
      "{component:<4} {approach:<8} {start_mm:>12} {increment_mm:>14} {points:>7} {min:>11} {max:>11} {unit}\n",
      "component"_is(name_of(table.component)), "approach"_is(word_for(table.approach)),
      "unit"_is(unit_of(table.component)),
      "start_mm"_is(p.empty() ? null_cell("-") : Cell{number_or_null(p.front()), fmt::format("{:.6g}", p.front())}),
      "increment_mm"_is(step_mm, step_mm ? fmt::format("{:.6g}", *step_mm) : "varies"), "points"_is(p.size()),
      "min"_is(extremes.least, hundredths(extremes.least)), "max"_is(extremes.most, hundredths(extremes.most)),
      "position_mm"_is(with_values ? Cell{p, {}} : shown_cell()),
      "compensation"_is(with_values ? Cell{table.compensation, {}} : shown_cell()));
}

}  // namespace

std::string_view word_for(Approach approach) {
  if (approach == Approach::unknown) return "both";
  return approach == Approach::forward ? "forward" : "reverse";
}

Cell tables_cell(const std::vector<laser::MapTable>& tables, bool with_values) {
  return list_cell(
      tables, [&](const laser::MapTable& table) { return table_cell(table, with_values); },
      "     approach   start [mm] increment [mm]  points    smallest     largest unit\n");
}

namespace {

/// Of one degC, kg or full duty.
std::string_view unit_of(const ThermalRow& row) {
  if (is_angular(row.component) || row.law == ThermalLaw::growth) return "um/m";
  return row.law == ThermalLaw::shift ? "um" : "um/m2";
}
std::string_view unit_of_source(const ThermalRow& row) {
  if (follows_motion(row.source)) return "mm/min";
  return row.source == kLoadInput ? "kg" : "degC";
}

}  // namespace

Cell thermal_cell(const laser::MapHeader& header) {
  Cell list = list_cell(header.thermal, [&](const ThermalRow& row) {
    const std::string from = follows_motion(row.source) ? fmt::format("full at {:.6g} mm/min", row.reference)
                             : row.minus == kNoInput ? fmt::format("from {:.6g} {}", row.reference, unit_of_source(row))
                                                     : fmt::format("less {}", source_text(header, row.minus));
    const std::string_view per = follows_motion(row.source) ? "" : row.source == kLoadInput ? "/kg" : "/degC";
    return record_cell("  {component:<4} {law:<8} {coefficient:>10} {unit:<12} {source}, {from}{lag_s}\n",
                       "component"_is(name_of(row.component)), "law"_is(name_of(row.law)),
                       "coefficient"_is(row.coefficient, 4), "unit"_is(fmt::format("{}{}", unit_of(row), per)),
                       "source"_is(source_text(header, row.source)),
                       "minus"_is(row.minus == kNoInput ? null_cell() : Cell{source_text(header, row.minus), {}}),
                       "reference"_is(Cell{number_or_null(row.reference), {}}), "from"_shown(from),
                       "lag_s"_is(row.lag_s, row.lag_s > 0.0 ? fmt::format(", lag {:.6g} s", row.lag_s) : ""),
                       "origin_mm"_is(Cell{number_or_null(row.origin_mm), {}}));
  });
  if (!header.thermal.empty()) list.text = "thermal rows, compensation:\n" + list.text;
  return list;
}

Cell header_cell(const laser::MapHeader& header) {
  laser::MapHeader words = header;
  words.rotary.clear();  // whole curves: their table says how large they are
  const std::string text = laser::header_text(words) + rotary_cell(header).text;
  Cell cell{object_of("customer"_is(text_cell(header.customer)), "machine"_is(text_cell(header.machine)),
                      "serial_number"_is(text_cell(header.serial_number)), "date"_is(text_cell(header.date)),
                      "engineer"_is(text_cell(header.engineer)), "configuration"_is(text_cell(header.configuration)),
                      "sources"_is(list_cell(header.sources,
                                             [](const laser::SourceFile& s) {
                                               return record_cell({}, "component"_is(s.component), "name"_is(s.name),
                                                                  "sha256"_is(s.sha256));
                                             })),
                      "declared_zero"_is(list_cell(header.declared_zero,
                                                   [](const laser::DeclaredZero& z) {
                                                     return record_cell({}, "component"_is(name_of(z.component)),
                                                                        "reason"_is(z.reason));
                                                   })),
                      "processing"_is(lines_cell(header.processing, ""))),
            text.empty() ? "no header\n" : text};
  if (!header.thermal.empty()) cell.json["thermal"] = thermal_cell(header).json;
  if (!header.rotary.empty()) cell.json["rotary"] = rotary_cell(header).json;
  if (header.bending != RotaryBending{}) cell.json["bending"] = bending_cell(header.bending).json;
  return cell;
}

Cell findings_cell(const std::vector<laser::MapFinding>& findings) {
  return list_cell(findings, [](const laser::MapFinding& finding) {
    return record_cell("{objection}: {message}\n", "objection"_is(finding.objection, "prevents sending", "remark"),
                       "message"_is(finding.message));
  });
}

std::vector<std::string> objections_in(const std::vector<laser::MapFinding>& findings) {
  std::vector<std::string> messages;
  for (const laser::MapFinding& finding : findings)
    if (finding.objection) messages.push_back(finding.message);
  return messages;
}

Cell squareness_cell(const std::vector<std::pair<Component, double>>& values, std::string_view begin) {
  Cell cell{Json::object(), {}};
  for (const auto& [component, um_per_m] : values) {
    const std::string key = fmt::format("{}_um_per_m", name_of(component));
    cell.json[key] = number_or_null(um_per_m);
    cell.text += fmt::format("{}compensation.squareness.{} = {:.4f}\n", begin, key, um_per_m);
  }
  return cell;
}

Cell squareness_cell(const std::vector<std::pair<Component, double>>& values, std::string_view origin,
                     const std::string& params_out) {
  Cell cell = squareness_cell(values, "  ");
  if (values.empty()) return cell;
  cell.text =
      (params_out.empty()
           ? fmt::format("squareness {}; without --params-out add these values to the parameters manually:\n", origin)
           : fmt::format("squareness {}, in {}:\n", origin, params_out)) +
      cell.text;
  return cell;
}

}  // namespace ecs::commissioning
