// The answer for one machine of a fleet, and the line of JSON that holds it in a results file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ecs::commissioning {

/// A cause in the answer for one machine.
struct FleetCause {
  std::string name;  ///< "effect:axis:sense-or-code"
  double probability = 0.0;
  std::optional<double> e_value;  ///< divided by the number of candidates tried; absent: no split shows it
  double false_naming = 1.0;
  std::optional<double> p_value{};  ///< beside the other causes, for having been chosen; absent: older results
  std::string standing = "proved";  ///< or "likely"

  friend bool operator==(const FleetCause&, const FleetCause&) = default;
};

struct FleetResult {
  std::string id;
  std::string hash;                ///< SHA-256 of what was read; empty with an error
  std::string verdict;             ///< of model/diagnosis/diagnose.hpp
  std::vector<FleetCause> causes;  ///< proved ones, then likely ones
  std::string type, batch;
  double processor_s = 0.0;
  std::string error;                ///< not diagnosed, and why; empty: diagnosed
  bool doubled = false;             ///< the error is that another row has the id already; the answer for that one holds
  std::optional<double> p_value{};  ///< that nothing is missing; absent: older results

  friend bool operator==(const FleetResult&, const FleetResult&) = default;
};

/// {"id", "hash", "verdict", "p_value", "causes", "type", "batch", "processor_s"} or {"id", "error"} ("doubled" where
/// it is), without the end of the line.
[[nodiscard]] std::string to_line(const FleetResult& result);
/// Nothing where the line is no such object.
[[nodiscard]] std::optional<FleetResult> result_in(std::string_view line);

}  // namespace ecs::commissioning
