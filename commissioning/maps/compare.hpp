// Where two maps differ: header, tables, values by position.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "laser/map/error_map.hpp"

namespace ecs::commissioning {

/// One difference. Values in um, or um/m for a rotation.
struct MapDifference {
  std::optional<Component> component;  ///< absent: the header
  Approach approach = Approach::unknown;
  std::optional<double> position_mm;  ///< absent: the table as a whole
  std::optional<double> expected;
  std::optional<double> found;
  std::string message;  ///< one line that says all of it
};

/// Header lines, declared zeros, tables, then values. Positions within 1e-6 mm and values within 1e-6 are the same.
[[nodiscard]] std::vector<MapDifference> differences_between(const laser::ErrorMap& expected,
                                                             const laser::ErrorMap& found);

/// Tables of the unit that leave the file's own curve by more than their resolution, each where it does so most.
[[nodiscard]] std::vector<MapDifference> beyond_resolution(const laser::ErrorMap& file, const laser::ErrorMap& unit);

/// Where a curve of the unit differs most from the curve that the file gives, at the points of either.
struct LargestDifference {
  Component component = Component::EXX;
  Approach approach = Approach::unknown;
  double position_mm = 0.0;
  double expected = 0.0;  ///< of the file, linear between its points, um or um/m
  double found = 0.0;     ///< of the unit
  [[nodiscard]] double difference() const { return std::abs(expected - found); }
};
/// Nothing: no table is in both.
[[nodiscard]] std::optional<LargestDifference> largest_difference(const laser::ErrorMap& file,
                                                                  const laser::ErrorMap& unit);

}  // namespace ecs::commissioning
