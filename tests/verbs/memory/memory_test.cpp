// Dumps of a unit's memory: kept, decoded, compared, whatever happened to their bytes.
#include <rapidcheck.h>

#include "base/answer_table.hpp"
#include "commissioning/memory/compare.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/memory/names.hpp"
#include "core/memory_image.hpp"
#include "laser/map/image.hpp"
#include "params/fields.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {
namespace {

UnitParameters linear_parameters() {
  UnitParameters p;
  p.scope = Scope::linear;
  p.axes[0].deadband_um = 2.0;
  return p;
}

/// EXX and EZZ for both approaches, EYY for each; three points each.
laser::ErrorMap small_map() {
  laser::ErrorMap map;
  map.header.machine = "mill";
  map.header.engineer = "A. Fitter";
  map.tables = {{Component::EXX, Approach::unknown, {-100.0, -50.0, 0.0}, {1.0, 2.0, 3.0}},
                {Component::EYY, Approach::forward, {0.0, 10.0, 20.0}, {0.0, -1.5, 4.0}},
                {Component::EYY, Approach::reverse, {0.0, 10.0, 20.0}, {0.5, -1.0, 4.5}},
                {Component::EZZ, Approach::unknown, {0.0, 10.0, 20.0}, {0.0, 0.0, 7.25}}};
  return map;
}

MemoryDump dump_with(const laser::ErrorMap& map, const UnitParameters& parameters) {
  const auto image = must(laser::image_of(map, parameters));
  MemoryDump dump{"2026-05-04T09:30:00Z", "rtu:/dev/ttyUSB0:115200:8N1:1", "MCM-0107", std::nullopt, {}, {}};
  std::vector<std::uint8_t> records(2 * kCommitSlotBytes, 0);
  const Commit commit{1, 0, static_cast<std::uint32_t>(image.bytes.size()), ImageView(image.bytes).check()};
  encode_commit(commit, Bytes(records).first(kCommitSlotBytes));
  std::vector<std::uint8_t> bank = image.bytes;
  bank.resize(bank.size() + 500, 0xEE);
  dump.regions.push_back({"commit records", kCommitRecords.first, records, static_cast<std::uint32_t>(records.size())});
  dump.regions.push_back({"axis memory bank A", kBankA.first, bank, static_cast<std::uint32_t>(bank.size())});
  return dump;
}
MemoryDump good_dump() { return dump_with(small_map(), linear_parameters()); }

TEST_CASE("a dump read back decodes to the parameters and tables that were put in") {
  const auto dump = must(dump_in(to_bytes(good_dump()), "d"));
  CHECK(dump.damage.empty());
  CHECK(dump.serial_number == "MCM-0107");
  const DecodedMemory memory = decoded(dump);
  CHECK(memory.sound());
  const DecodedImage* image = memory.main_image();
  REQUIRE(image != nullptr);
  CHECK(image->parameters == linear_parameters());
  REQUIRE(image->tables.size() == 4);
  CHECK(name_of(image->tables[1]) == "EYY forward");
  CHECK(image->tables[3].most == Approx(7.25));
  CHECK(image->tables[0].end_mm() == 0.0);
  CHECK(contains(image->header, "A. Fitter"));
}

TEST_CASE("the values of a table lie at the address that the directory view names") {
  const MemoryDump dump = good_dump();
  const DecodedMemory memory = decoded(dump);
  const DecodedTable& table = memory.main_image()->tables[3];
  const DumpRegion& bank = *region_at(dump, kBankA.first);
  const auto counts = load_big<std::uint16_t>(bank.bytes, table.values_address - kBankA.first + 4);
  CHECK(counts * table.entry.resolution == Approx(7.25));
}

TEST_CASE("a flipped bit of the image is reported, and everything else still decodes") {
  MemoryDump dump = good_dump();
  dump.regions[1].bytes[kPrefixBytes + kParameterBytes + 4 * kEntryBytes + 3] ^= 0x10;  // in a value
  const DecodedMemory memory = decoded(dump);
  CHECK_FALSE(memory.sound());
  const DecodedImage* image = memory.main_image();
  REQUIRE(image != nullptr);
  CHECK(image->verdict.fault == ImageFault::block_check);
  CHECK(image->verdict.check_expected != image->verdict.check_found);
  CHECK(image->parameters == linear_parameters());
  CHECK(image->tables.size() == 4);
}

TEST_CASE("a dump cut short, with a corrupted header or without one still gives its image") {
  const std::string whole = to_bytes(good_dump());
  const auto cut = must(dump_in(whole.substr(0, whole.size() - 300), "d"));
  CHECK_FALSE(cut.damage.empty());
  CHECK(decoded(cut).main_image()->verdict.fault == ImageFault::none);
  std::string spoilt = whole;
  spoilt[whole.find("MCM-0107")] = 'X';
  CHECK_FALSE(must(dump_in(spoilt, "d")).damage.empty());
  CHECK(decoded(must(dump_in(whole.substr(whole.find("ECSI") - 7), "d"))).main_image()->tables.size() == 4);
}

TEST_CASE("equal dumps do not differ, a changed parameter and value differ by name and place") {
  CHECK(differences(good_dump(), good_dump()).empty());
  UnitParameters parameters = linear_parameters();
  parameters.axes[0].deadband_um = 9.0;
  laser::ErrorMap map = small_map();
  map.tables[1].compensation[1] = -2.5;
  map.header.engineer = "B. Fitter";
  std::string all;
  for (const MemoryDifference& d : differences(good_dump(), dump_with(map, parameters)))
    all += d.what + " | " + d.a + " | " + d.b + "\n";
  check_holds(all, {"parameter axis.X.deadband_um | 2 um | 9 um", "table EYY forward: 1 value differs, at 10 mm",
                    "header engineer | A. Fitter | B. Fitter"});
  CHECK(!contains(all, "EXX"));
}

TEST_CASE("an image alone is compared with the active image of a dump, wherever that lies") {
  const auto image = must(laser::image_of(small_map(), linear_parameters())).bytes;
  const auto alone = must(dump_in(std::string(image.begin(), image.end()), "mill.image"));
  CHECK(alone.image_alone);
  CHECK(differences(alone, alone).empty());
  CHECK(differences(alone, good_dump()).empty());
  CHECK(differences(good_dump(), alone).empty());
  MemoryDump in_b = good_dump();
  in_b.regions[1].address = kBankB.first;
  const Commit commit{1, 1, static_cast<std::uint32_t>(image.size()), ImageView(image).check()};
  encode_commit(commit, Bytes(in_b.regions[0].bytes).first(kCommitSlotBytes));
  CHECK(differences(alone, in_b).empty());
  laser::ErrorMap map = small_map();
  map.tables[1].compensation[1] = -2.5;
  const auto changed = differences(alone, dump_with(map, linear_parameters()));
  CHECK(only(changed).what.starts_with("table EYY forward: 1 value differs"));
  auto flipped = image;
  flipped.back() ^= 1;  // in the padding or the header
  CHECK_FALSE(differences(must(dump_in(std::string(flipped.begin(), flipped.end()), "f")), good_dump()).empty());
}

TEST_CASE("any corrupted dump decodes to text and valid JSON without a crash") {
  const std::string whole = to_bytes(good_dump());
  CHECK(rc::check([&] {
    std::string bytes = whole;
    const auto changes = *rc::gen::inRange(1, 12);
    for (int i = 0; i < changes; ++i) {
      const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
      bytes[at] = static_cast<char>(*rc::gen::inRange(0, 256));
    }
    bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() + 1));
    const auto dump = dump_in(bytes, "spoilt");
    if (!dump) return;
    const DecodedMemory memory = decoded(*dump);
    const Cell answer = memory_cell(*dump, memory, true);
    RC_ASSERT(!answer.text.empty());
    RC_ASSERT(Json::parse(one_line(answer.json), nullptr, false).is_object());
    static_cast<void>(differences(*dump, good_dump()));
  }));
}

TEST_CASE("an image with any prefix and directory decodes without a crash") {
  const MemoryDump sound = good_dump();
  CHECK(rc::check([&] {
    MemoryDump dump = sound;
    std::vector<std::uint8_t>& bank = dump.regions[1].bytes;
    const auto changes = *rc::gen::inRange(1, 40);
    for (int i = 0; i < changes; ++i) {
      const bool in_prefix = *rc::gen::arbitrary<bool>();
      const auto at = in_prefix ? *rc::gen::inRange<std::size_t>(4, kPrefixBytes)
                                : *rc::gen::inRange<std::size_t>(kPrefixBytes, directory_offset() + 4 * kEntryBytes);
      bank[at] = *rc::gen::arbitrary<std::uint8_t>();
    }
    const DecodedMemory memory = decoded(dump);
    const Cell answer = memory_cell(dump, memory, true);
    RC_ASSERT(Json::parse(one_line(answer.json), nullptr, false).is_object());
    RC_ASSERT(!answer.text.empty());
  }));
}

TEST_CASE("each parameter has a place of its own in the image") {
  const auto& places = parameter_places();
  REQUIRE(places.size() == params::fields().size());
  std::vector<int> owner(kParameterBytes, -1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    CAPTURE(params::fields()[i].key);
    REQUIRE(places[i].bytes > 0);
    if (params::fields()[i].type == params::FieldType::number) CHECK(places[i].bytes == 8);
    for (std::uint32_t at = places[i].first; at < places[i].first + places[i].bytes; ++at) {
      CHECK(owner[at] == -1);
      owner[at] = static_cast<int>(i);
    }
  }
}

}  // namespace
}  // namespace ecs::app
