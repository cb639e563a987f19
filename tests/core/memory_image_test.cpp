// The memory image: what goes in comes out, and nothing that is not whole gets through check_image(). Whom an image is
// addressed to: a unit takes its own and no other.
#include "core/memory_image.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>

#include <zlib.h>

#include "core/address_map.hpp"
#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

using Image = std::vector<std::uint8_t>;

UnitParameters single_axis() {
  UnitParameters p;
  set_configuration(p, "TX");
  return p;
}

Image small_image() {
  return image_of(single_axis(),
                  {{Component::EXX, Approach::forward, -100.0, 10.0, 0.01, {5, -6, 700}},
                   {Component::EXX, Approach::reverse, -95.0, 12.5, 0.02, {-1, 2}}},
                  "customer: Müller");
}

ImageFault fault_of(const Image& image) { return check_image(image).fault; }

/// The image with one word of its prefix changed and the checksum made to agree again.
Image resealed_with(Image image, std::uint32_t at, std::uint32_t word) {
  store_big(image, at, word);
  seal_image(image);
  return image;
}
Image resealed_entry(std::uint32_t index, const TableEntry& entry) {
  Image image = small_image();
  write_entry(image, index, entry);
  seal_image(image);
  return image;
}

std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }

}  // namespace

TEST_CASE("a negative zero keeps its sign on the way through the block") {
  UnitParameters p;
  p.C0Y_um_per_m = -0.0;
  std::array<std::uint8_t, kParameterBytes> block{};
  encode_parameters(p, block);
  CHECK(bits_of(decode_parameters(block)->C0Y_um_per_m) == bits_of(-0.0));
}

TEST_CASE("impossible parameters are refused") {
  const auto refused = [](auto spoil) {
    UnitParameters p;
    spoil(p);
    std::array<std::uint8_t, kParameterBytes> block{};
    encode_parameters(p, block);
    return !decode_parameters(block).has_value();
  };
  const double nan = std::nan("");
  const double infinite = std::numeric_limits<double>::infinity();
  CHECK(!refused([](UnitParameters&) {}));
  CHECK(refused([](UnitParameters& p) { p.configuration = {'T', 'X', 'X', 'Z', 0}; }));
  CHECK(refused([](UnitParameters& p) { p.configuration = {'T', 'X', 'Y', 0, 0}; }));  // Z present, not in the chain
  CHECK(refused([](UnitParameters& p) { p.configuration = {'T', 'X', 'Y', 'Z', 'Z'}; }));
  CHECK(refused([](UnitParameters& p) { p.axis_present = {false, false, false}; }));
  CHECK(refused([](UnitParameters& p) { p.memory_modules = 0; }));
  CHECK(refused([](UnitParameters& p) { p.memory_modules = 6; }));
  CHECK(refused([](UnitParameters& p) { p.loop_period_us = 99.0; }));
  CHECK(refused([&](UnitParameters& p) { p.loop_period_us = nan; }));
  CHECK(refused([&](UnitParameters& p) { p.angular_scale = infinite; }));
  CHECK(refused([](UnitParameters& p) { p.angular_scale = 1e300; }));  // would overflow in the tick
  CHECK(refused([&](UnitParameters& p) { p.measurement_lines_mm[2][1] = nan; }));
  CHECK(refused([](UnitParameters& p) { p.axes[1].position_scale_um_per_count = 0.0; }));
  CHECK(refused([](UnitParameters& p) { p.axes[1].compensation_polarity = 0; }));
  CHECK(refused([](UnitParameters& p) { p.axes[2].output_scale_counts_per_um = 0.0; }));
  CHECK(refused([](UnitParameters& p) { p.axes[2].output_slew_um_per_s = 0.0; }));
  CHECK(refused([](UnitParameters& p) { p.axes[0].deadband_um = -1.0; }));
  CHECK(refused([](UnitParameters& p) { p.axes[0].datum.switch_polarity = 2; }));
  CHECK(refused([](UnitParameters& p) { p.scope = static_cast<Scope>(3); }));
  CHECK(refused([](UnitParameters& p) {
    p.configuration = {'X', 'Y', 'Z', 'T', 0};
    p.convention = Convention::as_printed;
  }));
}

TEST_CASE("random blocks of parameters are refused or decode to themselves, and never crash") {
  CHECK(rc::check([] {
    std::array<std::uint8_t, kParameterBytes> block{};
    encode_parameters(random_parameters(), block);
    for (int i = 0; i < 3; ++i)
      block[*rc::gen::inRange<std::size_t>(0, block.size())] = *rc::gen::arbitrary<std::uint8_t>();
    const auto decoded = decode_parameters(block);
    if (decoded) RC_ASSERT(chain_of(*decoded).has_value());
  }));
}

TEST_CASE("an image gives back its parameters, tables, values and header") {
  CHECK(rc::check([] {
    UnitParameters parameters = random_parameters();
    std::vector<PlannedTable> tables;
    for (std::size_t c = 0; c < kCurves; ++c) {
      const auto one = [&](Approach approach) {
        PlannedTable t{static_cast<Component>(c),     approach, number_up_to(5000.0), number_between(0.001, 500.0),
                       number_between(0.0001, 100.0), {}};
        t.counts = *rc::gen::container<std::vector<std::int16_t>>(rc::gen::arbitrary<std::int16_t>());
        tables.push_back(t);
      };
      switch (*rc::gen::inRange(0, 3)) {
        case 0:
          one(Approach::unknown);
          break;
        case 1:
          one(Approach::forward);
          one(Approach::reverse);
          break;
        default:
          break;
      }
    }
    const std::string header = *rc::gen::arbitrary<std::string>();
    const Image image = image_of(parameters, tables, header);
    RC_ASSERT(fault_of(image) == ImageFault::none);
    const ImageView view(image);
    RC_ASSERT(view.total_bytes() == image.size());
    RC_ASSERT(view.parameters() == parameters);
    RC_ASSERT(view.header() == header);
    RC_ASSERT(view.table_count() == tables.size());
    for (std::uint32_t i = 0; i < tables.size(); ++i) {
      const TableEntry entry = view.entry(i);
      RC_ASSERT(entry.component == tables[i].component);
      RC_ASSERT(entry.approach == tables[i].approach);
      RC_ASSERT(entry.declared_zero == tables[i].counts.empty());
      RC_ASSERT(entry.start_mm == tables[i].start_mm);
      RC_ASSERT(entry.increment_mm == tables[i].increment_mm);
      RC_ASSERT(entry.resolution == tables[i].resolution);
      RC_ASSERT(entry.count == tables[i].counts.size());
      for (std::uint32_t k = 0; k < entry.count; ++k)
        RC_ASSERT(view.value_counts(entry.first_value + k) == tables[i].counts[k]);
    }
  }));
}

TEST_CASE("the checksum is the CRC-32 of the whole image with its own four bytes zero") {
  Image image = small_image();
  const std::uint32_t stored = ImageView(image).check();
  std::fill_n(image.begin() + prefix_at::check, 4, std::uint8_t{0});
  CHECK(::crc32_z(0, image.data(), image.size()) == stored);
}

TEST_CASE("the parameters are where docs/core.md says") {
  UnitParameters p{.memory_modules = 3, .loop_period_us = 1250.0};
  p.measurement_lines_mm[2][1] = -77.0;
  p.axes[1].compensation_polarity = -1;
  p.axes[2].output_slew_um_per_s = 4321.0;
  p.axes[2].datum.reference_position_mm = -12.5;
  const Image image = image_of(p, {});
  CHECK(std::memcmp(image.data() + 64, "TXYZ\0\1\1\1", 8) == 0);
  CHECK(image[73] == 3);
  CHECK(load_double(image, 79) == 1250.0);
  CHECK(load_double(image, 143 + 8 * (3 * 2 + 1)) == -77.0);
  CHECK(image[294 + 25] == 0xFF);
  CHECK(load_double(image, 373 + 34) == 4321.0);
  CHECK(load_double(image, 373 + 71) == -12.5);
}

TEST_CASE("the bank may be longer than the image") {
  Image image = small_image();
  const auto size = static_cast<std::uint32_t>(image.size());
  image.resize(kBankBytes, 0xFF);
  const ImageVerdict verdict = check_image(image);
  CHECK(verdict.fault == ImageFault::none);
  CHECK(verdict.total_bytes == size);
  CHECK(verdict.check_found == verdict.check_expected);
}

TEST_CASE("no single changed byte passes, whatever it becomes") {
  Image image = small_image();
  std::size_t accepted = 0;
  for (std::uint8_t& byte : image)
    for (int flip = 1; flip < 256; ++flip) {
      byte = static_cast<std::uint8_t>(byte ^ flip);
      accepted += fault_of(image) == ImageFault::none ? 1u : 0u;
      byte = static_cast<std::uint8_t>(byte ^ flip);
    }
  CHECK(accepted == 0);
  CHECK(fault_of(image) == ImageFault::none);
}

TEST_CASE("no image cut short passes, at any length") {
  const Image image = small_image();
  for (std::size_t length = 0; length < image.size(); ++length) {
    const Image cut(image.begin(), image.begin() + static_cast<std::ptrdiff_t>(length));  // exact, for the sanitizer
    CHECK(fault_of(cut) != ImageFault::none);
  }
}

TEST_CASE("a resealed image of random words in its prefix and directory never crashes the check") {
  // the checksum agrees, so that every later check is reached
  CHECK(rc::check([] {
    Image image = small_image();
    for (int i = *rc::gen::inRange(1, 4); i > 0; --i) {
      const auto at = *rc::gen::element<std::uint32_t>(16, 20, 24, 28, 32, 36, 40, 576, 580, 584, 616, 620, 624);
      const auto word = *rc::gen::oneOf(
          rc::gen::arbitrary<std::uint32_t>(), rc::gen::inRange<std::uint32_t>(0xFFFFFF00, 0xFFFFFFFF),
          rc::gen::inRange<std::uint32_t>(0x7FFFFFF0, 0x80000010), rc::gen::inRange<std::uint32_t>(0, 1000));
      store_big(image, at, word);
    }
    seal_image(image);
    const ImageVerdict verdict = check_image(image);
    RC_ASSERT(verdict.fault != ImageFault::block_check);
    if (verdict.fault == ImageFault::none) {
      const ImageView view(image);
      for (std::uint32_t i = 0; i < view.table_count(); ++i)
        for (std::uint32_t k = 0; k < view.entry(i).count; ++k)
          RC_ASSERT(view.value_offset(view.entry(i).first_value + k) + 2 <= image.size());
    }
  }));
}

TEST_CASE("lengths that overflow 32 bits are refused") {
  const Image image = small_image();
  for (const std::uint32_t huge : {0xFFFFFFFFu, 0xFFFFFFF0u, 0x80000000u, 0x7FFFFFFFu, 0x06666667u /* × 40 wraps */}) {
    CAPTURE(huge);
    CHECK(fault_of(resealed_with(image, prefix_at::table_count, huge)) == ImageFault::bad_directory);
    CHECK(fault_of(resealed_with(image, prefix_at::value_count, huge)) == ImageFault::over_capacity);
    CHECK(fault_of(resealed_with(image, prefix_at::header_bytes, huge)) == ImageFault::wrong_length);
    CHECK(fault_of(resealed_with(image, prefix_at::header, huge)) == ImageFault::wrong_length);
    CHECK(fault_of(resealed_with(image, prefix_at::values, huge)) == ImageFault::wrong_length);
    CHECK(fault_of(resealed_with(image, prefix_at::directory, huge)) == ImageFault::wrong_length);
    CHECK(fault_of(resealed_with(image, prefix_at::parameters, huge)) == ImageFault::wrong_length);
  }
  // a value count that wraps round to the same total: 2 · 2³¹ ≡ 0
  const auto values = ImageView(image).value_count();
  CHECK(fault_of(resealed_with(image, prefix_at::value_count, values + 0x80000000u)) != ImageFault::none);
  Image total = image;
  store_big(total, prefix_at::total_bytes, std::uint32_t{0xFFFFFFFF});
  CHECK(fault_of(total) == ImageFault::wrong_length);
  store_big(total, prefix_at::total_bytes, std::uint32_t{64});
  CHECK(fault_of(total) == ImageFault::wrong_length);
}

TEST_CASE("a table outside the value area is refused") {
  TableEntry entry = ImageView(small_image()).entry(1);
  entry.first_value = 4;
  CHECK(fault_of(resealed_entry(1, entry)) == ImageFault::bad_entry);
  entry.first_value = 0xFFFFFFFF;
  CHECK(fault_of(resealed_entry(1, entry)) == ImageFault::bad_entry);
  entry.count = 6;  // first + count wraps round
  CHECK(fault_of(resealed_entry(1, entry)) == ImageFault::bad_entry);
  entry = ImageView(small_image()).entry(1);
  entry.count = 0xFFFFFFFE;
  CHECK(fault_of(resealed_entry(1, entry)) == ImageFault::bad_entry);
  entry = ImageView(small_image()).entry(1);
  entry.count = 0;
  CHECK(fault_of(resealed_entry(1, entry)) == ImageFault::bad_entry);
  entry.declared_zero = true;
  CHECK(fault_of(resealed_entry(1, entry)) == ImageFault::none);
}

TEST_CASE("tables must not share values: together they could outgrow the working form") {
  TableEntry entry = ImageView(small_image()).entry(1);
  entry.first_value = 0;
  entry.count = 5;
  const ImageVerdict verdict = check_image(resealed_entry(1, entry));
  CHECK(verdict.fault == ImageFault::bad_directory);
  CHECK(verdict.table == 1);
}

TEST_CASE("a table with impossible numbers is refused") {
  const TableEntry good = ImageView(small_image()).entry(0);
  const auto refused = [&](auto spoil) {
    TableEntry entry = good;
    spoil(entry);
    const ImageVerdict verdict = check_image(resealed_entry(0, entry));
    return verdict.fault == ImageFault::bad_entry && verdict.table == 0;
  };
  const double nan = std::nan("");
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double wrong : {nan, infinite, -infinite}) {
    CHECK(refused([&](TableEntry& e) { e.start_mm = wrong; }));
    CHECK(refused([&](TableEntry& e) { e.increment_mm = wrong; }));
    CHECK(refused([&](TableEntry& e) { e.resolution = wrong; }));
  }
  for (const double wrong : {0.0, -0.0, -1.0, 1e-300}) CHECK(refused([&](TableEntry& e) { e.increment_mm = wrong; }));
  for (const double wrong : {0.0, -0.01, 1e300}) CHECK(refused([&](TableEntry& e) { e.resolution = wrong; }));
  CHECK(refused([](TableEntry& e) { e.start_mm = 1e7; }));
  CHECK(refused([](TableEntry& e) { e.component = Component::C0Y; }));
  CHECK(refused([](TableEntry& e) { e.component = static_cast<Component>(200); }));
  CHECK(refused([](TableEntry& e) { e.approach = static_cast<Approach>(2); }));
  CHECK(refused([](TableEntry& e) { e.approach = static_cast<Approach>(-2); }));
}

TEST_CASE("the same curve twice for one approach is refused") {
  const auto tables = [](Approach a, Approach b) {
    return image_of(single_axis(),
                    {{Component::EXX, a, 0.0, 1.0, 0.01, {1}}, {Component::EXX, b, 0.0, 1.0, 0.01, {1}}});
  };
  CHECK(fault_of(tables(Approach::forward, Approach::forward)) == ImageFault::duplicate_table);
  CHECK(fault_of(tables(Approach::unknown, Approach::forward)) == ImageFault::duplicate_table);
  CHECK(fault_of(tables(Approach::reverse, Approach::unknown)) == ImageFault::duplicate_table);
  CHECK(fault_of(tables(Approach::reverse, Approach::forward)) == ImageFault::none);
}

TEST_CASE("an image may hold what the named modules hold, and no value more") {
  UnitParameters p = single_axis();
  const auto with = [&](std::size_t values) {
    return image_of(p, {{Component::EXX, Approach::unknown, 0.0, 0.1, 0.01, std::vector<std::int16_t>(values, 1)}});
  };
  CHECK(fault_of(with(32'000)) == ImageFault::none);
  CHECK(fault_of(with(32'001)) == ImageFault::over_capacity);
  p.memory_modules = 5;
  CHECK(fault_of(with(160'000)) == ImageFault::none);
  CHECK(fault_of(with(160'001)) == ImageFault::over_capacity);
}

TEST_CASE("the largest map leaves room for its header in the banks of its modules") {
  for (std::uint8_t modules = 1; modules <= kMostModules; ++modules) {
    const ImagePlan full{kMostTables, static_cast<std::uint32_t>(modules * kValuesPerModule), 4096};
    CHECK(image_bytes(full) <= bank_bytes(modules));
  }
}

TEST_CASE("an image of another format or with impossible parameters says so") {
  Image image = small_image();
  store_big(image, prefix_at::format, std::uint16_t{kFormatWithBending + 1});
  CHECK(fault_of(image) == ImageFault::wrong_format);
  image = small_image();
  image[64] = 'Q';
  seal_image(image);
  CHECK(fault_of(image) == ImageFault::bad_parameters);
}

namespace {

UnitParameters machine_of(const char* chain) {
  UnitParameters parameters;
  for (std::size_t i = 0; i < 5; ++i) parameters.configuration[i] = chain[i];
  return parameters;
}

/// A tilting rotary table with one curve of C; as a head B that C carries it can bend.
struct TableOfTwo {
  std::vector<std::uint8_t> side = std::vector<std::uint8_t>(12 * 36);
  RotarySetup setup{{'X', 'Y', 'A', 'C', 'T', 'Z'}, {}, {}};
  TableOfTwo() {
    setup.axes[0] = {'A', 0.001, 0.005, {1.0, 0.0, 0.0}, {600.0, 300.0, -560.0}, {0.0, 6.0, -9.0, 0.0, 14.0, -7.0}, 0};
    setup.axes[1] = {'C', -0.001, 0.005, {0.0, 0.0, 1.0}, {600.0, 300.0, -560.0}, {8.0, -5.5, 0.0, 18.0, -12.0, 0}, 90};
    setup.tables[1] = {0.0, 10.0, 36, {0.01, 0.01, 0.01, 0.01, 0.01, 0.01}, {side, side}};
  }
  [[nodiscard]] std::vector<std::uint8_t> image() const {
    return image_of(machine_of("XYTZ"), with_zeros({}), "", {}, {}, &setup);
  }
};

struct BentHead : TableOfTwo {
  BentHead() {
    setup.configuration = {'X', 'Y', 'T', 'Z', 'C', 'A'};
    setup.bending = {{1.5, -2.0, 3.0, 4.0, -5.0, 6.0}, {70.0, 80.0, -90.0, 0.0, 11.0, -12.0}};
  }
  [[nodiscard]] std::vector<std::uint8_t> image() const {
    UnitParameters parameters = machine_of("XYTZ");
    parameters.tool_offset_mm = {10.0, -20.0, 150.0};
    parameters.tool_range_mm = {300.0, 300.0, 300.0};
    return image_of(parameters, with_zeros({}), "", {}, {}, &setup);
  }
};

}  // namespace

TEST_CASE("rotary axes come back from an image of format 4, with and without thermal rows") {
  const TableOfTwo table;
  for (const bool warm : {false, true}) {
    const std::vector<ThermalRow> rows(warm ? 1 : 0);
    const auto image = image_of(machine_of("XYTZ"), with_zeros({}), "words", rows, {}, &table.setup);
    REQUIRE(text_of(check_image(image).fault) == "sound");
    const ImageView view(image);
    CHECK(view.format() == kFormatWithRotary);
    CHECK(view.header() == "words");
    CHECK(view.thermal_count() == rows.size());
    const auto back = view.rotary();
    REQUIRE(back);
    CHECK(back->configuration == table.setup.configuration);
    CHECK(back->axes == table.setup.axes);
    CHECK(back->tables[0].count == 0);
    CHECK(back->tables[1].count == 36);
    CHECK(back->tables[1].increment_deg == 10.0);
    CHECK(std::ranges::equal(back->tables[1].values[1], table.side));
  }
  CHECK(!ImageView(image_of(machine_of("XYTZ"), with_zeros({}))).rotary());
}

TEST_CASE("bending of a head comes back from an image of format 5, with the curves behind it") {
  BentHead head;
  head.side[7] = 42;
  head.setup.tables[1].values = {head.side, head.side};
  const auto image = head.image();
  REQUIRE(text_of(check_image(image).fault) == "sound");
  const ImageView view(image);
  CHECK(view.format() == kFormatWithBending);
  CHECK(image.size() == TableOfTwo().image().size() + kBendingBytes);
  const auto back = view.rotary();
  REQUIRE(back);
  CHECK(back->bending == head.setup.bending);
  CHECK(back->axes == head.setup.axes);
  CHECK(std::ranges::equal(back->tables[1].values[0], head.side));
  CHECK(ImageView(TableOfTwo().image()).rotary()->bending == RotaryBending{});
}

TEST_CASE("bending of impossible numbers is refused, whichever number it is") {
  for (std::size_t i = 0; i < 12; ++i)
    for (const double wrong :
         {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity(), 1e7}) {
      BentHead head;
      (i < 6 ? head.setup.bending.of_machine[i] : head.setup.bending.of_tool[i - 6]) = wrong;
      CHECK(check_image(head.image()).fault == ImageFault::bad_rotary_axis);
    }
}

TEST_CASE("an image with bending does not pass as one of format 4, nor one without as format 5") {
  for (auto [image, format] :
       {std::pair(BentHead().image(), kFormatWithRotary), std::pair(TableOfTwo().image(), kFormatWithBending)}) {
    store_big(image, prefix_at::format, format);
    seal_image(image);
    CHECK(check_image(image).fault == ImageFault::wrong_length);
  }
}

TEST_CASE("a rotary axis of impossible numbers is refused, whichever number it is") {
  TableOfTwo table;
  REQUIRE(check_image(table.image()).fault == ImageFault::none);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused_with = [&](auto change) {
    TableOfTwo changed;
    change(changed.setup.axes[1], changed.setup.tables[1], changed.setup);
    return check_image(changed.image()).fault == ImageFault::bad_rotary_axis;
  };
  for (const double wrong : {nan, 0.0, 180.0, 1e300})
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.deg_per_count = wrong; }));
  for (const double wrong : {nan, -1.0, 360.0})
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.deadband_deg = wrong; }));
  for (const double wrong : {nan, 4000.0})
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.zero_deg = wrong; }));
  for (std::size_t d = 0; d < kAxes; ++d) {
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.direction[d] = nan; }));
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.direction[d] += 0.1; }));
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.pivot_mm[d] = 1e7; }));
  }
  for (std::size_t s = 0; s < 6; ++s) {
    CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.location[s] = nan; }));
    CHECK(refused_with([&](auto&, RotaryCurves& curves, auto&) { curves.resolution[s] = 0.0; }));
  }
  CHECK(refused_with([&](auto&, RotaryCurves& curves, auto&) { curves.start_deg = nan; }));
  CHECK(refused_with([&](auto&, RotaryCurves& curves, auto&) { curves.increment_deg = 11.0; }));
  CHECK(refused_with([&](auto&, RotaryCurves& curves, auto&) { curves.increment_deg = 10.01; }));
  CHECK(refused_with([&](auto&, auto&, RotarySetup& setup) { setup.tables[0].start_deg = nan; }));  // without curves
  CHECK(refused_with([&](auto&, auto&, RotarySetup& setup) { setup.tables[0].increment_deg = nan; }));
  CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.letter = 'X'; }));
  CHECK(refused_with([&](RotaryAxis& axis, auto&, auto&) { axis.letter = '\0'; }));
  CHECK(refused_with([&](auto&, auto&, RotarySetup& setup) { setup.configuration[0] = 'U'; }));
  CHECK(refused_with([&](auto&, auto&, RotarySetup& setup) { setup.configuration[7] = 'X'; }));
}

TEST_CASE("wrong offsets and counts of rotary axes are refused, and no changed byte of them passes") {
  const auto image = TableOfTwo().image();
  for (const std::uint32_t at : {prefix_at::rotary, prefix_at::rotary_count, prefix_at::rotary_count + 4})
    for (const std::uint32_t wrong : {1u, 35u, 3601u, 0xFFFFFFFFu}) {
      auto changed = image;
      store_big(changed, at, wrong);
      seal_image(changed);
      CHECK(check_image(changed).fault != ImageFault::none);
    }
  const std::uint32_t first = load_big<std::uint32_t>(image, prefix_at::rotary);
  for (std::uint32_t at = first; at < first + kRotaryBytes; ++at) {
    auto changed = image;
    changed[at] ^= 0x10;
    CHECK(check_image(changed).fault == ImageFault::block_check);
  }
}

TEST_CASE("a resealed image of random numbers in its rotary axes is refused, or a map without a number that is none") {
  std::mt19937_64 random(45);
  const auto map = std::make_unique<CompiledMap>();
  int compiled = 0, bent = 0;
  for (int n = 0; n < 3000; ++n) {
    const bool bends = n % 2 == 0;
    auto image = bends ? BentHead().image() : TableOfTwo().image();
    const std::uint32_t first = load_big<std::uint32_t>(image, prefix_at::rotary);
    for (int k = 0; k < 2; ++k) {
      const auto number = static_cast<std::uint32_t>(random() % (bends ? 46 + kBendingBytes / 8 : 46));
      const std::uint32_t at = number < 46 ? first + 16 + (number / 23) * kRotaryAxisBytes + 8 + 8 * (number % 23)
                                           : first + kRotaryBytes + 8 * (number - 46);
      if (random() % 2 == 0)
        store_big(image, at, random());
      else
        store_double(image, at, load_double(image, at) * (1.0 + 1e-12) + 1e-13);
    }
    seal_image(image);
    if (check_image(image).fault != ImageFault::none || compile(ImageView(image), *map).fault != Fault::none) continue;
    ++compiled;
    TickState state;
    RotaryTickState rotary;
    start(state, {}, {}, {Approach::forward, Approach::forward, Approach::forward});
    start_rotary(map->rotary, rotary, {}, {}, {Approach::forward, Approach::forward});
    tick(*map, state, {1000, 2000, 3000}, ThermalPolynomial{}, rotary, {12'345, -54'321});
    for (const double um : state.compensation_um) REQUIRE(std::isfinite(um));
    bent += bends ? 1 : 0;
  }
  CHECK(compiled > 100);
  CHECK(bent > 100);
}

TEST_CASE("rotary axes that do not go with the parameters are refused when the map is made, with the reason") {
  const auto verdict_with = [](auto change) {
    TableOfTwo table;
    UnitParameters parameters = machine_of("XYTZ");
    change(parameters, table.setup);
    const auto image = image_of(parameters, with_zeros({}), "", {}, {}, &table.setup);
    REQUIRE(check_image(image).fault == ImageFault::none);
    const auto map = std::make_unique<CompiledMap>();
    return compile(ImageView(image), *map);
  };
  const auto as_it_is = verdict_with([](auto&, auto&) {});
  CHECK(as_it_is.fault == Fault::none);
  const auto other = verdict_with([](UnitParameters& parameters, auto&) { parameters = machine_of("XTYZ"); });
  CHECK(other.fault == Fault::map_not_for_parameters);
  CHECK(other.rotary == RotaryFault::other_chain);
  const auto moved =
      verdict_with([](auto&, RotarySetup& setup) { setup.configuration = {'A', 'C', 'X', 'Y', 'T', 'Z'}; });
  CHECK(moved.rotary == RotaryFault::turned_linear);
  const auto near = verdict_with([](UnitParameters& p, auto&) { p.interpolation = Interpolation::nearest; });
  CHECK(near.rotary == RotaryFault::part_of_model);
  const auto head =
      verdict_with([](auto&, RotarySetup& setup) { setup.configuration = {'X', 'Y', 'C', 'T', 'Z', 'A'}; });
  CHECK(head.rotary == RotaryFault::no_tool_range);
  const auto stiff = verdict_with([](auto&, RotarySetup& setup) { setup.bending.of_machine[0] = 1.0; });
  CHECK(stiff.rotary == RotaryFault::no_head);
}

TEST_CASE("every image fault has its words") {
  for (std::uint8_t f = 0; f <= static_cast<std::uint8_t>(ImageFault::bad_rotary_axis); ++f)
    CHECK(text_of(static_cast<ImageFault>(f)) != "unknown");
}

namespace {

using IdentifiedImage = std::vector<std::uint8_t>;

IdentifiedImage image_for(const ImageIdentity& identity, const UnitParameters& parameters) {
  IdentifiedImage image = image_of(parameters, {{Component::EXX, Approach::unknown, 0.0, 10.0, 0.01, {1, 2, 3}}});
  write_identity(image, identity);
  seal_image(image);
  return image;
}

const UnitParameters kMill = machine_of("TXYZ");
const std::uint32_t kOfMill = configuration_hash(kMill);

IdentityFault taken(const IdentifiedImage& image, const IdentifiedImage& active = {}) {
  return identity_fault(image, own_identity("M-1", active));
}

}  // namespace

TEST_CASE("an identity comes back from the image as it went in") {
  const IdentifiedImage image = image_for({"M-1", "moving column mill", 0x12345678}, kMill);
  CHECK(check_image(image).fault == ImageFault::none);
  CHECK(ImageView(image).identity() == ImageIdentity{"M-1", "moving column mill", 0x12345678});
}

TEST_CASE("a long name of a machine is cut between two characters") {
  const std::string name(39, 'x');
  CHECK(machine_in_identity(name + "y") == name + "y");
  CHECK(machine_in_identity(name + "ü") == name);
  const IdentifiedImage image = image_for({"0123456789ABCDEFG", name + "ü", 0}, kMill);
  CHECK(ImageView(image).identity() == ImageIdentity{"0123456789ABCDEF", name, 0});
}

TEST_CASE("a unit without a map takes what is addressed to its serial number") {
  CHECK(taken(image_for({"M-1", "mill", kOfMill}, kMill)) == IdentityFault::none);
  CHECK(taken(image_for({"M-1", "", kOfMill}, kMill)) == IdentityFault::none);
  CHECK(taken(image_for({"M-2", "mill", kOfMill}, kMill)) == IdentityFault::other_serial_number);
  CHECK(taken(image_for({"", "mill", kOfMill}, kMill)) == IdentityFault::not_stated);
  CHECK(taken(image_for({"M\x1b", "mill", kOfMill}, kMill)) == IdentityFault::not_stated);
  CHECK(taken(image_for({"M-1", "mill", kOfMill + 1}, kMill)) == IdentityFault::other_configuration);
}

TEST_CASE("a unit keeps to the machine and the configuration of the map it holds") {
  const IdentifiedImage active = image_for({"M-1", "mill", kOfMill}, kMill);
  const UnitParameters other = machine_of("XTYZ");
  CHECK(taken(image_for({"M-1", "mill", kOfMill}, kMill), active) == IdentityFault::none);
  CHECK(taken(image_for({"M-1", "lathe", kOfMill}, kMill), active) == IdentityFault::other_machine);
  CHECK(taken(image_for({"M-1", "", kOfMill}, kMill), active) == IdentityFault::other_machine);
  CHECK(taken(image_for({"M-1", "mill", configuration_hash(other)}, other), active) ==
        IdentityFault::other_configuration);
  CHECK(taken(image_for({"M-1", "mill", kOfMill}, other), active) == IdentityFault::none);  // addressed on purpose
}

TEST_CASE("parameters alone bind a unit to no machine") {
  IdentifiedImage parameters_alone = image_of(kMill, {});
  write_identity(parameters_alone, {"M-1", "mill", kOfMill});
  seal_image(parameters_alone);
  const UnitParameters other = machine_of("XTYZ");
  CHECK(taken(image_for({"M-1", "lathe", configuration_hash(other)}, other), parameters_alone) == IdentityFault::none);
}

TEST_CASE("configuration, axes and convention make another hash, polarity and limits do not") {
  CHECK(configuration_hash(machine_of("XTYZ")) != kOfMill);
  UnitParameters changed = kMill;
  changed.axis_present[2] = false;
  CHECK(configuration_hash(changed) != kOfMill);
  changed = kMill;
  changed.convention = Convention::as_printed;
  CHECK(configuration_hash(changed) != kOfMill);
  changed = kMill;
  changed.axes[0].compensation_polarity = -1;
  changed.tool_offset_mm[2] = 100.0;
  CHECK(configuration_hash(changed) == kOfMill);
}

TEST_CASE("an image of format 1 is sound and read, and names nobody") {
  const UnitParameters parameters = kMill;
  const ImagePlan plan{1, 2, 4, kFormatWithoutIdentity};
  IdentifiedImage image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, parameters);
  write_entry(image, 0, {Component::EXX, Approach::unknown, false, 0, 2, 0.0, 10.0, 0.01});
  write_value(image, 0, 7);
  write_value(image, 1, -7);
  write_header(image, "text");
  seal_image(image);
  CHECK(image.size() == 64 + 512 + 40 + 4 + 4);
  CHECK(check_image(image).fault == ImageFault::none);
  const ImageView view(image);
  CHECK_FALSE(view.identity().has_value());
  CHECK(view.entry(0).count == 2);
  CHECK(view.value_counts(1) == -7);
  CHECK(view.header() == "text");
  CHECK(identity_fault(image, own_identity("M-1", {})) == IdentityFault::not_stated);
}

TEST_CASE("every identity fault has its words, short enough for the answer of a unit") {
  for (std::uint8_t f = 0; f <= static_cast<std::uint8_t>(IdentityFault::other_configuration); ++f) {
    CHECK(text_of(static_cast<IdentityFault>(f)) != "unknown");
    CHECK(text_of(static_cast<IdentityFault>(f)).size() + 10 <= 80);
  }
}
