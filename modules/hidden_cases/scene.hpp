// What one hidden case is made of before anything is hidden: machine, weather, design of the measurement, map, what its
// stops cover; machine, weather and the order of stops drawn so that what is hidden can show. Does not live here:
// errors (ecs_emulator/effects, modules/hidden_cases/hiding.hpp), readings (modules/hidden_cases/case.hpp), Ciddor's
// equations of the virtual laser (ecs_emulator/instruments/interferometer.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/terms.hpp"
#include "ecs_emulator/random/random.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

[[nodiscard]] inline double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}
/// Even on a logarithmic scale. @pre 0 < low <= high
[[nodiscard]] inline double log_between(Random& random, double low, double high) {
  return low * std::exp(std::log(high / low) * random.uniform());
}
[[nodiscard]] inline bool chance(Random& random, double probability) { return random.uniform() < probability; }
[[nodiscard]] inline double sign_of_chance(Random& random) { return chance(random, 0.5) ? 1.0 : -1.0; }
/// From low to high, both included.
[[nodiscard]] inline int whole(Random& random, int low, int high) {
  return low + static_cast<int>(random.uniform() * (high - low + 1));
}
/// @pre !of.empty()
template <class T>
[[nodiscard]] const T& one(Random& random, const std::vector<T>& of) {
  return of[static_cast<std::size_t>(random.uniform() * static_cast<double>(of.size()))];
}
template <class T>
void shuffle(Random& random, std::vector<T>& list) {
  for (std::size_t i = list.size(); i > 1; --i)
    std::swap(list[i - 1], list[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
}
/// To a multiple of 1/per_unit.
[[nodiscard]] inline double rounded(double value, double per_unit) {
  const double steps = std::round(value * per_unit);
  return steps == 0.0 ? 0.0 : steps / per_unit;
}

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

/// What the stops of a scene cover: which axes move in which readings, and where.
struct Ground {
  struct Cover {
    bool moved = false;             ///< the axis is moved in readings of the sense
    bool both_ways = false;         ///< and comes from both sides
    std::vector<double> places_mm;  ///< coordinates in readings of the sense, from the datum, ascending, each once
  };
  std::array<PerAxis<Cover>, 6> covers{};  ///< [sense][axis]
  std::vector<Sense> senses;

  [[nodiscard]] const Cover& cover(Sense sense, Axis axis) const {
    return covers[static_cast<std::size_t>(sense)][index_of(axis)];
  }
  /// The only axis moved in readings of the sense, else the sense's own.
  [[nodiscard]] Axis natural_axis(Sense sense) const;
};
[[nodiscard]] Ground ground_of(const Scene& scene);

/// What a measurement must offer so that an error can be seen in it.
struct Needs {
  bool temperature = false;  ///< sensors, and hours in which temperatures change
  bool air = false;          ///< pressure and humidity, changing
  bool feeds = false;        ///< several feeds
  bool loads = false;        ///< several loads
  bool travel = false;       ///< travel since reversal
  bool map = false;          ///< the unit was compensating
  bool known = false;        ///< a component measured separately
  bool one_axis = false;     ///< a single axis is moved
  bool bidirectional = false;
  bool fine = false;          ///< short periods can be seen
  bool along = false;         ///< positioning, along the axis that moves
  bool translations = false;  ///< no rotations are measured
  bool levers = false;        ///< lines at several places of a lever arm
  bool squares = false;       ///< one axis against another
  bool grid = false;          ///< lines at several places, whatever the levers
  bool constant = false;      ///< one temperature, one pressure, one feed, one load
  bool time = false;
  bool irregular = false;  ///< targets at uneven distances: no period hides between them
  int least_axes = 1;
  int least_runs = 1;
  bool one_run = false;     ///< no target is measured again
  bool whole_runs = false;  ///< one line: a run is one stretch of time
};
/// What both need.
[[nodiscard]] Needs operator|(const Needs& a, const Needs& b);

/// n − n at 20 °C, 1013.25 hPa, 50 %RH. Air temperature of the stop's sensor t_air_degC.
[[nodiscard]] double missing_refraction(const Scene& scene, const Stop& stop);

/// @param readings  about this many
[[nodiscard]] Scene draw_scene(Random& random, const Needs& needs, std::size_t readings);

/// The geometry that follows from the machine.
void settle_geometry(Scene& scene);

/// The sense of what is measured along an axis.
[[nodiscard]] constexpr Sense translation_along(Axis axis) { return static_cast<Sense>(index_of(axis)); }

/// One line of a measurement: an axis moves through its targets while the others are parked.
struct Line {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
};
/// How the lines are travelled.
struct Travel {
  PerAxis<std::vector<double>> targets_mm{};
  int runs = 3;
  bool bidirectional = true;
  bool backward_first = false;
  double dwell_s = 2.0;
  double pause_s = 60.0;                     ///< between runs
  std::vector<double> feeds_mm_min{2000.0};  ///< of the runs, in turn
  std::vector<double> loads_kg{0.0};
};
/// Stops in the order of time, run by run, line by line; the weather is not filled in.
[[nodiscard]] std::vector<Stop> stops_along(const std::vector<Line>& lines, const Travel& travel);

}  // namespace ecs::emulator
