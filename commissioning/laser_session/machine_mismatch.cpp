#include "commissioning/laser_session/machine_mismatch.hpp"

#include <fmt/format.h>

#include "commissioning/link/emulator_process.hpp"
#include "core/memory_image.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {
namespace {

/// @param what  "The parameters are"
std::string other_than_emulated(std::string_view what, std::string_view configuration, const WatchedUnit& unit) {
  const auto file = unit.emulator ? emulated_machine() : std::nullopt;
  const auto emulated = file ? params::read_machine(*file) : Result<params::MachineFile>(params::MachineFile{});
  if (!emulated || emulated->machine.configuration.empty() || emulated->machine.configuration == configuration)
    return {};
  return fmt::format("{} of a machine {}, the emulated machine \"{}\" is {}: its unit refuses a map of another.", what,
                     configuration, emulated->machine.name, emulated->machine.configuration);
}

}  // namespace

std::string mismatch_of(const params::ParametersFile& file, const std::vector<LaserLine>& lines) {
  const UnitParameters& p = file.parameters;
  for (const LaserLine& line : lines) {
    if (!p.axis_present[index_of(line.group.axis)])
      return fmt::format("{} was measured, but the parameters ({}) have no axis {}.", name_of(line.component),
                         configuration_of(p), letter_of(line.group.axis));
    const laser::MeasuredMachine at_hand{file.identity.machine, file.identity.serial_number};
    if (const auto other = other_machine(measured_machine(line.set->metadata), at_hand, "the parameters are of"))
      return fmt::format("{} was {}.", name_of(line.component), *other);
  }
  return {};
}

std::string other_unit_for(const UnitParameters& p, const WatchedUnit& unit) {
  if (std::string other = other_than_emulated("The parameters are", configuration_of(p), unit); !other.empty())
    return other;
  if (unit.identity && unit.identity->configuration != 0 && unit.identity->configuration != configuration_hash(p))
    return fmt::format("The parameters ({}) have another configuration than the map in the unit, which refuses them.",
                       configuration_of(p));
  return {};
}

std::string mismatch_of(const params::Machine& machine, const laser::MeasurementSet& set) {
  for (const laser::Reading& reading : set.readings)
    if (!machine.axes[index_of(reading.axis)])
      return fmt::format("{} was measured, but the machine file ({}) has no axis {}.", letter_of(reading.axis),
                         machine.configuration, letter_of(reading.axis));
  return {};
}

std::string other_unit_for(const params::Machine& machine, const WatchedUnit& unit) {
  return other_than_emulated("The machine file is", machine.configuration, unit);
}

}  // namespace ecs::commissioning
