// A log of channels as measurements of X.
#pragma once

#include <doctest/doctest.h>

#include "commissioning/measurements/files.hpp"

namespace ecs {

inline laser::MeasurementSet read_log(const std::filesystem::path& file, const std::string& channel = {}) {
  commissioning::ImportArguments arguments;
  arguments.axis = "X";
  arguments.channel = channel;
  const auto log = commissioning::read_measurements(file.string(), arguments);
  REQUIRE_MESSAGE(log.has_value(), (log ? "" : to_text(log.error())));
  return log->set;
}

}  // namespace ecs
