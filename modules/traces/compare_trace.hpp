// `ecs model compare` on a recorded step of a servo axis: its drive constants against the oscilloscope.
#pragma once

#include <string>

#include "base/result.hpp"
#include "commissioning/plot/figure.hpp"

namespace ecs::commissioning {

/// True for a file whose header row has time_s and dac_V; false for any other, also one that cannot be read.
[[nodiscard]] bool is_trace_file(const std::string& file);

/// The picture: recorded, simulated as given and simulated as mended.
/// @param model  file with a [drive] table; without the table the constants are as printed in appendix A
[[nodiscard]] Result<DrawnOutcome> compare_trace(const std::string& model, const std::string& trace);

}  // namespace ecs::commissioning
