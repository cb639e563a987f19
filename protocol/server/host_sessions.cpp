#include "protocol/server/host_sessions.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace ecs::protocol {

HostSession& HostSessions::open(const SessionOpen& host, const std::string& origin) {
  auto found = std::find_if(sessions_.begin(), sessions_.end(), [&](const HostSession& session) {
    return session.id != 0 && session.host.key == host.key && session.host.number == host.number;
  });
  if (found == sessions_.end()) {
    found = next_to_go();
    const std::uint32_t id = number_by_chance(found->id);
    *found = HostSession{};
    found->id = id;
    found->origin = origin;
    found->nonce = chance_64();
  }
  found->host = host;
  found->used = ++uses_;
  return *found;
}

HostSession* HostSessions::next_to_go() {
  std::vector<HostSession*> open_to_all;
  for (HostSession& session : sessions_) {
    if (session.id == 0) return &session;
    const auto newer = std::count_if(sessions_.begin(), sessions_.end(), [&](const HostSession& other) {
      return other.keyed && other.used > session.used;
    });
    if (!session.keyed || newer >= static_cast<std::ptrdiff_t>(kKeptForArmed)) open_to_all.push_back(&session);
  }
  const auto rank = [&](const HostSession* session) {
    const auto of_its_origin = std::count_if(open_to_all.begin(), open_to_all.end(), [&](const HostSession* other) {
      return other->origin == session->origin;
    });
    return std::pair(-of_its_origin, session->used);
  };
  return *std::min_element(open_to_all.begin(), open_to_all.end(),
                           [&](const auto* a, const auto* b) { return rank(a) < rank(b); });
}

HostSession* HostSessions::find(std::uint32_t id) {
  const auto found = std::find_if(sessions_.begin(), sessions_.end(),
                                  [id](const HostSession& session) { return id != 0 && session.id == id; });
  if (found == sessions_.end()) return nullptr;
  found->used = ++uses_;
  return &*found;
}

std::uint32_t number_by_chance(std::uint32_t other) {
  std::uint32_t number = other;
  while (number == other || number == 0) number = static_cast<std::uint32_t>(chance_64());
  return number;
}

namespace {

constexpr std::uint64_t kMsPer_s = 1000;
constexpr std::uint32_t kSecondsPerMinute = 60;
constexpr int kBelowShown = 40;  ///< bits of a digest below the three bytes that an event shows: more have no room

std::uint64_t seconds_until(std::uint64_t until_ms, std::uint64_t now_ms) {
  return until_ms <= now_ms ? 0 : (until_ms - now_ms + kMsPer_s - 1) / kMsPer_s;
}

/// Where that host is; null: nowhere.
auto* place_of(auto& places, std::uint64_t key) {
  const auto its = std::find_if(places.begin(), places.end(),
                                [key](const auto& armed) { return armed.until_ms != 0 && armed.host.key == key; });
  return its == places.end() ? nullptr : &*its;
}

ArmAnswer arm_refused(UnitError error, std::uint16_t wait_s = 0) {
  ArmAnswer answer;
  answer.error = error;
  answer.wait_s = wait_s;
  return answer;
}

}  // namespace

ArmAnswer Arming::begin(const ArmShare& arm, HostSession& session, std::string_view serial_number,
                        const std::string& origin, std::uint64_t now_ms) {
  session.exchange.reset();
  if (arm.minutes == 0 || arm.minutes > kMostArmed_min) return session.arming = arm_refused(UnitError::bad_argument);
  if (const auto wait = wait_s(origin, now_ms); wait > 0)
    return session.arming = arm_refused(UnitError::too_many_codes, wait);
  if (!may_exchange(origin, now_ms)) return session.arming = arm_refused(UnitError::busy);
  const ExchangeTerms terms = exchange_terms(code_.code, serial_number, session.id, arm.minutes);
  const HalfExchange own = half_exchange(terms);
  const auto key = shared_key(terms, End::unit, own, arm.share);
  if (!key) return session.arming = arm_refused(UnitError::wrong_key);
  ArmAnswer answer;
  answer.share = own.share;
  ArmAnswer if_right = answer;
  if_right.confirmation = confirmation_of(terms, End::unit, *key, own.share);
  if_right.armed_s = arm.minutes * kSecondsPerMinute;
  session.exchange = ArmExchange{confirmation_of(terms, End::host, *key, arm.share), secret_from(*key), if_right};
  return session.arming = answer;
}

ArmAnswer Arming::confirm(const ArmConfirm& arm, HostSession& session, const std::string& origin,
                          std::uint64_t now_ms) {
  const auto exchange = std::exchange(session.exchange, std::nullopt);
  if (!exchange) return session.arming;
  if (const auto wait = wait_s(origin, now_ms); wait > 0)
    return session.arming = arm_refused(UnitError::too_many_codes, wait);
  if (!same(arm.confirmation, exchange->expected)) {
    count_wrong(origin, now_ms);
    return session.arming = arm_refused(UnitError::wrong_code, wait_s(origin, now_ms));
  }
  origin_of(origin).wrong_in_a_row = 0;
  wrong_in_all_ = 0;
  Armed* const its = place_of(armed_, session.host.key);
  Armed& place =
      its != nullptr ? *its : *std::min_element(armed_.begin(), armed_.end(), [](const Armed& a, const Armed& b) {
        return a.until_ms < b.until_ms;
      });
  place = {session.host, exchange->secret, now_ms + exchange->if_right.armed_s * kMsPer_s};
  return session.arming = exchange->if_right;
}

Arming::Origin& Arming::origin_of(const std::string& origin) {
  if (origins_.size() >= kOrigins && origins_.find(origin) == origins_.end())
    origins_.erase(std::min_element(origins_.begin(), origins_.end(), [](const auto& a, const auto& b) {
      return a.second.until_ms < b.second.until_ms;
    }));
  return origins_[origin];
}

bool Arming::may_exchange(const std::string& origin, std::uint64_t now_ms) {
  if (!needs_code()) return true;
  Origin& its = origin_of(origin);
  const double passed_s =
      static_cast<double>(now_ms - std::min(now_ms, its.counted_ms)) / static_cast<double>(kMsPer_s);
  its.exchanges_left = std::min(kMostExchanges, its.exchanges_left + kExchangesASecond * passed_s);
  its.counted_ms = now_ms;
  if (its.exchanges_left < 1.0) return false;
  its.exchanges_left -= 1.0;
  return true;
}

void Arming::count_wrong(const std::string& origin, std::uint64_t now_ms) {
  Origin& its = origin_of(origin);
  const unsigned doublings = std::min(its.wrong_in_a_row++, 6U);
  its.until_ms = now_ms + kMsPer_s * std::min<std::uint64_t>(std::uint64_t{1} << doublings, kLongestWait_s);
  if (++wrong_in_all_ < kMostWrongCodes) return;
  if (code_.fixed) {
    all_closed_until_ms_ = now_ms + kMsPer_s * kSecondsPerMinute;
    return;
  }
  code_.code = code_by_chance();
  code_changed_ = true;
  wrong_in_all_ = 0;
}

std::optional<std::string> Arming::take_new_code() {
  return std::exchange(code_changed_, false) ? std::optional(code_.code) : std::nullopt;
}

void Arming::disarm(const HostSession& session) {
  if (Armed* const its = place_of(armed_, session.host.key)) *its = {};
}

std::uint32_t Arming::left_s(const HostSession& session, std::uint64_t now_ms) const {
  const Armed* const its = place_of(armed_, session.host.key);
  return its == nullptr ? 0 : static_cast<std::uint32_t>(seconds_until(its->until_ms, now_ms));
}

std::optional<Secret> Arming::key_of(const HostSession& session, std::uint64_t now_ms) const {
  const Armed* const its = place_of(armed_, session.host.key);
  if (its == nullptr || its->until_ms <= now_ms) return std::nullopt;
  return session_key(its->secret, session.id, session.nonce);
}

std::uint16_t Arming::wait_s(const std::string& origin, std::uint64_t now_ms) const {
  const auto its = origins_.find(origin);
  const std::uint64_t until_ms = std::max(all_closed_until_ms_, its == origins_.end() ? 0 : its->second.until_ms);
  return static_cast<std::uint16_t>(seconds_until(until_ms, now_ms));
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
  origins_.clear();
  wrong_in_all_ = 0;
  all_closed_until_ms_ = 0;
}

namespace {

bool same_but_for_time(const HostEvent& a, const HostEvent& b) {
  return a.starts == b.starts && a.code == b.code && a.error == b.error && a.state == b.state && a.host == b.host &&
         a.text == b.text;
}

}  // namespace

std::uint32_t EventList::add(HostEvent event, bool armed) {
  const auto newest =
      std::find_if(events_.rbegin(), events_.rend(), [&](const Kept& kept) { return kept.armed == armed; });
  if (newest != events_.rend() && same_but_for_time(newest->event, event) &&
      newest->event.times < std::numeric_limits<std::uint16_t>::max()) {
    event.number = newest->event.number;
    event.times = static_cast<std::uint16_t>(newest->event.times + 1);
    newest->event = std::move(event);
    return newest->event.number;
  }
  event.number = ++newest_;
  events_.push_back({std::move(event), armed});
  const auto stranger = [](const Kept& kept) { return !kept.armed; };
  const auto strangers = static_cast<std::size_t>(std::count_if(events_.begin(), events_.end(), stranger));
  if (strangers > kKeptOfStrangers)
    events_.erase(std::find_if(events_.begin(), events_.end(), stranger));
  else if (events_.size() > kKeptEvents)
    events_.pop_front();
  return newest_;
}

void EventList::settle(std::uint32_t number, CommandState state, UnitError error) {
  for (Kept& kept : events_) {
    if (kept.event.number != number) continue;
    kept.event.state = state;
    kept.event.error = error;
  }
}

EventPage EventList::page(std::uint32_t first) const {
  EventPage page;
  page.newest = newest_;
  std::size_t place = 0;
  for (const Kept& kept : events_)
    if (kept.event.number >= first && place < page.events.size()) page.events[place++] = kept.event;
  return page;
}

std::string minutes_in_words(std::uint32_t seconds) { return fmt::format("{} min", seconds / kSecondsPerMinute); }

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
      if (command.staging_from == StagingFrom::kept) return "over the inactive map";
      return command.staging_from == StagingFrom::active ? "based on the active map" : "";
    case CommandCode::commit_staged:
      return fmt::format("{} bytes, SHA {:06x}", command.length, command.digest >> kBelowShown);
    case CommandCode::test_datum:
    case CommandCode::record_datum:
      return std::string(1, letter_of(command.axis));
    case CommandCode::run_user_software:
      return fmt::format("0x{:06X}", command.address);
    case CommandCode::select_tool:
    case CommandCode::remove_tool:
      return command.tool == 0 ? "0 (none)" : fmt::format("{}", command.tool);
    case CommandCode::try_squareness:
      return fmt::format("C0Y {:.6g}, B0Z {:.6g}, A0Z {:.6g}", command.squareness_um_per_m[0],
                         command.squareness_um_per_m[1], command.squareness_um_per_m[2]);
    case CommandCode::commit_tools:
      return fmt::format("{} tools, SHA {:06x}", command.length, command.digest >> kBelowShown);
    case CommandCode::set_tool:
    case CommandCode::stage_tool:
      return fmt::format("{}: {:.6g} {:.6g} {:.6g}", command.tool, command.tool_offset_mm[0], command.tool_offset_mm[1],
                         command.tool_offset_mm[2]);
    case CommandCode::arm:
      return "ended by the host";
    default:
      return {};
  }
}

}  // namespace ecs::protocol
