// The mode of the unit as people read it; files, JSON and the protocol keep name_of(UnitMode).
#pragma once

#include <string_view>

#include "core/fault.hpp"

namespace ecs {

/// "referencing" for datuming, as the program speaks of axes that are referenced; else the name.
[[nodiscard]] inline std::string_view word_of(UnitMode mode) noexcept {
  return mode == UnitMode::datuming ? "referencing" : name_of(mode);
}

}  // namespace ecs
