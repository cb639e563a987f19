// Deviations of a part that was cut and measured (post-process compensation, thesis 1.4.2.2), and what they say between
// the measured points. Does not live here: coordinate measuring files with columns of their own (`ecs laser import
// --columns` makes measurements of them).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::controllers {

struct MeasuredPoint {
  Vector3 nominal_mm{};    ///< program coordinates
  Vector3 deviation_um{};  ///< measured − nominal
};

struct PartDeviations {
  std::vector<MeasuredPoint> points;  ///< by X
  std::vector<std::string> notes;

  /// Weighted mean of the points nearer than `reach_mm`, by ((R − d) / (R·d))²: exact at the points, and no value
  /// beyond the reach of every point (modified Shepard method; R. Franke, G. Nielson, Int. J. Numerical Methods in
  /// Engineering 15 (1980) 1691, with constant nodal functions).
  [[nodiscard]] std::optional<Vector3> at(const Vector3& program_mm, double reach_mm) const;
};

/// CSV with x_mm, y_mm, z_mm and either dx_um, dy_um, dz_um or measured_x_mm, measured_y_mm, measured_z_mm; or
/// measurements (axis, sense, reading …) with readings EX, EY, EZ: repeated ones as their mean, absent senses as 0 with
/// a note. Refused, every row with line and column: cells that are no numbers, deviations above 100 mm, other senses;
/// two rows at one place in the first two forms.
[[nodiscard]] Result<PartDeviations> parse_part_deviations(std::string_view text, const std::string& file);

}  // namespace ecs::controllers
