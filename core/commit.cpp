#include <algorithm>

#include <zlib.h>

#include "core/memory_image.hpp"

namespace ecs {
namespace {

constexpr std::uint32_t kCommitMagic = 0x434D4954;  // "CMIT"
constexpr std::uint32_t kCheckAt = 20;

std::uint32_t record_check(ByteView slot) noexcept {
  return static_cast<std::uint32_t>(::crc32_z(0, slot.data(), kCheckAt));
}

std::optional<Commit> commit_in(ByteView slot) noexcept {
  if (load_big<std::uint32_t>(slot, 0) != kCommitMagic) return std::nullopt;
  if (load_big<std::uint32_t>(slot, kCheckAt) != record_check(slot)) return std::nullopt;
  const Commit commit{load_big<std::uint32_t>(slot, 4), load_big<std::uint32_t>(slot, 8),
                      load_big<std::uint32_t>(slot, 12), load_big<std::uint32_t>(slot, 16)};
  if (commit.bank > 1) return std::nullopt;
  return commit;
}

std::optional<Commit> commit_in(ByteView records, std::uint32_t slot) noexcept {
  return commit_in(records.subspan(slot * kCommitSlotBytes, kCommitSlotBytes));
}

}  // namespace

std::optional<Commit> active_commit(ByteView records) noexcept {
  const auto first = commit_in(records, 0);
  const auto second = commit_in(records, 1);
  if (first && second) return first->sequence > second->sequence ? first : second;
  return first ? first : second;
}

SlotState state_of_slot(ByteView records, std::uint32_t slot) noexcept {
  if (commit_in(records, slot)) return SlotState::sound;
  const ByteView bytes = records.subspan(slot * kCommitSlotBytes, kCommitSlotBytes);
  const bool erased = (bytes[0] == 0x00 || bytes[0] == 0xFF) &&
                      std::all_of(bytes.begin(), bytes.end(), [&](std::uint8_t byte) { return byte == bytes[0]; });
  return erased ? SlotState::blank : SlotState::damaged;
}

std::optional<std::uint32_t> damaged_slot(ByteView records) noexcept {
  for (std::uint32_t slot = 0; slot < kCommitSlots; ++slot)
    if (state_of_slot(records, slot) == SlotState::damaged) return slot;
  return std::nullopt;
}

std::uint32_t next_commit_slot(ByteView records) noexcept {
  const auto first = commit_in(records, 0);
  const auto second = commit_in(records, 1);
  if (!first) return 0;
  if (!second) return 1;
  return first->sequence > second->sequence ? 1 : 0;
}

void encode_commit(const Commit& commit, Bytes slot) noexcept {
  std::fill(slot.begin(), slot.end(), std::uint8_t{0});
  store_big(slot, 0, kCommitMagic);
  store_big(slot, 4, commit.sequence);
  store_big(slot, 8, commit.bank);
  store_big(slot, 12, commit.image_bytes);
  store_big(slot, 16, commit.image_check);
  store_big(slot, kCheckAt, record_check(slot));
}

}  // namespace ecs
