// Where two maps differ: header, tables, values by position.
#pragma once

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

}  // namespace ecs::commissioning
