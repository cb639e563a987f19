// What hosts did to the unit, or tried: the newest events, in the order in which they came.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// At most kKeptEvents.
class EventList {
 public:
  /// Adds an event, or counts it to the newest one where that is the same but for its time. @return its number
  std::uint32_t add(HostEvent event);
  /// A command that was under way has ended so.
  void settle(std::uint32_t number, CommandState state, UnitError error);
  /// From this number on, or from the oldest that is kept.
  [[nodiscard]] EventPage page(std::uint32_t first) const;

 private:
  std::deque<HostEvent> events_;
  std::uint32_t newest_ = 0;
};

/// The arguments of a command in a few words, at most kEventTextBytes.
[[nodiscard]] std::string arguments_in_words(const Command& command);
[[nodiscard]] std::string stretch_in_words(Address address, std::uint32_t bytes);

}  // namespace ecs::protocol
