// What the readers of several formats need: axis and sense that the file does not state, rows of numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/import/import.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// The moving axis from the options; a `usage` problem that says what to give if they have none.
[[nodiscard]] Result<Axis> axis_wanted(const ImportOptions& options, const std::string& file_name);

/// The sense of a positioning measurement, unless the options say otherwise; a rotation is refused.
[[nodiscard]] Result<Sense> positioning_sense(const ImportOptions& options, Axis axis, const std::string& file_name);

/// `parked_mm` with the moving axis at `target_mm`.
[[nodiscard]] Vector3 position_at(const ImportOptions& options, Axis axis, double target_mm);

/// The measured line of a file that states neither axis nor sense: axis and positioning sense of the options.
struct PositioningLine {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
};
[[nodiscard]] Result<PositioningLine> positioning_line(const ImportOptions& options, const std::string& file_name);

[[nodiscard]] Reading reading_at(const ImportOptions& options, const PositioningLine& at, double position_mm,
                                 double error_um, int text_line);

/// The numbers of a line that holds nothing else; empty otherwise. Decimal point or comma.
[[nodiscard]] std::vector<double> numbers_alone(std::string_view text_line);

/// The same, if there are `count` of them.
[[nodiscard]] std::optional<std::vector<double>> row_of(std::string_view text_line, std::size_t count);

/// Numbers the readings 1, 2, 3 … in their order.
void number_rows(MeasurementSet& set);

/// Options that do not suit the file.
[[nodiscard]] inline Problem usage(const std::string& file_name, std::string message) {
  return {ProblemKind::usage, std::move(message), file_name, 0, 0, {}};
}

}  // namespace ecs::laser
