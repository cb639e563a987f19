// Memory in bulk: read in checked pieces, written through the window; a map sent whole or not at all, and of it only
// what the unit does not hold yet; its commit: given once, and afterwards the unit itself says which map is active.
#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "base/file.hpp"
#include "core/memory_image.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {
namespace {

/// Rounds of sending what is missing that may pass without one block arriving.
constexpr int kFruitlessRounds = 3;

/// Tells how far a transfer is. The time left follows from the speed on the wire, where coded bytes are short.
class Meter {
 public:
  Meter(const Link& link, const ProgressCallback& callback, std::size_t bytes, std::size_t wire)
      : link_(link), callback_(callback), bytes_(bytes), wire_(wire), begun_(link.now()) {}
  void reach(std::size_t done, std::size_t wire) {
    if (!callback_) return;
    const std::chrono::duration<double> spent = link_.now() - begun_;
    const std::size_t left = wire_ - std::min(wire, wire_);
    callback_({std::min(done, bytes_), bytes_,
               spent.count() * static_cast<double>(left) / static_cast<double>(std::max<std::size_t>(wire, 1))});
  }

 private:
  const Link& link_;
  const ProgressCallback& callback_;
  std::size_t bytes_;
  std::size_t wire_;
  HostLine::Clock::time_point begun_;
};

Registers registers_of(const WindowOpen& window, const BlockFrame& frame, const std::optional<Secret>& key) {
  Registers registers(kBlockHeaderRegisters, 0);
  registers[0] = window.tag();
  registers[1] = frame.number;
  Registers payload = packed(frame.payload);
  put_check(registers, block_check(key, window, frame.number,
                                   window.coded ? unpacked(payload, 2 * payload.size()) : frame.payload));
  registers.insert(registers.end(), payload.begin(), payload.end());
  return registers;
}

using Image = std::span<const std::uint8_t>;

/// The image is compared with what the unit holds in pieces of this many bytes.
constexpr std::size_t kPieceBytes = 600;
/// Checks in one request: the unit looks at no more than 16 384 bytes for one, so that its loop waits for none.
constexpr std::size_t kPiecesAtOnce = std::min(kMostChecks, std::size_t{16'384} / kPieceBytes);
/// A share of the pieces from which on the rest is sent without looking for more: asking costs as much as a piece.
constexpr double kNearlyAll = 0.8;

/// Where a map is staged while that bank is active.
Address inactive_bank_beside(Bank active) { return active == Bank::A ? kBankB.first : kBankA.first; }

Problem wrong_bank(Address named, const ActiveMap& before) {
  return {ProblemKind::link,
          fmt::format("the unit gives 0x{:06X} as the address for the map, expected 0x{:06X}, the inactive bank; "
                      "another host uses the unit, or its answers are wrong. Not written",
                      named, inactive_bank_beside(before.active_bank)),
          {},
          0,
          0,
          {}};
}

/// The stretches of the image whose pieces the unit does not hold.
std::vector<std::pair<std::size_t, std::size_t>> missing_stretches(const std::vector<bool>& held, std::size_t bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> stretches;
  for (std::size_t piece = 0; piece < held.size(); ++piece) {
    if (held[piece]) continue;
    const std::size_t from = piece * kPieceBytes, to = std::min(from + kPieceBytes, bytes);
    if (!stretches.empty() && stretches.back().second == from)
      stretches.back().second = to;
    else
      stretches.emplace_back(from, to);
  }
  return stretches;
}

std::size_t count_of(const std::vector<bool>& held) {
  return static_cast<std::size_t>(std::count(held.begin(), held.end(), true));
}

}  // namespace

Result<std::vector<std::uint8_t>> UnitClient::read_piece(Address address, std::size_t bytes) {
  const std::size_t check = key_ ? kKeyedCheckRegisters : 0;
  const Block answer{kMemory.first, static_cast<std::uint16_t>(kMemoryHeaderRegisters + (bytes + 1) / 2 + check)};
  ECS_TRY(asked, ask_sealed(
                     kReadSelect,
                     [&](const Asker& who) {
                       return registers_of(ReadSelect{address, static_cast<std::uint16_t>(bytes), who}, 0);
                     },
                     answer));
  ECS_TRY(head, value_in<MemoryHead>(asked.registers));
  auto held = unpacked(std::span(asked.registers).subspan(kMemoryHeaderRegisters), bytes);
  if (!asked.believed) return problem(ProblemKind::link, fmt::format("memory at {:06X}: {}", address, kNotSealed));
  if (head.address != address || head.crc != crc32_of(held))
    return problem(
        ProblemKind::link,
        fmt::format("memory at {:06X}: the unit's reply does not agree with its CRC; read it again", address));
  return held;
}

Result<std::vector<std::uint8_t>> UnitClient::read_memory(Address address, std::size_t bytes,
                                                          const ProgressCallback& progress) {
  Meter meter(link_, progress, bytes, bytes);
  std::vector<std::uint8_t> memory;
  memory.reserve(bytes);
  while (memory.size() < bytes) {
    const std::size_t size = std::min(key_ ? kKeyedMemoryBytes : kMemoryBytes, bytes - memory.size());
    ECS_TRY(piece, read_piece(static_cast<Address>(address + memory.size()), size));
    memory.insert(memory.end(), piece.begin(), piece.end());
    meter.reach(memory.size(), memory.size());
  }
  return memory;
}

/// Opens the window, or finds it open: the same one again changes nothing, and one that a late frame has replaced is
/// opened again.
Result<WindowAck> UnitClient::ask_ack(const WindowOpen& asked) {
  WindowOpen window = asked;
  window.asker.challenge = ++challenge_;
  ECS_TRY(registers,
          link_.ask(kWindowOpen, sealed(protocol::registers_of(window, 0), Keyed::window, key_), kWindowAck));
  auto ack = value_in<WindowAck>(registers);
  if (!ack) return ack;
  const bool ours = ack->number == window.number && ack->address == window.address && ack->length == window.length;
  if (!ours) ack->error = UnitError::token_expired;
  const bool believed = !key_ || is_sealed(registers, kWindowAck, window.asker.challenge);
  const bool says_why = ack->error == UnitError::session_unknown || ack->error == UnitError::not_armed;
  if (!believed && !says_why) ack->error = UnitError::wrong_key;
  window_refusal_ = ack->error;
  if (ack->error == UnitError::session_unknown) session_ = 0;
  if (ack->error == UnitError::not_armed) wants_code_ = true;
  if (ack->error == UnitError::check_mismatch)
    return problem(
        ProblemKind::link,
        fmt::format("memory at {:06X}: the unit accepts no more blocks here, because several had a wrong check: "
                    "another program writes on this link, or the line corrupts data. Check both, then send again",
                    window.address));
  if (ack->error != UnitError::none)
    return problem(ProblemKind::refused, fmt::format("memory at {:06X}: the unit refuses to write: {}", window.address,
                                                     reason_of(ack->error)));
  return ack;
}

/// Sends the frames of which blocks have not arrived. A frame whose reply fails may have arrived, and one that the unit
/// does not take has its reason: the next acknowledgement tells.
Result<void> UnitClient::send_missing(const WindowOpen& window, const WindowFrames& frames, std::uint64_t received,
                                      const FrameCallback& sent) {
  int failures_in_a_row = 0;
  for (const BlockFrame& frame : frames.frames) {
    if ((frame.blocks & ~received) == 0) continue;
    const auto written = link_.write_once(kBlockWrite.first, registers_of(window, frame, key_));
    if (!written && link_.last_failure() == LinkFailure::exception) return {};
    failures_in_a_row = written ? 0 : failures_in_a_row + 1;
    const bool hopeless = link_.cancelled() || !link_.connected() || failures_in_a_row >= link_.timing().tries;
    if (!written && hopeless) return tl::unexpected(written.error());
    if (written) sent(frame);
    if (!written && frames.coded) return {};  // what follows is decoded after this one
  }
  return {};
}

/// Where the time of the arming ends meanwhile and the code is known, or another program of this host arms it again,
/// and where a block of somebody else has closed the window, it is sent again under another number.
Result<void> UnitClient::write_window(const WindowFrames& frames, const FrameCallback& sent) {
  constexpr int kMostWindows = 4;
  for (int windows = 1;; ++windows) {
    window_refusal_ = UnitError::none;
    auto done = fill_window(frames, sent);
    const bool of_arming = window_refusal_ == UnitError::wrong_key ||
                           (window_refusal_ == UnitError::not_armed && (knows_code() || secrets_));
    if (done || windows == kMostWindows || !(of_arming || window_refusal_ == UnitError::check_mismatch)) return done;
    if (!of_arming) continue;
    const std::uint32_t session = session_;
    ECS_DO(armed_session());
    if (session_ != session || !key_) return done;
  }
}

Result<void> UnitClient::fill_window(const WindowFrames& frames, const FrameCallback& sent) {
  const WindowOpen window{++window_number_,
                          frames.address,
                          static_cast<std::uint32_t>(frames.bytes.size()),
                          in_axis_memory(frames.address) ? token_ : 0,
                          frames.coded,
                          {session_, 0}};
  const std::size_t blocks = blocks_in(window.length, window.block_bytes());
  auto ack = ask_ack(window);
  int fruitless = 0;
  while (ack && static_cast<std::size_t>(std::popcount(ack->received)) < blocks) {
    ECS_DO(send_missing(window, frames, ack->received, sent));
    const auto before = ack->received;
    ack = ask_ack(window);
    fruitless = ack && ack->received == before ? fruitless + 1 : 0;
    if (fruitless >= kFruitlessRounds)
      return problem(ProblemKind::link,
                     fmt::format("memory at {:06X}: the unit answers, but accepts no block", frames.address));
  }
  if (!ack) return tl::unexpected(ack.error());
  if (ack->crc != crc32_of(frames.bytes))
    return problem(ProblemKind::link,
                   fmt::format("memory at {:06X} differs from the written data; run the RAM test", frames.address));
  return {};
}

Result<void> UnitClient::write_memory(Address address, std::span<const std::uint8_t> bytes,
                                      const ProgressCallback& progress) {
  if (bytes.empty()) return {};
  if (!in_axis_memory(address))  // begin staging has armed the session otherwise
    ECS_DO(armed_session());
  Meter meter(link_, progress, bytes.size(), bytes.size());
  for (std::size_t at = 0; at < bytes.size(); at += kWindowBytes) {
    const auto part = bytes.subspan(at, std::min(kWindowBytes, bytes.size() - at));
    std::size_t done = at;
    const auto reach = [&](std::size_t bytes_done) {
      done = bytes_done;
      meter.reach(done, done);
    };
    ECS_DO(write_window(plain_window(static_cast<Address>(address + at), part),
                        [&](const BlockFrame& frame) { reach(done + frame.bytes); }));
    reach(at + part.size());
  }
  ECS_TRY(crc, check_memory(address, static_cast<std::uint32_t>(bytes.size())));
  if (crc != crc32_of(bytes))
    return problem(ProblemKind::link,
                   fmt::format("memory at {:06X} differs from the written data; run the RAM test", address));
  return {};
}

Address address_of(Bank bank) { return bank == Bank::B ? kBankB.first : kBankA.first; }

/// Which pieces of the image lie at `bank` already, by their keyed checks.
Result<std::vector<bool>> UnitClient::held_at(Address bank, Image image) {
  const std::size_t pieces = (image.size() + kPieceBytes - 1) / kPieceBytes;
  std::vector<bool> held;
  while (held.size() < pieces) {
    const std::size_t at = held.size() * kPieceBytes;
    const std::size_t count = std::min(kPiecesAtOnce, pieces - held.size());
    const auto length = static_cast<std::uint32_t>(std::min(count * kPieceBytes, image.size() - at));
    const Block answer{kChecks.first, static_cast<std::uint16_t>(1 + kKeyedCheckRegisters * (count + 1))};
    ECS_TRY(asked, ask_sealed(
                       kCheckSelect,
                       [&](const Asker& who) {
                         return protocol::registers_of(CheckSelect{who, static_cast<Address>(bank + at), length,
                                                                   static_cast<std::uint16_t>(kPieceBytes)},
                                                       0);
                       },
                       answer));
    if (!asked.believed || !key_) return problem(ProblemKind::link, fmt::format("checks of memory: {}", kNotSealed));
    const std::span<const std::uint16_t> found(asked.registers);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t from = held.size() * kPieceBytes;
      const auto piece = image.subspan(from, std::min(kPieceBytes, image.size() - from));
      held.push_back(check_at_end(found.first(1 + kKeyedCheckRegisters * (i + 1))) ==
                     piece_check(*key_, static_cast<Address>(bank + from), piece));
    }
  }
  return held;
}

/// Where the staging begins: the active map, or what an earlier transfer has left, whichever has more of the image.
/// What was left is not asked for where the active map has nearly all.
Result<UnitClient::Beginning> UnitClient::beginning_for(const ActiveMap& before, Image image, Held by) {
  if (!key_) ECS_DO(armed_session());
  if (by == Held::nothing || !key_)
    return Beginning{StagingFrom::cleared, std::vector<bool>((image.size() + kPieceBytes - 1) / kPieceBytes)};
  Beginning beginning{StagingFrom::active, {}};
  if (before.active_bank != Bank::none) {
    ECS_TRY(active, held_at(address_of(before.active_bank), image));
    beginning.held = std::move(active);
    if (kNearlyAll * static_cast<double>(beginning.held.size()) <= static_cast<double>(count_of(beginning.held)))
      return beginning;
  }
  ECS_TRY(left, held_at(inactive_bank_beside(before.active_bank), image));
  if (beginning.held.empty() || count_of(left) >= count_of(beginning.held))
    beginning = {StagingFrom::kept, std::move(left)};
  return beginning;
}

Result<void> UnitClient::stage(Address address, Image image, const std::vector<bool>& held,
                               const ProgressCallback& progress, UploadReport& report) {
  std::vector<WindowFrames> windows;
  std::size_t missing = 0, wire = 0;
  for (const auto& [from, to] : missing_stretches(held, image.size())) {
    for (WindowFrames& window : windows_of(address, image, from, to)) windows.push_back(std::move(window));
    missing += to - from;
  }
  for (const WindowFrames& window : windows) wire += wire_bytes(window);
  report.bytes_sent = missing;
  Meter meter(link_, progress, image.size(), wire);
  std::size_t done = image.size() - missing, on_wire = 0;
  for (const WindowFrames& window : windows) {
    std::size_t brought = 0, bytes = 0;
    const auto sent = [&](const BlockFrame& frame) {
      brought = std::min(brought + frame.bytes, window.bytes.size());
      bytes += frame.payload.size();
      meter.reach(done + brought, on_wire + std::min(bytes, wire_bytes(window)));
    };
    ECS_DO(write_window(window, sent));
    done += window.bytes.size();
    on_wire += wire_bytes(window);
    meter.reach(done, on_wire);
  }
  meter.reach(image.size(), wire);
  return {};
}

Result<UploadReport> UnitClient::upload_image(Image image, const ProgressCallback& progress, Held held) {
  // Armed first: an answer that anybody can give says nothing of the map that is active.
  if (!key_ && (knows_code() || secrets_)) ECS_DO(armed_session());
  sends_armed_ = sends_armed_ || key_;
  ECS_TRY(before, active_map());
  const SentImage sent{image, digest_of(image)};
  UploadReport report{image.size(), 0, before.commit_sequence, true};
  if (held == Held::by_checks && key_ && before.digest == sent.digest) {
    if (progress) progress({image.size(), image.size(), 0.0});
    return report;
  }
  const auto beginning = beginning_for(before, image, held);
  if (!beginning) return tl::unexpected(given_up(beginning.error(), before));
  const auto address = begin_staging(beginning->from);
  if (!address) return tl::unexpected(given_up(address.error(), before));
  // With a kept secret alone, an answer that nobody sealed has left this host without a key until now.
  sends_armed_ = sends_armed_ || key_;
  if (*address != inactive_bank_beside(before.active_bank))
    return tl::unexpected(given_up(wrong_bank(*address, before), before));
  if (auto staged = stage(*address, image, beginning->held, progress, report); !staged)
    return tl::unexpected(given_up(std::move(staged.error()), before));
  if (auto still = nothing_else_committed(before); !still)
    return tl::unexpected(given_up(std::move(still.error()), before));
  ECS_TRY(committed, commit_staged(before, sent));
  report.commit_sequence = committed;
  report.already_held = false;
  return report;
}

namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kCommitLimit = 60s;  ///< checking and switching a whole bank
constexpr std::chrono::milliseconds kIdleLimit = 5s;
constexpr std::chrono::milliseconds kIdlePoll = 200ms;
constexpr std::string_view kHowToFindOut =
    "`ecs map verify` compares the unit with a map, `ecs utility status` shows the commit";

std::string another_is_active(const ActiveMap& now) {
  return fmt::format(
      "the active map has changed ({} bytes, commit no. {}): another host uses the unit, or another unit is on this "
      "link "
      "now; compare before compensating",
      now.image_length_bytes, now.commit_sequence);
}

std::string not_taken(const ActiveMap& before) {
  if (before.active_bank == Bank::none) return "; the unit contains no map, as before";
  return fmt::format("; the unit has stored nothing of the new map, and the old map is active (commit no. {})",
                     before.commit_sequence);
}

std::string unknown_after(const ActiveMap& before) {
  return fmt::format(
      "; the commit was sent, but no reply was received: it is not known which map is active. The unit may have "
      "accepted the new map (commit no. {} was active before); {}",
      before.commit_sequence, kHowToFindOut);
}

}  // namespace

Result<ActiveMap> UnitClient::active_map() {
  ECS_TRY(asked, ask_sealed(
                     kEcho, [](const Asker& who) { return protocol::registers_of(EchoAsk{who}, 0); }, kActiveMap));
  if (!asked.believed) return problem(ProblemKind::link, fmt::format("active map: {}", kNotSealed));
  auto now = value_in<ActiveMap>(asked.registers);
  if (now && serial_number_.empty()) serial_number_ = now->serial_number;
  if (!now || now->serial_number == serial_number_) return now;
  return problem(ProblemKind::link, fmt::format("unit {} answers on this link now, unit {} did before",
                                                now->serial_number, serial_number_));
}

/// The same once no command is under way; a problem if one stays busy.
Result<ActiveMap> UnitClient::active_map_when_idle() {
  if (!link_.connected()) ECS_DO(link_.reconnect());
  const auto until = link_.now() + kIdleLimit;
  for (;;) {
    ECS_TRY(result, result_now());
    if (result.state != CommandState::busy) return active_map();
    if (link_.now() >= until || !link_.pause(kIdlePoll))
      return problem(ProblemKind::link, "another command of the unit does not finish");
  }
}

/// A commit was given and it was not answered with `done`: the unit itself says what became of it. One that is still on
/// its way does nothing after an abandon that the unit has answered, so "not taken" is what it says after that.
Result<std::uint32_t> UnitClient::settled(const ActiveMap& before, const SentImage& sent, Problem why, bool cancelled) {
  auto now = active_map_when_idle();
  if (now && now->commit_sequence == before.commit_sequence) now = abandoned();
  const bool changed = now && now->commit_sequence != before.commit_sequence;
  const bool ours = changed && now->digest == sent.digest;
  const bool other_unit = !now && link_.last_failure() == LinkFailure::none;
  if (!now)
    why.message += (other_unit ? "; " + now.error().message : std::string()) + unknown_after(before);
  else if (!changed)
    why.message += not_taken(before);
  else if (!ours)
    why.message += "; " + another_is_active(*now);
  else if (cancelled)
    why.message +=
        fmt::format("; the unit had already accepted the new map: it is active (commit no. {})", now->commit_sequence);
  else if (why.kind == ProblemKind::refused)
    why.message +=
        fmt::format("; another host has sent the same map: it is active (commit no. {})", now->commit_sequence);
  else
    return now->commit_sequence;
  return tl::unexpected(std::move(why));
}

/// The unit has answered that what was committed is active. Whether it still is, at the end of this link: another host
/// or another unit may have come between.
Result<std::uint32_t> UnitClient::confirmed(std::uint32_t commit, const SentImage& sent) {
  const auto in_doubt = [&](const Problem& why) {
    return problem(ProblemKind::link,
                   fmt::format("the unit has accepted the new map, and it is active (commit no. {}); it "
                               "could not be checked afterwards: {}; {}",
                               commit, why.message, kHowToFindOut));
  };
  const auto now = active_map();
  if (!now) return in_doubt(now.error());
  if (now->commit_sequence == commit && now->digest == sent.digest) return commit;
  return problem(ProblemKind::link, "the commit was answered as done, but " + another_is_active(*now));
}

/// This unit and its active map are those of the beginning of the transfer.
Result<void> UnitClient::nothing_else_committed(const ActiveMap& before) {
  ECS_TRY(now, active_map());
  if (now.commit_sequence == before.commit_sequence && now.active_bank == before.active_bank) return {};
  return problem(ProblemKind::refused, "another host has sent a map in the meantime; this transfer changed nothing");
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
        "; this transfer changed nothing, but it could not be cancelled; the old map is active unless another host has "
        "sent one";
  else if (now->commit_sequence != before.commit_sequence)
    why.message += "; " + another_is_active(*now);
  else if (!key_)  // anybody can have answered
    why.message += before.active_bank == Bank::none
                       ? "; this transfer changed nothing; the unit contains no map unless another host has sent one"
                       : "; this transfer changed nothing; the old map is active unless another host has sent one";
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
                   .digest = short_digest(sent.digest),
                   .token = token_},
                  kCommitLimit);
  const bool cancelled = link_.cancelled();
  link_.heed_cancel(false);  // what follows is short and says which map is active
  auto ending = done ? confirmed(done->value, sent) : settled(before, sent, std::move(done.error()), cancelled);
  link_.heed_cancel(true);
  return ending;
}

}  // namespace ecs::protocol
