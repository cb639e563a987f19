// Readings along a path on which several axes move at once: the circle of ISO 230-4, the diagonal of ISO 230-6. A
// reading is then no error of one direction; it is the sum of the errors of all directions along the line in which the
// instrument measures. Such tests as measurement sets. Does not live here: the files of these tests (laser/standards),
// how readings become sums of motions (motions.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::laser {
struct BlockTest;
struct CircleTest;
struct DiagonalTest;
struct MeasurementSet;
}  // namespace ecs::laser

namespace ecs::model {

/// The column of a measurement set whose cells say on which path a reading was taken, as to_text() writes it.
inline constexpr std::string_view kPathColumn = "path";
/// The column, of readings or of motions along a path, of the time since the moving axis turned round [s].
inline constexpr std::string_view kTimeSinceReversalColumn = "time_since_reversal_s";

/// The column of the part of a pass, each with a zero of the instrument of its own.
inline constexpr std::string_view kPartColumn = "part";

enum class PathKind : std::uint8_t {
  circle,  ///< radial deviations, positive away from the centre; forward is counter-clockwise, with rising angle
  line,    ///< deviations of the distance from its start; forward is away from the start
};

struct Path {
  PathKind kind = PathKind::circle;
  std::string name;                             ///< of a circle its plane, "XY"; of a line any word, "PPN"
  std::array<Axis, 2> plane{Axis::X, Axis::Y};  ///< of a circle: axes at 0 and at 90 degrees
  double radius_mm = 0.0;                       ///< of a circle, above 0
  Vector3 from_mm{};                            ///< centre of a circle, start of a line; machine coordinates
  Vector3 to_mm{};                              ///< end of a line
  friend bool operator==(const Path&, const Path&) = default;
};

/// "circle XY radius 100 centre 400 250 0", "diagonal PPN from 0 0 0 to 800 500 400"; nothing for any other text.
[[nodiscard]] std::optional<Path> path_in(std::string_view text);
[[nodiscard]] std::string to_text(const Path& path);
/// "circle XY", "diagonal PPN"
[[nodiscard]] std::string name_of(const Path& path);

/// What is known of a place on a path, one number for each axis. Approaches 0: the way travelled is not known.
struct PlaceOnPath {
  double along = 0.0;                 ///< angle [deg], 0 … 360; distance from the start [mm]
  Vector3 direction{};                ///< unit vector in which the instrument measures
  std::array<int, kAxes> approach{};  ///< of each axis; 0 for one that does not move along the path
  /// Travel of each axis, near its reversal on a circle: up to a tenth of the radius. What dies away later passes there
  /// for lost motion, of which a circle shows no more either.
  std::array<std::optional<double>, kAxes> since_reversal_mm{};
  /// Way along the path since then, as long as the travel is given.
  std::array<std::optional<double>, kAxes> path_since_reversal_mm{};
  Vector3 share_of_feed{};  ///< speed of each axis in that along the path
};
/// @param approach  1, -1; 0 unknown
[[nodiscard]] PlaceOnPath place_on(const Path& path, const Vector3& position_mm, int approach);

/// "angle_deg" of a circle, "position_mm" of a line: how variables and tables name the place along a path.
[[nodiscard]] std::string_view variable_along(const Path& path);
/// "XY", "XYZ": the axes that move.
[[nodiscard]] std::string axes_of(const Path& path);

/// Every reading at its place on the circle, in column `path`; approach 1 is counter-clockwise. A centre that is not
/// given is at 0, with a note.
[[nodiscard]] laser::MeasurementSet set_of_circle(const laser::CircleTest& test);

/// Every reading at its place on the diagonal, in column `path`. The corner of the volume with the least coordinates
/// is at `# from_x_mm: ` …, else at 0, with a note. Refuses step diagonals, whose steps leave the line.
[[nodiscard]] Result<laser::MeasurementSet> set_of_diagonals(const laser::DiagonalTest& test);

/// The column of the sign with which a tool or probe that is too large displaces a touch: half of its excess.
inline constexpr std::string_view kTouchColumn = "touch";

/// Every length as two readings along its axis, a run of its own: 0 at the face with the smaller coordinate, the error
/// of the length at the other one. The approach is the direction in which each face is touched; of a step both are
/// touched forward. A face without a coordinate is at 0, with a note.
[[nodiscard]] laser::MeasurementSet set_of_blocks(const laser::BlockTest& test);

}  // namespace ecs::model
