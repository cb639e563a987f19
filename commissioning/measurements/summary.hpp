// What a measurement set holds, in numbers. As fields of an answer: fields.hpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "laser/environment_series.hpp"
#include "laser/groups.hpp"
#include "laser/measurement_set.hpp"

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

}  // namespace ecs::commissioning
