// Readings as flat columns in an order that does not depend on the file's, with the facts of machine, map and known
// components that effects need. Does not live here: what effects make of them (model/regression/regressors.hpp).
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/terms.hpp"
#include "laser/csv_columns.hpp"
#include "laser/map/error_map.hpp"
#include "laser/measurement_set.hpp"
#include "params/machine.hpp"

namespace ecs::model {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// A component measured separately (`[[known]]`); linear between points, end values hold.
struct KnownComponent {
  Component code = Component::EAX;
  std::vector<double> p_mm;   ///< ascending
  std::vector<double> value;  ///< um, um/m for angular codes
  friend bool operator==(const KnownComponent&, const KnownComponent&) = default;
};

/// Tables that are given with the readings: the map that was active while they were taken, and components known from
/// elsewhere.
struct KnownTables {
  std::optional<laser::ErrorMap> map;
  std::vector<KnownComponent> components;
};

/// One column of numbers, kNotMeasured where a row has none. Empty: the data do not have this column at all.
using Column = std::vector<double>;

/// Readings in canonical order: by time where every row has one, else by axis, sense, parked place, run, approach and
/// the way travelled. All columns have `size()` entries or none.
struct Observations {
  std::vector<int> row;                 ///< number of the data row in its file, from 1
  std::vector<std::size_t> file_order;  ///< file_order[k] = place in `readings` of the measurement set
  std::vector<Axis> axis;               ///< the axis being moved
  std::vector<Sense> sense;
  std::vector<int> run;
  std::vector<int> approach;         ///< 1, -1, 0 unknown
  std::vector<Vector3> position_mm;  ///< machine coordinates; of rotary axes [deg], A, B, C in place of X, Y, Z
  Column reading;                    ///< um, um/m for rotations
  Column time_s;                     ///< since the first reading
  Column feed_mm_min, load_kg, travel_since_reversal_mm, pressure_hPa, humidity_pct;
  std::map<std::string, Column, std::less<>> sensors_degC;  ///< by column name
  std::map<std::string, Column, std::less<>> extras;        ///< other columns of numbers
  std::vector<bool> compensated;  ///< the map was active (explicit or by the rule of the contract)
  bool has_compensated_column = false;
  bool has_run_column = false;
  bool rotary = false;  ///< the axes are A, B, C: all positions are in degrees, a turn is 360

  params::Machine machine;   ///< may be without axes: datum 0, lines 0; of rotary axes nothing is known
  TermTable terms;           ///< empty: no chain known, or rotary axes
  MeasurementLines lines{};  ///< where each axis was measured [mm]
  Vector3 datum_mm{};        ///< positions of effects count from here
  std::optional<laser::ErrorMap> map;
  std::vector<KnownComponent> known;
  std::vector<std::string> notes;  ///< what was assumed, in words

  [[nodiscard]] std::size_t size() const { return reading.size(); }
  [[nodiscard]] char letter(Axis a) const { return laser::letter_of(a, rotary); }
  /// "mm", "deg"
  [[nodiscard]] std::string_view position_unit() const { return laser::target_unit(rotary); }
  /// "x_mm", "c_deg"
  [[nodiscard]] std::string_view position_name(Axis a) const { return laser::target_column(a, rotary); }
  /// Coordinate from the datum [mm], of rotary axes [deg].
  [[nodiscard]] double p_mm(std::size_t k, Axis a) const { return position_mm[k][index_of(a)] - datum_mm[index_of(a)]; }
};

/// @param set  of linear axes or of rotary ones, not of both
/// @param machine  absent: datum and measurement lines at 0, no lever arms; it describes linear axes only
[[nodiscard]] Observations observations_of(const laser::MeasurementSet& set, const KnownTables& tables,
                                           const std::optional<params::Machine>& machine);

/// The rows `chosen` (places in canonical order, ascending), everything else the same.
[[nodiscard]] Observations subset(const Observations& all, const std::vector<std::size_t>& chosen);

/// Rows given twice count once, with a note: those that equal another in every column, their time stamp included; where
/// there are no times only if every row of the set stands as often, for rounded repeats may be equal by chance.
/// @param set  that `data` was made from
[[nodiscard]] Observations counted_once(Observations data, const laser::MeasurementSet& set);

/// Row k of a column that may be absent: NaN where nothing was measured.
[[nodiscard]] inline double cell(const Column& column, std::size_t k) {
  return column.empty() ? kNotMeasured : column[k];
}

}  // namespace ecs::model
