// Measurements as values: readings of one or more axes with what was known about each, the reader of their CSV form,
// the passes of an axis from the order of its stops, and on which machine a set was measured, as its header says. Does
// not live here: the writer (laser/writers/writers.hpp), instruments' own files (laser/import/import.hpp),
// statistics (laser/analysis/iso230.hpp).
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/csv_table.hpp"

namespace ecs::laser {

/// One stop of the machine in front of the instrument. What was not measured is absent, never NaN.
struct Reading {
  int row = 0;            ///< number of the data row in its file, from 1; 0: not from a file
  int line = 0;           ///< line of the file, from 1; 0: not from a file
  Axis axis = Axis::X;    ///< the axis being moved, or the direction about which it turns
  bool rotary = false;    ///< it turns: A, B or C
  Vector3 position_mm{};  ///< target, machine coordinates
  Vector3 angle_deg{};    ///< of the axes A, B, C; a turn is 360
  Sense sense = Sense::EX;
  double error = 0.0;  ///< actual − target; um for EX EY EZ, um/m for EA EB EC
  Approach approach = Approach::unknown;
  int run = 1;
  std::optional<double> time_s;
  std::optional<double> feed_mm_min;
  std::optional<double> load_kg;
  std::optional<double> travel_since_reversal_mm;
  std::optional<double> pressure_hPa;
  std::optional<double> humidity_pct;
  std::optional<bool> compensated;                              ///< the error map was active
  std::map<std::string, double, std::less<>> sensors_degC;      ///< by column name, `t_<sensor>_degC`
  std::map<std::string, double, std::less<>> extras;            ///< other columns of numbers, by name
  std::map<std::string, std::string, std::less<>> text_extras;  ///< other columns, by name

  friend bool operator==(const Reading&, const Reading&) = default;
};

struct MeasurementSet {
  std::string source;                   ///< the file it came from; empty: none
  std::vector<MetadataEntry> metadata;  ///< in file order
  std::vector<std::string> columns;     ///< header row, in file order; empty: not from a CSV file
  std::vector<Reading> readings;        ///< in file order
  std::vector<std::string> notes;       ///< what a reader had to assume, in words; no fault among them

  friend bool operator==(const MeasurementSet&, const MeasurementSet&) = default;
};

/// Position of the moving linear axis [mm].
[[nodiscard]] inline double target_mm(const Reading& reading) { return reading.position_mm[index_of(reading.axis)]; }

/// Position of the moving axis: [mm], of a rotary axis [deg].
[[nodiscard]] inline double target_of(const Reading& reading) {
  return (reading.rotary ? reading.angle_deg : reading.position_mm)[index_of(reading.axis)];
}
[[nodiscard]] constexpr std::string_view target_unit(bool rotary) { return rotary ? "deg" : "mm"; }

/// X, Y, Z; of a rotary axis A, B, C.
[[nodiscard]] constexpr char letter_of(Axis axis, bool rotary) {
  return static_cast<char>((rotary ? 'A' : 'X') + static_cast<char>(axis));
}
/// EXX … ECZ; of a rotary axis by the same rule: ECC is the angular positioning of C (ISO 230-7).
[[nodiscard]] std::string curve_name(Sense sense, Axis axis, bool rotary);

/// "um" for a translation, "um/m" for a rotation.
[[nodiscard]] constexpr std::string_view unit_of(Sense sense) { return is_rotation(sense) ? "um/m" : "um"; }

/// The first entry of that key (exact spelling); nothing if there is none.
[[nodiscard]] std::optional<std::string> metadata_value(const MeasurementSet& set, std::string_view key);

/// Names of every `t_<sensor>_degC` that some reading has, sorted.
[[nodiscard]] std::vector<std::string> sensor_names_of(const MeasurementSet& set);

/// `t_<sensor>_degC` with a sensor name in the middle.
[[nodiscard]] bool is_sensor_column(std::string_view name);

/// Reads the CSV form: `# key: value` lines, a header row, one row per reading. Columns by name in any order:
/// axis, sense, reading are needed; x_mm y_mm z_mm a_deg b_deg c_deg (absent = 0), approach (empty = unknown, absent =
/// by row order), run (= 1), time_s, feed_mm_min, load_kg, travel_since_reversal_mm, pressure_hPa, humidity_pct,
/// t_<sensor>_degC, compensated are known; others are kept. CRLF, a byte order mark, blanks round fields and quoted
/// fields are taken as they come, and semicolons or tabs between the fields, with decimal commas then. Refuses, every
/// bad row at once with line and column: unknown axis or sense, text or NaN where a number belongs, approach other than
/// 1, -1, 0, a run that is no integer, an empty position of the moving axis, missing or duplicate columns, rows of
/// another length, decimal commas between commas, empty and binary files, no readings.
[[nodiscard]] Result<MeasurementSet> parse_measurement_set(std::string_view text, const std::string& file_name);

/// The first reading on a circle or a diagonal as a refusal, for work on lines; nothing if there is none.
[[nodiscard]] std::optional<Problem> paths_refused(const MeasurementSet& set, const std::string& file_name);
/// The same, and that of a rotary axis, for work on lines of linear axes.
[[nodiscard]] std::optional<Problem> all_but_lines_refused(const MeasurementSet& set, const std::string& file_name);

/// The same from a file, of linear axes only.
[[nodiscard]] Result<MeasurementSet> read_measurement_set(const std::filesystem::path& path);

/// The readings whose position or error no machine has, line by line, with the limit; nothing if there are none.
[[nodiscard]] std::optional<Problem> implausible(const MeasurementSet& set, const std::string& file_name);

/// parse_measurement_set(), but where the column `approach` is absent it stays unknown.
[[nodiscard]] Result<MeasurementSet> set_with_approach_open(std::string_view text, const std::string& file_name);

struct MotionStop {
  Approach approach = Approach::unknown;
  int run = 1;  ///< how often the axis has gone this way, from 1
};

/// One for each position. A pass ends where the direction turns; a stop repeated at the turn begins the next pass. A
/// single jump back followed by the old direction begins another pass the same way. One lone position: unknown.
[[nodiscard]] std::vector<MotionStop> motion_of(const std::vector<double>& positions_mm);

/// Gives readings of a file that states no approach the direction in which their axis came, in each run that goes both
/// ways: unlike in `motion_of`, nobody said that the order is that of the motion, so what it leaves open stays unknown:
/// the first stop of a run, a single step back between two forward ones, positions in no order, a run that goes one
/// way. Where an axis turns, twice the usual number of readings are half of each pass. Paths (circles, diagonals) state
/// their own direction.
/// @return how many readings got one
std::size_t take_approach_from_order(MeasurementSet& set);

/// Empty: not said.
struct MeasuredMachine {
  std::string name;
  std::string serial_number;
};

/// Our own `machine` and `serial_number`, and what instruments write: `Machine`, `Serial No`. The first of each counts.
[[nodiscard]] MeasuredMachine measured_machine(const std::vector<MetadataEntry>& metadata);

/// "measured on \"a\", the machine file is of \"b\"" where both say a name, or a serial number, and they differ;
/// nothing where they do not contradict each other.
/// @param whose  "the machine file is of"
[[nodiscard]] std::optional<std::string> other_machine(const MeasuredMachine& measured, const MeasuredMachine& at_hand,
                                                       std::string_view whose);

/// Part of a travel by which readings may lie beyond it: optics and overrun need room at either end.
inline constexpr double kUsualMargin = 0.05;
/// "X positions was measured from -100 to 900 mm, but X travels from 0 to 500 mm: do file and machine belong
/// together?"; nothing within the margin.
/// @param ends_mm  least and greatest target, then the ends of the travel of the axis, machine coordinates
[[nodiscard]] std::optional<std::string> beyond_travel(std::string_view what, Axis axis,
                                                       const std::array<double, 2>& ends_mm,
                                                       const std::array<double, 2>& travel_mm);

}  // namespace ecs::laser
