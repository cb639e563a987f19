// The quantities of ISO 230-2 by key, symbol and name, as the verb and the screen show them.
#pragma once

#include <optional>

#include "laser/analysis/iso230.hpp"

namespace ecs::commissioning {

/// One quantity of the axis: key in JSON, symbol and name on the screen.
struct LaserQuantity {
  const char* key;
  const char* symbol;
  const char* name;
  std::optional<double> laser::Iso230::*value;
};

inline constexpr LaserQuantity kLaserQuantities[] = {
    {"A", "A", "bidirectional accuracy", &laser::Iso230::A},
    {"A_forward", "A fwd", "unidirectional accuracy, forward", &laser::Iso230::A_forward},
    {"A_reverse", "A rev", "unidirectional accuracy, reverse", &laser::Iso230::A_reverse},
    {"E", "E", "bidirectional systematic deviation", &laser::Iso230::E},
    {"E_forward", "E fwd", "unidirectional systematic deviation, forward", &laser::Iso230::E_forward},
    {"E_reverse", "E rev", "unidirectional systematic deviation, reverse", &laser::Iso230::E_reverse},
    {"M", "M", "range of the mean bidirectional deviation", &laser::Iso230::M},
    {"R", "R", "bidirectional repeatability", &laser::Iso230::R},
    {"R_forward", "R fwd", "unidirectional repeatability, forward", &laser::Iso230::R_forward},
    {"R_reverse", "R rev", "unidirectional repeatability, reverse", &laser::Iso230::R_reverse},
    {"B", "B", "reversal error", &laser::Iso230::B},
    {"B_mean", "B mean", "mean reversal error", &laser::Iso230::B_mean},
    {"three_sigma_band", "3s band", "max(mean + 3s) - min(mean - 3s) (BS 4656 Pt 16)",
     &laser::Iso230::three_sigma_band},
    {"non_repeatability", "6s", "non-repeatability, largest 6s (BS 4656 Pt 16)", &laser::Iso230::non_repeatability},
};

}  // namespace ecs::commissioning
