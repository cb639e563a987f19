// Which transaction meets which fault.
#include "protocol/line/faults.hpp"

namespace ecs::protocol {

std::optional<LineFault> line_fault_named(std::string_view name) {
  for (std::size_t i = 0; i < kLineFaults; ++i)
    if (kLineFaultNames[i] == name) return static_cast<LineFault>(i);
  return std::nullopt;
}

void LineFaults::next(LineFault fault, std::uint32_t transactions) {
  counted_[static_cast<std::size_t>(fault)] = transactions;
}

void LineFaults::with_probability(LineFault fault, double probability) {
  probability_[static_cast<std::size_t>(fault)] = probability;
}

void LineFaults::clear() {
  counted_ = {};
  probability_ = {};
}

std::optional<LineFault> LineFaults::draw() {
  for (std::size_t i = 0; i < kLineFaults; ++i) {
    if (counted_[i] == 0) continue;
    --counted_[i];
    return static_cast<LineFault>(i);
  }
  for (std::size_t i = 0; i < kLineFaults; ++i)
    if (probability_[i] > 0.0 && std::bernoulli_distribution(probability_[i])(random_))
      return static_cast<LineFault>(i);
  return std::nullopt;
}

std::size_t LineFaults::place(std::size_t limit) {
  return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
}

}  // namespace ecs::protocol
