// Which transaction meets which fault.
#include "protocol/line/faults.hpp"

#include "base/random.hpp"

namespace ecs::protocol {

std::optional<LinkFault> link_fault_named(std::string_view name) {
  for (std::size_t i = 0; i < kLinkFaults; ++i)
    if (kLinkFaultNames[i] == name) return static_cast<LinkFault>(i);
  return std::nullopt;
}

void LinkFaults::next(LinkFault fault, std::uint32_t transactions) {
  counted_[static_cast<std::size_t>(fault)] = transactions;
}

void LinkFaults::with_probability(LinkFault fault, double probability) {
  probability_[static_cast<std::size_t>(fault)] = probability;
}

void LinkFaults::clear() {
  counted_ = {};
  probability_ = {};
}

std::optional<LinkFault> LinkFaults::draw() {
  for (std::size_t i = 0; i < kLinkFaults; ++i) {
    if (counted_[i] == 0) continue;
    --counted_[i];
    return static_cast<LinkFault>(i);
  }
  for (std::size_t i = 0; i < kLinkFaults; ++i)
    if (probability_[i] > 0.0 && chance(random_, probability_[i])) return static_cast<LinkFault>(i);
  return std::nullopt;
}

std::size_t LinkFaults::place(std::size_t limit) { return one_of(random_, static_cast<std::uint32_t>(limit)); }

}  // namespace ecs::protocol
