// The commit of a map: given once, and afterwards the unit itself says which map is active.
#include <fmt/format.h>

#include "core/memory_image.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kCommitLimit = 60s;  ///< checking and switching a whole bank
constexpr std::chrono::milliseconds kIdleLimit = 5s;
constexpr std::chrono::milliseconds kIdlePoll = 200ms;
constexpr std::string_view kHowToFindOut =
    "`ecs map verify` compares the unit with a map, `ecs utility status` names the commit";

std::string another_is_active(const ActiveMap& now) {
  return fmt::format(
      "the active map is another one ({} bytes, commit {}): another host uses the unit, or another unit is on this "
      "link now; compare before compensating",
      now.image_length_bytes, now.commit_sequence);
}

std::string not_taken(const ActiveMap& before) {
  if (before.active_bank == Bank::none) return "; the unit has not taken the map: it holds none, as before";
  return fmt::format("; the unit has not taken the new map: the old map is active (commit {})", before.commit_sequence);
}

std::string unknown_after(const ActiveMap& before) {
  return fmt::format(
      "; the commit had been sent and its reply did not come: it is not known which map is active, the unit may have "
      "taken the new map (commit {} was active before); {}",
      before.commit_sequence, kHowToFindOut);
}

}  // namespace

Result<ActiveMap> UnitClient::active_map() {
  auto now = link_.ask(kEcho, Registers{0}, kActiveMap).and_then(value_in<ActiveMap>);
  if (now && serial_number_.empty()) serial_number_ = now->serial_number;
  if (!now || now->serial_number == serial_number_) return now;
  return problem(ProblemKind::link, fmt::format("unit {} answers on this link now, unit {} did before",
                                                now->serial_number, serial_number_));
}

/// The same once no command is under way; a problem if one stays busy.
Result<ActiveMap> UnitClient::active_map_when_idle() {
  if (!link_.connected()) ECS_DO(link_.reconnect());
  const auto until = std::chrono::steady_clock::now() + kIdleLimit;
  for (;;) {
    ECS_TRY(result, result_now());
    if (result.state != CommandState::busy) return active_map();
    if (std::chrono::steady_clock::now() >= until || !link_.pause(kIdlePoll))
      return problem(ProblemKind::link, "another command of the unit does not end");
  }
}

/// The active image is this one: by length, and by the block check that the unit computes over it.
/// An image that is not sound has none that could tell.
bool UnitClient::names(const ActiveMap& now, std::span<const std::uint8_t> image) {
  if (now.active_bank == Bank::none || now.image_length_bytes != image.size()) return false;
  const ImageVerdict verdict = check_image(image);
  return verdict.fault == ImageFault::none && verdict.total_bytes == image.size() &&
         now.block_check_expected == verdict.check_found && now.block_check_found == verdict.check_found;
}

/// Whether the active map is the one sent: its sequence alone does not tell whose it is.
Result<bool> UnitClient::holds(const ActiveMap& now, const SentImage& sent) {
  if (names(now, sent.bytes)) return true;
  if (now.active_bank == Bank::none || now.image_length_bytes != sent.bytes.size()) return false;
  return check_memory(address_of(now.active_bank), static_cast<std::uint32_t>(sent.bytes.size()))
      .map([&](std::uint32_t found) { return found == sent.crc; });
}

/// A commit was given and it was not answered with `done`: the unit itself says what became of it. One that is still on
/// its way does nothing after an abandon that the unit has answered, so "not taken" is what it says after that.
Result<std::uint32_t> UnitClient::settled(const ActiveMap& before, const SentImage& sent, Problem why, bool cancelled) {
  auto now = active_map_when_idle();
  if (now && now->commit_sequence == before.commit_sequence) now = abandoned();
  const bool changed = now && now->commit_sequence != before.commit_sequence;
  const auto ours = changed ? holds(*now, sent) : Result<bool>(false);
  const bool other_unit = !now && link_.last_failure() == LinkFailure::none;
  if (!now || !ours)
    why.message += (other_unit ? "; " + now.error().message : std::string()) + unknown_after(before);
  else if (!changed)
    why.message += not_taken(before);
  else if (!*ours)
    why.message += "; " + another_is_active(*now);
  else if (cancelled)
    why.message +=
        fmt::format("; the unit had already taken the new map: it is active (commit {})", now->commit_sequence);
  else if (why.kind == ProblemKind::refused)
    why.message += fmt::format("; another host has sent this very map: it is active (commit {})", now->commit_sequence);
  else
    return now->commit_sequence;
  return tl::unexpected(std::move(why));
}

/// The unit has answered that what was committed is active. Whether it still is, at the end of this link: another host
/// or another unit may have come between.
Result<std::uint32_t> UnitClient::confirmed(std::uint32_t commit, const SentImage& sent) {
  const auto in_doubt = [&](const Problem& why) {
    return problem(ProblemKind::link,
                   fmt::format("the unit has taken the new map, it is active (commit {}); it could not be looked at "
                               "afterwards: {}; {}",
                               commit, why.message, kHowToFindOut));
  };
  const auto now = active_map();
  if (!now) return in_doubt(now.error());
  const auto ours = now->commit_sequence == commit ? holds(*now, sent) : Result<bool>(false);
  if (!ours) return in_doubt(ours.error());
  if (*ours) return commit;
  return problem(ProblemKind::link, "the commit was answered as done, but " + another_is_active(*now));
}

/// This unit and its active map are those of the beginning of the transfer.
Result<void> UnitClient::nothing_else_committed(const ActiveMap& before) {
  ECS_TRY(now, active_map());
  if (now.commit_sequence == before.commit_sequence && now.active_bank == before.active_bank) return {};
  return problem(ProblemKind::refused, "another host has sent a map meanwhile; nothing was committed");
}

/// Takes back what was staged before any commit, even after a cancel, and says which map is active. What the unit has
/// refused needs no taking back: what is staged there now is another host's.
Problem UnitClient::given_up(Problem why, const ActiveMap& before) {
  link_.heed_cancel(false);
  const bool refused = why.kind == ProblemKind::refused;
  const auto now = !link_.connected() ? problem(ProblemKind::link, "") : refused ? active_map() : abandoned();
  link_.heed_cancel(true);
  if (!now)
    why.message +=
        "; nothing was committed, but what was sent could not be abandoned; the old map is active unless "
        "another host has sent one";
  else if (now->commit_sequence != before.commit_sequence)
    why.message += "; " + another_is_active(*now);
  else
    why.message += not_taken(before);
  return why;
}

/// What is staged is dropped: the active map afterwards.
Result<ActiveMap> UnitClient::abandoned() {
  const auto done = abandon_staged();
  if (!done && link_.last_failure() != LinkFailure::none) return tl::unexpected(done.error());
  return active_map();
}

Result<std::uint32_t> UnitClient::commit_staged(const ActiveMap& before, const SentImage& sent) {
  auto done = run({.code = CommandCode::commit_staged,
                   .length = static_cast<std::uint32_t>(sent.bytes.size()),
                   .crc = sent.crc,
                   .token = token_},
                  kCommitLimit);
  const bool cancelled = link_.cancelled();
  link_.heed_cancel(false);  // what follows is short and says which map is active
  auto ending = done ? confirmed(done->value, sent) : settled(before, sent, std::move(done.error()), cancelled);
  link_.heed_cancel(true);
  return ending;
}

}  // namespace ecs::protocol
