// Sizes of a volume that a hand can check, and what a unit leaves of it.
#include "volume/volume.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/volume_machine.hpp"

namespace ecs::volume {
namespace {

using doctest::Approx;

TEST_CASE("a grid holds both ends of every travel and no more places than asked for") {
  const Travels travel_mm{{{{0.0, 100.0}}, {{-50.0, 0.0}}, {{0.0, 10.0}}}};
  for (const std::size_t asked : std::initializer_list<std::size_t>{8, 27, 100, 1000, 99'999}) {
    const Grid grid = grid_over(travel_mm, asked, {});
    CHECK(grid.places() <= asked);
    CHECK(grid.places() > asked / 2);
    CHECK(grid.mm[0].front() == 0.0);
    CHECK(grid.mm[0].back() == 100.0);
    CHECK(grid.mm[1].front() == -50.0);
  }
  CHECK(grid_over(travel_mm, 1'000'000, {}).places() == 1'000'000);
  CHECK(grid_over({{{{0.0, 1.0}}, {}, {}}}, 500, {}).places() == 500);
}

TEST_CASE("a scale error alone is largest at the far end and needs no unit to be known") {
  CompensatedMachine machine = straight_machine();
  const auto answer = evaluated(machine, 1000);
  REQUIRE(answer);
  CHECK(answer->before.all.largest_um == Approx(20.0));  // 20 um over 1000 mm
  CHECK(answer->before.all.at_mm[0] == 1000.0);
  CHECK(answer->before.all.error_um[0] == Approx(20.0));
  // Places at even steps 0 … 20: mean square 20² · (2n−1)/(6(n−1)), n = 10
  CHECK(answer->before.all.rms_um == Approx(20.0 * std::sqrt(19.0 / 54.0)));
  CHECK(answer->before.diagonals.places == 4 * kDiagonalPlaces);
  CHECK(answer->before.edges.largest_um == Approx(20.0));
  CHECK(answer->after.all.largest_um < 1e-9);
}

TEST_CASE("95 of 100 places have no more than p95") {
  const auto answer = evaluated(straight_machine(), 1000);  // 10 steps of X: 0, 2.22, … 20
  REQUIRE(answer);
  CHECK(answer->before.all.p95_um == Approx(20.0).epsilon(1e-6));
  const auto finer = evaluated(straight_machine(), 1'000'000);
  CHECK(finer->before.all.p95_um == Approx(20.0 * 94.0 / 99.0).epsilon(1e-6));
}

TEST_CASE("a roll error acts by the lever and a longer tool by a longer one") {
  CompensatedMachine machine = straight_machine();
  machine.map.tables = {{Component::EAX, Approach::unknown, {0.0, 1000.0}, {0.0, -30.0}}};  // an error of 30 um/m
  machine.errors = errors_of_map(machine.map, machine.parameters, {0.0, 0.0, -200.0});
  machine.tool_offset_mm = {0.0, 0.0, -200.0};
  const Grid grid = grid_at(machine.travel_mm, {1000.0, 0.0, 0.0}, {});
  const auto errors = errors_over(machine, grid);
  REQUIRE(errors);
  CHECK(errors->before.at(grid, 1, {})[1] == Approx(6.0));  // E_Y = −EAX·Z, Z = −0.2 m
  CHECK(errors->after.at(grid, 1, {})[1] == Approx(6.0));   // the unit knows nothing of the tool
  machine.parameters.tool_offset_mm = machine.tool_offset_mm;
  CHECK(errors_over(machine, grid)->after.at(grid, 1, {})[1] == Approx(0.0));
}

TEST_CASE("reversal counts from the mean of both sides at the reference") {
  CompensatedMachine machine = straight_machine();
  machine.map.tables = {{Component::EXX, Approach::forward, {0.0, 1000.0}, {-3.0, -3.0}},
                        {Component::EXX, Approach::reverse, {0.0, 1000.0}, {3.0, 3.0}}};
  machine.errors = errors_of_map(machine.map, machine.parameters, {});
  const auto answer = evaluated(machine, 8);
  REQUIRE(answer);
  CHECK(answer->before.all.largest_um == Approx(3.0));
  CHECK(answer->before.all.rms_um == Approx(3.0));
}

TEST_CASE("vectors at places give the same answer as the components they come from") {
  const CompensatedMachine machine = straight_machine();
  CompensatedMachine other = machine;
  other.errors = {};
  other.errors.vectors = [&machine](const std::vector<Place>& places) -> Result<std::vector<Vector3>> {
    std::vector<Vector3> out;
    for (const Place& place : places) {
      const Grid grid = grid_at(machine.travel_mm, place.position_mm, {});
      out.push_back(errors_over(machine, grid)->before.at(grid, place.side, {}));
    }
    return out;
  };
  const auto a = evaluated(machine, 64), b = evaluated(other, 64);
  REQUIRE(b);
  CHECK(a->before.all.rms_um == Approx(b->before.all.rms_um));
  CHECK(a->before.diagonals.p95_um == Approx(b->before.diagonals.p95_um));
  CHECK(b->after.all.largest_um < 1e-9);
}

}  // namespace
}  // namespace ecs::volume
