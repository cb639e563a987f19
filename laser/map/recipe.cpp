#include "laser/map/recipe.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file_kind.hpp"
#include "base/toml_reader.hpp"
#include "laser/findings.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::string_view, 3> kSlopeNames{"none", "end_points", "least_squares"};

/// Reads one recipe; every method leaves its complaints in `reader_`.
class RecipeReader {
 public:
  RecipeReader(const std::string& file, std::filesystem::path folder) : reader_(file), folder_(std::move(folder)) {}

  Result<MapRecipe> read(std::string_view text) {
    ECS_TRY(table, reader_.parsed(text));
    MapRecipe recipe;
    reader_.only(
        table,
        {"customer", "engineer", "date", "machine", "serial_number", "remark", "shrink", "component", "declared_zero"},
        "recipe");
    recipe.customer = reader_.word(table, "customer").value_or("");
    recipe.engineer = reader_.word(table, "engineer").value_or("");
    recipe.date = reader_.word(table, "date").value_or("");
    if (const auto wrong = wrong_date(recipe.date)) reader_.complain(*table.get("date"), "date: " + *wrong);
    recipe.machine = reader_.word(table, "machine").value_or("");
    recipe.serial_number = reader_.word(table, "serial_number").value_or("");
    recipe.remark = reader_.word(table, "remark").value_or("");
    if (const toml::node* shrink = table.get("shrink")) {
      if (!shrink->is_boolean()) reader_.complain(*shrink, "shrink: expected true or false");
      recipe.shrink = shrink->value_or(false);
    }
    for (const toml::table* each : reader_.children(table, "component")) take_component(*each, recipe);
    for (const toml::table* each : reader_.children(table, "declared_zero")) take_zero(*each, recipe);
    if (!reader_.clean()) return tl::unexpected(reader_.all());
    return recipe;
  }

 private:
  std::optional<Component> code_of(const toml::table& table, const MapRecipe& recipe) {
    const auto code = reader_.word(table, "code");
    const auto component = component_of(code.value_or(""));
    if (!component) {
      reader_.complain(table, fmt::format("code: expected one of {}, found {}", fmt::join(kComponentNames, " "),
                                          in_quotes(code.value_or(""))));
      return std::nullopt;
    }
    const bool taken =
        std::ranges::any_of(recipe.components, [&](const ComponentRecipe& c) { return c.component == *component; }) ||
        std::ranges::any_of(recipe.declared_zero, [&](const DeclaredZero& z) { return z.component == *component; });
    if (taken) reader_.complain(table, fmt::format("{} occurs twice in the recipe: keep one", *code));
    return component;
  }

  void take_component(const toml::table& table, MapRecipe& recipe) {
    reader_.only(table, {"code", "files", "slope", "smoothing_mm", "exclude_runs", "increment_mm"}, "component");
    const auto component = code_of(table, recipe);
    if (!component) return;
    ComponentRecipe made;
    made.component = *component;
    made.files = files_of(table);
    made.slope = slope_of(table);
    made.smoothing_mm = positive_or_zero(table, "smoothing_mm").value_or(0.0);
    made.increment_mm = positive_or_zero(table, "increment_mm");
    if (made.increment_mm == 0.0)
      reader_.complain(*table.get("increment_mm"), "increment_mm: expected a number above 0");
    made.exclude_runs = runs_of(table);
    const std::size_t most = is_angular(*component) ? 2 : 1;
    if (made.files.empty() || made.files.size() > most)
      reader_.complain(table, fmt::format("files: expected {} for {}, found {}",
                                          most == 2 ? "one file, or two linear runs" : "one file", name_of(*component),
                                          made.files.size()));
    recipe.components.push_back(std::move(made));
  }

  void take_zero(const toml::table& table, MapRecipe& recipe) {
    reader_.only(table, {"code", "reason"}, "declared_zero");
    const auto component = code_of(table, recipe);
    const std::string reason = reader_.word(table, "reason").value_or("");
    if (reason.empty()) reader_.complain(table, "reason: say why the component may be taken as zero");
    if (component) recipe.declared_zero.push_back({*component, reason});
  }

  std::vector<std::filesystem::path> files_of(const toml::table& table) {
    std::vector<std::filesystem::path> files;
    const toml::node* node = table.get("files");
    const toml::array* names = node == nullptr ? nullptr : node->as_array();
    if (names == nullptr) {
      reader_.complain(table, "files: expected a list of file names");
      return files;
    }
    for (const toml::node& name : *names) {
      if (const auto* text = name.as_string())
        files.push_back(folder_ / text->get());
      else
        reader_.complain(name, "files: expected a file name in quotes");
    }
    return files;
  }

  std::optional<SlopeMethod> slope_of(const toml::table& table) {
    const auto word = reader_.word(table, "slope");
    if (!word) return std::nullopt;
    if (const auto method = slope_method_named(*word)) return method;
    reader_.complain(*table.get("slope"),
                     fmt::format("slope: expected none, end_points or least_squares, found {}", in_quotes(*word)));
    return std::nullopt;
  }

  std::optional<double> positive_or_zero(const toml::table& table, std::string_view key) {
    const auto value = reader_.number(table, key);
    if (value && *value < 0.0) reader_.complain(*table.get(key), fmt::format("{}: expected 0 or more", key));
    return value;
  }

  std::vector<int> runs_of(const toml::table& table) {
    std::vector<int> runs;
    const toml::node* node = table.get("exclude_runs");
    if (node == nullptr) return runs;
    const toml::array* list = node->as_array();
    if (list == nullptr) {
      reader_.complain(*node, "exclude_runs: expected a list of run numbers");
      return runs;
    }
    for (const toml::node& each : *list) {
      const auto run = each.is_integer() ? each.value<int>() : std::nullopt;
      if (run)
        runs.push_back(*run);
      else
        reader_.complain(each, "exclude_runs: expected a run number");
    }
    return runs;
  }

  TomlReader reader_;
  std::filesystem::path folder_;
};

}  // namespace

std::string_view name_of(SlopeMethod method) { return kSlopeNames[static_cast<std::size_t>(method)]; }

std::optional<SlopeMethod> slope_method_named(std::string_view word) {
  const auto known = std::ranges::find(kSlopeNames, word);
  if (known == kSlopeNames.end()) return std::nullopt;
  return static_cast<SlopeMethod>(known - kSlopeNames.begin());
}

SlopeMethod default_slope(Component component) {
  return is_squareness(component) || is_straightness(component) ? SlopeMethod::least_squares : SlopeMethod::none;
}

Result<MapRecipe> parse_map_recipe(std::string_view text, const std::string& file_name,
                                   const std::filesystem::path& folder) {
  return RecipeReader(file_name, folder).read(text);
}

Result<MapRecipe> read_map_recipe(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::recipe, path));
  return parse_map_recipe(text, path.string(), path.parent_path());
}

}  // namespace ecs::laser
