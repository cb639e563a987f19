// The largest error between the places of a grid: a jump or a short wave falls between even places unseen.
// Does not live here: the places of the grid (statistics.hpp).
#pragma once

#include "volume/volume.hpp"

namespace ecs::volume {

inline constexpr std::size_t kPlacesOfLine = 2001;  ///< 0.5 mm apart on an axis of a metre

/// The largest error on lines along each axis through `from`, from there again, until no line holds a larger one: no
/// smaller than `from`. Rotary axes stand at the angles of the machine.
/// @param of  before or after compensation: &BeforeAfter::before, &BeforeAfter::after
[[nodiscard]] Result<ErrorSize> largest_between(const CompensatedMachine& machine, const ErrorSize& from,
                                                VolumeError BeforeAfter::*of);

}  // namespace ecs::volume
