#include "protocol/server/arming.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace ecs::protocol {

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

}  // namespace ecs::protocol
