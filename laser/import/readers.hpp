// The parts that readers of several formats are made of: axis and sense that a file does not state, dates and times,
// logs of several channels joined by time, tables over an even grid, the set-up of a workpiece taken out, air and
// temperatures of an environment log, a Renishaw run file as it stands. Does not live here: which column holds what
// (rows.hpp), what the numbers mean (the readers).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/environment_series.hpp"
#include "laser/import/import.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// The moving axis from the options; a `usage` problem that says what to give if they have none.
[[nodiscard]] Result<Axis> axis_wanted(const ImportOptions& options, const std::string& file_name);

/// The sense of a positioning measurement, unless the options say otherwise; a rotation is refused.
[[nodiscard]] Result<Sense> positioning_sense(const ImportOptions& options, Axis axis, const std::string& file_name);

/// `parked_mm` with the moving axis at `target_mm`.
[[nodiscard]] Vector3 position_at(const ImportOptions& options, Axis axis, double target_mm);

/// The measured line of a file that states neither axis nor sense: axis and positioning sense of the options.
struct PositioningLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
};
[[nodiscard]] Result<PositioningLine> positioning_line(const ImportOptions& options, const std::string& file_name);

[[nodiscard]] Reading reading_at(const ImportOptions& options, const PositioningLine& at, double position_mm,
                                 double error_um, int text_line);

/// The numbers of a line that holds nothing else; empty otherwise. Decimal point or comma.
[[nodiscard]] std::vector<double> numbers_alone(std::string_view text_line);

/// The same, if there are `count` of them.
[[nodiscard]] std::optional<std::vector<double>> row_of(std::string_view text_line, std::size_t count);

/// Numbers the readings 1, 2, 3 … in their order.
void number_rows(MeasurementSet& set);

/// Options that do not suit the file.
[[nodiscard]] inline Problem usage(const std::string& file_name, std::string message) {
  return {ProblemKind::usage, std::move(message), file_name, 0, 0, {}};
}

/// Gives every reading the conditions at its time, linear between the rows of the log; beyond its ends those of the
/// end. What a reading has of its own stays. Where both state dates they meet there, else the log begins with the
/// first reading. A log without times has a row every `every_s` seconds; absent: its rows are spread evenly over the
/// readings (over their order, where they have no time). The notes say which of these, and how far the log reaches.
/// `usage` if the readings have no time and the log has.
[[nodiscard]] Result<void> join_environment(MeasurementSet& set, const EnvironmentSeries& series,
                                            std::optional<double> every_s);

/// Seconds since the start of 1970 of "2022-11-08 14:07:19.279", "2022-11-08T14:07:19Z" or "08.11.2022 14:07:19";
/// since midnight of "14:07:19.279". Whatever zone the clock had. Nothing for other forms.
[[nodiscard]] std::optional<double> seconds_in(std::string_view text);

/// "2022-11-08 14:07:19.279"; empty for a time of day, which is no date.
[[nodiscard]] std::string date_time_text(double seconds);

/// The key of the metadata that says when `time_s` is 0.
inline constexpr std::string_view kBegun = "begun";

struct ChannelSample {
  double time_s = 0.0;  ///< since 1970, or of any other clock that all channels share
  double value = 0.0;
  int line = 0;  ///< of the file, from 1
};

struct ChannelLog {
  std::map<std::string, std::vector<ChannelSample>, std::less<>> channels;  ///< by name; any order in time
  std::size_t left_out = 0;                                                 ///< values that are no numbers
};

/// "z (1402 values), btemp (141 values)"
[[nodiscard]] std::string channels_text(const ChannelLog& log);

/// Reads the log by `options.channels`, whose headings are names of channels. The first field that gives a reading is
/// the clock: each of its values is a row. Rows without a position, axis or second reading within the greatest gap are
/// left out, a sensor without a value there is absent in the row; the notes count both.
/// @pre options.channels
[[nodiscard]] Result<MeasurementSet> read_channels(ChannelLog log, const std::string& file_name,
                                                   const ImportOptions& options);

/// The places along one axis. Each is a number, or a name under which the file states it ("xmin"), or several names
/// separated by bars of which the file states one ("xspacing|spacing").
struct MatrixAxis {
  Axis axis = Axis::X;
  std::string first_mm;
  std::string last_mm;  ///< empty: `step_mm` is given
  std::string step_mm;
  std::string count;  ///< empty: as many as there are
};

struct MatrixLayout {
  std::array<MatrixAxis, 2> axes{};  ///< along the cells of a row, along the rows
  std::string section;  ///< how the line begins above the part that is read, up to the next line with '['; empty: all
  std::string line_prefix;  ///< taken off every line
  std::string absent;       ///< a cell that holds no value
  char delimiter = ',';
};

/// "x=xmin+xspacing*xnum,y=ymin..ymax": AXIS=FIRST+STEP or FIRST..LAST, and *COUNT where the file states it; the axis
/// along the cells of a row first.
[[nodiscard]] Result<std::array<MatrixAxis, 2>> matrix_axes(std::string_view text);

/// measured = nominal + shift + rotation × (nominal − centre), for rotations of any size
struct RigidSetUp {
  Vector3 centre_mm{};      ///< of the nominal positions
  Vector3 shift_um{};       ///< of the centre
  Vector3 rotation_um_m{};  ///< about X, Y, Z: the rotation vector; 0 about an axis that the positions do not tell
  int rotations = 3;        ///< that the positions tell: 0 of a single point, 2 of points on a line
  std::array<Vector3, kAxes> matrix{};  ///< rows of the rotation
};

/// The rotation and shift that bring the nominal positions nearest to the measured ones (least squares; K. S. Arun,
/// T. S. Huang, S. D. Blostein, IEEE PAMI 9 (1987) 698; S. Umeyama, IEEE PAMI 13 (1991) 376, keeps it a rotation where
/// the points lie in a plane). Nothing for fewer than two points.
/// @pre nominal_mm.size() == measured_mm.size()
[[nodiscard]] std::optional<RigidSetUp> rigid_set_up(const std::vector<Vector3>& nominal_mm,
                                                     const std::vector<Vector3>& measured_mm);

/// What the set-up makes of the error at a nominal position [um].
[[nodiscard]] Vector3 set_up_error_um(const RigidSetUp& set_up, const Vector3& nominal_mm);

/// Takes the set-up out of the readings EX, EY, EZ that rows of a file give at one place: each row with two or three of
/// them is a point. A note tells shift, rotation, and the rms before and after. Where the rows lack a direction, its
/// error counts as 0 for the fit.
void take_out_set_up(MeasurementSet& set);

/// Keeps the readings of each axis and sense that stand in a stretch of three or more, one after the other, whose
/// positions lie within `at_rest_mm` of the first of them; with `average` a stretch becomes one reading at its mean
/// position, its error, time, conditions and numbers the means, with `readings_averaged` and `scatter` (standard
/// deviation) beside. Absent: readings at the same place, how many they are, make a stretch. The notes say how many
/// readings were left out and averaged.
void keep_at_rest(MeasurementSet& set, std::optional<double> at_rest_mm, bool average);

/// One line of DEVIATIONS.
struct RunPoint {
  int line = 0;
  int run = 0;     ///< single pass, from 1
  int target = 0;  ///< from 1
  double deviation = 0.0;
};

struct RunFile {
  std::vector<MetadataEntry> header;  ///< HEADER and the keys of TARGET DATA but the targets
  std::vector<MetadataEntry> user_text;
  std::vector<MetadataEntry> equipment;  ///< newer software: instruments and optics
  std::vector<MetadataEntry> environment;
  std::vector<double> targets;  ///< mm (degrees for rotary axes), in file order
  std::optional<long long> target_count;
  std::optional<long long> run_count;  ///< single passes
  std::vector<long long> flags;
  std::vector<RunPoint> points;
  bool has_end = false;  ///< the EOF section stands
};

/// Reads the sections; every line that cannot be read is a finding. Checks that the counts agree with what stands
/// there.
/// @param accept_truncated  missing points and a missing end are no fault
[[nodiscard]] Result<RunFile> run_file_in(std::string_view text, const std::string& file_name, bool accept_truncated);

/// The value of a key, case ignored; nothing if there is none or it is empty.
[[nodiscard]] std::optional<std::string> value_of(const std::vector<MetadataEntry>& entries, std::string_view key);

/// The numbers of a text, separated by blanks, decimal point or comma; what is no number is left out.
[[nodiscard]] std::vector<double> numbers_of(std::string_view text);

}  // namespace ecs::laser
