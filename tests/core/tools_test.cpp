// Tools: the record that keeps their table, and the change from one to another while the loop runs, against a map that
// was compiled with the offset of that tool.
#include "core/tools.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "base/random.hpp"
#include "core/address_map.hpp"
#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr double kAtOnce = std::numeric_limits<double>::infinity();

/// Curves of every component at random, −300 … 300 counts of 0.01, every 50 mm over 1 m.
std::vector<PlannedTable> random_tables(std::mt19937_64& random) {
  std::uniform_int_distribution<int> counts(-300, 300);
  std::vector<PlannedTable> tables;
  for (std::size_t c = 0; c < kCurves; ++c) {
    PlannedTable table{static_cast<Component>(c), Approach::unknown, -500.0, 50.0, 0.01, {}};
    if (is_angular(table.component)) table.resolution = 0.1;
    for (int k = 0; k <= 20; ++k) table.counts.push_back(static_cast<std::int16_t>(counts(random)));
    tables.push_back(std::move(table));
  }
  return tables;
}

const std::vector<ThermalRow> kRows{{Component::ECX, ThermalLaw::shift, 0, kNoInput, 3.0, 20.0, 0.0, 0.0},
                                    {Component::EAZ, ThermalLaw::shift, 1, kNoInput, -2.0, 20.0, 0.0, 0.0},
                                    {Component::EYY, ThermalLaw::growth, 1, kNoInput, 9.0, 20.0, 0.0, 0.0}};

struct ToolLoop {
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;
  ThermalState thermal;
  InputValues inputs{};

  ToolLoop(const std::vector<PlannedTable>& tables, const UnitParameters& p, const Vector3& position_mm) {
    const auto image = image_of(p, tables, "", kRows);
    REQUIRE(check_image(image).fault == ImageFault::none);
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
    inputs[0] = {23.5, true, 1};
    inputs[1] = {18.0, true, 1};
    start(state, {}, position_mm, {Approach::forward, Approach::reverse, Approach::forward});
    REQUIRE_FALSE(begin_thermal(map->thermal, thermal, inputs, position_mm, nullptr, 0.0));
  }
  Vector3 compensation_um() {
    tick(*map, state, {}, thermal.acting);
    return state.compensation_um;
  }
};

UnitParameters parameters_with_tools(std::string_view configuration) {
  UnitParameters p;
  p.configuration = {};
  std::copy(configuration.begin(), configuration.end(), p.configuration.begin());
  p.tool_range_mm = {400.0, 400.0, 400.0};
  for (AxisParameters& axis : p.axes) axis.output_limit_um = 10'000.0;
  return p;
}

double largest_difference(const Vector3& a, const Vector3& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("after a change of the tool the loop adds what a map compiled with that tool adds") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-480.0, 480.0), offset(-400.0, 400.0);
  for (const char* const configuration : {"TXYZ", "XTYZ", "XYTZ", "TZX"}) {
    for (int trial = 0; trial < 50; ++trial) {
      UnitParameters p = parameters_with_tools(configuration);
      if (std::string_view(configuration) == "TZX") p.axis_present = {true, false, true};
      p.tool_offset_mm = {offset(random), 0.0, offset(random)};
      const auto tables = random_tables(random);
      const Vector3 position_mm{place(random), p.axis_present[1] ? place(random) : 0.0, place(random)};
      const Vector3 tool_mm{offset(random), offset(random), offset(random)};
      ToolLoop changed(tables, p, position_mm);
      CHECK(change_tool(*changed.map, changed.state, changed.thermal, tool_mm, kAtOnce));
      p.tool_offset_mm = tool_mm;
      ToolLoop compiled(tables, p, position_mm);
      CHECK(largest_difference(changed.compensation_um(), compiled.compensation_um()) < 1e-9);
    }
  }
}

TEST_CASE("while the tool changes no axis is corrected by more than the limit more or less in one period") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-480.0, 480.0), offset(-400.0, 400.0);
  int changes = 0;
  double largest_um = 0.0;
  for (int trial = 0; trial < 100; ++trial) {
    ToolLoop loop(random_tables(random), parameters_with_tools("XYTZ"), {place(random), place(random), place(random)});
    Vector3 before_um = loop.compensation_um();
    for (int tool = 0; tool < 10; ++tool, ++changes) {
      const Vector3 tool_mm{offset(random), offset(random), offset(random)};
      const double most_um = 0.02;
      for (bool reached = false; !reached;) {
        reached = change_tool(*loop.map, loop.state, loop.thermal, tool_mm, most_um);
        const Vector3 now_um = loop.compensation_um();
        largest_um = std::max(largest_um, largest_difference(now_um, before_um));
        before_um = now_um;
      }
      CHECK(loop.map->tool_offset_mm == tool_mm);
    }
  }
  CHECK(changes == 1000);
  CHECK(largest_um <= 0.02 + 1e-9);
}

TEST_CASE("squareness that changes while the loop runs is corrected as a map compiled with it, and no axis steps") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-480.0, 480.0), squareness(-80.0, 80.0);
  const auto tables = random_tables(random);
  for (int k = 0; k < 100; ++k) {
    UnitParameters p = parameters_with_tools("TXYZ");
    const Vector3 position_mm{place(random), place(random), place(random)};
    p.C0Y_um_per_m = squareness(random);
    ToolLoop changed(tables, p, position_mm);
    Vector3 before_um = changed.compensation_um();
    const Vector3 wanted{squareness(random), squareness(random), squareness(random)};
    bool reached = false;
    for (int period = 0; period < 2000 && !reached; ++period) {
      reached = change_squareness(*changed.map, changed.state, wanted, 0.1);
      const Vector3 now_um = changed.compensation_um();
      CHECK(largest_difference(now_um, before_um) <= 0.1 + 1e-9);
      before_um = now_um;
    }
    REQUIRE(reached);
    p.C0Y_um_per_m = wanted[0], p.B0Z_um_per_m = wanted[1], p.A0Z_um_per_m = wanted[2];
    ToolLoop compiled(tables, p, position_mm);
    CHECK(largest_difference(before_um, compiled.compensation_um()) < 1e-9);
  }
}

TEST_CASE("what a tool offset does for each mm is the change that it makes") {
  std::mt19937_64 random(3);
  ToolLoop loop(random_tables(random), parameters_with_tools("TXYZ"), {-120.0, 310.0, 45.0});
  const Vector3 before_um = loop.compensation_um();
  const PerAxis<Vector3> effect = tool_effect_um_per_mm(*loop.map, loop.state, loop.thermal);
  for (std::size_t l = 0; l < kAxes; ++l) {
    Vector3 tool_mm{};
    tool_mm[l] = 100.0;
    REQUIRE(change_tool(*loop.map, loop.state, loop.thermal, tool_mm, kAtOnce));
    const Vector3 after_um = loop.compensation_um();
    for (std::size_t o = 0; o < kAxes; ++o)
      CHECK(after_um[o] - before_um[o] == Approx(100.0 * effect[l][o]).epsilon(1e-9));
  }
}

TEST_CASE("a range of tools makes the components needed that only a tool levers") {
  UnitParameters p;
  p.configuration = {'T', 'X', 'Y', 'Z', 0};
  const ComponentSet without = components_needed(p);
  p.tool_range_mm = {0.0, 0.0, 200.0};
  const ComponentSet with = components_needed(p);
  CHECK_FALSE(without.contains(Component::EAZ));
  CHECK(with.contains(Component::EAZ));
  CHECK(with.contains(Component::EBZ));
  CHECK_FALSE(with.contains(Component::ECZ));
}

TEST_CASE("the table of tools survives a supply that fails after any byte of its record") {
  std::vector<std::uint8_t> region(kToolRecord.size, 0);
  const auto write = [&](const ToolTable& table, std::size_t bytes) {
    std::vector<std::uint8_t> slot(kToolTableBytes);
    encode_tools(table, slot);
    const std::size_t at = next_tool_slot(region) * kToolTableBytes;
    std::copy_n(slot.begin(), bytes, region.begin() + static_cast<std::ptrdiff_t>(at));
  };
  CHECK_FALSE(stored_tools(region).has_value());
  ToolTable before{1, 7, {}};
  REQUIRE(put_tool(before, {7, {0.0, 0.0, 151.25}}));
  REQUIRE(put_tool(before, {12, {1.5, -2.5, 80.0}}));
  write(before, kToolTableBytes);
  CHECK(stored_tools(region) == before);
  ToolTable after = before;
  ++after.sequence;
  after.selected = 12;
  REQUIRE(remove_tool(after, 7));
  const std::vector<std::uint8_t> as_it_was = region;
  for (std::size_t bytes = 0; bytes <= kToolTableBytes; ++bytes) {
    region = as_it_was;
    write(after, bytes);
    const auto found = stored_tools(region);
    REQUIRE(found.has_value());
    const bool one_of_both = *found == before || *found == after;
    CHECK(one_of_both);
  }
  CHECK(stored_tools(region) == after);
}

TEST_CASE("the table has room for 64 tools, and a number once") {
  ToolTable table;
  for (std::uint16_t number = 1; number <= kMostTools; ++number) CHECK(put_tool(table, {number, {}}));
  CHECK_FALSE(put_tool(table, {9000, {}}));
  CHECK(put_tool(table, {5, {1.0, 2.0, 3.0}}));
  CHECK(tool_of(table, 5)->offset_mm == Vector3{1.0, 2.0, 3.0});
  CHECK(remove_tool(table, 6));
  CHECK_FALSE(remove_tool(table, 6));
  CHECK(tool_of(table, 6) == nullptr);
  CHECK(put_tool(table, {9000, {}}));
}

TEST_CASE("images from before tools could change are read with the usual limits and no range") {
  UnitParameters p;
  std::vector<std::uint8_t> block(kParameterBytes);
  encode_parameters(p, block);
  std::fill(block.begin() + 388, block.end(), std::uint8_t{0});
  const auto read = decode_parameters(block);
  REQUIRE(read.has_value());
  CHECK(*read == p);
}
