// Error maps: made by a recipe, or opened, and judged; the travels that a map should cover; header, tables and findings
// as text and JSON, how findings are summed up in a word.
// Does not live here: how a map is made (laser/map/build.hpp), maps of models (from_model.hpp).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json_fwd.hpp"
#include "base/result.hpp"
#include "laser/map/build.hpp"
#include "laser/map/error_map.hpp"
#include "params/machine.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

[[nodiscard]] laser::Travels travels_of(const params::Machine& machine);

/// The travels that the file `machine.toml` in the folder of a parameter file gives, if it describes the machine of
/// those parameters: the same chain and, where [identity] states one, the same name. Nothing known otherwise.
[[nodiscard]] laser::Travels travels_beside(const std::string& params_file, const params::ParametersFile& parameters);

/// Those of a machine file, of none ("") those beside the parameters.
[[nodiscard]] Result<laser::Travels> travels_given(const std::string& machine_file, const std::string& params_file,
                                                   const params::ParametersFile& parameters);

[[nodiscard]] bool has_objections(const std::vector<laser::MapFinding>& findings);
/// What to do where tables are unevenly spaced.
inline constexpr const char* kEvenly =
    "space the points evenly (in step 4 of PROCESS LASER DATA: choose a grid), or give --accept-resampling to `ecs map "
    "send` and to `ecs map build MAP --image`";

/// Messages of the findings that are no objections.
[[nodiscard]] std::vector<std::string> remarks_in(const std::vector<laser::MapFinding>& findings);

/// laser::findings_for(), and a remark where sending would resample tables.
[[nodiscard]] std::vector<laser::MapFinding> findings_before_sending(const laser::ErrorMap& map,
                                                                     const UnitParameters& parameters,
                                                                     const laser::Travels& travels);

/// "1 remark", "2 remarks".
[[nodiscard]] std::string remarks_counted(std::size_t remarks);

/// "complete", "complete, 2 remarks", "not complete".
[[nodiscard]] std::string completeness(const std::vector<laser::MapFinding>& findings);

/// What a verb says below the findings of a map that it built.
/// @param of_two_machines  map and parameters name different ones
/// @param enter_squareness  the squareness in the answer is not yet in the parameters
[[nodiscard]] std::string verdict_text(const laser::ErrorMap& map, const std::vector<laser::MapFinding>& findings,
                                       bool of_two_machines, bool enter_squareness);
[[nodiscard]] bool squareness_differs(const UnitParameters& a, const UnitParameters& b);

/// A `usage` problem for anything but CODE=reason.
[[nodiscard]] Result<laser::DeclaredZero> declared_zero_in(const std::string& word);

struct MadeMap {
  laser::BuiltMap map;
  std::vector<laser::MapFinding> findings;
  /// Nothing is objected to.
  [[nodiscard]] bool complete() const { return !has_objections(findings); }
};

/// As laser::build_map(); machine and serial number are those of the parameters where neither recipe nor files state
/// them. @param travels  that the map should cover
[[nodiscard]] Result<MadeMap> made_map(const laser::MapRecipe& recipe, const params::ParametersFile& parameters,
                                       const laser::Travels& travels,
                                       const laser::FileReader& read = laser::read_plain);

/// Map and parameters, each where it has a file.
[[nodiscard]] Result<void> write_map(const std::string& file, const laser::ErrorMap& map,
                                     const std::string& params_file, const UnitParameters& parameters,
                                     const params::Identity& identity);

/// A map that is there already, with what was declared zero since.
[[nodiscard]] Result<MadeMap> opened_map(const std::string& file, const std::vector<laser::DeclaredZero>& zero,
                                         const params::ParametersFile& parameters, const laser::Travels& travels);

[[nodiscard]] std::string_view word_for(Approach approach);  ///< "forward", "reverse", "both"

/// In the text a line for each table: component, approach, start, increment ("varies"), points, smallest and largest
/// compensation. @param with_values  positions and values of each table in JSON as well
[[nodiscard]] Cell tables_cell(const std::vector<laser::MapTable>& tables, bool with_values);
[[nodiscard]] Cell header_cell(const laser::MapHeader& header);
/// The rows that follow live inputs; no text where there are none.
[[nodiscard]] Cell thermal_cell(const laser::MapHeader& header);
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
