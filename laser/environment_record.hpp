// One line of an environment log. Does not live here: reading and writing such logs (laser/import/import.hpp,
// laser/writers/table_writers.hpp).
#pragma once

#include "core/axis.hpp"

namespace ecs::laser {

struct EnvironmentRecord {
  Vector3 stage_mm{};
  Vector3 air_degC{};  ///< at the X, Y and Z interferometer
  double pressure_hPa = 0.0;
  double humidity_pct = 0.0;
  double sample_degC = 0.0;
  friend bool operator==(const EnvironmentRecord&, const EnvironmentRecord&) = default;
};

}  // namespace ecs::laser
