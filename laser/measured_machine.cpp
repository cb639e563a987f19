#include "laser/measured_machine.hpp"

#include <fmt/format.h>

#include "base/shown.hpp"
#include "base/text.hpp"

namespace ecs::laser {

namespace {

/// As a map's header may hold it.
std::string stated_name(const std::string& value) {
  constexpr std::size_t kLongest = 160;
  return cut_line(shown(value), kLongest);
}

}  // namespace

MeasuredMachine measured_machine(const std::vector<MetadataEntry>& metadata) {
  MeasuredMachine machine;
  for (const MetadataEntry& entry : metadata) {
    const std::string key = lower(entry.key);
    if (key == "machine" && machine.name.empty()) machine.name = stated_name(entry.value);
    if ((key == "serial_number" || key == "serial no") && machine.serial_number.empty())
      machine.serial_number = stated_name(entry.value);
  }
  return machine;
}

std::optional<std::string> other_machine(const MeasuredMachine& measured, const MeasuredMachine& at_hand,
                                         std::string_view whose) {
  if (!measured.name.empty() && !at_hand.name.empty() && measured.name != at_hand.name)
    return fmt::format("measured on \"{}\", {} \"{}\"", measured.name, whose, at_hand.name);
  if (!measured.serial_number.empty() && !at_hand.serial_number.empty() &&
      measured.serial_number != at_hand.serial_number)
    return fmt::format("measured on serial number {}, {} serial number {}", measured.serial_number, whose,
                       at_hand.serial_number);
  return std::nullopt;
}

}  // namespace ecs::laser
