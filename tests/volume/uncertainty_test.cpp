// The two ways of propagation against each other, and the bound against maps that were drawn like it and like none.
#include "volume/uncertainty.hpp"

#include "base/random.hpp"
#include "tests/support/test.hpp"
#include "tests/support/volume_machine.hpp"

namespace ecs::volume {
namespace {

/// Nothing but what a test sets.
UncertaintySettings nothing_assumed() {
  UncertaintySettings settings;
  settings.instrument_um_per_m = settings.temperature_degC = settings.declared_zero = settings.squareness_um_per_m =
      0.0;
  return settings;
}

TEST_CASE("a value of a map alone is as uncertain at the tool as it is in the table") {
  CompensatedMachine machine = straight_machine();
  machine.map.tables = {{Component::EXX, Approach::unknown, {0.0, 500.0, 1000.0}, {0.0, -10.0, -20.0}}};
  machine.map.header.uncertainty = {{Component::EXX, 2.0, 0.0, 0}};
  const UncertaintyBudget budget = budget_of(machine, nothing_assumed());
  const auto at = [&](double x) { return covariance_at(machine, budget, {x, 100.0, 100.0}, 1)[0][0]; };
  CHECK(at(0.0) == Approx(0.0));                // the reference
  CHECK(at(500.0) == Approx(8.0));              // its own value and that of the reference
  CHECK(at(750.0) == Approx(4.0 * 0.5 + 4.0));  // half of two values
}

TEST_CASE("what grows with the distance is an expansion") {
  CompensatedMachine machine = straight_machine();
  machine.map.header.uncertainty = {{Component::EXX, 0.0, 0.0, 0}};
  UncertaintySettings settings = nothing_assumed();
  settings.temperature_degC = 0.1;
  settings.instrument_um_per_m = 0.5;
  const UncertaintyBudget budget = budget_of(machine, settings);
  CHECK(std::sqrt(covariance_at(machine, budget, {1000.0, 0.0, 0.0}, 0)[0][0]) == Approx(std::hypot(1.17, 0.5)));
}

TEST_CASE("a component declared zero counts by its lever") {
  CompensatedMachine machine = straight_machine();
  machine.map.header.uncertainty = {{Component::EXX, 0.0, 0.0, 0}};
  machine.map.header.declared_zero = {{Component::EAX, "too small"}};
  UncertaintySettings settings = nothing_assumed();
  settings.declared_zero = 2.0;
  const UncertaintyBudget budget = budget_of(machine, settings);
  CHECK(budget.curves[index_of(Component::EAX)].unmeasured == 2.0);
  CHECK(covariance_at(machine, budget, {700.0, 500.0, 0.0}, 1)[2][2] > 0.0);
}

TEST_CASE("a table that states nothing gets the noise that its roughness shows") {
  CompensatedMachine machine = straight_machine();
  laser::MapTable rough{Component::EXX, Approach::unknown, {}, {}};
  std::mt19937_64 generator(5);
  NormalDraws normal(0.0, 1.5);
  for (int i = 0; i <= 400; ++i) {
    rough.position_mm.push_back(2.5 * i);
    rough.compensation.push_back(30.0 * std::sin(0.01 * i) + normal(generator));
  }
  machine.map.tables = {rough};
  const CurveUncertainty u = budget_of(machine, nothing_assumed()).curves[index_of(Component::EXX)];
  CHECK(u.from == RepeatabilityFrom::roughness);
  CHECK(u.value == Approx(1.5).epsilon(0.15));
}

TEST_CASE("linear propagation and draws agree at every place, on chains of all kinds") {
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT", "ZTYX"}) {
    CAPTURE(chain);
    CompensatedMachine machine = stated_machine(chain);
    machine.parameters.measurement_lines_mm = {{{0, 100, 50}, {200, 0, 70}, {100, 30, 0}}};
    machine.tool_offset_mm = {20.0, -30.0, -150.0};
    machine.map.header.declared_zero = {{Component::EBY, "too small"}};
    std::erase_if(machine.map.tables, [](const auto& table) { return table.component == Component::EBY; });
    const UncertaintyBudget budget = budget_of(machine, {});
    const Grid grid = grid_over(machine.travel_mm, 18, reference_of(machine.parameters));
    constexpr int kDraws = 4000;  // a standard deviation to 1.1 %
    MapDraws draws(machine, budget, 11);
    std::vector<Vector3> squares(2 * grid.places());
    std::vector<Vector3> row(grid.mm[2].size());
    for (int k = 0; k < kDraws; ++k) {
      draws.next();
      const Field field = draws.over(grid);
      std::size_t n = 0;
      for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t x = 0; x < grid.mm[0].size(); ++x)
          for (std::size_t y = 0; y < grid.mm[1].size(); ++y) {
            field.row(side, x, y, row);
            for (const Vector3& error : row) {
              for (std::size_t d = 0; d < kAxes; ++d) squares[n][d] += error[d] * error[d] / kDraws;
              ++n;
            }
          }
    }
    std::size_t n = 0;
    for (std::size_t side = 0; side < 2; ++side)
      for (const double x : grid.mm[0])
        for (const double y : grid.mm[1])
          for (const double z : grid.mm[2]) {
            const Covariance linear = covariance_at(machine, budget, {x, y, z}, side);
            for (std::size_t d = 0; d < kAxes; ++d)
              CHECK(std::sqrt(squares[n][d]) == Approx(std::sqrt(linear[d][d])).epsilon(0.06));
            ++n;
          }
  }
}

TEST_CASE("the bound of the volume says both ways how certain it is, and they agree") {
  const CompensatedMachine machine = stated_machine();
  const auto u = must(uncertainty_of(machine, budget_of(machine, {}), {}, 1000));
  CHECK(u.linear_rms_um == Approx(u.drawn_rms_um).epsilon(0.05));
  CHECK(u.largest_95_um > u.largest_50_um);
  CHECK(u.rms_95_um > u.linear_rms_um);
  CHECK(u.largest_95_um > u.rms_95_um);
}

TEST_CASE("curves that do not act leave those alone that do") {
  CompensatedMachine machine = straight_machine();
  machine.map.header.uncertainty = {{Component::EXX, 1.0, 0.0, 0}};
  const auto u = must(uncertainty_of(machine, budget_of(machine, nothing_assumed()), nothing_assumed(), 64));
  CHECK(u.linear_rms_um > 0.5);
  CHECK(u.drawn_rms_um == Approx(u.linear_rms_um).epsilon(0.08));
}

TEST_CASE("maps drawn with other seeds stay inside the bound in 95 of 100") {
  const CompensatedMachine machine = stated_machine("XYTZ");
  const UncertaintyBudget budget = budget_of(machine, {});
  const auto u = uncertainty_of(machine, budget, {}, 1000);
  const Grid grid = grid_over(machine.travel_mm, 1000, {});
  MapDraws draws(machine, budget, 1000);
  int inside = 0;
  for (int k = 0; k < 400; ++k) {
    draws.next();
    if (size_of(grid, {draws.over(grid), {}}).largest_um <= u->largest_95_um) ++inside;
  }
  CHECK(inside >= 368);  // binomial: 380 expected, below 368 one in 400
  CHECK(inside < 398);
}

TEST_CASE("a finer grid has no smaller bound") {
  const CompensatedMachine machine = stated_machine();
  const UncertaintyBudget budget = budget_of(machine, {});
  UncertaintySettings settings;
  settings.draws = 100;
  const auto coarse = uncertainty_of(machine, budget, settings, 1000),
             fine = uncertainty_of(machine, budget, settings, 100'000);
  REQUIRE(fine);
  CHECK(fine->largest_95_um >= coarse->largest_95_um * 0.98);
}

}  // namespace
}  // namespace ecs::volume
