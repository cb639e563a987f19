// The version of the program.
#pragma once

namespace ecs {

inline constexpr const char* kVersion = "ecs 0.1.0";

}  // namespace ecs
