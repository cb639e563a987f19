// Sizes of a volume that a hand can check, and what a unit leaves of it. The sums of volume/field.hpp against rigid
// bodies with exact rotation matrices, written from the definition alone.
#include "volume/volume.hpp"

#include <random>

#include "base/random.hpp"
#include "tests/support/exact_machine.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/volume_machine.hpp"
#include "volume/field.hpp"

namespace ecs::volume {
namespace {

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
  const auto answer = must(evaluated(machine, 1000));
  CHECK(answer.before.all.largest_um == Approx(20.0));  // 20 um over 1000 mm
  CHECK(answer.before.all.at_mm[0] == 1000.0);
  CHECK(answer.before.all.error_um[0] == Approx(20.0));
  // Places at even steps 0 … 20: mean square 20² · (2n−1)/(6(n−1)), n = 10
  CHECK(answer.before.all.rms_um == Approx(20.0 * std::sqrt(19.0 / 54.0)));
  CHECK(answer.before.diagonals.places == 4 * kDiagonalPlaces);
  CHECK(answer.before.edges.largest_um == Approx(20.0));
  CHECK(answer.after.all.largest_um < 1e-9);
}

TEST_CASE(
    "a part of the volume has no larger error than the whole: a peak between grid places shows on the diagonals") {
  CompensatedMachine machine = straight_machine();
  machine.map.tables = {
      {Component::EXX, Approach::unknown, {0.0, 490.0, 500.0, 510.0, 1000.0}, {0.0, 0.0, -50.0, 0.0, 0.0}}};
  machine.errors = errors_of_map(machine.map, machine.parameters, {});
  const auto answer = must(evaluated(machine, 1000));  // X in ten places, none near 500
  CHECK(answer.before.diagonals.largest_um == Approx(50.0));
  CHECK(answer.before.all.largest_um == Approx(50.0));
  CHECK(answer.before.all.at_mm[0] == Approx(500.0));
  CHECK(answer.before.all.largest_along_um[0] == Approx(50.0));
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
  const auto errors = must(errors_over(machine, grid));
  CHECK(errors.before.at(grid, 1, {})[1] == Approx(6.0));  // E_Y = −EAX·Z, Z = −0.2 m
  CHECK(errors.after.at(grid, 1, {})[1] == Approx(6.0));   // the unit knows nothing of the tool
  machine.parameters.tool_offset_mm = machine.tool_offset_mm;
  CHECK(errors_over(machine, grid)->after.at(grid, 1, {})[1] == Approx(0.0));
}

TEST_CASE("reversal counts from the mean of both sides at the reference") {
  CompensatedMachine machine = straight_machine();
  machine.map.tables = {{Component::EXX, Approach::forward, {0.0, 1000.0}, {-3.0, -3.0}},
                        {Component::EXX, Approach::reverse, {0.0, 1000.0}, {3.0, 3.0}}};
  machine.errors = errors_of_map(machine.map, machine.parameters, {});
  const auto answer = must(evaluated(machine, 8));
  CHECK(answer.before.all.largest_um == Approx(3.0));
  CHECK(answer.before.all.rms_um == Approx(3.0));
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

struct Case {
  Grid grid;
  Components components;
  Kinematics kinematics;
};

Case case_of(const std::string& configuration, double size, std::mt19937_64& generator) {
  UniformDraws any(-1.0, 1.0);
  const Chain chain = *chain_of(configuration);
  Travels travel_mm{};
  for (const Axis axis : kAllAxes)
    if (chain.has(axis)) travel_mm[index_of(axis)] = {-1200.0, 900.0};
  Case made{grid_over(travel_mm, 27, {}), {}, {*terms_of(chain, Convention::iso, CurveKind::carriage), {}, {}}};
  for (std::size_t c = 0; c < kComponents; ++c) {
    const auto component = static_cast<Component>(c);
    if (is_squareness(component)) {
      made.components.squareness[c] = 50.0 * size * any(generator);
      continue;
    }
    if (!chain.has(moving_axis(component))) continue;
    for (auto& side : made.components.curve)
      for (std::size_t i = 0; i < coordinates_of(made.grid, moving_axis(component)).size(); ++i)
        side[c].push_back((is_angular(component) ? 60.0 : 40.0) * size * any(generator));
  }
  for (auto& line : made.kinematics.lines_mm)
    for (std::size_t l = 0; l < kAxes; ++l) line[l] = chain.has(static_cast<Axis>(l)) ? 300.0 * any(generator) : 0.0;
  for (double& offset : made.kinematics.tool_offset_mm) offset = 150.0 * any(generator);
  return made;
}

/// Largest distance between both, um, over every place of the grid.
double largest_difference(const Case& made, const std::string& configuration) {
  const Field field(made.grid, made.components, made.kinematics);
  double largest = 0.0;
  for (std::size_t side = 0; side < kSides.size(); ++side)
    for (std::size_t x = 0; x < made.grid.mm[0].size(); ++x)
      for (std::size_t y = 0; y < made.grid.mm[1].size(); ++y)
        for (std::size_t z = 0; z < made.grid.mm[2].size(); ++z) {
          const GridIndex index{x, y, z};
          test::MachineErrors exact{made.components.squareness, made.kinematics.lines_mm,
                                    made.kinematics.tool_offset_mm};
          for (std::size_t c = 0; c < kCurves; ++c)
            if (const auto& values = made.components.curve[side][c]; !values.empty())
              exact.values[c] = values[index[index_of(moving_axis(static_cast<Component>(c)))]];
          const Vector3 expected = test::exact_error_um(configuration, exact, made.grid.at(index));
          const Vector3 found = field.at(side, index);
          for (std::size_t d = 0; d < kAxes; ++d)
            if (chain_of(configuration)->has(static_cast<Axis>(d)))
              largest = std::max(largest, std::abs(found[d] - expected[d]));
        }
  return largest;
}

TEST_CASE("the field agrees with exact matrices to second order on every chain") {
  for (const std::string& chain : test::every_chain()) {
    CAPTURE(chain);
    std::mt19937_64 large(7), small(7);
    const double difference = largest_difference(case_of(chain, 1.0, large), chain);
    const double of_half = largest_difference(case_of(chain, 0.5, small), chain);
    CHECK(difference < 0.2);                   // um, of errors of up to some hundred um
    CHECK(of_half < difference / 3.0 + 1e-7);  // a quarter, were it of second order alone
  }
}

TEST_CASE("a row of places is the same as one place after the other") {
  std::mt19937_64 generator(3);
  const Case made = case_of("XTYZ", 1.0, generator);
  Field field(made.grid, made.components, made.kinematics);
  field.count_from_reference();
  std::vector<Vector3> row(made.grid.mm[2].size());
  field.row(1, 2, 0, row);
  for (std::size_t z = 0; z < row.size(); ++z)
    for (std::size_t d = 0; d < kAxes; ++d) CHECK(row[z][d] == Approx(field.at(1, {2, 0, z})[d]));
}

TEST_CASE("at the reference the mean of both sides is zero") {
  std::mt19937_64 generator(4);
  const Case made = case_of("XYTZ", 1.0, generator);
  Field field(made.grid, made.components, made.kinematics);
  field.count_from_reference();
  for (std::size_t d = 0; d < kAxes; ++d) CHECK(field.at_reference(0)[d] + field.at_reference(1)[d] == Approx(0.0));
}

}  // namespace
}  // namespace ecs::volume
