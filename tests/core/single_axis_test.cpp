// The thesis's own example (3.4, figure 3.5): one axis, a progressive error, compensation in steps of the resolution.
#include <algorithm>
#include <cmath>
#include <memory>

#include <doctest/doctest.h>

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
  CHECK(worst_um == doctest::Approx(kResolution_um / 2.0).epsilon(0.001));  // half a step is left half way between
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
