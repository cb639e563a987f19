#include "protocol/server/host_sessions.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include <fmt/format.h>

namespace ecs::protocol {

HostSession& HostSessions::open(const SessionOpen& host) {
  auto found = std::find_if(sessions_.begin(), sessions_.end(), [&](const HostSession& session) {
    return session.id != 0 && session.host.key == host.key && session.host.number == host.number;
  });
  if (found == sessions_.end()) {
    found = std::min_element(sessions_.begin(), sessions_.end(),
                             [](const HostSession& a, const HostSession& b) { return a.used < b.used; });
    *found = HostSession{number_by_chance(found->id), host, {}, 0};
  }
  found->host = host;
  found->used = ++uses_;
  return *found;
}

HostSession* HostSessions::find(std::uint32_t id) {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(),
                                  [id](const HostSession& session) { return id != 0 && session.id == id; });
  if (found == sessions_.end()) return nullptr;
  found->used = ++uses_;
  return &*found;
}

std::uint32_t number_by_chance(std::uint32_t other) {
  std::random_device chance;
  std::uint32_t number = other;
  while (number == other || number == 0) number = chance();
  return number;
}

namespace {

constexpr std::uint64_t kMsPer_s = 1000;
constexpr std::uint32_t kSecondsPerMinute = 60;

std::uint64_t seconds_until(std::uint64_t until_ms, std::uint64_t now_ms) {
  return until_ms <= now_ms ? 0 : (until_ms - now_ms + kMsPer_s - 1) / kMsPer_s;
}

/// Where that host is; null: nowhere.
auto* place_of(auto& places, std::uint64_t key) {
  const auto its = std::find_if(places.begin(), places.end(),
                                [key](const auto& armed) { return armed.until_ms != 0 && armed.host.key == key; });
  return its == places.end() ? nullptr : &*its;
}

CommandResult refused(UnitError error, std::string text) {
  return {0, CommandState::refused, error, 0, 0, std::move(text)};
}

}  // namespace

CommandResult Arming::arm(const Command& command, const HostSession& session, std::uint64_t now_ms) {
  if (command.minutes > kMostArmed_min)
    return refused(UnitError::bad_argument, fmt::format("expected at most {} minutes", kMostArmed_min));
  Armed* const its = place_of(armed_, session.host.key);
  if (command.minutes == 0) {
    if (its != nullptr) *its = {};
    return {0, CommandState::done, UnitError::none, 0, 0, {}};
  }
  if (const auto wait = wait_s(now_ms); wait > 0)
    return refused(UnitError::too_many_codes, fmt::format("try again in {} s", wait));
  if (!code_.empty() && command.proof != arm_proof(code_, session.id)) {
    const unsigned doublings = std::min(wrong_in_a_row_++, 6U);
    const auto wait = std::min<std::uint64_t>(std::uint64_t{1} << doublings, kLongestWait_s);
    closed_until_ms_ = now_ms + wait * kMsPer_s;
    return refused(UnitError::wrong_code, fmt::format("try again in {} s", wait));
  }
  wrong_in_a_row_ = 0;
  Armed& place =
      its != nullptr ? *its : *std::min_element(armed_.begin(), armed_.end(), [](const Armed& a, const Armed& b) {
        return a.until_ms < b.until_ms;
      });
  const std::uint32_t seconds = command.minutes * kSecondsPerMinute;
  place = {session.host, now_ms + seconds * kMsPer_s};
  return {0, CommandState::done, UnitError::none, 0, seconds, {}};
}

std::uint32_t Arming::left_s(const HostSession& session, std::uint64_t now_ms) const {
  if (code_.empty()) return kMostArmed_min * kSecondsPerMinute;
  const Armed* const its = place_of(armed_, session.host.key);
  return its == nullptr ? 0 : static_cast<std::uint32_t>(seconds_until(its->until_ms, now_ms));
}

std::uint16_t Arming::wait_s(std::uint64_t now_ms) const {
  return static_cast<std::uint16_t>(seconds_until(closed_until_ms_, now_ms));
}

std::optional<ArmingEnd> Arming::take_ended(std::uint64_t now_ms) {
  const auto its = std::find_if(armed_.begin(), armed_.end(), [now_ms](const Armed& armed) {
    return armed.until_ms != 0 && armed.until_ms <= now_ms;
  });
  if (its == armed_.end()) return std::nullopt;
  const Armed ended = std::exchange(*its, Armed{});
  return ArmingEnd{ended.host, ended.until_ms};
}

void Arming::begin_again() {
  armed_ = {};
  wrong_in_a_row_ = 0;
  closed_until_ms_ = 0;
}

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
      if (command.staging_from == StagingFrom::kept) return "over the contents of the bank";
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
