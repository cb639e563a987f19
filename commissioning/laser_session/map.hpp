// The map that the chosen files, parameters and components give, what is missing for it, and its files on disc.
// Does not live here: how a recipe becomes a map (commissioning/maps/build.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/laser_session/choices.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/maps/build.hpp"
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

/// Which lines make which component; kept as long as lines and parameters stay the same.
struct LaserAssignment {
  std::string made_from;    ///< what it depends on, as text
  laser::MapRecipe recipe;  ///< components and their files alone
  std::vector<std::string> unused;
  std::string problem;
};

struct LaserMapWork {
  std::optional<params::ParametersFile> parameters;  ///< scope as chosen
  std::string parameters_problem;
  LaserAssignment assignment;
  laser::MapRecipe recipe;      ///< everything: what `ecs map build` would be given
  std::optional<MadeMap> made;  ///< absent: refused, or nothing to build
  std::vector<std::string> refusals;
  std::vector<LaserComponent> components;
  std::string csv;  ///< of the map that was made
  [[nodiscard]] bool complete() const { return made && made->complete(); }
  [[nodiscard]] const std::vector<laser::MapFinding>& findings() const;
  [[nodiscard]] std::size_t missing() const;
};

/// Who, when, which machine: as chosen, else what the files say.
[[nodiscard]] LaserHeaderChoice header_with_files(const LaserHeaderChoice& chosen, const std::vector<LaserLine>& lines);

/// The parameters with the scope chosen. Reads the file.
void take_parameters(LaserMapWork& work, const LaserChoices& choices);
/// Which line serves which component. A line that a map cannot name as it is goes into a file of `folder` first.
void assign_lines(LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines,
                  const LaserAssignment& before, const std::filesystem::path& folder);
/// Places of the lines that a component is made from.
[[nodiscard]] std::vector<std::size_t> lines_behind(const laser::ComponentRecipe& component,
                                                    const std::vector<LaserLine>& lines,
                                                    const std::filesystem::path& folder);
/// Builds the map, or takes the one that was opened, and judges it.
void build_laser_map(LaserMapWork& work, const LaserChoices& choices, const std::vector<LaserLine>& lines,
                     const std::filesystem::path& folder);

/// Where a line is prepared: a name of its own for each line of the list.
[[nodiscard]] std::filesystem::path prepared_path(const std::vector<LaserLine>& lines, std::size_t at,
                                                  const std::filesystem::path& folder);
[[nodiscard]] LaserLineChoice choice_for_line(const LaserChoices& choices, const LaserLine& line);
[[nodiscard]] LaserComponentChoice choice_for_component(const LaserChoices& choices, Component component);

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
/// same map with `ecs map build`, and the files that had to be prepared for it. @pre work.made
[[nodiscard]] Result<SavedMap> save_laser_map(const LaserMapWork& work, const LaserChoices& choices,
                                              const std::filesystem::path& prepared_folder);
/// The commands that write the same files (commissioning/session/commands.hpp).
/// @param lines  from which the map was made
void note_saved_map(const SavedMap& saved, const LaserChoices& choices, const std::vector<LaserLine>& lines);

}  // namespace ecs::commissioning
