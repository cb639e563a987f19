// The thesis's own example (3.4, figure 3.5): one axis, a progressive error, compensation in steps of the resolution.
// The unit's own output moves the axes it watches: it must not be taken for a move of the control.
#include <memory>

#include "core/tick.hpp"
#include "tests/core/support/image_of.hpp"
#include "tests/support/random_values.hpp"

using namespace ecs;
using namespace ecs::test;

namespace {

constexpr double kError_um_per_mm = 0.25;
constexpr double kResolution_um = 2.0;
constexpr double kStep_mm = 8.0;  // the travel over which the error grows by the resolution
constexpr int kSteps = 50;

struct Rig {
  std::unique_ptr<CompiledMap> map = std::make_unique<CompiledMap>();
  TickState state;

  Rig() {
    UnitParameters p;
    set_configuration(p, "TX");
    p.interpolation = Interpolation::nearest;
    p.axes[0].position_scale_um_per_count = kResolution_um;
    p.axes[0].output_scale_counts_per_um = 1.0 / kResolution_um;
    p.axes[0].output_slew_um_per_s = 1e6;
    PlannedTable steps{Component::EXX, Approach::unknown, 0.0, kStep_mm, kResolution_um, {}};
    for (int k = 0; k <= kSteps; ++k) steps.counts.push_back(static_cast<std::int16_t>(-k));
    const auto image = image_of(p, {steps});
    REQUIRE(compile(ImageView(image), *map).fault == Fault::none);
    start(state, {}, {}, {Approach::forward, Approach::forward, Approach::forward});
  }
  /// Error left at a position [um].
  double residual_um(std::int64_t counts) {
    tick(*map, state, {counts, 0, 0});
    return kError_um_per_mm * state.position_mm[0] + kResolution_um * state.dac_counts[0];
  }
};

}  // namespace

TEST_CASE("stepping half an increment in advance keeps the axis within its resolution, out and back") {
  Rig rig;
  const auto end = static_cast<std::int64_t>(kSteps * kStep_mm * 1000.0 / kResolution_um);
  double worst_um = 0.0;
  for (std::int64_t counts = 0; counts <= end; ++counts)
    worst_um = std::max(worst_um, std::abs(rig.residual_um(counts)));
  for (std::int64_t counts = end; counts >= 0; --counts)
    worst_um = std::max(worst_um, std::abs(rig.residual_um(counts)));
  CHECK(worst_um <= kResolution_um);
  CHECK(worst_um == Approx(kResolution_um / 2.0).epsilon(0.001));  // half a step is left half way between
}

TEST_CASE("each value is applied 4 mm before its point, in either direction") {
  Rig rig;
  (void)rig.residual_um(1'998);  // 3.996 mm
  CHECK(rig.state.dac_counts[0] == 0);
  (void)rig.residual_um(2'000);
  CHECK(rig.state.dac_counts[0] == -1);
  (void)rig.residual_um(4'000);  // 8 mm
  CHECK(rig.state.dac_counts[0] == -1);
  (void)rig.residual_um(1'999);
  CHECK(rig.state.dac_counts[0] == 0);
}

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
