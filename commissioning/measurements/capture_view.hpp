// What a capture tells the operator: what comes next, what was read.
#pragma once

#include <string>

#include "devices/capture_record.hpp"

namespace ecs::commissioning {

/// "next: X forward to 50 mm (2 of 11, run 1 of 3, 13 of 66 in all)"; at the beginning of a pass also from where.
/// Empty: all done.
[[nodiscard]] std::string due_text(const devices::CaptureRecord& record);

/// The last reading with its time and temperatures: "3.10 um at X 50 mm (12.4 s, air 20.31 degC)".
[[nodiscard]] std::string taken_text(const devices::CaptureRecord& record);

/// "air 20.31 degC, material 19.80 degC, 1013.2 hPa, 45 %RH"; empty: nothing is known.
[[nodiscard]] std::string around_text(const devices::Values& values);
[[nodiscard]] std::string around_text(const laser::Reading& reading);

}  // namespace ecs::commissioning
