#include "params/position_unit.hpp"

#include <fmt/format.h>

#include "base/units.hpp"

namespace ecs::params {
namespace {

constexpr PositionUnit kMetric{"mm", "mm/min", 1.0, 4, 1};
constexpr PositionUnit kImperial{"in", "in/min", kMmPerInch, 5, 2};

}  // namespace

std::string PositionUnit::position(double position_mm) const {
  return fmt::format("{:.{}f}", position_mm / mm, decimals);
}

std::string PositionUnit::speed_of(double mm_min) const { return fmt::format("{:.{}f}", mm_min / mm, speed_decimals); }

std::string PositionUnit::with_unit(double position_mm) const {
  return fmt::format("{} {}", position(position_mm), length);
}

const PositionUnit& position_unit(MeasurementSystem system) {
  return system == MeasurementSystem::imperial ? kImperial : kMetric;
}

}  // namespace ecs::params
