// Keyed checks of blocks. Apart from unit_registers.cpp: who only decodes registers needs no keys.
#include "protocol/registers/unit_registers.hpp"

namespace ecs::protocol {
namespace {

/// The number's registers, high word first.
void append(Registers& registers, std::uint64_t number, unsigned count) {
  for (unsigned left = count; left-- > 0;) registers.push_back(static_cast<std::uint16_t>(number >> 16 * left));
}

std::span<const std::uint16_t> sealed_part(std::span<const std::uint16_t> block) {
  return block.subspan(1, block.size() - 1 - kKeyedCheckRegisters);
}

}  // namespace

void put_check(Registers& block, std::uint64_t check) {
  block.resize(block.size() - kKeyedCheckRegisters);
  append(block, check, kKeyedCheckRegisters);
}

std::uint64_t check_at_end(std::span<const std::uint16_t> block) {
  std::uint64_t check = 0;
  for (const std::uint16_t word : block.last(kKeyedCheckRegisters)) check = check << 16 | word;
  return check;
}

Registers sealed(Registers block, Keyed kind, const std::optional<Secret>& key) {
  put_check(block, keyed_check(key, kind, sealed_part(block)));
  return block;
}

bool seal_agrees(std::span<const std::uint16_t> block, Keyed kind, const std::optional<Secret>& key) {
  return check_at_end(block) == keyed_check(key, kind, sealed_part(block));
}

std::uint64_t answer_check(const Secret& key, const Block& block, std::uint32_t challenge,
                           std::span<const std::uint16_t> answer) {
  Registers registers{block.first};
  append(registers, challenge, 2);
  const auto content = answer.first(answer.size() - kKeyedCheckRegisters);
  registers.insert(registers.end(), content.begin(), content.end());
  return keyed_check(key, Keyed::answer, registers);
}

std::uint64_t block_check(const std::optional<Secret>& key, const WindowOpen& window, std::uint16_t number,
                          std::span<const std::uint8_t> payload) {
  Registers registers;
  for (const std::uint32_t of_window :
       {window.asker.session, window.number, std::uint32_t{window.address}, window.length, window.token})
    append(registers, of_window, 2);
  append(registers, window.coded ? 1 : 0, 1);
  append(registers, number, 1);
  return keyed_check(key, Keyed::block, registers, payload);
}

std::uint64_t piece_check(const Secret& key, Address address, std::span<const std::uint8_t> bytes) {
  Registers registers;
  append(registers, address, 2);
  return keyed_check(key, Keyed::piece, registers, bytes);
}

}  // namespace ecs::protocol
