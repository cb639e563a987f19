// Another tool in the running loop, against the product of the exact matrices of the chain with the tool at its end
// (tests/core/support/measured_machine.hpp).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/tick.hpp"
#include "tests/core/support/measured_machine.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr double kAtOnce_um = std::numeric_limits<double>::infinity();

// How far a first-order model may be from the matrices. With nine angles of up to a, s = 9 a, the product of the
// rotations differs from 1 + Σ ε by at most s²/2, at an arm of √3 (150 + 300) mm = 0.78 m; what lies inside rotations
// of other axes (curves and own levers up to 25 um, squareness up to 4 um an axis) is turned by at most 2 s in all:
// with 10 um/m 0.0032 + 0.0052 um where every sign conspires. The matrices know their second order themselves: it is
// what the errors and the same errors negated have in common, at most 0.0004 um here, and 0.007 um with 50 um/m.
constexpr double kSmallAngles_um_per_m = 10.0;
constexpr double kLargeAngles_um_per_m = 50.0;
constexpr double kSecondOrderOfSmallAngles_um = 0.003;
// Half the difference between the two has no second order. What is left is s³/6 at the same arm and s²/2 of what lies
// inside: 1.5e-7 um with small and 2.2e-5 um with large angles.
constexpr double kThirdOrderOfSmallAngles_um = 2e-7;
constexpr double kThirdOrderOfLargeAngles_um = 3e-5;

/// The unit with the map that was measured on this machine.
struct UnitOnMachine {
  const MeasuredMachine& machine;
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;
  ThermalState thermal;
  InputValues inputs{};
  PerAxis<std::int64_t> counts{};

  explicit UnitOnMachine(const MeasuredMachine& m) : machine(m) {
    const auto image = image_of(m.parameters, map_of(m), "", m.rows, {.stuck_s = 0.0});  // inputs here stay as they are
    REQUIRE(check_image(image).fault == ImageFault::none);
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
  }
  /// The loop begins here.
  void begin(const Standing& at) {
    place(at.position_mm);
    start(state, counts, at.position_mm, at.approach);
    inputs = at.inputs;
    thermal = {};
    (void)begin_thermal(map->thermal, thermal, inputs, at.position_mm, nullptr, 0.0);
    period();
  }
  void place(const Vector3& position_mm) {
    for (std::size_t a = 0; a < kAxes; ++a) counts[a] = std::llround(position_mm[a] * 1000.0);
  }
  void period() {
    if (machine.rows.empty()) {
      tick(*map, state, counts);
      return;
    }
    tick(*map, state, counts, thermal.acting);
    if (state.ticks % 100 == 0) slow_loop();
  }
  void slow_loop() {
    for (InputValue& input : inputs) input.number += input.present ? 1 : 0;
    (void)step_thermal(map->thermal, thermal, inputs, state.position_mm, kThermalStep_s);
  }
  bool another_tool(const Vector3& tool_mm, double most_um) {
    const bool reached = change_tool(*map, state, thermal, tool_mm, most_um);
    period();
    return reached;
  }
  /// D/A output before it is rounded, um.
  [[nodiscard]] Vector3 output_um() const {
    return {state.output_counts[0] / kCountsEachUm, state.output_counts[1] / kCountsEachUm,
            state.output_counts[2] / kCountsEachUm};
  }
};

/// A thousand places, each with another tool, at once or in steps of 0.25 um.
FromMatrices thousand_places(Draws& draws, const MeasuredMachine& m) {
  UnitOnMachine unit(m);
  FromMatrices seen;
  Vector3 tool_mm = m.parameters.tool_offset_mm;
  for (int place = 0; place < 1000; ++place) {
    const Standing at = draws.standing(m.chain);
    unit.begin(at);
    seen.note(unit.output_um(), m, at, tool_mm);  // the tool before
    tool_mm = draws.vector(kLongestTool_mm);
    const double most_um = place % 2 == 0 ? kAtOnce_um : 0.25;
    int periods = 1;
    while (!unit.another_tool(tool_mm, most_um) && periods < 10'000) ++periods;
    REQUIRE(periods < 10'000);
    if (most_um == kAtOnce_um) REQUIRE(periods == 1);
    seen.note(unit.output_um(), m, at, tool_mm);
    seen.note(unit.state.compensation_um, m, at, tool_mm);
    for (std::size_t a = 0; a < kAxes; ++a)
      REQUIRE(std::abs(unit.state.dac_counts[a] - unit.state.output_counts[a]) <= 0.5 + 1e-9);
    unit.slow_loop();
    unit.period();
    seen.note(unit.output_um(), m, at, tool_mm);  // the slow loop keeps the tool
  }
  return seen;
}

constexpr double kMostEachPeriod_um = 0.02;  // 20 um/s at 1 kHz

/// A loop that does not stop: axes go to other places, tools are changed, and some changes are overtaken by the next.
struct RunningUnit {
  UnitOnMachine unit;
  Draws& draws;
  Standing at;
  double largest_step_um = 0.0;  ///< of the output of any axis, from one period to the next, while no axis moves
  std::int32_t largest_dac_step = 0;
  int abandoned = 0;

  RunningUnit(const MeasuredMachine& m, Draws& with) : unit(m), draws(with), at(with.standing(m.chain)) {
    unit.begin(at);
  }

  /// Goes elsewhere, changes the tool, and one time in four goes on before it has changed, with another tool.
  Vector3 change_tool_on_the_way() {
    move();
    Vector3 tool_mm = draws.vector(kLongestTool_mm);
    if (draws.one_in(4) && !changes_within(tool_mm, 50)) {
      ++abandoned;
      move();
      tool_mm = draws.one_in(2) ? Vector3{} : draws.vector(kLongestTool_mm);
    }
    REQUIRE(changes_within(tool_mm, 20'000));
    const TickState before = unit.state;
    REQUIRE(unit.another_tool(tool_mm, kMostEachPeriod_um));
    CHECK(unit.state.output_counts == before.output_counts);
    return tool_mm;
  }

 private:
  bool changes_within(const Vector3& tool_mm, int periods) {
    for (int period = 0; period < periods; ++period) {
      const TickState before = unit.state;
      const bool reached = unit.another_tool(tool_mm, kMostEachPeriod_um);
      for (std::size_t a = 0; a < kAxes; ++a) {
        const double step_um = std::abs(unit.state.output_counts[a] - before.output_counts[a]) / kCountsEachUm;
        largest_step_um = std::max(largest_step_um, step_um);
        largest_dac_step = std::max(largest_dac_step, std::abs(unit.state.dac_counts[a] - before.dac_counts[a]));
      }
      if (reached) return true;
    }
    return false;
  }
  /// Each axis by more than its deadband, in one period.
  void move() {
    const Vector3 to_mm = draws.place(unit.machine.chain);
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (std::abs(to_mm[a] - at.position_mm[a]) < 2.0) continue;
      at.approach[a] = to_mm[a] > at.position_mm[a] ? Approach::forward : Approach::reverse;
      at.position_mm[a] = to_mm[a];
    }
    unit.place(at.position_mm);
    unit.period();
  }
};

}  // namespace

TEST_CASE("after a change of tool the output is the error of the exact matrices negated, for every chain") {
  Draws draws(20261126);
  const auto chains = every_chain();
  REQUIRE(chains.size() == 48);
  for (const std::string& chain : chains) {
    CAPTURE(chain);
    const FromMatrices seen = thousand_places(draws, draws.machine(chain, kSmallAngles_um_per_m, 8.0, false));
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.second_order_um <= kSecondOrderOfSmallAngles_um);
    CHECK(seen.first_order_um <= kThirdOrderOfSmallAngles_um);
  }
}

TEST_CASE("thermal rotations turn another tool as the exact matrices do, on every chain") {
  Draws draws(20261127);
  for (const std::string& chain : every_chain()) {
    CAPTURE(chain);
    const FromMatrices seen = thousand_places(draws, draws.machine(chain, kSmallAngles_um_per_m, 8.0, true));
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.second_order_um <= kSecondOrderOfSmallAngles_um);
    CHECK(seen.first_order_um <= kThirdOrderOfSmallAngles_um);
  }
}

TEST_CASE("with angles of 50 um/m a change of tool follows the exact matrices to first order") {
  Draws draws(20261128);
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT", "YXTZ", "ZTXY"}) {
    CAPTURE(chain);
    const FromMatrices seen = thousand_places(draws, draws.machine(chain, kLargeAngles_um_per_m, 40.0, true));
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.first_order_um <= kThirdOrderOfLargeAngles_um);
  }
}

TEST_CASE("a thousand changes of tool in a running loop keep the limit in every period and end at the matrices") {
  Draws draws(20261129);
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT"}) {
    CAPTURE(chain);
    const MeasuredMachine m = draws.machine(chain, kLargeAngles_um_per_m, 40.0, true);
    RunningUnit running(m, draws);
    FromMatrices seen;
    for (int change = 0; change < 1000; ++change) {
      const Vector3 tool_mm = running.change_tool_on_the_way();
      seen.note(running.unit.output_um(), m, running.at, tool_mm);
    }
    CHECK(running.largest_step_um <= kMostEachPeriod_um + 1e-9);
    CHECK(running.largest_step_um > 0.9 * kMostEachPeriod_um);
    CHECK(running.largest_dac_step <= 1);  // 0.8 counts
    CHECK(running.abandoned > 100);
    CHECK(seen.whole_um <= kAllowed_um);
    CHECK(seen.first_order_um <= kThirdOrderOfLargeAngles_um);
  }
}
