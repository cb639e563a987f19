// The commit records: a new map becomes active whole, whenever the power goes.
#include <array>

#include "core/memory_image.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;

namespace {

using Records = std::array<std::uint8_t, 2 * kCommitSlotBytes>;

/// Writes `commit` as the unit does, stopping after `bytes` bytes of the slot.
Records written(Records records, const Commit& commit, std::size_t bytes = kCommitSlotBytes) {
  std::array<std::uint8_t, kCommitSlotBytes> slot{};
  encode_commit(commit, slot);
  const std::size_t at = next_commit_slot(records) * kCommitSlotBytes;
  for (std::size_t i = 0; i < bytes; ++i) records[at + i] = slot[i];
  return records;
}

constexpr Commit kFirst{1, 0, 4000, 0x12345678};
constexpr Commit kSecond{2, 1, 5000, 0x9ABCDEF0};
constexpr Commit kThird{3, 0, 6000, 0x0F1E2D3C};

Records blank(std::uint8_t filling) {
  Records records{};
  records.fill(filling);
  return records;
}

}  // namespace

TEST_CASE("blank memory commits to nothing, whatever it is blank with") {
  CHECK(!active_commit(blank(0x00)));
  CHECK(!active_commit(blank(0xFF)));
  CHECK(next_commit_slot(blank(0xFF)) == 0);
}

TEST_CASE("power lost at any byte of the first commit leaves no map or the complete one") {
  for (const std::uint8_t filling : {std::uint8_t{0x00}, std::uint8_t{0xFF}, std::uint8_t{0x55}})
    for (std::size_t bytes = 0; bytes <= kCommitSlotBytes; ++bytes) {
      const auto active = active_commit(written(blank(filling), kFirst, bytes));
      if (active)
        CHECK(*active == kFirst);
      else
        CHECK(bytes < 24);
    }
  CHECK(active_commit(written(blank(0), kFirst)) == kFirst);
}

TEST_CASE("power lost at any byte of a later commit leaves the old map or the new one") {
  const Records one = written(blank(0xFF), kFirst);
  const Records two = written(one, kSecond);
  REQUIRE(active_commit(two) == kSecond);
  for (std::size_t bytes = 0; bytes <= kCommitSlotBytes; ++bytes) {
    const auto second = must(active_commit(written(one, kSecond, bytes)));
    CHECK((second == kFirst || second == kSecond));
    const auto third = must(active_commit(written(two, kThird, bytes)));
    CHECK((third == kSecond || third == kThird));
    if (bytes == kCommitSlotBytes) CHECK(third == kThird);
  }
}

TEST_CASE("a torn commit is written again into the same slot") {
  const Records one = written(blank(0), kFirst);
  const Records torn = written(one, kSecond, 11);
  CHECK(next_commit_slot(torn) == 1);
  CHECK(active_commit(written(torn, kSecond)) == kSecond);
}

TEST_CASE("the higher sequence counts, and the active slot is never the next to be written") {
  Records records = blank(0);
  for (std::uint32_t sequence = 1; sequence < 50; ++sequence) {
    const std::uint32_t next = next_commit_slot(records);
    CHECK(next == (sequence - 1) % 2);
    records = written(records, {sequence, sequence % 2, sequence * 10, sequence * 77});
    CHECK(active_commit(records)->sequence == sequence);
  }
}

TEST_CASE("no single changed byte of a slot is believed") {
  const Records one = written(blank(0), kFirst);
  for (std::size_t i = 0; i < 24; ++i)
    for (int flip = 1; flip < 256; ++flip) {
      Records spoilt = one;
      spoilt[i] = static_cast<std::uint8_t>(spoilt[i] ^ flip);
      CHECK(!active_commit(spoilt));
    }
}

TEST_CASE("random records are not believed") {
  CHECK(rc::check([] {
    Records records{};
    for (auto& byte : records) byte = *rc::gen::arbitrary<std::uint8_t>();
    RC_ASSERT(!active_commit(records).has_value());
    RC_ASSERT(next_commit_slot(records) < 2u);
  }));
}

TEST_CASE("a commit to a bank that does not exist is invalid") {
  CHECK(!active_commit(written(blank(0), {1, 2, 4000, 1})));
}

TEST_CASE("a slot that is neither erased nor holds a sound commit is damaged") {
  for (const std::uint8_t filling : {std::uint8_t{0x00}, std::uint8_t{0xFF}}) {
    const Records one = written(blank(filling), kFirst);
    CHECK(state_of_slot(one, 0) == SlotState::sound);
    CHECK(state_of_slot(one, 1) == SlotState::blank);
    CHECK(!damaged_slot(one));
    for (std::size_t bit = 0; bit < 8 * kCommitSlotBytes; ++bit) {
      Records flipped = one;
      flipped[kCommitSlotBytes + bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      CHECK(damaged_slot(flipped) == 1);
    }
    for (std::size_t bit = 0; bit < 8 * 24; ++bit) {
      Records flipped = one;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      CHECK(damaged_slot(flipped) == 0);
      CHECK(!active_commit(flipped));
    }
  }
  CHECK(damaged_slot(blank(0x55)) == 0);
}
