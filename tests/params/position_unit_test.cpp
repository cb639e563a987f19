// In which unit positions are shown.
#include "params/position_unit.hpp"

#include "tests/support/test.hpp"

namespace ecs::params {
namespace {

TEST_CASE("positions are shown in mm, or in inches of 25.4 mm where the parameters say imperial") {
  const PositionUnit& metric = position_unit(MeasurementSystem::metric);
  CHECK(metric.with_unit(254.0) == "254.0000 mm");
  CHECK(metric.speed_of(1200.0) == "1200.0");
  const PositionUnit& imperial = position_unit(MeasurementSystem::imperial);
  CHECK(imperial.with_unit(-254.0) == "-10.00000 in");
  CHECK(imperial.position(0.001) == "0.00004");
  CHECK(imperial.speed_of(2540.0) == "100.00");
  CHECK(imperial.speed == "in/min");
}

}  // namespace
}  // namespace ecs::params
