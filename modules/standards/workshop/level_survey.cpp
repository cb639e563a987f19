#include "modules/standards/workshop/level_survey.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"
#include "ecs_emulator/random/random.hpp"
#include "laser/csv_table.hpp"

namespace ecs::emulator {
namespace {

constexpr double kClear_mm = 1.0;  ///< from the surface: the cutter is off the part
constexpr double kMostInclined_um_per_m = 100.0;
constexpr double kObliqueShare = 0.01;  ///< by which a diagonal may miss its corners

/// Shares of the way from one point to the other, 0 to 1, at which a circle about it passes over `point`.
std::vector<double> crossings(const SurfacePoint& from, const SurfacePoint& to, double radius,
                              const SurfacePoint& point) {
  const double dx = to[0] - from[0], dy = to[1] - from[1], px = point[0] - from[0], py = point[1] - from[1];
  const double a = dx * dx + dy * dy, b = px * dx + py * dy, c = px * px + py * py - radius * radius;
  const double root = b * b - a * c;
  std::vector<double> shares;
  if (a == 0.0 || root < 0.0) return shares;
  for (const double share : {(b - std::sqrt(root)) / a, (b + std::sqrt(root)) / a})
    if (share >= 0.0 && share <= 1.0) shares.push_back(share);
  return shares;
}

}  // namespace

Result<CutSurface> CutSurface::parse(std::string_view text, const std::string& file, const FaceCut& cut) {
  const auto column = [](const char* form, std::size_t axis) {
    return fmt::format(fmt::runtime(form), small_letter_of(static_cast<Axis>(axis)));
  };
  const std::size_t first = index_of(cut.plane[0]), second = index_of(cut.plane[1]), normal = cut.normal();
  const std::array<std::string, 6> names{column("position_{}_mm", first),       column("position_{}_mm", second),
                                         column("command_{}_mm", normal),       column("e{}_um", normal),
                                         column("rotation_{}_um_per_m", first), column("rotation_{}_um_per_m", second)};
  const std::vector<std::string_view> needed(names.begin(), names.end());
  laser::Findings findings(file);
  ECS_TRY(table, laser::parse_csv_table(text, file, needed, findings));
  laser::TableReader reader(table, findings);
  CutSurface surface;
  surface.radius_mm_ = 0.5 * cut.cutter_mm;
  // The height of a circle turned by r falls or rises along the first axis by r about the second, and the other way
  // round.
  const double turned = (normal + 1) % 3 == first ? 1.0 : -1.0;
  for (const laser::CsvRow& row : table.rows) {
    reader.take(row);
    std::array<double, 6> value{};
    for (std::size_t k = 0; k < names.size(); ++k) value[k] = reader.number(names[k]).value_or(0.0);
    surface.way_.push_back(
        {{value[0], value[1]}, (value[2] - cut.at_mm) * kUmPerMm + value[3], {-turned * value[5], turned * value[4]}});
  }
  if (findings.empty() && surface.way_.size() < 2)
    findings.add(0, 0, "expected two samples of a trace or more, found {}", surface.way_.size());
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return surface;
}

std::optional<double> CutSurface::height_um(const SurfacePoint& point_mm) const {
  std::optional<double> lowest_um;
  for (std::size_t k = 1; k < way_.size(); ++k) {
    const Centre &from = way_[k - 1], &to = way_[k];
    if (std::max(std::abs(from.height_um), std::abs(to.height_um)) > kClear_mm * kUmPerMm) continue;
    for (const double share : crossings(from.at_mm, to.at_mm, radius_mm_, point_mm)) {
      double height_um = std::lerp(from.height_um, to.height_um, share);
      for (std::size_t i = 0; i < 2; ++i)
        height_um += std::lerp(from.slope_um_per_m[i], to.slope_um_per_m[i], share) / kMmPerM *
                     (point_mm[i] - std::lerp(from.at_mm[i], to.at_mm[i], share));
      lowest_um = std::min(height_um, lowest_um.value_or(height_um));
    }
  }
  return lowest_um;
}

namespace {

/// A line of the union jack, its ends as shares of width and depth, in the order of `ecs test flatness`.
struct JackLine {
  const char* name;
  SurfacePoint first, last;
};
constexpr std::array<JackLine, 8> kJack{{{"NW-SE", {0, 1}, {1, 0}},
                                         {"NE-SW", {1, 1}, {0, 0}},
                                         {"NE-NW", {1, 1}, {0, 1}},
                                         {"NE-SE", {1, 1}, {1, 0}},
                                         {"SE-SW", {1, 0}, {0, 0}},
                                         {"NW-SW", {0, 1}, {0, 0}},
                                         {"E-W", {1, 0.5}, {0, 0.5}},
                                         {"N-S", {0.5, 1}, {0.5, 0}}}};

/// Even numbers of steps along width, depth and diagonal.
Result<std::array<int, 3>> jack_steps(const LevelSurvey& survey) {
  const double width_mm = survey.north_east_mm[0] - survey.south_west_mm[0];
  const double depth_mm = survey.north_east_mm[1] - survey.south_west_mm[1];
  if (!(width_mm > 0.0 && depth_mm > 0.0))
    return problem(ProblemKind::usage, "expected --to beyond --from along both axes");
  const std::array<double, 3> lengths_mm{width_mm, depth_mm, std::hypot(width_mm, depth_mm)};
  std::array<int, 3> steps{};
  for (std::size_t k = 0; k < 3; ++k) {
    steps[k] = 2 * static_cast<int>(std::lround(lengths_mm[k] / survey.foot_mm / 2.0));
    const double rest_mm = std::abs(steps[k] * survey.foot_mm - lengths_mm[k]);
    if (steps[k] > 0 && rest_mm <= (k == 2 ? kObliqueShare * lengths_mm[k] : 0.01 * survey.foot_mm)) continue;
    constexpr std::array kNames{"side along the first axis", "side along the second axis", "diagonal"};
    return problem(ProblemKind::usage,
                   "step: the {} has {:.6g} mm; expected an even number of steps of {:.6g} mm, such as on a "
                   "surface of 24 by 10 steps, whose diagonal has 26",
                   kNames[k], lengths_mm[k], survey.foot_mm);
  }
  return steps;
}

}  // namespace

Result<std::string> survey_with_level(const CutSurface& surface, const FaceCut& cut, const LevelSurvey& survey) {
  ECS_TRY(steps, jack_steps(survey));
  const SurfacePoint &low = survey.south_west_mm, &high = survey.north_east_mm;
  const double width_mm = high[0] - low[0], depth_mm = high[1] - low[1];
  Random random(seed_of(survey.seed, 0, 0));
  std::array<double, 2> inclined_um_per_m{};
  for (double& slope : inclined_um_per_m) slope = kMostInclined_um_per_m * (2.0 * random.uniform() - 1.0);
  Vector3 corner_mm{};
  corner_mm[index_of(cut.plane[0])] = low[0];
  corner_mm[index_of(cut.plane[1])] = low[1];
  corner_mm[cut.normal()] = cut.at_mm;
  std::string text = fmt::format(
      "# instrument: electronic level\n# step_mm: {}\n# unit: um/m\n# positive: rises\n# plane: {}{}\n"
      "# south_west_mm: {} {} {}\nline,station_mm,reading\n",
      survey.foot_mm, letter_of(cut.plane[0]), letter_of(cut.plane[1]), corner_mm[0], corner_mm[1], corner_mm[2]);
  for (const JackLine& line : kJack) {
    const double along = line.last[0] - line.first[0], across = line.last[1] - line.first[1];
    const int count = along != 0.0 && across != 0.0 ? steps[2] : along != 0.0 ? steps[0] : steps[1];
    const double length_mm = std::hypot(along * width_mm, across * depth_mm);
    const SurfacePoint unit{along * width_mm / length_mm, across * depth_mm / length_mm};
    double before_um = 0.0;
    for (int k = 0; k <= count; ++k) {
      const double from_middle_mm = (k - 0.5 * count) * survey.foot_mm;
      const SurfacePoint at{
          std::lerp(low[0], high[0], 0.5 * (line.first[0] + line.last[0])) + unit[0] * from_middle_mm,
          std::lerp(low[1], high[1], 0.5 * (line.first[1] + line.last[1])) + unit[1] * from_middle_mm};
      const auto height_um = surface.height_um(at);
      if (!height_um)
        return problem(ProblemKind::usage,
                       "line {}, station {}: no edge of the cutter has passed {} {:.3f}, {} {:.3f} mm; "
                       "expected --from, --to and --at within the surface that the program cuts",
                       line.name, k, letter_of(cut.plane[0]), at[0], letter_of(cut.plane[1]), at[1]);
      if (k > 0)
        text += fmt::format("{},{},{:.4f}\n", line.name, k * survey.foot_mm,
                            (*height_um - before_um) / survey.foot_mm * kMmPerM + unit[0] * inclined_um_per_m[0] +
                                unit[1] * inclined_um_per_m[1] + survey.noise_um_per_m * random.normal());
      before_um = *height_um;
    }
  }
  return text;
}

}  // namespace ecs::emulator
