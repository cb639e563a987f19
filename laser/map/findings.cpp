// What stands against sending a map: completeness, limits, extent.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "laser/map/coverage.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {
namespace {

bool is_declared_zero(const ErrorMap& map, Component c) {
  return std::any_of(map.header.declared_zero.begin(), map.header.declared_zero.end(),
                     [&](const DeclaredZero& z) { return z.component == c; });
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
    const bool measured = std::any_of(map.header.sources.begin(), map.header.sources.end(),
                                      [&](const SourceFile& s) { return s.component == name_of(c); });
    if (!needed.contains(c) || measured || is_declared_zero(map, c) || squareness_um_per_m(parameters, c) != 0.0)
      continue;
    findings.push_back({true, fmt::format("{} ({}) is needed: the parameters hold 0 and no file says it was measured; "
                                          "set it, or declare it zero with a reason",
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
        {true, fmt::format("{}{} asks for {:.6g} um at {} mm, but axis.{}.output_limit_um is {:.6g}: mend the "
                           "value, or raise the limit if the machine is that far off",
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
  const auto largest = std::max_element(steps.begin(), steps.end());
  const auto at = static_cast<std::size_t>(largest - steps.begin());
  const double peak = *largest;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  const double usual = steps[steps.size() / 2];
  if (peak > 20.0 && peak > 20.0 * usual)
    findings.push_back(
        {false, fmt::format("{}{} jumps by {:.1f} {} between {} and {} mm, {:.0f} times its usual step: a wrong "
                            "value?",
                            name_of(table.component), approach_text(table), peak, unit_of(table.component),
                            table.position_mm[at], table.position_mm[at + 1], peak / std::max(usual, 0.01))});
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
    findings.push_back({true, fmt::format("the map was made for a {} machine, the parameters say {}",
                                          map.header.configuration, configuration_of(parameters))});
  for (const DeclaredZero& zero : map.header.declared_zero)
    if (!is_squareness(zero.component) && has_any(map, zero.component))
      findings.push_back(
          {true, fmt::format("{} is declared zero and has values too: keep one", name_of(zero.component))});
  find_missing(map, parameters, findings);
  find_squareness(map, parameters, findings);
  for (MapFinding& warning : coverage_warnings(map, parameters, travels)) findings.push_back(std::move(warning));
  find_in_tables(map, parameters, findings);
  return findings;
}

}  // namespace ecs::laser
