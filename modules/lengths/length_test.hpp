// A test by lengths: how far the tool is displaced along a line or from a fixed point, pose by pose, and the plan of
// such a test, which lacks the readings. Deviations of points of an artefact or of a grid in space (thesis 4.1.1) are
// readings of the same kind, along each axis. Format: modules/lengths/README.md.
// Does not live here: what the lengths say of the machine (identify.hpp), which lengths to measure (plan_lengths.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::model {

enum class LengthInstrument {
  interferometer,  ///< along a fixed straight line: what is displaced along it
  tracker,         ///< from a station whose coordinates are known roughly; follows the tool anywhere
  ball_bar,        ///< the same, of nearly constant length
  points,          ///< a placement of an artefact or a grid: deviations along the axes; it lies anyhow, as a rigid body
};
[[nodiscard]] std::string_view word_of(LengthInstrument instrument);

/// The instrument where it stands.
struct LengthSetUp {
  std::string name;
  LengthInstrument instrument = LengthInstrument::tracker;
  Vector3
      place{};  ///< interferometer: unit vector along which a greater length counts; else the station [mm]; 0 of points
  int line = 0;  ///< of the file
};

/// Where the reflector or ball sits, counted from the point at which the curves of a map are measured.
struct LengthTool {
  std::string name;
  Vector3 offset_mm{};
};

struct LengthReading {
  int line = 0;  ///< of the file
  std::size_t set_up = 0;
  std::size_t tool = 0;
  int run = 1;  ///< the readout keeps its zero within a run
  Vector3 position_mm{};
  PerAxis<int> approach{1, 1, 1};  ///< 1 or -1: the direction in which each axis moved last
  Vector3 along{};                 ///< of points: unit vector along which the deviation counts
  double deviation_um = 0.0;       ///< measured less nominal length; the zero is free
};

struct LengthTest {
  std::string source;
  std::string machine;
  std::string configuration;
  PerAxis<std::optional<double>> knots_mm{};  ///< spacing that a plan is made for
  std::optional<double> minutes;              ///< that a plan takes
  std::optional<double> bar_um;               ///< standard uncertainty of a ball bar's length, the same in all set-ups
  std::vector<LengthTool> tools;
  std::vector<LengthSetUp> set_ups;
  std::vector<LengthReading> readings;  ///< in the order in which they are taken
};

/// Reads a test, or a plan: the same without the column deviation_um. A file of points has deviation_x_um … in its
/// place, and each row is a reading for every deviation in it; an empty cell was not measured. All faults at once, with
/// line and column: a column missing, a tool or set-up that no head line describes, a set-up without readings, an
/// approach other than 1 and -1, poses of an interferometer off its line, a station nearer than 10 mm to the tool.
[[nodiscard]] Result<LengthTest> parse_lengths(std::string_view text, const std::string& file_name, bool plan = false);

[[nodiscard]] std::string to_csv(const LengthTest& test, bool plan);

/// Whether it is a file of points; a file has no other set-ups then.
[[nodiscard]] bool has_points(const LengthTest& test);

/// The point whose distance is measured: position and tool offset [mm].
[[nodiscard]] Vector3 point_of(const LengthTest& test, const LengthReading& reading);

}  // namespace ecs::model
