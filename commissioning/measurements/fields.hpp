// Measurements as fields of an answer.
#pragma once

#include "base/json_fwd.hpp"
#include "commissioning/measurements/summary.hpp"

namespace ecs::commissioning {

/// "axis", "sense", "component", "unit", "parked_mm" (coordinates of the axes that do not move), "compensated".
[[nodiscard]] AnswerFields measured_line_fields(const laser::Group& group);

/// "readings", "axes", "senses", "runs", "targets", "metadata", "notes", "lines", "sensors". In the text "lines" is a
/// table of 80 columns, the others a line for each entry. @param most_lines  rows of that table
[[nodiscard]] AnswerFields set_fields(const laser::MeasurementSet& set, std::size_t most_lines = SIZE_MAX);

/// A line for each condition with its smallest and largest value. @param of  what is counted: "readings"
[[nodiscard]] Cell conditions_cell(const std::vector<ConditionSummary>& conditions, std::string_view of);

}  // namespace ecs::commissioning
