// A flat surface that a face cutter has cut, from the trace of its part program, and the survey of it with an
// electronic level along the eight lines of a union jack (thesis 7.3, figure 7.23). Does not live here: what the
// readings say about the surface (modules/standards/plate.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::emulator {

/// A coordinate along each of the two axes of the surface [mm].
using SurfacePoint = std::array<double, 2>;

/// Which surface of the part, and with which cutter: its edges run on a circle at right angles to the tool, which
/// stands on the positive side of the surface.
struct FaceCut {
  std::array<Axis, 2> plane{Axis::X, Axis::Z};
  double at_mm = 0.0;        ///< commanded coordinate of the surface along the third axis
  double cutter_mm = 152.4;  ///< diameter; the 6 inches of the thesis
  [[nodiscard]] std::size_t normal() const { return 3 - index_of(plane[0]) - index_of(plane[1]); }
};

/// The lowest way of an edge of the cutter over every point: both halves of the circle cut, and a later pass cuts off
/// what an earlier one left. What is commanded more than 1 mm from the surface does not cut.
class CutSurface {
 public:
  /// @param text  trace of a part program (ecs_emulator/part_programs/run.hpp). A wrong row is refused with its line
  [[nodiscard]] static Result<CutSurface> parse(std::string_view text, const std::string& file, const FaceCut& cut);

  /// Above the commanded surface; nothing where no edge has passed [um].
  [[nodiscard]] std::optional<double> height_um(const SurfacePoint& point_mm) const;

 private:
  struct Centre {
    SurfacePoint at_mm{};
    double height_um = 0.0;                  ///< above the commanded surface
    std::array<double, 2> slope_um_per_m{};  ///< of the circle of the edges, along the two axes
  };

  double radius_mm_ = 0.0;
  std::vector<Centre> way_;
};

struct LevelSurvey {
  SurfacePoint south_west_mm{};  ///< corner stations, machine coordinates
  SurfacePoint north_east_mm{};
  double foot_mm = 75.0;        ///< distance of the feet: the step
  double noise_um_per_m = 0.5;  ///< standard deviation of a reading: 0.1 arcsec
  std::uint64_t seed = 1;
};

/// The file for `ecs test flatness`. East is the first axis of the plane, north the second. Part and level stand
/// inclined by the same slopes for all lines, up to ±100 um/m, and every reading has its noise.
/// `usage` problems: sides or diagonals that are no even number of steps (diagonals to 1 %), a station that no edge of
/// the cutter has passed.
[[nodiscard]] Result<std::string> survey_with_level(const CutSurface& surface, const FaceCut& cut,
                                                    const LevelSurvey& survey);

}  // namespace ecs::emulator
