// Memory in bulk: read in checked pieces, written through the window.
#include <algorithm>
#include <bit>
#include <random>

#include <fmt/format.h>

#include "base/file.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "protocol/registers/window_block.hpp"

namespace ecs::protocol {

namespace {

/// Rounds of sending what is missing that may pass without one block arriving.
constexpr int kFruitlessRounds = 3;

/// Tells how far a transfer is and how long it will take at its mean speed so far.
class Meter {
 public:
  Meter(const ProgressCallback& callback, std::size_t total) : callback_(callback), total_(total) {}
  void add(std::size_t bytes) { reach(done_ + bytes); }
  void reach(std::size_t bytes) {
    done_ = std::min(bytes, total_);
    if (!callback_) return;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun_;
    const double share_left =
        static_cast<double>(total_ - done_) / static_cast<double>(std::max<std::size_t>(done_, 1));
    callback_({done_, total_, spent.count() * share_left});
  }

 private:
  const ProgressCallback& callback_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

Registers registers_of(const WindowOpen& window, const BlockFrame& frame) {
  Registers registers{window.tag, frame.number, 0};
  Registers payload = packed(frame.payload);
  registers[2] =
      block_check(window, frame.number, window.coded ? unpacked(payload, 2 * payload.size()) : frame.payload);
  registers.insert(registers.end(), payload.begin(), payload.end());
  return registers;
}

}  // namespace

Result<std::vector<std::uint8_t>> UnitClient::read_piece(Address address, std::size_t bytes) {
  const ReadSelect select{address, static_cast<std::uint16_t>(bytes)};
  const Block answer{kMemory.first, static_cast<std::uint16_t>(kMemoryHeaderRegisters + (bytes + 1) / 2)};
  ECS_TRY(registers, link_.ask(kReadSelect, registers_of(select, 0), answer));
  const auto number_at = [&](std::size_t at) {
    return static_cast<std::uint32_t>(registers[at]) << 16 | registers[at + 1];
  };
  auto held = unpacked(std::span(registers).subspan(kMemoryHeaderRegisters), bytes);
  if (number_at(1) != address || number_at(3) != crc32_of(held))
    return problem(
        ProblemKind::link,
        fmt::format("memory at {:06X}: the unit's reply does not agree with its CRC; read it again", address));
  return held;
}

Result<std::vector<std::uint8_t>> UnitClient::read_memory(Address address, std::size_t bytes,
                                                          const ProgressCallback& progress) {
  Meter meter(progress, bytes);
  std::vector<std::uint8_t> memory;
  memory.reserve(bytes);
  while (memory.size() < bytes) {
    const std::size_t size = std::min(kMemoryBytes, bytes - memory.size());
    ECS_TRY(piece, read_piece(static_cast<Address>(address + memory.size()), size));
    memory.insert(memory.end(), piece.begin(), piece.end());
    meter.add(size);
  }
  return memory;
}

/// Opens the window, or finds it open: the same one again changes nothing, and one that a late frame has replaced is
/// opened anew.
Result<WindowAck> UnitClient::ask_ack(const WindowOpen& window) {
  auto ack = link_.ask(kWindowOpen, registers_of(window, 0), kWindowAck).and_then([](const Registers& block) {
    return window_ack_in(block);
  });
  if (!ack) return ack;
  const bool ours = ack->tag == window.tag && ack->address == window.address && ack->length == window.length;
  if (!ours) ack->error = UnitError::token_expired;
  window_refusal_ = ack->error;
  if (ack->error == UnitError::session_unknown) session_ = 0;
  if (ack->error == UnitError::not_armed) wants_code_ = true;
  if (ack->error == UnitError::check_mismatch)
    return problem(ProblemKind::link,
                   fmt::format("memory at {:06X}: the unit takes no more blocks here, since several came with a wrong "
                               "check: another program writes on this link, or the line changes what it carries. Look "
                               "for both, then send again",
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
    const auto written = link_.write_once(kBlockWrite.first, registers_of(window, frame));
    if (!written && link_.last_failure() == LinkFailure::exception) return {};
    failures_in_a_row = written ? 0 : failures_in_a_row + 1;
    const bool hopeless = link_.cancelled() || !link_.connected() || failures_in_a_row >= link_.timing().tries;
    if (!written && hopeless) return tl::unexpected(written.error());
    if (written) sent(frame);
    if (!written && frames.coded) return {};  // what follows is decoded after this one
  }
  return {};
}

/// Where the time of the arming ends meanwhile and the code is known, the host is armed again and the window sent anew.
Result<void> UnitClient::write_window(const WindowFrames& frames, const FrameCallback& sent) {
  window_refusal_ = UnitError::none;
  auto done = fill_window(frames, sent);
  if (done || window_refusal_ != UnitError::not_armed || !knows_code()) return done;
  const std::uint32_t session = session_;
  ECS_DO(armed_session());
  return session_ == session ? fill_window(frames, sent) : done;
}

Result<void> UnitClient::fill_window(const WindowFrames& frames, const FrameCallback& sent) {
  if (window_tag_ == 0) window_tag_ = static_cast<std::uint16_t>(std::random_device{}());
  if (++window_tag_ == 0) ++window_tag_;
  const WindowOpen window{window_tag_,
                          frames.address,
                          static_cast<std::uint32_t>(frames.bytes.size()),
                          in_axis_memory(frames.address) ? token_ : 0,
                          frames.coded,
                          session_};
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
                     fmt::format("memory at {:06X}: the unit answers, but takes no block", frames.address));
  }
  if (!ack) return tl::unexpected(ack.error());
  if (ack->crc != crc32_of(frames.bytes))
    return problem(ProblemKind::link,
                   fmt::format("memory at {:06X} does not hold what was written; run the RAM test", frames.address));
  return {};
}

Result<void> UnitClient::write_memory(Address address, std::span<const std::uint8_t> bytes,
                                      const ProgressCallback& progress) {
  if (bytes.empty()) return {};
  if (!in_axis_memory(address))  // begin staging has armed the session otherwise
    ECS_DO(armed_session());
  Meter meter(progress, bytes.size());
  for (std::size_t at = 0; at < bytes.size(); at += kWindowBytes) {
    const auto part = bytes.subspan(at, std::min(kWindowBytes, bytes.size() - at));
    ECS_DO(write_window(plain_window(static_cast<Address>(address + at), part),
                        [&](const BlockFrame& frame) { meter.add(frame.bytes); }));
    meter.reach(at + part.size());
  }
  ECS_TRY(crc, check_memory(address, static_cast<std::uint32_t>(bytes.size())));
  if (crc != crc32_of(bytes))
    return problem(ProblemKind::link,
                   fmt::format("memory at {:06X} does not hold what was written; run the RAM test", address));
  return {};
}

}  // namespace ecs::protocol
