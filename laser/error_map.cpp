#include "laser/error_map.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

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
  const std::array<double, 3> value{parameters.C0Y_um_per_m, parameters.B0Z_um_per_m, parameters.A0Z_um_per_m};
  for (std::size_t i = kCurves; i < kComponents; ++i) {
    const auto c = static_cast<Component>(i);
    const bool measured = std::any_of(map.header.sources.begin(), map.header.sources.end(),
                                      [&](const SourceFile& s) { return s.component == name_of(c); });
    if (!needed.contains(c) || measured || is_declared_zero(map, c) || value[i - kCurves] != 0.0) continue;
    findings.push_back({true, fmt::format("{} ({}) is needed: the parameters hold 0 and no file says it was measured; "
                                          "set it, or declare it zero with a reason",
                                          name_of(c), description_of(c))});
  }
}

}  // namespace

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

std::vector<MapFinding> findings_for(const ErrorMap& map, const UnitParameters& parameters) {
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
  return findings;
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

}  // namespace ecs::laser
