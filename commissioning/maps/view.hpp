// An error map as text and JSON: header, tables, findings. Only for .cpp files (heavy header).
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {

[[nodiscard]] std::string_view word_for(Approach approach);  ///< "forward", "reverse", "both"

/// A line per table: component, approach, start, increment ("varies"), points, smallest and largest compensation.
[[nodiscard]] std::string tables_text(const std::vector<laser::MapTable>& tables);
[[nodiscard]] std::string header_view(const laser::MapHeader& header);
[[nodiscard]] std::string findings_text(const std::vector<laser::MapFinding>& findings);

/// @param with_values  positions and values of each table as well
[[nodiscard]] Json table_json(const laser::MapTable& table, bool with_values);
[[nodiscard]] Json header_json(const laser::MapHeader& header);
[[nodiscard]] Json findings_json(const std::vector<laser::MapFinding>& findings);

}  // namespace ecs::commissioning
