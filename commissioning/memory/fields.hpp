// Which bytes of an image carry which field: names and meaning beside the bytes.
#pragma once

#include <string>
#include <vector>

#include "commissioning/memory/decode.hpp"

namespace ecs::commissioning {

struct ByteField {
  Address address = 0;
  std::uint32_t bytes = 0;
  std::string name;   ///< "prefix.total_bytes", "axis.X.deadband_um", "table 3 increment_mm"
  std::string value;  ///< with its unit
};

/// Prefix, parameters, identity and table directory of an image, by address. Where the bytes end, the list ends.
/// @param region  the bytes it was decoded from
[[nodiscard]] std::vector<ByteField> fields_of(const DecodedImage& image, const DumpRegion& region);

/// Offset of each parameter in the parameter block, and its length: `first` 512 where it is not stored.
struct FieldPlace {
  std::uint32_t first = 0;
  std::uint32_t bytes = 0;
};
/// In the order of params::fields(). Found by encoding: a field lies where the bytes change with it.
[[nodiscard]] const std::vector<FieldPlace>& parameter_places();

/// "45 43 53 49"
[[nodiscard]] std::string hex_of(ByteView bytes);

}  // namespace ecs::commissioning
