#include "app/map_checks.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace ecs::app {
namespace {

void take_difference(std::vector<std::string>& objections, std::string_view what, const std::string& of_map,
                     const std::string& other, std::string_view where) {
  if (of_map.empty() || other.empty() || of_map == other) return;
  objections.push_back(
      fmt::format("the map was made for {} \"{}\", {} says \"{}\": take the right map, or give "
                  "--other-machine if this is meant",
                  what, of_map, where, other));
}

}  // namespace

std::vector<std::string> objections_to_map(const laser::ErrorMap& map, const UnitParameters& parameters) {
  std::vector<std::string> objections;
  for (const laser::MapFinding& finding : laser::findings_for(map, parameters))
    if (finding.objection) objections.push_back(finding.message);
  const std::array<double, 3> squareness{parameters.C0Y_um_per_m, parameters.B0Z_um_per_m, parameters.A0Z_um_per_m};
  for (std::size_t i = kCurves; i < kComponents; ++i) {
    const auto name = name_of(static_cast<Component>(i));
    const bool measured = std::any_of(map.header.sources.begin(), map.header.sources.end(),
                                      [&](const laser::SourceFile& source) { return source.component == name; });
    if (measured && squareness[i - kCurves] == 0.0)
      objections.push_back(
          fmt::format("{} was measured for this map, but the parameters hold 0: use the parameters "
                      "that `ecs map build --params-out` wrote",
                      name));
  }
  return objections;
}

std::vector<std::string> other_machine(const laser::MapHeader& header, const params::Identity& identity) {
  std::vector<std::string> objections;
  take_difference(objections, "machine", header.machine, identity.machine, "[identity] of the parameters");
  take_difference(objections, "serial number", header.serial_number, identity.serial_number,
                  "[identity] of the parameters");
  return objections;
}

std::vector<std::string> other_unit(const laser::MapHeader& header, const std::string& serial_number) {
  std::vector<std::string> objections;
  take_difference(objections, "serial number", header.serial_number, serial_number, "the unit");
  return objections;
}

std::optional<Problem> refused_map(const std::vector<std::string>& objections, const std::string& file) {
  if (objections.empty()) return std::nullopt;
  std::vector<Problem> problems;
  for (const std::string& objection : objections) problems.push_back({ProblemKind::refused, objection, file, 0, 0, {}});
  return folded(std::move(problems));
}

}  // namespace ecs::app
