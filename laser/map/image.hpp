// The error map as the bytes of the unit's axis memory, and back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/memory_image.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {

struct MapImage {
  std::vector<std::uint8_t> bytes;
  std::vector<std::string> notes;    ///< tables that had to be resampled, with the largest difference that makes
  std::vector<std::string> changed;  ///< of these, the tables that it changes by more than their resolution
};

/// Parameters and map as one image, checksum and the identity that the header states included. Refused (with every
/// reason) if findings_for() objects, if the values or the bytes exceed the axis memory modules, or if a table needs
/// more points than a uniform grid can give. Values are rounded to 0.01 um (0.01 um/m); a table beyond ±327 um to 0.1,
/// beyond ±3.2 mm to 1. Tables whose points are not evenly spaced are resampled at their smallest spacing.
[[nodiscard]] Result<MapImage> image_of(const ErrorMap& map, const UnitParameters& parameters);

/// Of a table with these values, um or um/m: 0.01, 0.1 or 1.
[[nodiscard]] double resolution_for(const std::vector<double>& values);

/// The value of that many counts, to the digits that the resolution has.
[[nodiscard]] double value_of_counts(std::int16_t counts, double resolution);

/// What image_of() changes in tables whose points are not evenly spaced: "2 tables are unevenly spaced, and resampling
/// changes them by up to 1.05 um (EYY forward)". Empty: no table changes by more than its resolution.
[[nodiscard]] std::string change_by_resampling(const ErrorMap& map);

/// Parameters alone: an image without tables, for a unit that has no map yet. It is addressed to nobody.
[[nodiscard]] std::vector<std::uint8_t> image_of(const UnitParameters& parameters);

/// Whom an image says it is for: its identity, or the header of its map in one of format 1.
struct StatedIdentity {
  std::string serial_number;  ///< empty: not stated
  std::string machine;        ///< empty: not stated
};
/// @param image  sound
[[nodiscard]] StatedIdentity stated_identity(std::span<const std::uint8_t> image);

/// The image addressed to a unit, in the format of today, sealed again. Refused if check_image() finds fault.
[[nodiscard]] Result<std::vector<std::uint8_t>> with_identity(std::vector<std::uint8_t> image,
                                                              const ImageIdentity& identity);

/// What an image holds. Refused, saying why, if check_image() finds fault.
struct ImageContent {
  UnitParameters parameters;
  ErrorMap map;
};
[[nodiscard]] Result<ImageContent> content_of(std::span<const std::uint8_t> image);

/// The image with its parameters replaced, sealed again. Its identity stays.
[[nodiscard]] Result<std::vector<std::uint8_t>> with_parameters(std::vector<std::uint8_t> image,
                                                                const UnitParameters& parameters);

}  // namespace ecs::laser
