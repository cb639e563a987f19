// One file format of a controller: its words, what it holds, its options, writing and reading. Verbs, help, detection,
// documentation and tests walk the list of those that the program knows. Then what tests ask of single formats.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/controllers/curve.hpp"
#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

/// A whole number within least … most.
struct IntegerRange {
  int least = 0, most = 0;
};

/// What a format leaves to its user: `--name` on the command line. Text, unless words, a range or a flag say otherwise.
struct FormatOption {
  std::string_view name;  ///< without dashes
  std::string_view help;
  std::string_view fallback = {};            ///< the value where none was given
  std::vector<std::string_view> words = {};  ///< one of these
  std::optional<IntegerRange> range = {};
  bool is_flag = false;  ///< "1" where it was given, else empty
};

/// The values of options by name.
class OptionValues {
 public:
  OptionValues() = default;
  /// The fallbacks of the options.
  explicit OptionValues(const std::vector<FormatOption>& options);
  void set(std::string_view name, std::string value) { values_[std::string(name)] = std::move(value); }
  /// Empty where there is none.
  [[nodiscard]] std::string_view text(std::string_view name) const;
  /// 0 where there is none.
  [[nodiscard]] int integer(std::string_view name) const;
  [[nodiscard]] bool flag(std::string_view name) const { return !text(name).empty(); }

 private:
  std::map<std::string, std::string> values_;
};

/// "X=AX1,Y=AX2", pair by pair; no axis where the text is no such pair. Empty: no pairs.
[[nodiscard]] std::vector<std::pair<std::optional<Axis>, std::string_view>> axis_pairs(std::string_view text);

/// A file to be read.
struct ReadRequest {
  std::string file_name;
  std::string_view text;   ///< decoded, UTF-8
  std::string_view bytes;  ///< as in the file
  bool only_file = true;   ///< no other file is read with it
  OptionValues options;
};

/// What option "axis" says; nothing if it was not given. A `usage` problem where several files are read.
[[nodiscard]] Result<std::optional<Axis>> axis_option(const ReadRequest& request);

/// What option "axis" says, else the name of the file: "x.comp", "mill_y.comp", "screwcompZ.dat", "CNC7X.TAB" end in a
/// letter of its own. A `usage` problem where neither names an axis.
[[nodiscard]] Result<Axis> axis_of_file(const ReadRequest& request);

/// What a format can hold of a map, in the words of the documentation.
struct Holds {
  std::string_view positioning, reversal, straightness, squareness, rotations, points;
};

struct ControllerFormat {
  std::string_view id;                ///< "linuxcnc": verb `ecs export linuxcnc`
  std::string_view title;             ///< "SINUMERIK 840D", heading of a report
  std::string_view name;              ///< "SINUMERIK", within a sentence
  std::string_view summary = {};      ///< help of the verb
  std::string_view example = {};      ///< a whole command line
  std::string_view output_help = {};  ///< of -o
  std::string_view marks;             ///< by what a file is recognised, in words
  int place = 0;                      ///< menus, documentation and detection go in rising order
  Holds holds;
  double resolution_um = 0.0;  ///< of the values in a file
  bool tables_add_up = false;  ///< the controller adds several tables of one component
  std::vector<FormatOption> write_options = {};
  std::vector<FormatOption> read_options = {};
  /// Whether the writer names files like that, in a folder. None: one file under any name.
  bool (*is_file)(std::string_view name) = nullptr;
  /// Whether decoded text is of this format.
  bool (*recognises)(std::string_view text) = nullptr;
  /// None: the format is read only, and has no summary, example and resolution.
  Result<ControllerExport> (*write)(const ExportSource& source, const OptionValues& options) = nullptr;
  Result<ControllerTables> (*read)(const ReadRequest& request) = nullptr;
  /// Formats with lever arms: a map that was read, as parameters expect it. @param levers_from_lines  the curves are
  /// those of their measurement lines already; else they count from the machine zero
  laser::ErrorMap (*at_measurement_lines)(const laser::ErrorMap& read, const UnitParameters& parameters,
                                          bool levers_from_lines) = nullptr;
};

/// Each `<id>_format` of a source `<id>_format.cpp` (registry.cmake), in the order of their places.
[[nodiscard]] std::span<const ControllerFormat* const> controller_formats();

/// Nothing if no format has this id.
[[nodiscard]] const ControllerFormat* controller_format(std::string_view id);

/// The first format that recognises decoded text; nothing if none does.
[[nodiscard]] const ControllerFormat* recognised_format(std::string_view text);

/// Its row of the table "What each holds" in modules/controllers/README.md.
[[nodiscard]] std::string holds_row(const ControllerFormat& format);

inline constexpr std::size_t kLinuxCncMostPoints = 256;  ///< of the rest LinuxCNC uses nothing

enum class MachineUnits { mm, inch };

struct LinuxCncOptions {
  int type = 1;  ///< COMP_FILE_TYPE. 0: nominal, where the machine really is forward, reverse; 1: nominal, trims
  MachineUnits units = MachineUnits::mm;          ///< [TRAJ] LINEAR_UNITS
  std::size_t most_points = kLinuxCncMostPoints;  ///< 2 … 256
};

/// `x.comp`, `y.comp`, `z.comp` for the positioning tables of the axes that exist. Numbers and blanks only, nominal
/// strictly increasing: LinuxCNC stops reading without a message at anything else. Refused: no positioning table.
[[nodiscard]] Result<ControllerExport> linuxcnc_export(const ExportSource& source, const LinuxCncOptions& options);

struct LinuxCncReadOptions {
  Axis axis = Axis::X;
  std::optional<int> type;  ///< absent: taken from the numbers, with a note; refused where they leave it open
  MachineUnits units = MachineUnits::mm;
  bool as_loaded = false;  ///< only what LinuxCNC itself would take; else every row of three numbers
};

/// Warnings name the lines at which LinuxCNC stops without a word (a comment, an empty line, a mark at the beginning),
/// drops a row (nominal not increasing) or takes no more (after 256). Refused, all at once: rows that are no three
/// numbers, values no machine can need, no rows.
[[nodiscard]] Result<ControllerTables> parse_linuxcnc(std::string_view text, const std::string& file_name,
                                                      const LinuxCncReadOptions& options);

struct SiemensOptions {
  PerAxis<std::string> axis_name{"AX1", "AX2", "AX3"};  ///< machine axes, as the control numbers or names them
  int encoder = 0;                                      ///< 0 or 1: first or second measuring system
  bool cec_adds = false;                                ///< the control adds CEC values instead of subtracting them
  std::size_t most_points = 1000;                       ///< of one table; at most MD38000 and MD18342 (828D: 200)
  std::size_t most_tables = 62;                         ///< CEC tables (828D: 8)
};

/// `AX_EEC.INI` with the mean positioning error of each axis, and `NC_CEC.INI` with two one-direction tables for the
/// reversal of each axis, straightness and squareness. Every table has an even grid and is zero at the reference
/// position of its input axis, but for the reversal, which cannot be. Where there are more tables than the control
/// has: squareness goes into the straightness tables, two directions are kept where they bring most, and if even the
/// means are too many the smallest stay behind; the answer says so.
[[nodiscard]] Result<ControllerExport> siemens_export(const ExportSource& source, const SiemensOptions& options);

/// Reads either kind of file, also of a whole-control backup: `N10` numbers, `%_N_…`, `CHANDATA`, M0, M02, M17, M30,
/// RET, machine data, comments; blanks instead of `=`; `[0.1]` instead of `[0,1]`; EX exponents; any case. Left out
/// with a note: tables without points, tables of rotary axes and modulo tables that are all zero. Refused, all at once:
/// lines that are none of these, tables without MIN, MAX or STEP, missing points, multiplied tables, axes that
/// `axis_name` does not tell (AX1 … AX3, X1 … Z1, X … Z are known besides).
[[nodiscard]] Result<ControllerTables> parse_siemens(std::string_view text, const std::string& file_name,
                                                     const SiemensOptions& options);

/// kw_nr_max must stay below kw.ssfk.max_points, 1500 unless it is set.
inline constexpr std::size_t kTwinCatMostPoints = 1499;

struct TwinCatOptions {
  PerAxis<int> axis_number{1, 2, 3};             ///< logical axis numbers of the control, above 0, all different
  std::size_t most_points = kTwinCatMostPoints;  ///< 2 … 1499
  /// The control adds the values instead of subtracting them. Absent: a list of ours is read as it says; else no.
  std::optional<bool> adds;
};

/// `achskw1.lis` and so on, named after the logical axis numbers, for the positioning tables of the axes that exist:
/// a table for each direction, positions and errors as whole tenths of a micrometre. Notes name the step of each axis
/// when its list becomes active at the reference position, and values that TwinCAT 2 has no room for. Refused: no
/// positioning table.
[[nodiscard]] Result<ControllerExport> twincat_export(const ExportSource& source, const TwinCatOptions& options);
/// Whether the writer names files like that: "achskw12.lis".
[[nodiscard]] bool is_twincat_file(std::string_view name);

/// Reads `kopf.*` and `kw.ssfk.*`: points of their own or at even steps, one table or two; any case; comments behind
/// `#` or behind the value. Left out with a note: other compensations of the same list. Refused, all at once: lines
/// that are none of these, encoder increments, modulo axes, points that are missing or do not rise, values no machine
/// can need, a list whose axis cannot be told or is none of X, Y, Z by its name, a list of ours with the other sign
/// than `options` ask for.
/// @param axis  given: whatever the list says
[[nodiscard]] Result<ControllerTables> parse_twincat(std::string_view text, const std::string& file_name,
                                                     const TwinCatOptions& options,
                                                     std::optional<Axis> axis = std::nullopt);

/// Comments of our own files: where lever arms count from.
inline constexpr std::string_view kLeversFromZero =
    "Lever arms count from the machine zero: the curves hold what the rotations do there.";
inline constexpr std::string_view kLeversFromLines =
    "The curves are those of their measurement lines; lever arms count from there.";

struct EtalonOptions {
  std::string file_name = "errors.txt";
  /// The control counts lever arms from the machine zero. True: the curves are brought there from the lines on which
  /// they were measured. False: they are written as they are in the map.
  bool levers_from_zero = true;
  std::size_t most_points = 0;  ///< of one function; 0: as many as the map has
};

/// The curve of a component for a control that levers rotations from the machine zero: a translation is brought there
/// from its measurement line. Nothing where the machine lacks the axis or the map has nothing to write.
[[nodiscard]] std::optional<ControlCurve> curve_at_machine_zero(const ExportSource& source, const TermTable& terms,
                                                                Component component);

/// One file with the errors (not the compensations): every curve of the map as grid points, C0Y, B0Z, A0Z as values.
/// The format has one function for both approaches: the mean. Refused: squareness and terms in the printed signs.
[[nodiscard]] Result<ControllerExport> etalon_export(const ExportSource& source, const EtalonOptions& options);

/// `[NAME]`, then `VALUE = number` or `Gridpoints = {` rows `}`; `//` comments; any case of the key words. Functions of
/// rotary axes are left out with a note. `levers_from_lines` is what the head of a file of ours says. Refused, all at
/// once: other lines, names that are none, positions that do not rise or fall throughout, values no machine can have,
/// functions that do not end.
[[nodiscard]] Result<ControllerTables> parse_etalon(std::string_view text, const std::string& file_name);

/// A map read from this format as parameters expect it: curves on their measurement lines, angles by their angular
/// scale. @param levers_from_lines  the curves stand on the lines already; false: at the machine zero
[[nodiscard]] laser::ErrorMap at_measurement_lines(const laser::ErrorMap& read, const UnitParameters& parameters,
                                                   bool levers_from_lines = false);

struct HeidenhainOptions {
  bool kinematics = true;         ///< straightness and rotations in C1 to C6; false: axis columns only, no rotations
  bool holds_errors = true;       ///< the control takes the values off; false: it adds them
  bool levers_from_zero = true;   ///< as EtalonOptions
  std::size_t most_points = 256;  ///< of one table
  std::optional<Axis> axis;       ///< reading: the axis of the table; by its name where absent
};

/// A table for each axis and config.cma. Positioning is in the column of the axis, the reverse approach in BACKLASH;
/// straightness and rotations are the mean of both. Squareness is a slope of straightness. Refused: printed signs, a
/// map without anything for an axis of the machine.
[[nodiscard]] Result<ControllerExport> heidenhain_export(const ExportSource& source, const HeidenhainOptions& options);

/// `BEGIN NAME.COM MM`, the heading, rows with an AXISPOS, `[END]`; cells stand under their heading. A .CMA has no
/// tables of its own: a note. Refused: inches, tables with even steps (DATUM, DISTANCE), positions that do not rise,
/// cells that are no number, a BACKLASH without a value of the axis.
[[nodiscard]] Result<ControllerTables> parse_heidenhain(std::string_view text, const std::string& file_name,
                                                        const HeidenhainOptions& options);

/// What stands in column C1 … C6 of the table of an axis: EX, EY, EZ, EA, EB, EC of its motion.
inline constexpr std::size_t kHeidenhainColumns = 6;

/// Digits behind the point, mm and degrees.
inline constexpr int kHeidenhainLengthDigits = 4, kHeidenhainAngleDigits = 6;

struct CentroidOptions {
  double counts_per_mm = 0.0;              ///< encoder counts of the axes; above 0
  PerAxis<std::optional<double>> home_mm;  ///< first value of a table; absent: reference position, in reading 0
  bool adds = true;                        ///< the control adds the values to the position; false: subtracts them
  std::size_t most_points = 0;             ///< of one table; 0: as many as the map has; uneven: at its smallest step
};

/// Version 1 of the ball screw tables (CNC7 6.00 to 7.17): `CNC7X.TAB` and so on for the positioning tables of the axes
/// that exist, CRLF: number of values and travel, then a correction a line, all in whole encoder counts. The values are
/// the mean of both approaches at even steps from home, zero at home. Source: https://www.cncsnw.com/LaserComp.htm (CNC
/// Services Northwest) for the layout; unit, sign and the travel are assumptions, which the answer names
/// (modules/controllers/README.md). Refused: no positioning table, a home inside a table.
[[nodiscard]] Result<ControllerExport> centroid_export(const ExportSource& source, const CentroidOptions& options);

/// A table of one axis, the same values for both approaches. Refused, all at once: a heading that is not two whole
/// numbers (versions 2 and 3), values that are none, more or fewer than announced, steps below one count, positions and
/// values no machine has.
[[nodiscard]] Result<ControllerTables> parse_centroid(std::string_view text, const std::string& file_name, Axis axis,
                                                      const CentroidOptions& options);

}  // namespace ecs::controllers
