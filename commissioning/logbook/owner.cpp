// Whose logbook it is.
#include <algorithm>

#include <fmt/format.h>

#include "commissioning/logbook/store.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kLeastMachineCut = 37;  // bytes; a unit's identity cuts longer names (core/memory_image.cpp)

bool same_machine(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto& [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  return shorter.size() >= kLeastMachineCut && longer.starts_with(shorter);
}

}  // namespace

bool belongs(const LogOwner& owner, const LogOwner& of) {
  const bool empty = owner.machine.empty() && owner.serial_number.empty();
  const bool both_named = !owner.machine.empty() && !of.machine.empty();
  const bool both_numbered = !owner.serial_number.empty() && !of.serial_number.empty();
  if (both_named && !same_machine(owner.machine, of.machine)) return false;
  if (both_numbered && owner.serial_number != of.serial_number) return false;
  return empty || both_named || both_numbered;
}

std::string in_words(const LogOwner& owner) {
  if (owner.machine.empty() && owner.serial_number.empty()) return "no machine yet";
  if (owner.serial_number.empty()) return owner.machine;
  if (owner.machine.empty()) return fmt::format("the unit with serial number {}", owner.serial_number);
  return fmt::format("{}, serial number {}", owner.machine, owner.serial_number);
}

}  // namespace ecs::commissioning
