// A circular test (ISO 230-4) as values: radial deviations of contouring both ways, with what was known of the circle.
// Does not live here: the file (laser/standards/circle.hpp), its writer (laser/writers/writers.hpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/axis.hpp"
#include "laser/csv_table.hpp"

namespace ecs::laser {

/// One radial deviation.
struct CircleReading {
  int line = 0;             ///< of the file, from 1; 0: not from a file
  double angle_deg = 0.0;   ///< 0 on the positive first axis, 90 on the positive second axis; 0 … 360
  double deviation_um = 0;  ///< actual − nominal radius, positive away from the centre
  bool clockwise = false;   ///< contoured with falling angle; else counter-clockwise
  int run = 1;
  int part = 1;  ///< number of the zero of the instrument, which a run may set again for each half of the circle
  friend bool operator==(const CircleReading&, const CircleReading&) = default;
};

struct CircleTest {
  std::string source;                           ///< the file it came from; empty: none
  std::vector<MetadataEntry> metadata;          ///< in file order, those below among them
  std::array<Axis, 2> plane{Axis::X, Axis::Y};  ///< first and second axis
  double radius_mm = 0.0;                       ///< nominal, above 0
  std::optional<double> feed_mm_min;
  std::optional<double> start_angle_deg;
  std::array<std::optional<double>, 2> centre_mm{};  ///< of the two axes, machine coordinates
  std::vector<CircleReading> readings;               ///< in file order
};

/// "X" and "Y" as "XY".
[[nodiscard]] inline std::string plane_name(const std::array<Axis, 2>& plane) {
  return {letter_of(plane[0]), letter_of(plane[1])};
}
[[nodiscard]] constexpr const char* contouring_name(bool clockwise) { return clockwise ? "cw" : "ccw"; }

}  // namespace ecs::laser
