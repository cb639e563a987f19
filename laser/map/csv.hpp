// The error map as text that a person can inspect and edit: `# key: value` header lines, then
// axis,sense,approach,p_mm,value_um (EA EB EC: um/m). The values are compensation, what the unit adds.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "laser/map/error_map.hpp"

namespace ecs::laser {

[[nodiscard]] std::string to_map_csv(const ErrorMap& map);

/// Reads a map. Columns by name in any order; an unknown column is refused. Every bad row at once: unknown axis or
/// sense, approach not 1, -1 or 0, NaN or infinity, values no machine can need (beyond ±32 mm), a position given twice,
/// approach 0 beside 1 or -1 of the same component, no rows at all; with a line `# rows: N`, as to_map_csv writes it,
/// another number of rows and a last row without its line end. Rows may stand in any order.
/// UTF-16 and the code pages of laser/text_decoding.hpp are read too; a NUL is refused with its place.
[[nodiscard]] Result<ErrorMap> parse_map_csv(std::string_view bytes, const std::string& file_name);
[[nodiscard]] Result<ErrorMap> read_map_csv(const std::filesystem::path& path);

}  // namespace ecs::laser
