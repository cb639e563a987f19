// A machine and what was measured on it: the readings with everything that a measurement set says about them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bench/foreign/random.hpp"

namespace foreign {

struct AxisFacts {
  double low_mm = 0.0;
  double high_mm = 0.0;
  double datum_mm = 0.0;
  double resolution_um = 0.1;
  std::optional<double> screw_pitch_mm;
  std::optional<double> scale_pitch_mm;
  double expansion_um_per_m_degC = 11.0;
  std::optional<std::array<double, 3>> measurement_line_mm;  ///< machine coordinates; the own one is unused
};

struct Machine {
  std::string name;
  std::string configuration;
  std::array<AxisFacts, 3> axes;
};

struct Reading {
  char axis = 'X';
  std::string sense;
  std::array<double, 3> at_mm{};
  int approach = 1;
  int run = 1;
  double time_s = 0.0;
  double feed_mm_min = 0.0;
  double load_kg = 0.0;
  double travel_mm = 0.0;  ///< since reversal
  double pressure_hPa = 1013.25;
  double humidity_pct = 50.0;
  std::vector<double> sensors_degC;  ///< in the order of Setup::sensors
};

/// Compensation of one component by linear interpolation, for one approach or both (0).
struct MapTable {
  char axis = 'X';
  std::string sense;
  int approach = 0;
  std::vector<double> p_mm;
  std::vector<double> value_um;
};

struct Known {
  std::string code;
  std::vector<double> p_mm;
  std::vector<double> value;
};

struct Setup {
  Machine machine;
  std::vector<std::string> sensors;  ///< column names
  bool feed = false;
  bool load = false;
  bool travel = false;
  bool air = false;
  bool moved_targets = false;
  std::vector<Reading> readings;  ///< in order of time
  std::vector<MapTable> map;
  std::optional<Known> known;
  std::string layout;  ///< "line", "levers" or "plane"
};

/// What a set must have so that an effect can show.
struct Wishes {
  bool along = false;   ///< the sense of the moving axis itself
  bool across = false;  ///< another sense
  bool both_approaches = false;
  bool runs = false;   ///< at least three
  bool feeds = false;  ///< the feed differs from run to run
  bool one_feed = false;
  bool loads = false;
  bool one_load = false;
  bool travel = false;  ///< travel_since_reversal_mm, with targets close behind the reversal
  bool air = false;
  bool one_weather = false;  ///< air columns that do not change
  bool material = false;     ///< t_material_degC
  bool one_temperature = false;
  int sensors = 0;           ///< further ones, at least
  bool ramp = false;         ///< the first further sensor rises evenly with time
  bool similar_air = false;  ///< t_air follows t_material; weather else constant
  bool levers = false;       ///< several lines
  bool plane = false;
  bool map = false;
  bool known = false;
  std::string square;  ///< C0Y, B0Z or A0Z: a straightness line that shows it
};

[[nodiscard]] std::size_t index_of(char axis);
[[nodiscard]] char axis_of(std::size_t index);
/// Linear between the points; the end value holds beyond the ends.
[[nodiscard]] double interpolated(const std::vector<double>& p, const std::vector<double>& value, double at);
/// Refraction of air less that at 20 °C, 1013.25 hPa, 50 %RH for 633 nm (Birch and Downs 1993, 1994).
[[nodiscard]] double excess_refraction(double air_degC, double pressure_hPa, double humidity_pct);

[[nodiscard]] Setup draw_setup(Random& random, const Wishes& wishes);

}  // namespace foreign
