// The table of a commissioning: which measurements the plan has, what they show before and after compensation, beside
// what was published.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/analysis/pipeline.hpp"
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

/// One phase of one measurement. Values in um, or um/m for a rotation.
struct MeasuredPhase {
  std::filesystem::path file;
  laser::ProcessedReadings readings;
  laser::Iso230 iso;  ///< of the readings without their slope
};

struct TableRow {
  PlannedMeasurement planned;
  std::optional<MeasuredPhase> before;
  std::optional<MeasuredPhase> after;
  std::vector<Problem> problems;  ///< files missing or unfit

  /// Before over after; nothing without both.
  [[nodiscard]] std::optional<double> ratio() const;
  /// The band after compensation is larger than the published one.
  [[nodiscard]] bool exceeds_published() const;
};

/// Reads `<name>.csv` of both folders; a row with problems has them, the others are whole.
[[nodiscard]] std::vector<TableRow> table_of(const std::vector<PlannedMeasurement>& plan,
                                             const std::filesystem::path& before, const std::filesystem::path& after);

/// In JSON a list of the rows. The text has 80 columns; the definition of the band and every problem stand under it.
[[nodiscard]] Cell table_cell(const std::vector<TableRow>& rows);

}  // namespace ecs::commissioning
