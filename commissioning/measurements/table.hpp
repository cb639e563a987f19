// The table of a commissioning: what the plan's measurements show before and after compensation, beside what was
// published.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/measurements/plan.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/analysis/pipeline.hpp"

namespace ecs::commissioning {

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
