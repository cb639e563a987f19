#include "protocol/server/event_list.hpp"

#include <limits>

#include <fmt/format.h>

namespace ecs::protocol {

namespace {

bool same_but_for_time(const HostEvent& a, const HostEvent& b) {
  return a.starts == b.starts && a.code == b.code && a.error == b.error && a.state == b.state && a.host == b.host &&
         a.text == b.text;
}

}  // namespace

std::uint32_t EventList::add(HostEvent event) {
  if (!events_.empty() && same_but_for_time(events_.back(), event) &&
      events_.back().times < std::numeric_limits<std::uint16_t>::max()) {
    event.number = events_.back().number;
    event.times = static_cast<std::uint16_t>(events_.back().times + 1);
    events_.back() = std::move(event);
    return newest_;
  }
  event.number = ++newest_;
  events_.push_back(std::move(event));
  if (events_.size() > kKeptEvents) events_.pop_front();
  return newest_;
}

void EventList::settle(std::uint32_t number, CommandState state, UnitError error) {
  for (HostEvent& event : events_) {
    if (event.number != number) continue;
    event.state = state;
    event.error = error;
  }
}

EventPage EventList::page(std::uint32_t first) const {
  EventPage page;
  page.newest = newest_;
  std::size_t place = 0;
  for (const HostEvent& event : events_)
    if (event.number >= first && place < page.events.size()) page.events[place++] = event;
  return page;
}

std::string stretch_in_words(Address address, std::uint32_t bytes) {
  return fmt::format("0x{:06X}, {} bytes", address, bytes);
}

std::string arguments_in_words(const Command& command) {
  switch (command.code) {
    case CommandCode::set_axis_position:
      return fmt::format("{} {:.6g} mm", letter_of(command.axis), command.position_mm);
    case CommandCode::output_compensation:
      return fmt::format("{} {:.4g} um, {}", letter_of(command.axis), command.output_um,
                         command.relay_on ? "relay closed" : "relay open");
    case CommandCode::begin_staging:
      if (command.staging_from == StagingFrom::kept) return "over what the bank holds";
      return command.staging_from == StagingFrom::active ? "copy of the active map" : "";
    case CommandCode::commit_staged:
      return fmt::format("{} bytes, {:08X}", command.length, command.crc);
    case CommandCode::test_datum:
    case CommandCode::record_datum:
      return std::string(1, letter_of(command.axis));
    case CommandCode::run_user_software:
      return fmt::format("0x{:06X}", command.address);
    case CommandCode::arm:
      return fmt::format("{} min", command.minutes);
    default:
      return {};
  }
}

}  // namespace ecs::protocol
