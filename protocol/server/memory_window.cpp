// Blocks of a bulk write into the memory of a unit.
#include "protocol/server/memory_window.hpp"

#include <algorithm>
#include <vector>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "protocol/server/register_server.hpp"

namespace ecs::protocol {

namespace {

/// @param count  0 … 64
std::uint64_t bits_below(std::size_t count) {
  return count >= kWindowBlocks ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
}

}  // namespace

bool MemoryWindow::open(const WindowOpen& window) {
  if (window == window_) return false;
  window_ = window;
  received_ = 0;
  wrong_checks_ = 0;
  const bool possible = window.length > 0 && window.length <= kWindowBlocks * window.block_bytes();
  if (window.tag == 0 || !possible || (window.coded && !in_axis_memory(window.address)))
    error_ = UnitError::bad_argument;
  else if (in_axis_memory(window.address) && (window.token == 0 || window.token != token_))
    error_ = UnitError::token_expired;
  else
    error_ = unit_->may_write(window.address, window.length);
  return true;
}

void MemoryWindow::refuse(UnitError why) {
  received_ = 0;
  error_ = why;
}

void MemoryWindow::stage_under(std::uint32_t token) {
  token_ = token;
  received_ = 0;
  error_ = UnitError::token_expired;
}

bool MemoryWindow::take(std::span<const std::uint16_t> registers) {
  if (error_ != UnitError::none || registers.size() < kBlockHeaderRegisters) return false;
  const std::uint16_t tag = registers[0];
  const std::uint16_t number = registers[1];
  const auto payload = registers.subspan(kBlockHeaderRegisters);
  if (tag == 0 || tag != window_.tag) return false;
  const std::size_t bytes = window_.coded ? 2 * payload.size() : bytes_in_block(window_.length, number);
  if (bytes == 0 || payload.size() != (bytes + 1) / 2) return false;
  const auto content = unpacked(payload, bytes);
  if (block_check(window_, number, content) != registers[2]) {
    if (++wrong_checks_ >= kMostWrongChecks) refuse(UnitError::check_mismatch);
    return false;
  }
  if (window_.coded) return take_coded(number, content);
  if (!put(number * kBlockBytes, content)) return false;
  received_ |= std::uint64_t{1} << number;
  return true;
}

bool MemoryWindow::put(std::size_t offset, std::span<const std::uint8_t> bytes) {
  error_ = unit_->write_memory(static_cast<Address>(window_.address + offset), bytes);
  return error_ == UnitError::none;
}

/// The codes of as many blocks as the high byte of `number` says, and one more, from the block of its low byte on.
bool MemoryWindow::take_coded(std::uint16_t number, std::span<const std::uint8_t> code) {
  const std::size_t first = number & 0xFFu;
  const std::size_t count = (number >> 8) + std::size_t{1};
  const std::size_t blocks = blocks_in(window_.length, kCodedBlockBytes);
  if (count > kCodedBlocksInFrame || first >= blocks || count > blocks - first) return false;
  if ((~received_ & bits_below(first)) != 0) return false;
  const std::size_t offset = first * kCodedBlockBytes;
  const std::size_t bytes = std::min(count * kCodedBlockBytes, window_.length - offset);
  const Address at = static_cast<Address>(window_.address + offset);
  const Address bank = kBankB.contains(at) ? kBankB.first : kBankA.first;
  const std::size_t history = std::min<std::size_t>(at - bank, block_code::kHistoryBytes);
  const auto memory = std::span(decoded_).first(history + bytes);
  if (unit_->read_memory(static_cast<Address>(at - history), memory.first(history)) != UnitError::none) return false;
  if (!decode_blocks(code, memory, history, kCodedBlockBytes) || !put(offset, memory.subspan(history))) return false;
  received_ |= bits_below(first + count) & ~bits_below(first);
  return true;
}

std::uint64_t MemoryWindow::all_blocks() const { return bits_below(blocks_in(window_.length, window_.block_bytes())); }

WindowAck MemoryWindow::ack() const {
  WindowAck ack{window_.tag, error_, window_.address, window_.length, received_, 0};
  if (window_.tag == 0 || error_ != UnitError::none || received_ != all_blocks()) return ack;
  std::vector<std::uint8_t> held(window_.length);
  ack.error = unit_->read_memory(window_.address, held);
  if (ack.error == UnitError::none) ack.crc = crc32_of(held);
  return ack;
}

}  // namespace ecs::protocol
