// What the engineer chose on the way from laser files to a map: small, kept on disc as a draft, undone by putting an
// older value in its place.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/measurements/files.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::commissioning {

struct LaserFileChoice {
  std::string path;
  ImportArguments answers;  ///< what the file does not say
  /// Where the other axes stood, as in "y=-1400,z=0", where the file states it wrongly; by the line as the file states
  /// it (LaserLine::stated).
  std::map<std::string, std::string> places{};
};

/// Readings left out of one measured line, each with its reason (may be empty). Nothing is removed from any file.
struct LaserLineChoice {
  std::map<int, std::string> runs;
  std::map<std::size_t, std::string> readings;  ///< by their place in the line
  friend bool operator==(const LaserLineChoice&, const LaserLineChoice&) = default;
};

struct LaserChoices {
  std::vector<LaserFileChoice> files;
  std::map<std::string, LaserLineChoice> lines;  ///< by LaserLine::key
  /// Its header (empty: from the files, else from the parameters), what is done to each component, what is declared
  /// zero; which files the components have follows from the lines.
  laser::MapRecipe recipe;
  std::string opened_map;  ///< an error map taken as it is, in place of one from the lines; empty: none
  std::string params_file;
  std::string scope;  ///< "linear", "planar", "volumetric"; empty: as in the parameters
  std::string map_file = "map.csv";
};

/// JSON; reading it back gives the same choices.
[[nodiscard]] std::string choices_text(const LaserChoices& choices);
/// Nothing if it is no such text.
[[nodiscard]] std::optional<LaserChoices> choices_in(const std::string& text);
[[nodiscard]] inline bool operator==(const LaserChoices& a, const LaserChoices& b) {
  return choices_text(a) == choices_text(b);
}

}  // namespace ecs::commissioning
