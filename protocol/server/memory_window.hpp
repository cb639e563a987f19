// The unit's side of a bulk write: numbered blocks of one stretch of memory, in any order, each checked by itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/block_code.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

class UnitPort;

/// Wrong checks of blocks that close a window. The CRC of the line keeps out all but 1 in 65,536 spoilt frames, so a
/// block that is wrong within a right frame is rare and three in one window are no noise; a stranger finds the check of
/// a block with a chance of 1 in 65,536 a try.
inline constexpr unsigned kMostWrongChecks = 3;

/// Assembles blocks into the memory of a unit. Blocks may come twice or out of order; one that is not intact, not of
/// this window or beyond its end is not taken. Memory is only written inside the stretch that the unit agreed to.
class MemoryWindow {
 public:
  explicit MemoryWindow(UnitPort& unit) : unit_(&unit) {}

  /// From now on axis memory is written only under this token; the window that is open ends, acknowledged as
  /// `token_expired`. 0: nothing is staged.
  void stage_under(std::uint32_t token);
  [[nodiscard]] std::uint32_t token() const { return token_; }
  [[nodiscard]] std::uint32_t session() const { return window_.session; }
  [[nodiscard]] const WindowOpen& window() const { return window_; }
  [[nodiscard]] UnitError error() const { return error_; }

  /// Starts a window; the tag that is already open changes nothing. A stretch that may not be written, or not under
  /// this token, leaves the window closed with the reason in ack().error.
  /// @return false: it was open, or refused, already
  bool open(const WindowOpen& window);
  /// The window that was opened last is closed for this reason.
  void refuse(UnitError why);

  /// One frame: tag, number, check, payload. In a coded window it brings several blocks, taken all or not at all, and
  /// none before those below them. False: not taken. The kMostWrongChecks-th wrong check closes the window,
  /// acknowledged as `check_mismatch`; what it has brought stays in memory.
  [[nodiscard]] bool take(std::span<const std::uint16_t> registers);

  [[nodiscard]] WindowAck ack() const;

 private:
  [[nodiscard]] bool take_coded(std::uint16_t number, std::span<const std::uint8_t> code);
  [[nodiscard]] bool put(std::size_t offset, std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::uint64_t all_blocks() const;

  UnitPort* unit_;
  std::uint32_t token_ = 0;  ///< of the staging; 0: none
  WindowOpen window_;
  UnitError error_ = UnitError::none;
  std::uint64_t received_ = 0;
  unsigned wrong_checks_ = 0;  ///< of blocks of this window
  std::array<std::uint8_t, block_code::kHistoryBytes + kCodedBlocksInFrame * kCodedBlockBytes> decoded_{};
};

}  // namespace ecs::protocol
