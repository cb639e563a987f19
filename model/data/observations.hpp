// Readings as flat columns in an order that does not depend on the file's, with the facts of machine, map and known
// components that effects need. Does not live here: what effects make of them (model/regression/regressors.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/terms.hpp"
#include "laser/csv_columns.hpp"
#include "laser/map/error_map.hpp"
#include "laser/measurement_set.hpp"
#include "model/data/path.hpp"
#include "model/data/sensor_history.hpp"
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

/// From where effects count time, temperatures and air: what was first in the data that a model was fitted to; air
/// counts from the reference of docs/physics.md.
struct Origin {
  struct Air {
    double degC = 20.0, pressure_hPa = 1013.25, humidity_pct = 50.0;
    friend bool operator==(const Air&, const Air&) = default;
  };
  std::optional<double> time_s;  ///< cell of the first reading; absent: the data have no times
  std::string date{};            ///< and time of day of that reading, as laser::date_time_text; "": not known
  std::map<std::string, double, std::less<>> sensors_degC{};  ///< first temperature of each sensor, by column name
  std::optional<Air> air{};                                   ///< absent: Air{}
  friend bool operator==(const Origin&, const Origin&) = default;
};

/// What is given with the readings: the map that was active while they were taken, components known from elsewhere, and
/// the origin of a model that was fitted to other readings.
struct KnownTables {
  std::optional<laser::ErrorMap> map;
  std::vector<KnownComponent> components;
  std::optional<Origin> origin{};
};

/// What a reading of a ball or of another artefact holds of errors elsewhere in the chain of a machine with rotary
/// axes.
struct ThroughChain {
  std::array<std::array<double, 6>, kAxes> of_axis{};  ///< by A, B, C and sense: of 1 um or 1 um/m of that error
  Vector3 of_workpiece{};  ///< of 1 um along X, Y, Z of the workpiece at angles of 0 by which the ball on it is off
  Vector3 of_tool{};       ///< likewise of the tool and what is in the spindle
  /// Of 1 um/m of scale of X, Y, Z, then of squareness C0Y, B0Z, A0Z, where the linear axes stand [um].
  std::array<double, 2 * kAxes> of_linear{};
  /// By A, B, C: from which side it came to its angle, standing axes too (1, -1; 0 unknown).
  PerAxis<int> approach{};
  int ball = 1;  ///< which of `Observations::balls_mm`
  int tool = 1;  ///< which of `Observations::tools_mm`
  friend bool operator==(const ThroughChain&, const ThroughChain&) = default;
};

/// One column of numbers, kNotMeasured where a row has none. Empty: the data do not have this column at all.
using Column = std::vector<double>;

/// Columns of readings of a ball or another artefact: the tool, 1 where the sensor turns with the workpiece, and 1
/// where x_mm, y_mm, z_mm are the tool centre point that the control shows, not the linear axes.
inline constexpr std::array<const char*, kAxes> kToolColumns{"tool_x_mm", "tool_y_mm", "tool_z_mm"};
inline constexpr const char* kOnWorkpiece = "on_workpiece";
inline constexpr const char* kAtTip = "at_tip";
/// Nearer places are those of one ball, or of one tool.
inline constexpr double kSameBall_mm = 1.0, kSameTool_mm = 1e-3;
/// Number, from 1, of a place among those seen so far, the last where several are there; a new one is added.
[[nodiscard]] int numbered_place(std::vector<Vector3>& seen_mm, const Vector3& place_mm, double same_mm);

/// Of readings of lengths and of angles.
inline constexpr std::string_view kBothUnits = "um, um/m";

struct Motions;

/// What was measured: a sense, or one of the paths. Readings of one channel along one axis are of one instrument.
using Channel = int;
inline constexpr Channel kSenseChannels = static_cast<Channel>(kSenseNames.size());

/// Readings in canonical order: by time where every row has one (by clock and time where clocks restart: a row is of
/// another if its time is less than that before), else by axis, sense, parked place, run, approach and the way
/// travelled; those along paths behind the others. All columns have `size()` entries or none.
struct Observations {
  std::vector<int> row;                 ///< number of the data row in its file, from 1
  std::vector<std::size_t> file_order;  ///< file_order[k] = place in `readings` of the measurement set
  std::vector<Axis> axis;               ///< the axis being moved
  std::vector<Sense> sense;
  std::vector<int> run;
  std::vector<int> approach;         ///< 1, -1, 0 unknown
  std::vector<Vector3> position_mm;  ///< machine coordinates; of rotary axes [deg], A, B, C in place of X, Y, Z
  Column reading;                    ///< um, um/m for rotations
  Column of_map;                     ///< what the map did to each reading and was taken out of it; empty: nothing was
  Column time_s;                     ///< since the first reading; effects count it from `origin`, by since_origin_s()
  Column feed_mm_min, load_kg, travel_since_reversal_mm, pressure_hPa, humidity_pct;
  std::map<std::string, Column, std::less<>> sensors_degC;  ///< by column name
  std::map<std::string, Column, std::less<>> extras;        ///< other columns of numbers
  std::shared_ptr<const SensorHistory> history;             ///< of the whole measurement; null: no times or no sensors
  std::vector<std::size_t> in_history;                      ///< number of the row in it
  std::vector<bool> compensated;  ///< the map was active (explicit or by the rule of the contract)
  bool has_compensated_column = false;
  bool rotary = false;  ///< the axes are A, B, C: all positions are in degrees, a turn is 360
  /// Of rotary axes: where the linear axes stood. Empty: the file does not say.
  std::vector<Vector3> place_mm;
  std::vector<Vector3> pose_deg;  ///< of linear axes: at which angles rotary ones stood. Empty: always at the same
  /// Of rotary axes where `place_mm` and their pivots are known: how their errors reach the reading. Empty: readings of
  /// an error of the axis itself.
  std::vector<ThroughChain> through_chain;
  std::vector<Vector3> balls_mm;  ///< where balls stand on the table, in the frame of the workpiece
  std::vector<Vector3> tools_mm;  ///< from the tool reference point to the ball or probe in the spindle, angles at 0
  std::string not_followed;       ///< why no model can follow these readings on this machine; empty: one can
  /// That follows a ball, with the travels of all axes: more of its readings can be planned. Null: readings of no ball.
  std::shared_ptr<const params::Machine> ball_machine;
  std::vector<Axis> rotary_axes;  ///< of the machine, where `through_chain` is known: those that moved come first

  // Readings along paths; sense and axis of such a row are those of the first axis of its path, approach is that along
  // the path, and its reading is what is left of it without centre, radius or zero (motions.hpp).
  std::vector<Path> paths;               ///< empty: every reading is of one sense while one axis moves
  std::vector<std::size_t> path;         ///< number of the path from 1; 0: none
  Column along;                          ///< on a path: angle [deg] or distance from its start [mm]
  Column place;                          ///< on a path: the same, one value for what is one place of all passes
  std::shared_ptr<const Motions> moved;  ///< the motions that all readings were made up of; null without paths
  std::vector<std::size_t> of_moved;     ///< number of the row among the readings of `moved`
  std::vector<bool> aside;               ///< of motions: only what the approach of the moving axis does counts

  /// Number, from 1, of the measured line among those of its sense along its axis: another parked position or set-up is
  /// another line. Empty: as if all were one, as for readings along paths, and of rotary axes without a column
  /// `set_up`.
  std::vector<int> line;
  /// By axis and sense: the runs with which a session begins, the first one left out. The readout may have been set to
  /// zero before each. Without an entry all is one session.
  std::map<std::pair<Axis, Sense>, std::vector<int>> sessions;
  /// By sense: its own axis where that moved, else the first that did.
  std::array<Axis, kSenseNames.size()> natural_axes{Axis::X, Axis::Y, Axis::Z, Axis::X, Axis::Y, Axis::Z};

  params::Machine machine;   ///< may be without axes: datum 0, lines 0; of rotary axes only their letters are known
  TermTable terms;           ///< empty: no chain known, or rotary axes
  MeasurementLines lines{};  ///< where each axis was measured [mm]
  Vector3 datum_mm{};        ///< positions of effects count from here
  std::optional<laser::ErrorMap> map;
  std::vector<KnownComponent> known;
  Origin origin{};             ///< that of a model, else of these readings
  double first_since_s = 0.0;  ///< time of the first reading since the origin
  std::string clock_note{};    ///< why that time is an assumption; "": dates say it, or there is no origin of a model
  std::vector<std::string> notes;  ///< what was assumed, in words

  [[nodiscard]] std::size_t size() const { return reading.size(); }
  [[nodiscard]] Axis natural_axis(Sense of) const { return natural_axes[static_cast<std::size_t>(of)]; }
  [[nodiscard]] int line_of(std::size_t k) const { return line.empty() ? 1 : line[k]; }
  [[nodiscard]] double of_map_in(std::size_t k) const { return of_map.empty() ? 0.0 : of_map[k]; }
  [[nodiscard]] bool on_path(std::size_t k) const { return !path.empty() && path[k] != 0; }
  /// @pre on_path(k)
  [[nodiscard]] const Path& path_of(std::size_t k) const { return paths[path[k] - 1]; }
  [[nodiscard]] Channel channel(std::size_t k) const {
    return on_path(k) ? kSenseChannels + static_cast<Channel>(path[k]) - 1 : static_cast<Channel>(sense[k]);
  }
  /// Of a row on a path "circle XY", else "".
  [[nodiscard]] std::string path_name(std::size_t k) const { return on_path(k) ? name_of(path_of(k)) : std::string(); }
  /// Place along what moved: the coordinate of the moving axis from the datum, or that along the path.
  [[nodiscard]] double along_of(std::size_t k) const { return on_path(k) ? along[k] : p_mm(k, axis[k]); }
  /// Unit of along_of(): "deg" of a rotary axis and of a circle, else "mm".
  [[nodiscard]] std::string_view unit_along(std::size_t k) const {
    return laser::target_unit(rotary || (on_path(k) && path_of(k).kind == PathKind::circle));
  }
  /// What readings of one place share: the position, or the place on the path.
  [[nodiscard]] Vector3 place_of(std::size_t k) const {
    return on_path(k) ? Vector3{place[k], 0.0, 0.0} : position_mm[k];
  }
  /// The position without its moving axis; the same all along a path.
  [[nodiscard]] Vector3 parked_of(std::size_t k) const {
    if (on_path(k)) return {};
    Vector3 parked = position_mm[k];
    parked[index_of(axis[k])] = 0.0;
    return parked;
  }
  /// The rows on which effects act: these readings, or the motions they are made up of.
  [[nodiscard]] const Observations& motions() const;
  [[nodiscard]] char letter(Axis a) const { return laser::letter_of(a, rotary); }
  /// "um", "um/m" where all readings are of rotations, "um, um/m" where some are.
  [[nodiscard]] std::string_view reading_unit() const;
  /// "mm", "deg"
  [[nodiscard]] std::string_view position_unit() const { return laser::target_unit(rotary); }
  /// "x_mm", "c_deg"
  [[nodiscard]] std::string_view position_name(Axis a) const { return laser::target_column(a, rotary); }
  /// From which side axis `a` came to where it is in reading k; 0: not known, or it was not the one that moved.
  [[nodiscard]] int approach_of(std::size_t k, Axis a) const {
    if (!through_chain.empty()) return through_chain[k].approach[index_of(a)];
    return axis[k] == a ? approach[k] : 0;
  }
  /// What 1 um (1 um/m) of an error of an axis in `s` does in reading k; of axes without a known chain 1 in readings
  /// of that sense, else 0.
  [[nodiscard]] double share_of(std::size_t k, Axis a, Sense s) const {
    if (through_chain.empty()) return sense[k] == s ? 1.0 : 0.0;
    return through_chain[k].of_axis[index_of(a)][static_cast<std::size_t>(s)];
  }
  /// Time since the origin. @pre there are times
  [[nodiscard]] double since_origin_s(std::size_t k) const { return time_s[k] + first_since_s; }
  /// Coordinate from the datum [mm], of rotary axes [deg].
  [[nodiscard]] double p_mm(std::size_t k, Axis a) const { return position_mm[k][index_of(a)] - datum_mm[index_of(a)]; }
};

/// @param set  of linear axes or of rotary ones, not of both; a text column `path` puts readings of linear axes on a
///   path (path.hpp), other texts in it say nothing
/// @param machine  absent: datum and measurement lines at 0, no lever arms; it describes linear axes only
[[nodiscard]] Observations observations_of(const laser::MeasurementSet& set, const KnownTables& tables,
                                           const std::optional<params::Machine>& machine);

/// Places of about `wanted` of this many readings, at random one from each stretch: an even step could fall in with the
/// order of senses or targets. The same for the same numbers.
[[nodiscard]] std::vector<std::size_t> even_choice(std::size_t readings, std::size_t wanted);

/// From the axes that moved. @pre data.axis and data.sense are complete
void set_natural_axes(Observations& data);

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
