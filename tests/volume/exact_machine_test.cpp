// The sums of volume/field.hpp against rigid bodies with exact rotation matrices, written from the definition alone.
#include "tests/support/exact_machine.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "base/random.hpp"
#include "tests/support/random_values.hpp"
#include "volume/field.hpp"

namespace ecs::volume {
namespace {

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
    for (std::size_t d = 0; d < kAxes; ++d) CHECK(row[z][d] == doctest::Approx(field.at(1, {2, 0, z})[d]));
}

TEST_CASE("at the reference the mean of both sides is zero") {
  std::mt19937_64 generator(4);
  const Case made = case_of("XYTZ", 1.0, generator);
  Field field(made.grid, made.components, made.kinematics);
  field.count_from_reference();
  for (std::size_t d = 0; d < kAxes; ++d)
    CHECK(field.at_reference(0)[d] + field.at_reference(1)[d] == doctest::Approx(0.0));
}

}  // namespace
}  // namespace ecs::volume
