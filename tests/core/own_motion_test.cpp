// The unit's own output moves the axes it watches: it must not be taken for a move of the control.
#include <cmath>
#include <memory>

#include <doctest/doctest.h>

#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

/// X and Y; the straightness of Y asks X for up to 100 um along Y, and for 26 um more in reverse. X stands at a control
/// whose loop follows the output with `kv_per_s`; the unit assumes 30.
struct TwoAxes {
  UnitParameters parameters;
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;
  double kv_per_s;
  double x_command_mm = 0.0;
  double x_drift_mm = 0.0;

  explicit TwoAxes(double true_kv_per_s) : kv_per_s(true_kv_per_s) {
    set_configuration(parameters, "TXY");
    parameters.axis_present = {true, true, false};
    parameters.scope = Scope::planar;
    std::vector<PlannedTable> tables;
    const ComponentSet needed = components_needed(parameters);
    for (std::size_t c = 0; c < kCurves; ++c)
      if (needed.has[c] && c != index_of(Component::EXY))
        tables.push_back({static_cast<Component>(c), Approach::unknown, 0.0, 1.0, 1.0, {0}});
    tables.push_back({Component::EXY, Approach::forward, 0.0, 100.0, 1.0, {0, 100}});
    tables.push_back({Component::EXY, Approach::reverse, 0.0, 100.0, 1.0, {26, 126}});
    const auto image = image_of(parameters, tables);
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
    start(state, {0, 0, 0}, {0.0, 0.0, 0.0}, {Approach::forward, Approach::forward, Approach::forward});
  }

  void step(double y_mm) {
    const double part = 1.0 - std::exp(-kv_per_s * map->period_s);
    const double output_mm = state.dac_counts[0] / parameters.axes[0].output_scale_counts_per_um / 1000.0;
    x_drift_mm += (output_mm - x_drift_mm) * part;
    tick(*map, state, {std::lround((x_command_mm + x_drift_mm) * 1000.0), std::lround(y_mm * 1000.0), 0});
  }
  /// Y there and back at 100 mm/s, reversing at once.
  void y_there_and_back() {
    for (int k = 0; k <= 1000; ++k) step(0.1 * k);
    for (int k = 1000; k >= 0; --k) step(0.1 * k);
  }
};

}  // namespace

TEST_CASE("an axis at rest does not change approach when another axis moves it, with a drive gain a quarter off") {
  for (const double kv_per_s : {22.5, 30.0, 37.5}) {
    CAPTURE(kv_per_s);
    TwoAxes machine(kv_per_s);
    machine.y_there_and_back();
    CHECK(machine.x_drift_mm > 0.02);
    CHECK(machine.state.approach[0] == Approach::forward);
    CHECK(machine.state.approach[1] == Approach::reverse);
  }
}

TEST_CASE("a move of the control turns the axis all the same, however far it has drifted") {
  TwoAxes machine(30.0);
  for (int k = 0; k <= 1000; ++k) machine.step(0.1 * k);
  machine.x_command_mm = -0.02;  // four times the deadband, a fifth of the drift
  for (int k = 0; k < 10; ++k) machine.step(100.0);
  CHECK(machine.state.approach[0] == Approach::reverse);
}
