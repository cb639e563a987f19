// What the memory screen is made of: bytes that are known, patterns, differences.
#include "app/screens/memory/screen.hpp"
#include "commissioning/memory/bytes.hpp"
#include "commissioning/memory/compare.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {
namespace {

using Row = std::vector<std::uint8_t>;

TEST_CASE("bytes, text and numbers are typed as the unit stores them, high byte first") {
  CHECK(pattern_in("45 43 53").value() == Row{0x45, 0x43, 0x53});
  CHECK(pattern_in(" 0x4E75 ").value() == Row{0x4E, 0x75});
  CHECK(pattern_in("\"ECSI\"").value() == Row{'E', 'C', 'S', 'I'});
  CHECK(pattern_in("\"a b").value() == Row{'a', ' ', 'b'});
  CHECK(pattern_in("8:255").value() == Row{0xFF});
  CHECK(pattern_in("16:-250").value() == Row{0xFF, 0x06});
  CHECK(pattern_in("32:70000").value() == Row{0x00, 0x01, 0x11, 0x70});
  CHECK(pattern_in("64:-1").value() == Row(8, 0xFF));
  CHECK(pattern_in("f:1").value() == Row{0x3F, 0xF0, 0, 0, 0, 0, 0, 0});
  for (const char* wrong : {"", "4", "XY", "\"\"", "8:256", "16:70000", "16:", "f:abc", "32:1.5"}) {
    CAPTURE(wrong);
    CHECK_FALSE(pattern_in(wrong));
  }
}

TEST_CASE("nothing is known of a unit's memory until it is read, page by page") {
  MemoryBytes memory = MemoryBytes::of_unit(1);
  CHECK(memory.region_of(kBankA.first)->size == kModuleBankBytes);
  CHECK_FALSE(memory.at(kSystemRam.first));
  memory.put(kSystemRam.first + kPageBytes, Row(2 * kPageBytes, 7));
  CHECK(memory.at(kSystemRam.first + kPageBytes) == 7);
  CHECK_FALSE(memory.at(kSystemRam.first + 3 * kPageBytes));
  const Stretch unread = memory.unread(kSystemRam.first + kPageBytes + 5, kSystemRam.first + 10 * kPageBytes, 4);
  CHECK(unread.first == kSystemRam.first + 3 * kPageBytes);
  CHECK(unread.bytes == 4 * kPageBytes);
  CHECK(memory.known(kSystemRam.first + kPageBytes + 10, 1000).size() == 2 * kPageBytes - 10);
  CHECK_FALSE(memory.at(0x050000));  // no memory there
  memory.forget();
  CHECK_FALSE(memory.at(kSystemRam.first + kPageBytes));
}

TEST_CASE("the last page of a region is known although it is shorter") {
  MemoryBytes memory = MemoryBytes::of_unit(1);
  memory.put(kCommitRecords.first, Row(kCommitRecords.size, 1));
  CHECK(memory.part_known(*memory.region_of(kCommitRecords.first)) == 1.0);
  CHECK(memory.unread(kCommitRecords.first, kCommitRecords.first + kCommitRecords.size, 9).bytes == 0);
}

TEST_CASE("a search finds what spans two pages and asks for what it has not read") {
  MemoryBytes memory = MemoryBytes::of_unit(1);
  Row page(kPageBytes, 0);
  page.back() = 0x12;
  memory.put(kSystemRam.first, page);
  const Row pattern{0x12, 0x34};
  const SearchStep before = find_pattern(memory, pattern, kSystemRam.first);
  CHECK(before.kind == SearchStep::Kind::unread);
  CHECK(before.address == kSystemRam.first + kPageBytes);
  page.front() = 0x34;
  memory.put(kSystemRam.first + kPageBytes, page);
  const SearchStep found = find_pattern(memory, pattern, kSystemRam.first);
  CHECK(found.kind == SearchStep::Kind::found);
  CHECK(found.address == kSystemRam.first + kPageBytes - 1);
}

/// Two regions of a dump, one byte changed.
MemoryDump small_dump(std::uint8_t byte) {
  MemoryDump dump;
  Row ram(1000, 0);
  ram[500] = byte;
  dump.regions.push_back({"system RAM", kSystemRam.first, ram, 1000, true});
  return dump;
}

TEST_CASE("bytes that differ are listed by region where they have no name, and visited in a cycle") {
  const MemoryBytes a = MemoryBytes::of_dump(small_dump(1)), b = MemoryBytes::of_dump(small_dump(2));
  const auto rows = difference_rows(a, MemoryNames(a), b, MemoryNames(b));
  CHECK(only(rows).first == kSystemRam.first + 500);
  CHECK(rows[0].a == "01");
  CHECK(rows[0].b == "02");
  CHECK(next_difference(a, b, kSystemRam.first) == kSystemRam.first + 500);
  CHECK(next_difference(a, b, kSystemRam.first + 500) == kSystemRam.first + 500);
  CHECK_FALSE(next_difference(a, a, 0));
  CHECK(difference_rows(a, MemoryNames(a), MemoryBytes(), MemoryNames()).front().b == "missing");
}

TEST_CASE("EPROM and commit records are refused with the reason, and so is what goes beyond a region") {
  const MemoryBytes memory = MemoryBytes::of_unit(1);
  CHECK(may_write(memory, kSystemRam.first, 16));
  CHECK(contains(may_write(memory, 0x1000, 1).error().message, "EPROM is protected"));
  CHECK(contains(may_write(memory, kCommitRecords.first, 1).error().message, "only the unit"));
  CHECK(contains(may_write(memory, kSystemRam.first + kSystemRam.size - 1, 2).error().message, "beyond"));
  CHECK_FALSE(may_write(memory, 0x060000, 1));
  CHECK(may_write_in(UnitMode::integration));
  for (const UnitMode mode : {UnitMode::starting, UnitMode::datuming, UnitMode::compensating, UnitMode::halted})
    CHECK_FALSE(may_write_in(mode));
}

TEST_CASE("rows have 32, 16, 8 or 4 bytes as they fit, and the cursor is always among them") {
  const MemoryRegion ram{"RAM", 0x40000, 0x10000, true};
  CHECK(rows_for(ram, 0x40000, 14, 140, 0x40000).per_row == 32);
  CHECK(rows_for(ram, 0x40000, 14, 80, 0x40000).per_row == 16);
  CHECK(rows_for(ram, 0x40000, 5, 44, 0x40000).per_row == 8);
  CHECK(rows_for(ram, 0x40000, 5, 20, 0x40000).per_row == 4);
  for (const Address cursor : {0x40000u, 0x400FFu, 0x48123u, 0x4FFFFu}) {
    const MemoryRows rows = rows_for(ram, cursor, 14, 80, 0x47000);
    CHECK(cursor >= rows.first);
    CHECK(cursor < rows.first + rows.shown().bytes);
    CHECK(rows.first + rows.shown().bytes <= ram.last() + 1);
  }
}

}  // namespace
}  // namespace ecs::app
