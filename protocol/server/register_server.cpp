// Registers read and written, as the unit understands them.
#include "protocol/server/register_server.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <vector>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {

namespace {

constexpr std::array kAnswers{kIdentity, kStatus, kMonitor, kPointers, kCommandResult, kWindowAck, kMemory, kChecks};
constexpr std::array kEchoed{kEcho, kReadSelect, kWindowOpen, kCommand, kCheckSelect};
constexpr std::uint32_t kLongestCheck = 0x100000;  ///< more than any region of the unit

std::optional<Block> answer_block(std::uint16_t first, std::uint16_t count) {
  for (const Block& block : kAnswers)
    if (block.contains(first, count)) return block;
  return std::nullopt;
}

std::optional<Block> request_block(std::uint16_t first, std::size_t count) {
  for (const Block& block : kEchoed)
    if (block.contains(first, static_cast<std::uint32_t>(count))) return block;
  return std::nullopt;
}

/// Differs from that of the staging before, and is no token of another unit but by chance.
std::uint32_t next_token(std::uint32_t before) {
  std::random_device chance;
  std::uint32_t token = before;
  while (token == before || token == 0) token = chance();
  return token;
}

}  // namespace

tl::expected<Registers, ModbusException> RegisterServer::read(std::uint16_t first, std::uint16_t count) {
  if (first + std::uint32_t{count} <= requests_.size())
    return Registers(requests_.begin() + first, requests_.begin() + first + count);
  const auto block = answer_block(first, count);
  if (!block) return tl::unexpected(ModbusException::illegal_address);
  Registers whole;
  if (*block == kMemory || *block == kChecks) {
    auto of_memory = *block == kMemory ? memory_answer() : checks_answer();
    if (!of_memory) return of_memory;
    whole = std::move(*of_memory);
  } else {
    whole = answer(*block);
  }
  const auto from = whole.begin() + (first - block->first);
  return Registers(from, from + count);
}

Registers RegisterServer::answer(const Block& block) {
  if (block == kIdentity) return registers_of(unit_->identity(), echo_);
  if (block == kStatus) return registers_of(unit_->status(), echo_);
  if (block == kMonitor) return registers_of(unit_->monitor(), echo_);
  if (block == kPointers) return pointer_registers_of(unit_->status(), echo_);
  if (block == kCommandResult) return registers_of(result_now(), echo_);
  return registers_of(window_.ack(), echo_);
}

tl::expected<Registers, ModbusException> RegisterServer::memory_answer() {
  const auto select = read_select_in(std::span(requests_).subspan(kReadSelect.first, kReadSelect.count));
  if (!select || select->bytes == 0 || select->bytes > kMemoryBytes)
    return tl::unexpected(ModbusException::illegal_value);
  std::vector<std::uint8_t> bytes(select->bytes);
  if (unit_->read_memory(select->address, bytes) != UnitError::none)
    return tl::unexpected(ModbusException::illegal_address);
  const std::uint32_t crc = crc32_of(bytes);
  Registers registers{echo_, static_cast<std::uint16_t>(select->address >> 16),
                      static_cast<std::uint16_t>(select->address & 0xFFFF), static_cast<std::uint16_t>(crc >> 16),
                      static_cast<std::uint16_t>(crc & 0xFFFF)};
  const Registers data = packed(bytes);
  registers.insert(registers.end(), data.begin(), data.end());
  registers.resize(kMemory.count, 0);
  return registers;
}

tl::expected<Registers, ModbusException> RegisterServer::checks_answer() {
  const auto select = check_select_in(std::span(requests_).subspan(kCheckSelect.first, kCheckSelect.count));
  const bool possible = select && select->length > 0 && select->length <= kBankBytes && select->piece > 0;
  if (!possible || (select->length - 1) / select->piece >= kMostChecks)
    return tl::unexpected(ModbusException::illegal_value);
  Registers registers{echo_};
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t at = 0; at < select->length; at += select->piece) {
    bytes.resize(std::min<std::uint32_t>(select->piece, select->length - at));
    if (unit_->read_memory(select->address + at, bytes) != UnitError::none)
      return tl::unexpected(ModbusException::illegal_address);
    const std::uint32_t crc = crc32_of(bytes);
    registers.push_back(static_cast<std::uint16_t>(crc >> 16));
    registers.push_back(static_cast<std::uint16_t>(crc & 0xFFFF));
  }
  registers.resize(kChecks.count, 0);
  return registers;
}

tl::expected<void, ModbusException> RegisterServer::write(std::uint16_t first, std::span<const std::uint16_t> values) {
  if (first == kBlockWrite.first && values.size() <= kBlockWrite.count) {
    if (!window_.take(values)) return tl::unexpected(ModbusException::illegal_value);
    return {};
  }
  const auto block = request_block(first, values.size());
  if (!block) return tl::unexpected(ModbusException::illegal_address);
  std::copy(values.begin(), values.end(), requests_.begin() + first);
  if (first == block->first) echo_ = values.front();
  if (block->count > 1 && first == block->first && values.size() == block->count) act_on(*block);
  return {};
}

void RegisterServer::act_on(const Block& block) {
  const auto whole = std::span<const std::uint16_t>(requests_).subspan(block.first, block.count);
  if (block == kWindowOpen) {
    if (const auto window = window_open_in(whole)) window_.open(*window);
  } else if (block == kCommand) {
    const std::uint16_t sequence = whole[1];
    if (sequence == 0 || std::find(sequences_.begin(), sequences_.end(), sequence) != sequences_.end()) return;
    sequences_[next_sequence_++ % sequences_.size()] = sequence;
    if (const auto command = command_in(whole))
      take_command(*command);
    else
      result_ = {sequence,
                 CommandState::refused,
                 whole[2] >= kCommandCount ? UnitError::unknown_command : UnitError::bad_argument,
                 0,
                 0,
                 {}};
  }
}

void RegisterServer::take_command(const Command& command) {
  (void)result_now();
  if (command.code == CommandCode::check_memory) {
    result_ = check_memory(command);
  } else if (port_busy_ && command.code != CommandCode::stop) {
    result_ = {command.sequence, CommandState::refused, UnitError::busy, 0, 0, {}};
  } else {
    result_ = begun(command);
    result_.sequence = command.sequence;
    port_busy_ = result_.state == CommandState::busy;
    busy_sequence_ = command.sequence;
  }
}

/// The unit's answer. A staging ends with the next one, with its commit and when it is abandoned; under another token
/// than its own it does neither.
CommandResult RegisterServer::begun(const Command& command) {
  const bool begins = command.code == CommandCode::begin_staging;
  const bool ends = command.code == CommandCode::commit_staged || command.code == CommandCode::abandon_staged;
  if (ends && window_.token() == 0) return {0, CommandState::refused, UnitError::no_staging, 0, 0, {}};
  if (ends && command.token != window_.token()) return {0, CommandState::refused, UnitError::token_expired, 0, 0, {}};
  CommandResult result = unit_->begin(command);
  if (result.state != CommandState::done && result.state != CommandState::busy) return result;
  if (begins) result.token = next_token(window_.token());
  if (begins || ends) window_.stage_under(result.token);
  return result;
}

CommandResult RegisterServer::check_memory(const Command& command) {
  CommandResult result{command.sequence, CommandState::done, UnitError::none, 0, 0, {}};
  std::vector<std::uint8_t> bytes(std::min(command.length, kLongestCheck));
  if (command.length == 0 || command.length > kLongestCheck)
    result.error = UnitError::bad_argument;
  else
    result.error = unit_->read_memory(command.address, bytes);
  if (result.error != UnitError::none)
    result.state = CommandState::refused;
  else
    result.value = crc32_of(bytes);
  return result;
}

const CommandResult& RegisterServer::result_now() {
  if (!port_busy_) return result_;
  CommandResult now = unit_->progress();
  now.sequence = busy_sequence_;
  port_busy_ = now.state == CommandState::busy;
  if (result_.sequence == busy_sequence_) result_ = std::move(now);
  return result_;
}

}  // namespace ecs::protocol
