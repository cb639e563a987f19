// Data sets with a known hidden cause, made by arithmetic of their own: machines, layouts, instruments and noises of
// several kinds. Does not live here: the method under test (model/), how it is scored (diagnose_table.cpp).
#pragma once

#include <cstdint>

#include "diagnose_case.hpp"

namespace ecs::bench {

/// @param snr  rms of each hidden effect, beyond what the model absorbs, over the standard deviation of one reading
[[nodiscard]] Case make_case(CaseKind kind, double snr, std::uint64_t seed);

}  // namespace ecs::bench
