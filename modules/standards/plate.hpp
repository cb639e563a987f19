// Flatness of a surface from the eight lines of a union jack, each measured in equal steps by a level or by a mirror on
// a foot before an autocollimator: ISO 230-1 (1996: 5.3; 2012: flatness of functional surfaces), ISO 8512-2, evaluated
// as J. C. Moody, "How to calibrate surface plates in the plant", The Tool Engineer, October 1955, 15-21.
// The form that the map of the machine predicts for a surface that was cut without compensation.
// Does not live here: plates measured point by point (laser/import/plate.cpp).
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/tick.hpp"
#include "laser/csv_table.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {

inline constexpr std::size_t kPlateLines = 8;
/// The lines in the order of Moody's worksheets, each from its first to its last station.
inline constexpr std::array<std::string_view, kPlateLines> kPlateLineNames{"NW-SE", "NE-SW", "NE-NW", "NE-SE",
                                                                           "SE-SW", "NW-SW", "E-W",   "N-S"};
/// Above this closure error at the centre Moody has the work repeated: 100 microinches.
inline constexpr double kLargestClosure_um = 2.54;

/// Slopes [um/m] of the steps of each line; above 0: the surface rises from the first to the last station. The zero of
/// a line is free: an autocollimator has one of its own for each line.
struct PlateReadings {
  std::string source;
  std::vector<MetadataEntry> metadata;
  double step_mm = 0.0;  ///< distance of the feet
  std::array<std::vector<double>, kPlateLines> slopes_um_per_m;
};

/// A station, seen from above with north up: x from west to east, y from south to north, the south-west corner at 0.
struct PlateStation {
  std::size_t line = 0;  ///< index into kPlateLineNames
  std::size_t step = 0;  ///< from 0, the first station
  double x_mm = 0.0;
  double y_mm = 0.0;
  double height_um = 0.0;  ///< above the lowest station, from the datum plane of Moody
};

struct Flatness {
  double width_mm = 0.0;  ///< west to east, between the corner stations
  double depth_mm = 0.0;
  std::vector<PlateStation> stations;  ///< line after line; where lines cross, once for each of them
  /// Height of the centre by the line between the perimeter's middles less that by the diagonals, [0] E-W, [1] N-S
  /// [um].
  std::array<double, 2> closure_um{};
  double moody_um = 0.0;          ///< greatest height: the plane is parallel to both diagonals
  double least_squares_um = 0.0;  ///< between the two planes parallel to that of least squares
  double minimum_zone_um = 0.0;   ///< between the two closest planes (ISO 1101, ISO 12781-1): the flatness error
};

/// Reads `line,station_mm,reading` below `# step_mm: 101.6`, `# unit: arcsec` (or um/m, which is the preset) and, where
/// a positive reading means that the surface falls, `# positive: falls`. A row is a step: station_mm is that of its
/// foot ahead. Refuses, with line and column: lines missing, in another order or named from the other end, unequal
/// steps, an odd number of steps (no station at the centre), opposite lines of different length, diagonals that do not
/// fit the sides by 10 %.
[[nodiscard]] Result<PlateReadings> parse_plate_readings(std::string_view text, const std::string& file_name);

/// The heights by Moody's worksheets: diagonals through 0 at the centre with ends of equal height, the perimeter
/// between the ends of the diagonals, centre lines between the middles of the perimeter, then shifted to 0 at the
/// centre.
[[nodiscard]] Flatness flatness_of(const PlateReadings& readings);

struct PredictedForm {
  double least_squares_um = 0.0;    ///< between the two planes parallel to that of least squares
  double difference_rms_um = 0.0;   ///< measured less predicted height, each above its plane of least squares
  double difference_most_um = 0.0;  ///< the largest of them, without its sign
};

/// The errors of the map along the normal of the surface at every station, mean of both approaches. The readings say
/// where the surface lay: `# plane: XZ` (east, north), `# south_west_mm: -2950 -1200 -875` (X, Y, Z).
[[nodiscard]] Result<PredictedForm> predicted_form(const PlateReadings& readings, const Flatness& measured,
                                                   const ErrorMap& map, const UnitParameters& parameters);

}  // namespace ecs::laser
