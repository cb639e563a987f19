#include <map>

#include <doctest/doctest.h>

#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/workshop/survey.hpp"
#include "tests/ecs_emulator/support/emulated_unit.hpp"

using namespace ecs;
using namespace ecs::emulator;
using namespace ecs::emulator::test;

namespace {

/// Every component errs, none at its axis's datum; angles of some 50 um/m, so that levers count.
std::string every_error() {
  std::string text = "[squareness]\nC0Y = 40.0\nB0Z = -50.0\nA0Z = 60.0\n";
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto curve = static_cast<Component>(c);
    const std::string size = std::to_string((is_angular(curve) ? 50.0 : 15.0) * (c % 2 == 0 ? 1.0 : -0.7));
    text += "[[contribution]]\ncomponent = \"" + std::string(name_of(curve)) + "\"\nformula = \"" + size + "*sin(p/" +
            std::to_string(120 + 7 * c) + ") + 0.002*p*(d+1)\"\n";
  }
  return text;
}

double squareness_slope(Component curve) {  // um/m of E along the moving axis
  if (curve == Component::EXY) return -40.0;
  if (curve == Component::EXZ) return -50.0;
  return curve == Component::EYZ ? -60.0 : 0.0;
}

}  // namespace

TEST_CASE("compensated with curves measured along the axes, any machine is accurate in its whole volume") {
  for (const std::string configuration : {"TXYZ", "XTYZ", "XYTZ", "XYZT", "YXTZ", "ZXTY"}) {
    CAPTURE(configuration);
    Bench bench(every_error(), ideal_machine(configuration));
    bench.parameters.C0Y_um_per_m = 40.0;
    bench.parameters.B0Z_um_per_m = -50.0;
    bench.parameters.A0Z_um_per_m = 60.0;
    const ComponentSet needed = components_needed(bench.parameters);
    std::map<std::pair<Component, Approach>, std::map<long, double>> measured;
    for (std::size_t c = 0; c < kCurves; ++c) {
      const auto curve = static_cast<Component>(c);
      if (!needed.contains(curve)) continue;
      MeasurementPlan plan;
      plan.axis = moving_axis(curve);
      plan.sense = sense_of(curve);
      const auto [low, high] = bench.simulation.machine().axis(plan.axis).facts().travel_mm;
      plan.targets_mm = targets_between(high, low, 10.0);
      plan.runs = 1;
      plan.feed_mm_min = 6000.0;
      const auto set = measure(bench.simulation, plan);
      REQUIRE(set.has_value());
      for (const auto& reading : set->readings)
        measured[{curve, reading.approach}][std::lround(laser::target_mm(reading))] = reading.error;
    }
    const SurveyPlan plan{.step_mm = 100.0, .approach = Approach::reverse};
    const double before_um = worst(survey(bench.simulation, plan)->grid).length_um();
    bench.compensate([&](Component curve, double p, Approach approach) {
      return squareness_slope(curve) * p * 1e-3 - measured[{curve, approach}][std::lround(p)];
    });
    const auto after = survey(bench.simulation, plan);
    REQUIRE(after.has_value());
    CHECK(before_um > 30.0);
    CHECK(worst(after->grid).length_um() < 0.2);
  }
}
