// The numbers that host, unit and files share, as they are written in docs/core.md and docs/unit.md: a change of one is
// a new format, and the limits of what a unit takes.
#include <cstring>
#include <limits>

#include <zlib.h>

#include "core/address_map.hpp"
#include "core/block_code.hpp"
#include "core/datum.hpp"
#include "core/memory_image.hpp"
#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr std::uint32_t kOneModule = 73'728;

std::uint32_t number_at(const std::vector<std::uint8_t>& image, std::size_t at) {
  return load_big<std::uint32_t>(image, at);
}

std::vector<std::uint8_t> image_with(double start_mm, double increment_mm, double resolution) {
  UnitParameters parameters;
  set_configuration(parameters, "TX");
  return image_of(parameters, {{Component::EXX, Approach::forward, start_mm, increment_mm, resolution, {5, -6}}},
                  "words");
}

bool takes(double start_mm, double increment_mm, double resolution) {
  return check_image(image_with(start_mm, increment_mm, resolution)).fault == ImageFault::none;
}

bool is_region(const Region& region, Address first, std::uint32_t size) {
  return region.first == first && region.size == size;
}

}  // namespace

TEST_CASE("every region of memory lies where docs/unit.md says") {
  CHECK(is_region(kEprom, 0x000000, 0x10000));
  CHECK(is_region(kSystemRam, 0x040000, 0x10000));
  CHECK(is_region(kMachineInputs, 0x0E0000, 0x1000));
  CHECK(is_region(kCommitRecords, 0x0F0000, 128));
  CHECK(is_region(kBankA, 0x100000, 5 * kOneModule));
  CHECK(is_region(kBankB, 0x200000, 5 * kOneModule));
  CHECK(is_region(kThermalRecord, 0x0F1000, 640));
  CHECK(is_region(kToolRecord, 0x0F2000, 4160));
  CHECK(kRegions.size() == 7);
  CHECK(bank_bytes(1) == kOneModule);
  CHECK(kMostValues == 160'000);
  CHECK(kUserRegisters == 0x040000);
  CHECK(kUserRegisterBytes == 72);  // 16 registers and the program counter of 32 bits each, SR in the last
  CHECK(kUserPrograms == 0x041000);
  CHECK(kDatumRecordAddress == 0x041000);
  CHECK(kDatumRecordMagic == 0x45445251);
  CHECK(kDatumRecordHeaderBytes == 32);
  CHECK(kDatumSampleBytes == 5);
  CHECK(kMostDatumSamples == 11'000);
  CHECK(kDatumRecord_s == 10.0);
}

TEST_CASE("an image has its numbers at the offsets of docs/core.md") {
  UnitParameters parameters;
  set_configuration(parameters, "TX");
  auto image = image_with(-100.0, 12.5, 0.02);
  write_identity(image, {"MCM-0107", "moving column mill", 0x01020304});
  seal_image(image);
  REQUIRE(image.size() == 64 + 512 + 64 + 40 + 2 * 2 + 5);
  CHECK(std::memcmp(image.data(), "ECSI\0\2", 6) == 0);
  CHECK(number_at(image, 8) == image.size());
  CHECK(number_at(image, 12) == check_image(image).check_found);
  CHECK(number_at(image, 16) == 64);
  CHECK(number_at(image, 20) == 640);
  CHECK(number_at(image, 24) == 1);
  CHECK(number_at(image, 28) == 680);
  CHECK(number_at(image, 32) == 2);
  CHECK(number_at(image, 36) == 684);
  CHECK(number_at(image, 40) == 5);
  CHECK(std::memcmp(image.data() + 64, "TX\0", 3) == 0);
  CHECK(std::memcmp(image.data() + 576, "MCM-0107\0", 9) == 0);
  CHECK(std::memcmp(image.data() + 592, "moving column mill\0", 19) == 0);
  CHECK(number_at(image, 632) == 0x01020304);
  CHECK(number_at(image, 636) == 0);
  CHECK(image[640] == 0);
  CHECK(image[641] == 1);
  CHECK(number_at(image, 644) == 0);
  CHECK(number_at(image, 648) == 2);
  CHECK(load_double(image, 656) == -100.0);
  CHECK(load_double(image, 664) == 12.5);
  CHECK(load_double(image, 672) == 0.02);
  CHECK(load_big<std::int16_t>(image, 680) == 5);
  CHECK(std::memcmp(image.data() + 684, "words", 5) == 0);
  CHECK(kImageFormat == 2);
  CHECK(kFormatWithoutIdentity == 1);
  CHECK(kFormatWithThermal == 3);
  CHECK(kFormatWithRotary == 4);
  CHECK(kFormatWithBending == 5);
  CHECK(kBendingBytes == 96);
  CHECK(directory_offset(1) == 576);
  CHECK(kMostTables == 36);
}

TEST_CASE("an image of format 3 has thermal settings and rows behind its directory, at the offsets of docs/core.md") {
  UnitParameters parameters;
  set_configuration(parameters, "TX");
  const std::vector<ThermalRow> rows{{Component::EZX, ThermalLaw::bending, 3, 5, -1.5, 21.0, 60.0, -250.0}};
  const auto image =
      image_of(parameters, {{Component::EXX, Approach::unknown, 0.0, 1.0, 0.01, {5, -6}}}, "words", rows);
  REQUIRE(image.size() == 64 + 512 + 64 + 40 + 64 + 40 + 2 * 2 + 5);
  CHECK(std::memcmp(image.data(), "ECSI\0\3", 6) == 0);
  CHECK(number_at(image, 28) == 784);
  CHECK(number_at(image, 44) == 680);
  CHECK(number_at(image, 48) == 1);
  const ThermalSettings usual;
  const std::array numbers{usual.rate_um_per_s,      usual.hold_s,    usual.longest_age_s, usual.stuck_s,
                           usual.fastest_degC_per_s, usual.step_degC, usual.least_degC,    usual.greatest_degC};
  for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(load_double(image, 680 + 8 * i) == numbers[i]);
  CHECK(image[744] == 2);
  CHECK(image[745] == 2);
  CHECK(image[746] == 3);
  CHECK(image[747] == 5);
  CHECK(load_double(image, 752) == -1.5);
  CHECK(load_double(image, 760) == 21.0);
  CHECK(load_double(image, 768) == 60.0);
  CHECK(load_double(image, 776) == -250.0);
}

TEST_CASE("an image of format 4 has rotary axes before its values, with bending of format 5, as in docs/core.md") {
  UnitParameters parameters;
  set_configuration(parameters, "TX");
  std::vector<std::uint8_t> reverse(12 * 2), forward(12 * 2);
  store_big(reverse, 0, std::uint16_t{0x1234});
  store_big(forward, 12 * 2 - 2, std::uint16_t{0x5678});
  RotarySetup setup{{'X', 'C', 'T'}, {}, {}};
  setup.axes[1] = {'C', 0.25, 0.5, {0.0, 0.6, 0.8}, {1.0, 2.0, 3.0}, {4.0, 5.0, 6.0, 7.0, 8.0, 9.0}, 10.0};
  setup.tables[1] = {-20.0, 5.0, 2, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}, {reverse, forward}};
  const auto image =
      image_of(parameters, {{Component::EXX, Approach::unknown, 0.0, 1.0, 0.01, {5, -6}}}, "words", {}, {}, &setup);
  REQUIRE(image.size() == 64 + 512 + 64 + 40 + 400 + 2 * 24 + 2 * 2 + 5);
  CHECK(std::memcmp(image.data(), "ECSI\0\4", 6) == 0);
  CHECK(number_at(image, 28) == 680 + 448);
  CHECK(number_at(image, 48) == 0);
  CHECK(number_at(image, 52) == 680);
  CHECK(number_at(image, 56) == 0);
  CHECK(number_at(image, 60) == 2);
  CHECK(std::memcmp(image.data() + 680, "XCT\0\0\0\0\0", 8) == 0);
  CHECK(image[696] == 0);
  CHECK(image[888] == 'C');
  const std::array numbers{0.25, 0.5, 10.0, 0.0,   0.6, 0.8, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0,
                           7.0,  8.0, 9.0,  -20.0, 5.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  for (std::size_t i = 0; i < numbers.size(); ++i) CHECK(load_double(image, 896 + 8 * i) == numbers[i]);
  CHECK(load_big<std::uint16_t>(image, 1080) == 0x1234);
  CHECK(load_big<std::uint16_t>(image, 1126) == 0x5678);
  CHECK(load_big<std::int16_t>(image, 1128) == 5);
  setup.bending = {{1.5, 2.5, 3.5, 4.5, 5.5, 6.5}, {7.5, 8.5, 9.5, 10.5, 11.5, 12.5}};
  const auto bent =
      image_of(parameters, {{Component::EXX, Approach::unknown, 0.0, 1.0, 0.01, {5, -6}}}, "words", {}, {}, &setup);
  REQUIRE(bent.size() == image.size() + 96);
  CHECK(std::memcmp(bent.data(), "ECSI\0\5", 6) == 0);
  CHECK(std::memcmp(bent.data() + 680, image.data() + 680, 400) == 0);
  for (std::size_t i = 0; i < 12; ++i) CHECK(load_double(bent, 1080 + 8 * i) == 1.5 + static_cast<double>(i));
  CHECK(load_big<std::uint16_t>(bent, 1176) == 0x1234);
}

TEST_CASE("an identity is cut at 16 and 40 bytes") {
  auto image = image_with(0.0, 1.0, 0.01);
  write_identity(image, {std::string(50, 's'), std::string(50, 'm'), 7});
  CHECK(std::memcmp(image.data() + 576, std::string(16, 's').c_str(), 16) == 0);
  CHECK(std::memcmp(image.data() + 592, std::string(40, 'm').c_str(), 40) == 0);
  CHECK(number_at(image, 632) == 7);
}

TEST_CASE("a table begins within a kilometre, steps by 0.1 um to a kilometre, counts at most 1000 um") {
  const double above = 1.0 + 1e-9;
  CHECK(takes(1e6, 1.0, 0.01));
  CHECK(takes(-1e6, 1.0, 0.01));
  CHECK_FALSE(takes(1e6 * above, 1.0, 0.01));
  CHECK_FALSE(takes(-1e6 * above, 1.0, 0.01));
  CHECK(takes(0.0, 1e-4, 0.01));
  CHECK_FALSE(takes(0.0, 1e-4 / above, 0.01));
  CHECK(takes(0.0, 1e6, 0.01));
  CHECK_FALSE(takes(0.0, 1e6 * above, 0.01));
  CHECK(takes(0.0, 1.0, 1000.0));
  CHECK_FALSE(takes(0.0, 1.0, 1000.0 * above));
  CHECK(takes(0.0, 1.0, 1e-300));
  CHECK_FALSE(takes(0.0, 1.0, 0.0));
}

TEST_CASE("no number among the parameters is beyond 1e9") {
  std::array<std::uint8_t, 512> block{};
  UnitParameters parameters;
  set_configuration(parameters, "TX");
  const auto comes_back = [&](double value) {
    parameters.tool_offset_mm[0] = value;
    encode_parameters(parameters, block);
    return decode_parameters(block).has_value();
  };
  CHECK(comes_back(1e9));
  CHECK(comes_back(-1e9));
  CHECK_FALSE(comes_back(1e9 + 1));
  CHECK_FALSE(comes_back(std::numeric_limits<double>::infinity()));
  CHECK_FALSE(comes_back(std::nan("")));
}

TEST_CASE("a commit record is 20 bytes and their check, marked CMIT, in one of two slots of 64") {
  std::vector<std::uint8_t> records(128, 0);
  CHECK(kCommitSlots == 2);
  CHECK(kCommitSlotBytes == 64);
  CHECK(next_commit_slot(records) == 0);
  encode_commit({7, 1, 1000, 0x01020304}, std::span(records).subspan(64, 64));
  CHECK(std::memcmp(records.data() + 64, "CMIT\0\0\0\7\0\0\0\1\0\0\3\350\1\2\3\4", 20) == 0);
  CHECK(number_at(records, 84) == ::crc32_z(0, records.data() + 64, 20));
  CHECK(std::all_of(records.begin() + 88, records.end(), [](std::uint8_t byte) { return byte == 0; }));
  CHECK(active_commit(records) == Commit{7, 1, 1000, 0x01020304});
  CHECK(next_commit_slot(records) == 0);
}

TEST_CASE("the codes of blocks are those of docs/protocol.md") {
  using namespace block_code;
  CHECK(kModeBits == 2);
  CHECK(kParameterBits == 4);
  CHECK(kMostParameter == 14);
  CHECK(kMostUnary == 20);
  CHECK(kHistoryBytes == 1024);
  CHECK(kLeastRepeat == 3);
  CHECK(kRunBits == 6);
}

TEST_CASE("a model has at most 30 terms, 21 components, 18 of them curves, on 3 axes in two directions") {
  CHECK(kMostTerms == 30);
  CHECK(kComponents == 21);
  CHECK(kCurves == 18);
  CHECK(kAxes == 3);
}
