// Looks at a volume beside its sizes: one place, a plane, what falls between the places.
// Does not live here: the evaluation itself (volume/volume.hpp).
#pragma once

#include <string>
#include <string_view>

#include "commissioning/volume/work.hpp"

namespace ecs::commissioning {

/// "-100,0,-250" as X, Y, Z. @param option  as problems name it
[[nodiscard]] Result<Vector3> coordinates_in(const std::string& text, std::string_view option);

/// The error at the place that `text` says: X, Y, Z and behind them the angles of rotary axes. Refused: outside the
/// travels. @param expected  what is known before the true errors are
[[nodiscard]] Result<void> look_at(const std::string& text, const volume::CompensatedMachine& expected,
                                   VolumeWork& work);

/// The plane ("XY", or kLongestPlane) through the place of the largest error before compensation.
[[nodiscard]] Result<void> cut(const std::string& plane, VolumeWork& work);

/// The largest errors between the places. Refused: rotary axes.
[[nodiscard]] Result<void> look_between(VolumeWork& work);

}  // namespace ecs::commissioning
