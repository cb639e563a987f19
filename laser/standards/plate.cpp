// Heights of a plate by the worksheets of Moody (1955), with the corrections of B. Allen, "Comments on Moody's method
// for surface plate calibration" (2019): the lowest height is taken off, not added.
#include "laser/standards/plate.hpp"

#include <algorithm>
#include <numeric>

#include "base/units.hpp"
#include "laser/standards/zone.hpp"

namespace ecs::laser {
namespace {

enum PlateLineIndex : std::size_t { kNwSe, kNeSw, kNeNw, kNeSe, kSeSw, kNwSw, kEW, kNS };

struct Spot {
  double x = 0.0, y = 0.0;  ///< of width and depth
};
/// Ends of the lines, first and last.
constexpr std::array<std::array<Spot, 2>, kPlateLines> kEnds{{{{{0, 1}, {1, 0}}},
                                                              {{{1, 1}, {0, 0}}},
                                                              {{{1, 1}, {0, 1}}},
                                                              {{{1, 1}, {1, 0}}},
                                                              {{{1, 0}, {0, 0}}},
                                                              {{{0, 1}, {0, 0}}},
                                                              {{{1, 0.5}, {0, 0.5}}},
                                                              {{{0.5, 1}, {0.5, 0}}}}};

using Heights = std::vector<double>;

/// Sums of the slopes, first station 0 [um].
Heights raw_heights(const PlateReadings& plate, std::size_t line) {
  Heights heights{0.0};
  for (const double slope : plate.slopes_um_per_m[line])
    heights.push_back(heights.back() + slope * plate.step_mm / kMmPerM);
  return heights;
}

/// Turned and shifted so that it begins and ends there.
Heights between(Heights heights, double first, double last) {
  const double n = static_cast<double>(heights.size() - 1);
  const double begin = heights.front(), turn = (last - first) - (heights.back() - begin);
  for (std::size_t k = 0; k < heights.size(); ++k) heights[k] += first - begin + turn * static_cast<double>(k) / n;
  return heights;
}

double middle_of(const Heights& heights) { return heights[heights.size() / 2]; }

Heights shifted(Heights heights, double by) {
  for (double& height : heights) height += by;
  return heights;
}

/// 0 at the middle, both ends of one height.
Heights diagonal(Heights heights) {
  heights = between(std::move(heights), 0.0, 0.0);
  return shifted(heights, -middle_of(heights));
}

}  // namespace

Flatness flatness_of(const PlateReadings& plate) {
  std::array<Heights, kPlateLines> lines;
  for (std::size_t i = 0; i < kPlateLines; ++i) lines[i] = raw_heights(plate, i);
  lines[kNwSe] = diagonal(std::move(lines[kNwSe]));
  lines[kNeSw] = diagonal(std::move(lines[kNeSw]));
  const double nw = lines[kNwSe].front(), se = lines[kNwSe].back();
  const double ne = lines[kNeSw].front(), sw = lines[kNeSw].back();
  lines[kNeNw] = between(std::move(lines[kNeNw]), ne, nw);
  lines[kNeSe] = between(std::move(lines[kNeSe]), ne, se);
  lines[kSeSw] = between(std::move(lines[kSeSw]), se, sw);
  lines[kNwSw] = between(std::move(lines[kNwSw]), nw, sw);
  lines[kEW] = between(std::move(lines[kEW]), middle_of(lines[kNeSe]), middle_of(lines[kNwSw]));
  lines[kNS] = between(std::move(lines[kNS]), middle_of(lines[kNeNw]), middle_of(lines[kSeSw]));
  Flatness flatness;
  flatness.closure_um = {middle_of(lines[kEW]), middle_of(lines[kNS])};
  lines[kEW] = shifted(std::move(lines[kEW]), -flatness.closure_um[0]);
  lines[kNS] = shifted(std::move(lines[kNS]), -flatness.closure_um[1]);

  flatness.width_mm = plate.step_mm * static_cast<double>(plate.slopes_um_per_m[kNeNw].size());
  flatness.depth_mm = plate.step_mm * static_cast<double>(plate.slopes_um_per_m[kNeSe].size());
  double lowest = 0.0;
  for (const Heights& line : lines) lowest = std::min(lowest, *std::min_element(line.begin(), line.end()));
  std::vector<ZonePoint> points;
  for (std::size_t i = 0; i < kPlateLines; ++i)
    for (std::size_t k = 0; k < lines[i].size(); ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(lines[i].size() - 1);
      const auto& [first, last] = kEnds[i];
      PlateStation station{i, k, flatness.width_mm * std::lerp(first.x, last.x, share),
                           flatness.depth_mm * std::lerp(first.y, last.y, share), lines[i][k] - lowest};
      flatness.moody_um = std::max(flatness.moody_um, station.height_um);
      points.push_back({station.x_mm, station.y_mm, station.height_um});
      flatness.stations.push_back(station);
    }
  flatness.least_squares_um = least_squares_zone(points).width();
  flatness.minimum_zone_um = minimum_zone(points).width();
  return flatness;
}

}  // namespace ecs::laser
