// What a map is made of and how: the files of each component and what is done to their readings.
// Does not live here: doing it (build.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "core/parameters.hpp"
#include "laser/analysis/process.hpp"
#include "laser/import/import.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::laser {

/// The word of a method in recipes and on command lines.
[[nodiscard]] std::string_view name_of(SlopeMethod method);
[[nodiscard]] std::optional<SlopeMethod> slope_method_named(std::string_view word);

/// Least squares for straightness and squareness, none for the rest.
[[nodiscard]] SlopeMethod default_slope(Component component);

/// One component of the map.
struct ComponentRecipe {
  Component component = Component::EXX;
  /// One file; for a rotation found from two linear runs at two offsets (thesis 6.3.2.3), two.
  std::vector<std::filesystem::path> files;
  std::optional<SlopeMethod> slope;  ///< absent: default_slope()
  double smoothing_mm = 0.0;         ///< window of the local quadratic; 0: none
  std::vector<int> exclude_runs;
  std::optional<double> increment_mm;  ///< of the tables; absent: the spacing of the targets
  friend bool operator==(const ComponentRecipe&, const ComponentRecipe&) = default;
};

struct MapRecipe {
  bool shrink = false;  ///< every curve below its own noise (laser/analysis/shrinking.hpp)
  std::string customer;
  std::string engineer;
  std::string date;
  std::string machine;                      ///< empty: from the files
  std::string serial_number;                ///< empty: from the files
  std::vector<ComponentRecipe> components;  ///< curves and squareness values
  std::vector<DeclaredZero> declared_zero;
  std::string remark{};  ///< kept with the steps of the map
};

/// What is done to a component, without its files where the recipe names none.
[[nodiscard]] ComponentRecipe settings_of(const MapRecipe& recipe, Component component);
/// The same to be changed; added where the recipe lacks it.
[[nodiscard]] ComponentRecipe& settings_in(MapRecipe& recipe, Component component);
/// Why a component is declared zero; empty: it is not.
[[nodiscard]] std::string zero_reason(const MapRecipe& recipe, Component component);
/// Zeros stay in the order of their codes. @param reason  empty: it is no longer declared zero
void declare_zero(MapRecipe& recipe, Component component, const std::string& reason);

/// Reads a recipe (docs/laser.md):
///   customer, engineer, date, machine, serial_number, remark, shrink (true or false)
///   [[component]] code, files (relative to the recipe), slope, smoothing_mm, exclude_runs, increment_mm
///   [[declared_zero]] code, reason
/// Refuses unknown keys, unknown codes, a component named twice or both measured and declared zero.
[[nodiscard]] Result<MapRecipe> parse_map_recipe(std::string_view text, const std::string& file_name,
                                                 const std::filesystem::path& folder);
[[nodiscard]] Result<MapRecipe> read_map_recipe(const std::filesystem::path& path);
/// The same recipe as a file; files as they are named.
[[nodiscard]] std::string recipe_text(const MapRecipe& recipe);

/// Parked positions closer than this are the same measurement line.
inline constexpr double kSameLine_mm = 0.5;

/// Read against a square: its slope is the squareness.
[[nodiscard]] bool is_square(const MeasurementSet& set);
/// The squareness that an indicator of `sense` shows on a square while `axis` moves; nothing for a rotation and for the
/// axis's own direction.
[[nodiscard]] std::optional<Component> squareness_shown(Axis axis, Sense sense);

/// The recipe that the files themselves suggest for a unit with these parameters: each file by its axis and sense; a
/// rotation without a file of its own from two linear runs on parallel lines, if there are such; straightness by
/// least squares; no smoothing. Files that serve nothing are named in `unused`, with the reason.
struct SuggestedRecipe {
  MapRecipe recipe;
  std::vector<std::string> unused;
};
[[nodiscard]] Result<SuggestedRecipe> suggest_recipe(const std::vector<std::filesystem::path>& files,
                                                     const UnitParameters& parameters,
                                                     const FileReader& read = read_plain);

}  // namespace ecs::laser
