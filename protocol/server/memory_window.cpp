// Blocks of a bulk write into the memory of a unit.
#include "protocol/server/memory_window.hpp"

#include <vector>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "protocol/registers/window_block.hpp"
#include "protocol/server/register_server.hpp"

namespace ecs::protocol {

void MemoryWindow::open(const WindowOpen& window) {
  if (window == window_ && error_ == UnitError::none) return;
  window_ = window;
  received_ = 0;
  if (window.tag == 0 || window.length == 0 || window.length > kWindowBytes)
    error_ = UnitError::bad_argument;
  else if (in_axis_memory(window.address) && (window.token == 0 || window.token != token_))
    error_ = UnitError::token_expired;
  else
    error_ = unit_->may_write(window.address, window.length);
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
  const std::size_t bytes = bytes_in_block(window_.length, number);
  const auto payload = registers.subspan(kBlockHeaderRegisters);
  if (tag == 0 || tag != window_.tag || bytes == 0 || payload.size() != (bytes + 1) / 2) return false;
  const auto content = unpacked(payload, bytes);
  if (block_check(window_, number, content) != registers[2]) return false;
  error_ = unit_->write_memory(static_cast<Address>(window_.address + number * kBlockBytes), content);
  if (error_ != UnitError::none) return false;
  received_ |= std::uint64_t{1} << number;
  return true;
}

std::uint64_t MemoryWindow::all_blocks() const {
  const std::size_t blocks = blocks_in(window_.length);
  return blocks >= kWindowBlocks ? ~std::uint64_t{0} : (std::uint64_t{1} << blocks) - 1;
}

WindowAck MemoryWindow::ack() const {
  WindowAck ack{window_.tag, error_, window_.address, window_.length, received_, 0};
  if (window_.tag == 0 || error_ != UnitError::none || received_ != all_blocks()) return ack;
  std::vector<std::uint8_t> held(window_.length);
  ack.error = unit_->read_memory(window_.address, held);
  if (ack.error == UnitError::none) ack.crc = crc32_of(held);
  return ack;
}

}  // namespace ecs::protocol
