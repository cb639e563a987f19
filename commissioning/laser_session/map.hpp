// The map that the chosen files, parameters and components give, what is missing for it, and its files on disc.
// Does not live here: how a recipe becomes a map (commissioning/maps/build.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/laser_session/lines.hpp"
#include "commissioning/maps/findings.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

enum class ComponentState {
  present,        ///< from a measured file
  in_parameters,  ///< a squareness that the parameters hold already
  zero,           ///< declared zero, with a reason
  refused,        ///< its file cannot serve
  missing,
};

/// One component that the chosen scope needs.
struct LaserComponent {
  Component component = Component::EXX;
  ComponentState state = ComponentState::missing;
  std::string detail;  ///< files, reason, or why not; of a missing one why its measurement is not used
};

struct LaserMapWork {
  std::optional<params::ParametersFile> parameters;  ///< scope as chosen
  std::string parameters_problem;
  laser::SuggestedRecipe suggested;  ///< which lines serve which component, which serve none
  laser::MapRecipe recipe;           ///< everything: what `ecs map build` would be given
  std::optional<MadeMap> made;       ///< absent: refused, or nothing to build
  std::vector<std::string> refusals;
  std::vector<LaserComponent> components;
  std::string csv;  ///< of the map that was made
  [[nodiscard]] bool complete() const { return made && made->complete(); }
  [[nodiscard]] const std::vector<laser::MapFinding>& findings() const;
  [[nodiscard]] std::size_t missing() const;
};

/// The header: who, when, which machine, as chosen, else what the files say.
[[nodiscard]] laser::MapRecipe header_with_files(laser::MapRecipe chosen, const std::vector<LaserLine>& lines);

/// The map that follows from the choices, or the one that was opened, judged. Reads the parameters; what a map cannot
/// name as it is is prepared from the lines, and lies in no file yet.
[[nodiscard]] LaserMapWork laser_map(const LaserChoices& choices, const std::vector<LaserLine>& lines);
/// Places of the lines that a component is made from.
[[nodiscard]] std::vector<std::size_t> lines_behind(const laser::ComponentRecipe& component,
                                                    const std::vector<LaserLine>& lines);
[[nodiscard]] LaserLineChoice choice_for_line(const LaserChoices& choices, const LaserLine& line);

/// The files that belong to a map: "out/map.csv" → "out/map-parameters.toml", "out/map-recipe.toml", "out/map-files".
struct MapFiles {
  std::string map, parameters, recipe, folder;
};
[[nodiscard]] MapFiles files_of_map(const std::string& map_file);

struct SavedMap {
  MapFiles files;
  std::string csv;          ///< of the map
  laser::MapRecipe recipe;  ///< as it was kept; of a map that was opened: empty
  std::string opened{};     ///< the map that was opened, as it stood in its file before; empty: none was
};
/// A map that was opened has no recipe. Writes map, parameters with the squareness measured, the recipe that makes the
/// same map with `ecs map build`, and the files that have to be prepared for it. @pre work.made
/// @param choices, lines  that `work` follows from
[[nodiscard]] Result<SavedMap> save_laser_map(const LaserMapWork& work, const LaserChoices& choices,
                                              const std::vector<LaserLine>& lines);
/// The commands that write the same files (commissioning/session/commands.hpp).
/// @param lines  from which the map was made
void note_saved_map(const SavedMap& saved, const LaserChoices& choices, const std::vector<LaserLine>& lines);

}  // namespace ecs::commissioning
