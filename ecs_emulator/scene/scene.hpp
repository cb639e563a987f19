// What one hidden case is made of before anything is hidden: machine, weather, design of the measurement, map.
// Does not live here: errors (ecs_emulator/effects), readings (ecs_emulator/hidden_cases/measure.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/terms.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

/// Air and bodies at one time.
struct Weather {
  double pressure_hPa = 1013.25;
  double humidity_pct = 50.0;
  std::vector<double> degC;  ///< one per sensor of the scene
};

/// One stop of the machine: everything that an error can depend on.
struct Stop {
  Axis axis = Axis::X;  ///< the one that moves
  Vector3 position_mm{};
  Sense sense = Sense::EX;
  int approach = 1;
  int run = 1;
  double time_s = 0.0;  ///< since the first reading
  double feed_mm_min = 2000.0;
  double load_kg = 0.0;
  double travel_since_reversal_mm = 0.0;
  Weather weather;
};

/// One table of the error map that the unit held: compensation, linear between points.
struct UnitTable {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Approach approach = Approach::unknown;  ///< unknown: for both
  std::vector<double> p_mm;               ///< machine coordinates, ascending
  std::vector<double> value;
};
using UnitMap = std::vector<UnitTable>;

/// A component measured separately.
struct KnownCurve {
  Component code = Component::EAX;
  std::vector<double> p_mm;
  std::vector<double> value;
};

/// Columns that the data file shows.
struct Shown {
  bool approach = true;
  bool run = true;
  bool time = true;
  bool feed = false;
  bool load = false;
  bool travel = false;  ///< since the last reversal
  bool air = false;     ///< pressure and humidity
  bool compensated = false;
  double first_time_s = 0.0;  ///< on the clock of the file
};

struct Scene {
  params::Machine machine;
  Chain chain{};
  MeasurementLines lines_mm{};
  Vector3 datum_mm{};
  TermTable terms;                   ///< of the machine as it is (CurveKind::carriage)
  std::vector<std::string> sensors;  ///< columns, t_<name>_degC; may be none
  std::vector<Stop> stops;           ///< in the order of time
  UnitMap map;                       ///< empty: the unit was off
  std::vector<KnownCurve> known;
  Shown shown;
  bool even_grid = true;  ///< the targets were at equal steps before they were moved

  [[nodiscard]] double p_mm(const Stop& stop, Axis axis) const {
    return stop.position_mm[index_of(axis)] - datum_mm[index_of(axis)];
  }
  /// Place of a sensor in `Weather::degC`; nothing where there is none of that name.
  [[nodiscard]] std::optional<std::size_t> sensor(const std::string& column) const;
  /// What that sensor's place has at a stop [°C].
  [[nodiscard]] double degC(const std::string& column, const Stop& stop, double otherwise) const;
};

/// Linear between points, end values hold. @pre x not empty, as many values
[[nodiscard]] double between_points(const std::vector<double>& x, const std::vector<double>& value, double at);

}  // namespace ecs::emulator
