// The plan of a commissioning: which measurements were made, and what was published of them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::commissioning {

enum class PlanPhase { both, before, after };

/// One `[[measure]]`.
struct PlannedMeasurement {
  std::string name;  ///< of its file, without .csv
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  std::string title;
  laser::SlopeMethod slope = laser::SlopeMethod::none;
  std::optional<double> published_before;  ///< band, um or um/m
  std::optional<double> published_after;
  PlanPhase phase = PlanPhase::both;
};

/// Reads `[[measure]]` tables: name, axis, sense, and optional title, slope, published_before, published_after, phase.
/// Without slope: least_squares for straightness, none for the rest and for `instrument = "square"`, whose slope is the
/// squareness itself. Other keys belong to whoever measures and mean nothing here. Every bad entry at once: missing or
/// unknown words, a name that is no plain file name or stands twice, no `[[measure]]` at all.
[[nodiscard]] Result<std::vector<PlannedMeasurement>> parse_plan(std::string_view text, const std::string& file_name);
[[nodiscard]] Result<std::vector<PlannedMeasurement>> read_plan(const std::filesystem::path& path);

}  // namespace ecs::commissioning
