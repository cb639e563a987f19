// What a measurement set holds, in numbers and as fields of an answer; the quantities of ISO 230-2 by key, symbol and
// name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/environment_series.hpp"
#include "laser/groups.hpp"
#include "laser/measurement_set.hpp"
#include "laser/standards/iso230_uncertainty.hpp"

namespace ecs::commissioning {

/// One measurement line.
struct LineSummary {
  laser::Group group;
  std::size_t readings = 0;
  std::size_t runs = 0;  ///< different run numbers
  std::size_t targets = 0;
  double first_mm = 0.0;          ///< lowest target
  double last_mm = 0.0;           ///< highest target
  std::optional<double> step_mm;  ///< between all targets; absent where it varies
  bool forward = false;           ///< has forward readings
  bool reverse = false;
};

[[nodiscard]] std::vector<LineSummary> lines_in(const laser::MeasurementSet& set);

/// "Y -1400, Z 0": positions of the axes that do not move.
[[nodiscard]] std::string parked_text(const laser::Group& group);
/// "yes", "no", "?"
[[nodiscard]] std::string_view compensated_text(const laser::Group& group);
/// "with compensation", "compensation not stated".
[[nodiscard]] std::string_view compensation_text(const laser::Group& group);

/// Smallest and largest value of everything measured besides the error: sensors, air, feed, time.
struct ConditionSummary {
  std::string name;
  std::size_t readings = 0;
  double least = 0.0;
  double most = 0.0;
};
[[nodiscard]] std::vector<ConditionSummary> conditions_in(const laser::MeasurementSet& set);
/// The same of an environment log.
[[nodiscard]] std::vector<ConditionSummary> conditions_in(const laser::EnvironmentSeries& series);

/// One quantity of the axis: key in JSON, symbol and name on the screen.
struct LaserQuantity {
  const char* key;
  const char* symbol;
  const char* name;
  std::optional<double> laser::Iso230::*value;
  std::optional<double> laser::Iso230Uncertainty::*uncertainty;  ///< null: the standard gives none
};

inline constexpr LaserQuantity kLaserQuantities[] = {
    {"A", "A", "bidirectional accuracy", &laser::Iso230::A, &laser::Iso230Uncertainty::A},
    {"A_forward", "A fwd", "unidirectional accuracy, forward", &laser::Iso230::A_forward,
     &laser::Iso230Uncertainty::A_forward},
    {"A_reverse", "A rev", "unidirectional accuracy, reverse", &laser::Iso230::A_reverse,
     &laser::Iso230Uncertainty::A_reverse},
    {"E", "E", "bidirectional systematic error", &laser::Iso230::E, &laser::Iso230Uncertainty::E},
    {"E_forward", "E fwd", "unidirectional systematic error, forward", &laser::Iso230::E_forward,
     &laser::Iso230Uncertainty::E_forward},
    {"E_reverse", "E rev", "unidirectional systematic error, reverse", &laser::Iso230::E_reverse,
     &laser::Iso230Uncertainty::E_reverse},
    {"M", "M", "range of the mean bidirectional error", &laser::Iso230::M, &laser::Iso230Uncertainty::M},
    {"R", "R", "bidirectional repeatability", &laser::Iso230::R, &laser::Iso230Uncertainty::R},
    {"R_forward", "R fwd", "unidirectional repeatability, forward", &laser::Iso230::R_forward,
     &laser::Iso230Uncertainty::R_forward},
    {"R_reverse", "R rev", "unidirectional repeatability, reverse", &laser::Iso230::R_reverse,
     &laser::Iso230Uncertainty::R_reverse},
    {"B", "B", "reversal error", &laser::Iso230::B, &laser::Iso230Uncertainty::B},
    {"B_mean", "B mean", "mean reversal error", &laser::Iso230::B_mean, &laser::Iso230Uncertainty::B_mean},
    {"three_sigma_band", "3s band", "max(mean + 3s) - min(mean - 3s) (BS 4656 Pt 16)", &laser::Iso230::three_sigma_band,
     nullptr},
    {"non_repeatability", "6s", "non-repeatability, largest 6s (BS 4656 Pt 16)", &laser::Iso230::non_repeatability,
     nullptr},
    {"vdi_P", "P VDI", "positional uncertainty (VDI/DGQ 3441)", &laser::Iso230::vdi_P, nullptr},
    {"vdi_Ps", "Ps VDI", "largest positional scatter (VDI/DGQ 3441)", &laser::Iso230::vdi_Ps, nullptr},
};

/// "axis", "sense", "component", "unit", "parked_mm" (coordinates of the axes that do not move), "compensated".
[[nodiscard]] AnswerFields measured_line_fields(const laser::Group& group);

/// "readings", "axes", "senses", "runs", "targets", "metadata", "notes", "lines", "sensors". In the text "lines" is a
/// table of 80 columns, the others a line for each entry. @param most_lines  rows of that table
[[nodiscard]] AnswerFields set_fields(const laser::MeasurementSet& set, std::size_t most_lines = SIZE_MAX);

/// A line for each condition with its smallest and largest value. @param of  what is counted: "readings"
[[nodiscard]] Cell conditions_cell(const std::vector<ConditionSummary>& conditions, std::string_view of);

}  // namespace ecs::commissioning
