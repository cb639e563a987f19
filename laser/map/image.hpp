// The error map as the bytes of the unit's axis memory, and back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "laser/map/error_map.hpp"

namespace ecs::laser {

struct MapImage {
  std::vector<std::uint8_t> bytes;
  std::vector<std::string> notes;    ///< tables that had to be resampled, with the largest difference that makes
  std::vector<std::string> changed;  ///< of these, the tables that it changes by more than their resolution
};

/// Parameters and map as one image, block check included. Refused (with every reason) if findings_for() objects, if the
/// values or the bytes exceed the axis memory modules, or if a table needs more points than a uniform grid can give.
/// Values are rounded to 0.01 um (0.01 um/m); a table beyond ±327 um to 0.1, beyond ±3.2 mm to 1.
/// Tables whose points are not evenly spaced are resampled at their smallest spacing.
[[nodiscard]] Result<MapImage> image_of(const ErrorMap& map, const UnitParameters& parameters);

/// Of a table with these values, um or um/m: 0.01, 0.1 or 1.
[[nodiscard]] double resolution_for(const std::vector<double>& values);

/// Parameters alone: an image without tables, for a unit that has no map yet.
[[nodiscard]] std::vector<std::uint8_t> image_of(const UnitParameters& parameters);

/// What an image holds. Refused, saying why, if check_image() finds fault.
struct ImageContent {
  UnitParameters parameters;
  ErrorMap map;
};
[[nodiscard]] Result<ImageContent> content_of(std::span<const std::uint8_t> image);

/// The image with its parameters replaced, sealed again.
[[nodiscard]] Result<std::vector<std::uint8_t>> with_parameters(std::vector<std::uint8_t> image,
                                                                const UnitParameters& parameters);

}  // namespace ecs::laser
