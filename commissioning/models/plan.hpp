// Places to be measured or predicted, from a measurement set whose readings do not count.
#pragma once

#include <string>

#include "commissioning/measurements/files.hpp"

namespace ecs::commissioning {

/// The rows of a file; a CSV with the columns of a measurement set but without `reading` is taken with readings 0.
struct Plan {
  laser::MeasurementSet set;
  bool has_readings = true;
};
[[nodiscard]] Result<Plan> plan_in(const std::string& file, const ImportArguments& import);

}  // namespace ecs::commissioning
