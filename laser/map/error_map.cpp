// An error map, and what stands against sending it: completeness, limits, extent.
#include "laser/map/error_map.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "laser/groups.hpp"
#include "laser/map/rotary_map.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

const MapTable* table_of(const ErrorMap& map, Component component, Approach approach) {
  const MapTable* both = nullptr;
  for (const MapTable& table : map.tables) {
    if (table.component != component) continue;
    if (table.approach == approach) return &table;
    if (table.approach == Approach::unknown) both = &table;
  }
  return both;
}

double compensation_at(const MapTable& table, double position_mm) {
  const auto& p = table.position_mm;
  if (position_mm <= p.front()) return table.compensation.front();
  if (position_mm >= p.back()) return table.compensation.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), position_mm) - p.begin());
  const double part = (position_mm - p[above - 1]) / (p[above] - p[above - 1]);
  return std::lerp(table.compensation[above - 1], table.compensation[above], part);
}

double unit_value_at(const MapTable& table, Interpolation interpolation, double position_mm) {
  if (interpolation == Interpolation::linear) return compensation_at(table, position_mm);
  const auto& p = table.position_mm;
  const auto above = static_cast<std::size_t>(std::lower_bound(p.begin(), p.end(), position_mm) - p.begin());
  if (above == 0) return table.compensation.front();
  if (above == p.size()) return table.compensation.back();
  const bool upper = position_mm - p[above - 1] >= p[above] - position_mm;
  return table.compensation[upper ? above : above - 1];
}

std::string description_of(Component component) {
  if (component == Component::C0Y) return "squareness of Y to X";
  if (component == Component::B0Z) return "squareness of Z to X";
  if (component == Component::A0Z) return "squareness of Z to Y";
  const char axis = letter_of(moving_axis(component));
  if (is_positioning(component)) return fmt::format("{} axis linear positioning error", axis);
  const char direction = letter_of(direction_of(sense_of(component)));
  if (is_straightness(component)) return fmt::format("{} axis straightness error in {}", axis, direction);
  if (direction == axis) return fmt::format("{} axis roll error", axis);
  return fmt::format("{} axis rotation about {} (pitch or yaw)", axis, direction);
}

double largest_in(const std::vector<MapTable>& tables, Component component) {
  double largest = 0.0;
  for (const MapTable& table : tables)
    if (table.component == component)
      for (const double value : table.compensation) largest = std::max(largest, std::abs(value));
  return largest;
}

namespace {

constexpr std::size_t kFewestPoints = 3;  ///< two show a straight line, whatever the curve does between them
constexpr double kApart = 0.75;           ///< of a spacing: ends further apart differ by a point
constexpr double kApartAndRefused = 1.5;  ///< of a spacing: from here findings_for() objects
constexpr std::string_view kBeyondTheEnds = "the unit keeps the end value of a table beyond its end";

struct Span {
  double first_mm = 0.0;
  double last_mm = 0.0;
  [[nodiscard]] double length_mm() const { return last_mm - first_mm; }
};

Span span_of(const MapTable& table) { return {table.position_mm.front(), table.position_mm.back()}; }

Span around(const Span& a, const Span& b) { return {std::min(a.first_mm, b.first_mm), std::max(a.last_mm, b.last_mm)}; }

double spacing_mm(const MapTable& table) {
  return span_of(table).length_mm() / static_cast<double>(table.position_mm.size() - 1);
}

/// The two tables of a component, the same one twice where it serves both approaches.
struct Pair {
  const MapTable* forward;
  const MapTable* reverse;
  [[nodiscard]] bool one() const { return forward == reverse; }
  [[nodiscard]] Span span() const { return around(span_of(*forward), span_of(*reverse)); }
  [[nodiscard]] double spacing() const { return std::max(spacing_mm(*forward), spacing_mm(*reverse)); }
};

/// Nothing where a table is missing or a single point: findings_for() objects to both.
std::optional<Pair> tables_of(const ErrorMap& map, Component c) {
  const Pair pair{table_of(map, c, Approach::forward), table_of(map, c, Approach::reverse)};
  if (pair.forward == nullptr || pair.reverse == nullptr) return std::nullopt;
  if (pair.forward->position_mm.size() < 2 || pair.reverse->position_mm.size() < 2) return std::nullopt;
  return pair;
}

/// What all tables of an axis that are used cover together.
std::optional<Span> covered_along(const ErrorMap& map, const ComponentSet& needed, Axis axis) {
  std::optional<Span> all;
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto c = static_cast<Component>(i);
    if (!needed.contains(c) || moving_axis(c) != axis) continue;
    if (const auto pair = tables_of(map, c)) all = all ? around(*all, pair->span()) : pair->span();
  }
  return all;
}

void warn_of_travel(Component c, const Pair& pair, const Span& travel, bool of_machine,
                    std::vector<MapFinding>& findings) {
  const Span span = pair.span();
  if (of_machine)
    if (auto beyond = beyond_travel(name_of(c), moving_axis(c), {span.first_mm, span.last_mm},
                                    {travel.first_mm, travel.last_mm})) {
      findings.push_back({false, std::move(*beyond)});
      return;
    }
  const double margin_mm = std::max(pair.spacing(), kUsualMargin * travel.length_mm()) * (1.0 + 1e-9);
  if (span.first_mm - travel.first_mm <= margin_mm && travel.last_mm - span.last_mm <= margin_mm) return;
  const double covered_mm =
      std::max(0.0, std::min(span.last_mm, travel.last_mm) - std::max(span.first_mm, travel.first_mm));
  const char axis = letter_of(moving_axis(c));
  findings.push_back({false, fmt::format("{} covers only {:.6g} of {:.6g} mm of {} ({:.6g} to {:.6g}): {}", name_of(c),
                                         covered_mm, travel.length_mm(),
                                         of_machine ? fmt::format("the travel of {}", axis)
                                                    : fmt::format("the common range of the tables of {}", axis),
                                         travel.first_mm, travel.last_mm, kBeyondTheEnds)});
}

void warn_of_uneven_ends(Component c, const Pair& pair, std::vector<MapFinding>& findings) {
  if (pair.one()) return;
  const Span forward = span_of(*pair.forward);
  const Span reverse = span_of(*pair.reverse);
  const double apart_mm =
      std::max(std::abs(forward.first_mm - reverse.first_mm), std::abs(forward.last_mm - reverse.last_mm));
  const double spacing = std::min(spacing_mm(*pair.forward), spacing_mm(*pair.reverse));
  const double refused_mm = kApartAndRefused * (pair.forward->position_mm[1] - pair.forward->position_mm[0]);
  if (apart_mm <= kApart * spacing || apart_mm > refused_mm) return;
  findings.push_back({false, fmt::format("{}: forward is measured from {:.6g} to {:.6g} mm only, reverse from {:.6g} "
                                         "to {:.6g} mm: {}",
                                         name_of(c), forward.first_mm, forward.last_mm, reverse.first_mm,
                                         reverse.last_mm, kBeyondTheEnds)});
}

void warn_of_few_points(Component c, const Pair& pair, std::vector<MapFinding>& findings) {
  const std::size_t forward = pair.forward->position_mm.size();
  const std::size_t reverse = pair.reverse->position_mm.size();
  if (std::min(forward, reverse) >= kFewestPoints) return;
  const std::string points = pair.one() ? fmt::format("{} points", forward)
                                        : fmt::format("{} points forward, {} in reverse", forward, reverse);
  findings.push_back(
      {false, fmt::format("{} has {}: fewer than {} do not show the shape of the error; measure more targets",
                          name_of(c), points, kFewestPoints)});
}

}  // namespace

std::vector<MapFinding> coverage_warnings(const ErrorMap& map, const UnitParameters& parameters,
                                          const Travels& travels) {
  std::vector<MapFinding> findings;
  const ComponentSet needed = components_needed(parameters);
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto c = static_cast<Component>(i);
    if (!needed.contains(c)) continue;
    const auto pair = tables_of(map, c);
    if (!pair) continue;
    const auto& travel = travels[index_of(moving_axis(c))];
    const auto all = travel ? Span{(*travel)[0], (*travel)[1]} : covered_along(map, needed, moving_axis(c)).value();
    warn_of_travel(c, *pair, all, travel.has_value(), findings);
    warn_of_uneven_ends(c, *pair, findings);
    warn_of_few_points(c, *pair, findings);
  }
  return findings;
}

std::vector<std::string> missing_in(const MapHeader& header) {
  std::vector<std::string> missing;
  const std::array<std::pair<const char*, const std::string*>, 5> fields{{{"customer", &header.customer},
                                                                          {"machine", &header.machine},
                                                                          {"serial number", &header.serial_number},
                                                                          {"engineer", &header.engineer},
                                                                          {"date", &header.date}}};
  for (const auto& [name, value] : fields)
    if (value->empty()) missing.emplace_back(name);
  return missing;
}

namespace {

bool is_declared_zero(const ErrorMap& map, Component c) {
  return std::ranges::any_of(map.header.declared_zero, [&](const DeclaredZero& z) { return z.component == c; });
}

bool has_both_approaches(const ErrorMap& map, Component c) {
  return table_of(map, c, Approach::forward) != nullptr && table_of(map, c, Approach::reverse) != nullptr;
}

bool has_any(const ErrorMap& map, Component c) {
  return table_of(map, c, Approach::forward) != nullptr || table_of(map, c, Approach::reverse) != nullptr;
}

void find_missing(const ErrorMap& map, const UnitParameters& parameters, std::vector<MapFinding>& findings) {
  const ComponentSet needed = components_needed(parameters);
  for (std::size_t i = 0; i < kCurves; ++i) {
    const auto c = static_cast<Component>(i);
    if (needed.contains(c)) {
      if (has_both_approaches(map, c) || is_declared_zero(map, c)) continue;
      findings.push_back({true, has_any(map, c)
                                    ? fmt::format("{} ({}) has one approach only: give both, or approach 0", name_of(c),
                                                  description_of(c))
                                    : fmt::format("{} ({}) is missing: measure it, or declare it zero with a reason",
                                                  name_of(c), description_of(c))});
    } else if (has_any(map, c)) {
      findings.push_back({false, fmt::format("{} is not used by a {} machine in this scope", name_of(c),
                                             configuration_of(parameters))});
    }
  }
}

void find_squareness(const ErrorMap& map, const UnitParameters& parameters, std::vector<MapFinding>& findings) {
  const ComponentSet needed = components_needed(parameters);
  for (std::size_t i = kCurves; i < kComponents; ++i) {
    const auto c = static_cast<Component>(i);
    const bool measured =
        std::ranges::any_of(map.header.sources, [&](const SourceFile& s) { return s.component == name_of(c); });
    if (!needed.contains(c) || measured || is_declared_zero(map, c) || squareness_um_per_m(parameters, c) != 0.0)
      continue;
    findings.push_back({true, fmt::format("{} ({}) is needed: its parameter is 0 and no file states that it was "
                                          "measured; set it, or declare it zero with a reason",
                                          name_of(c), description_of(c))});
  }
}

std::string approach_text(const MapTable& table) {
  if (table.approach == Approach::unknown) return "";
  return table.approach == Approach::forward ? " forward" : " reverse";
}

/// A translation beyond the output limit of the axis it moves can never be put out.
void find_beyond_limit(const MapTable& table, const UnitParameters& parameters, std::vector<MapFinding>& findings) {
  if (is_angular(table.component)) return;
  const std::size_t moved = index_of(direction_of(sense_of(table.component)));
  if (!parameters.axis_present[moved]) return;
  const double limit_um = parameters.axes[moved].output_limit_um;
  for (std::size_t i = 0; i < table.compensation.size(); ++i) {
    if (std::abs(table.compensation[i]) <= limit_um) continue;
    findings.push_back(
        {true, fmt::format("{}{} requires {:.6g} um at {} mm, but axis.{}.output_limit_um is {:.6g}: correct the "
                           "value, or raise the limit if the error of the machine is that large",
                           name_of(table.component), approach_text(table), table.compensation[i], table.position_mm[i],
                           letter_of(static_cast<Axis>(moved)), limit_um)});
    return;
  }
}

/// A table that has lost its end, or stands somewhere else.
void find_displaced(const MapTable& table, const UnitParameters& parameters, std::vector<MapFinding>& findings) {
  if (table.position_mm.size() < 2) {
    findings.push_back({true, fmt::format("{}{} has one point only: give at least two", name_of(table.component),
                                          approach_text(table))});
    return;
  }
  const double first_mm = table.position_mm.front();
  const double last_mm = table.position_mm.back();
  const double step_mm = (last_mm - first_mm) / static_cast<double>(table.position_mm.size() - 1);
  const double datum_mm = parameters.axes[index_of(moving_axis(table.component))].datum.reference_position_mm;
  if (datum_mm < first_mm - step_mm || datum_mm > last_mm + step_mm)
    findings.push_back(
        {true, fmt::format("{}{} lies at {} … {} mm and does not reach the reference position {} mm: the "
                           "positions are not machine coordinates, or the datum parameters are wrong",
                           name_of(table.component), approach_text(table), first_mm, last_mm, datum_mm)});
}

void find_uneven_ends(const ErrorMap& map, Component c, std::vector<MapFinding>& findings) {
  const MapTable* forward = table_of(map, c, Approach::forward);
  const MapTable* reverse = table_of(map, c, Approach::reverse);
  if (forward == nullptr || reverse == nullptr || forward == reverse) return;
  if (forward->position_mm.size() < 2 || reverse->position_mm.size() < 2) return;
  const double step_mm = forward->position_mm[1] - forward->position_mm[0];
  if (std::abs(forward->position_mm.front() - reverse->position_mm.front()) > 1.5 * step_mm ||
      std::abs(forward->position_mm.back() - reverse->position_mm.back()) > 1.5 * step_mm)
    findings.push_back(
        {true, fmt::format("{} covers {} … {} mm forward, but {} … {} mm in reverse: part of a table is missing",
                           name_of(c), forward->position_mm.front(), forward->position_mm.back(),
                           reverse->position_mm.front(), reverse->position_mm.back())});
}

/// One value that stands out from its neighbours: worth a look before the machine follows it.
void find_spike(const MapTable& table, std::vector<MapFinding>& findings) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < table.compensation.size(); ++i)
    steps.push_back(std::abs(table.compensation[i] - table.compensation[i - 1]));
  if (steps.size() < 8) return;
  const auto largest = std::ranges::max_element(steps);
  const auto at = static_cast<std::size_t>(largest - steps.begin());
  const double peak = *largest;
  const double usual = median_of(std::move(steps));
  if (peak > 20.0 && peak > 20.0 * usual)
    findings.push_back(
        {false, fmt::format("{}{} jumps by {:.1f} {} between {} and {} mm, {:.0f} times its usual step: a wrong "
                            "value?",
                            name_of(table.component), approach_text(table), peak, unit_of(table.component),
                            table.position_mm[at], table.position_mm[at + 1], peak / std::max(usual, 0.01))});
}

/// Rows that act on nothing, or are too many for the unit.
void find_thermal(const ErrorMap& map, const UnitParameters& parameters, std::vector<MapFinding>& findings) {
  const auto& rows = map.header.thermal;
  if (rows.size() > kMostThermalRows)
    findings.push_back({true, fmt::format("the map has {} thermal rows, the unit has room for {}: remove the smallest",
                                          rows.size(), kMostThermalRows)});
  ThermalWorking working;
  for (const ThermalRow& row : rows) {
    compile_thermal({&row, 1}, map.header.thermal_settings, parameters, working);
    if (working.rows[0].of_one == ThermalPolynomial{} && row.coefficient != 0.0)
      findings.push_back({false, fmt::format("thermal row {} {} is not used by a {} machine in this scope",
                                             name_of(row.component), name_of(row.law), configuration_of(parameters))});
  }
}

void find_in_tables(const ErrorMap& map, const UnitParameters& parameters, std::vector<MapFinding>& findings) {
  const ComponentSet needed = components_needed(parameters);
  for (const MapTable& table : map.tables) {
    if (!needed.contains(table.component)) continue;
    find_beyond_limit(table, parameters, findings);
    find_displaced(table, parameters, findings);
    find_spike(table, findings);
  }
  for (std::size_t i = 0; i < kCurves; ++i) find_uneven_ends(map, static_cast<Component>(i), findings);
}

}  // namespace

std::optional<std::string> squareness_left_behind(const MapHeader& header, const UnitParameters& parameters) {
  std::vector<std::string_view> names;
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z}) {
    const auto is_named = [&](const SourceFile& file) { return file.component == name_of(square); };
    if (squareness_um_per_m(parameters, square) == 0.0 && std::ranges::any_of(header.sources, is_named))
      names.push_back(name_of(square));
  }
  if (names.empty()) return std::nullopt;
  return fmt::format(
      "{} {} measured for this map, but {} 0: use the parameters written by `ecs map build --params-out`",
      fmt::join(names, ", "), names.size() == 1 ? "was" : "were",
      names.size() == 1 ? "its parameter is" : "their parameters are");
}

std::vector<MapFinding> findings_for(const ErrorMap& map, const UnitParameters& parameters) {
  return findings_for(map, parameters, Travels{});
}

std::vector<MapFinding> findings_for(const ErrorMap& map, const UnitParameters& parameters, const Travels& travels) {
  std::vector<MapFinding> findings;
  if (!terms_of(parameters)) {
    findings.push_back({true, "the parameters describe no machine: run `ecs params check`"});
    return findings;
  }
  if (!map.header.configuration.empty() && map.header.configuration != configuration_of(parameters))
    findings.push_back({true, fmt::format("the map was made for the machine configuration {}, the parameters state {}",
                                          map.header.configuration, configuration_of(parameters))});
  for (const DeclaredZero& zero : map.header.declared_zero)
    if (!is_squareness(zero.component) && has_any(map, zero.component))
      findings.push_back(
          {true, fmt::format("{} is declared zero but also has values: keep only one", name_of(zero.component))});
  find_missing(map, parameters, findings);
  find_squareness(map, parameters, findings);
  for (MapFinding& warning : coverage_warnings(map, parameters, travels)) findings.push_back(std::move(warning));
  find_in_tables(map, parameters, findings);
  find_thermal(map, parameters, findings);
  if (std::string objection = rotary_objection(map.header, parameters); !objection.empty())
    findings.push_back({true, std::move(objection)});
  return findings;
}

}  // namespace ecs::laser
