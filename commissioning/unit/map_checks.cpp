#include "commissioning/unit/map_checks.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/address_map.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"

namespace ecs::commissioning {
namespace {

struct Stated {
  std::string_view origin;  ///< "the map was made for serial number"
  const std::string& value;
};

void take_difference(std::vector<std::string>& objections, const Stated& ours, const std::string& other,
                     std::string_view where, std::string_view advice = kTakeTheRightOne) {
  if (ours.value.empty() || other.empty() || ours.value == other) return;
  objections.push_back(fmt::format("{} \"{}\", {} says \"{}\": {}", ours.origin, ours.value, where, other, advice));
}

constexpr std::string_view kWhoseMap =
    "nobody can check whose map it is; `ecs map build` writes these lines. If it is meant for this unit, give "
    "--other-machine";
constexpr std::string_view kMapSerial = "the map was made for serial number";
constexpr std::string_view kOfParameters = "[identity] of the parameters";

std::vector<std::string> two_machines(const laser::MapHeader& header, const params::Identity& identity,
                                      std::string_view advice) {
  std::vector<std::string> objections;
  take_difference(objections, {"the map was made for machine", header.machine}, identity.machine, kOfParameters,
                  advice);
  take_difference(objections, {kMapSerial, header.serial_number}, identity.serial_number, kOfParameters, advice);
  return objections;
}

}  // namespace

std::vector<std::string> objections_to_map(const laser::ErrorMap& map, const UnitParameters& parameters) {
  std::vector<std::string> objections;
  for (const laser::MapFinding& finding : laser::findings_for(map, parameters))
    if (finding.objection) objections.push_back(finding.message);
  for (std::size_t i = kCurves; i < kComponents; ++i) {
    const auto component = static_cast<Component>(i);
    const auto name = name_of(component);
    const bool measured = std::any_of(map.header.sources.begin(), map.header.sources.end(),
                                      [&](const laser::SourceFile& source) { return source.component == name; });
    if (measured && squareness_um_per_m(parameters, component) == 0.0)
      objections.push_back(
          fmt::format("{} was measured for this map, but the parameters hold 0: use the parameters that `ecs map build "
                      "--params-out` wrote",
                      name));
  }
  return objections;
}

std::vector<std::string> other_machine(const laser::MapHeader& header, const params::Identity& identity) {
  return two_machines(header, identity, kTakeTheRightOne);
}

std::vector<std::string> made_for_two_machines(const laser::MapHeader& header, const params::Identity& identity) {
  return two_machines(header, identity, "as they stand, `ecs map send` refuses the map with these parameters");
}

std::vector<std::string> other_unit(const laser::MapHeader& header, const std::string& serial_number) {
  std::vector<std::string> objections;
  if (header.machine.empty() && header.serial_number.empty())
    objections.push_back(fmt::format("its header names neither machine nor serial number: {}", kWhoseMap));
  if (header.configuration.empty())
    objections.push_back(fmt::format("its header names no configuration: {}", kWhoseMap));
  take_difference(objections, {kMapSerial, header.serial_number}, serial_number, "the unit");
  return objections;
}

std::vector<std::string> other_unit(const params::Identity& identity, const std::string& serial_number) {
  std::vector<std::string> objections;
  take_difference(objections, {"the parameters were made for serial number", identity.serial_number}, serial_number,
                  "the unit");
  return objections;
}

std::vector<std::string> other_unit(const std::string& dumped_from, std::span<const std::uint8_t> image,
                                    const std::string& serial_number) {
  std::vector<std::string> objections;
  take_difference(objections, {"the dump was taken from serial number", dumped_from}, serial_number, "the unit");
  const auto content = laser::content_of(image);
  if (!content) {
    objections.push_back(fmt::format("whose map it is cannot be read: {}; give --other-machine to load it nonetheless",
                                     to_text(content.error())));
    return objections;
  }
  for (std::string& differs : other_unit(content->map.header, serial_number)) objections.push_back(std::move(differs));
  return objections;
}

std::vector<std::string> no_room_for(std::span<const std::uint8_t> image, const protocol::Identity& identity) {
  std::vector<std::string> objections;
  const ImageView view(image);
  const auto parameters = view.parameters();
  if (parameters && parameters->memory_modules > identity.memory_modules)
    objections.push_back(
        fmt::format("the parameters count on {} axis memory modules, the unit has {}: put more modules into its rack, "
                    "or set memory_modules in the parameters to {}",
                    parameters->memory_modules, identity.memory_modules, identity.memory_modules));
  if (view.value_count() > identity.capacity_values)
    objections.push_back(
        fmt::format("the map holds {} values, the unit holds at most {}: use a larger increment, or put more axis "
                    "memory modules into its rack",
                    view.value_count(), identity.capacity_values));
  const std::size_t room = bank_bytes(static_cast<std::uint8_t>(std::min<int>(identity.memory_modules, kMostModules)));
  if (image.size() > room)
    objections.push_back(
        fmt::format("the map has {} bytes, a bank of the unit {}: use a larger increment, or put more axis memory "
                    "modules into its rack",
                    image.size(), room));
  return objections;
}

std::optional<Problem> refused_map(const std::vector<std::string>& objections, const std::string& file) {
  if (objections.empty()) return std::nullopt;
  std::vector<Problem> problems;
  for (const std::string& objection : objections) problems.push_back({ProblemKind::refused, objection, file, 0, 0, {}});
  return folded(std::move(problems));
}

}  // namespace ecs::commissioning
