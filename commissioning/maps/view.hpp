// An error map as text and JSON: header, tables, findings. Only for .cpp files (heavy header).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json_fwd.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {

[[nodiscard]] std::string_view word_for(Approach approach);  ///< "forward", "reverse", "both"

/// In the text a line for each table: component, approach, start, increment ("varies"), points, smallest and largest
/// compensation. @param with_values  positions and values of each table in JSON as well
[[nodiscard]] Cell tables_cell(const std::vector<laser::MapTable>& tables, bool with_values);
[[nodiscard]] Cell header_cell(const laser::MapHeader& header);
/// A line each.
[[nodiscard]] Cell findings_cell(const std::vector<laser::MapFinding>& findings);
/// What the objections among them say.
[[nodiscard]] std::vector<std::string> objections_in(const std::vector<laser::MapFinding>& findings);

/// {"C0Y_um_per_m": 12.5}; in the text a line each as parameter files have it. @param begin  of each line
[[nodiscard]] Cell squareness_cell(const std::vector<std::pair<Component, double>>& values,
                                   std::string_view begin = {});
/// The same below a heading. @param origin  "measured"  @param params_out  the file that holds them; empty: none
[[nodiscard]] Cell squareness_cell(const std::vector<std::pair<Component, double>>& values, std::string_view origin,
                                   const std::string& params_out);

}  // namespace ecs::commissioning
