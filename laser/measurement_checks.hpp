// What readers of measurements share: readings that cannot be, a measurement CSV that leaves the approach open.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// The readings whose position or error no machine has, line by line, with the limit; nothing if there are none.
[[nodiscard]] std::optional<Problem> implausible(const MeasurementSet& set, const std::string& file_name);

/// parse_measurement_set(), but where the column `approach` is absent it stays unknown.
[[nodiscard]] Result<MeasurementSet> set_with_approach_open(std::string_view text, const std::string& file_name);

}  // namespace ecs::laser
