// A log of channels as measurements of X.
#pragma once

#include "commissioning/measurements/files.hpp"
#include "tests/support/test.hpp"

namespace ecs {

inline laser::MeasurementSet read_log(const std::filesystem::path& file, const std::string& channel = {}) {
  commissioning::ImportArguments arguments{.axis = "X", .channel = channel};
  return must(commissioning::read_measurements(file.string(), arguments)).set;
}

}  // namespace ecs
