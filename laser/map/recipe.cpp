#include "laser/map/recipe.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/clock.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "laser/findings.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::string_view, 3> kSlopeNames{"none", "end_points", "least_squares"};

/// Who, when, which machine: in the order of the file.
constexpr std::array<std::pair<std::string_view, std::string MapRecipe::*>, 6> kWords{
    {{"customer", &MapRecipe::customer},
     {"engineer", &MapRecipe::engineer},
     {"date", &MapRecipe::date},
     {"machine", &MapRecipe::machine},
     {"serial_number", &MapRecipe::serial_number},
     {"remark", &MapRecipe::remark}}};

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
    for (const auto& [key, member] : kWords) recipe.*member = reader_.word(table, key).value_or("");
    if (const auto wrong = wrong_date(recipe.date)) reader_.complain(*table.get("date"), "date: " + *wrong);
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

ComponentRecipe settings_of(const MapRecipe& recipe, Component component) {
  const auto found = std::ranges::find(recipe.components, component, &ComponentRecipe::component);
  return found == recipe.components.end() ? ComponentRecipe{component, {}, {}, 0.0, {}, {}} : *found;
}

ComponentRecipe& settings_in(MapRecipe& recipe, Component component) {
  const auto found = std::ranges::find(recipe.components, component, &ComponentRecipe::component);
  return found == recipe.components.end() ? recipe.components.emplace_back(settings_of(recipe, component)) : *found;
}

std::string zero_reason(const MapRecipe& recipe, Component component) {
  const auto found = std::ranges::find(recipe.declared_zero, component, &DeclaredZero::component);
  return found == recipe.declared_zero.end() ? std::string() : found->reason;
}

void declare_zero(MapRecipe& recipe, Component component, const std::string& reason) {
  std::erase_if(recipe.declared_zero, [&](const DeclaredZero& zero) { return zero.component == component; });
  if (!reason.empty()) recipe.declared_zero.push_back({component, reason});
  std::ranges::sort(recipe.declared_zero, {}, [](const DeclaredZero& zero) { return name_of(zero.component); });
}

namespace {

/// A TOML string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

}  // namespace

std::string recipe_text(const MapRecipe& recipe) {
  std::string text = "# How this map was made; `ecs map build` makes it again from the same files.\n";
  for (const auto& [key, member] : kWords)
    if (!(recipe.*member).empty()) text += fmt::format("{} = {}\n", key, quoted(recipe.*member));
  if (recipe.shrink) text += "shrink = true\n";
  for (const ComponentRecipe& one : recipe.components) {
    text += fmt::format("\n[[component]]\ncode = \"{}\"\nfiles = [", name_of(one.component));
    for (std::size_t k = 0; k < one.files.size(); ++k) text += (k == 0 ? "" : ", ") + quoted(one.files[k].string());
    text += "]\n";
    if (one.slope) text += fmt::format("slope = \"{}\"\n", name_of(*one.slope));
    if (one.smoothing_mm > 0.0) text += fmt::format("smoothing_mm = {}\n", shortest(one.smoothing_mm));
    if (one.increment_mm) text += fmt::format("increment_mm = {}\n", shortest(*one.increment_mm));
    if (!one.exclude_runs.empty()) text += fmt::format("exclude_runs = [{}]\n", fmt::join(one.exclude_runs, ", "));
  }
  for (const DeclaredZero& zero : recipe.declared_zero)
    text +=
        fmt::format("\n[[declared_zero]]\ncode = \"{}\"\nreason = {}\n", name_of(zero.component), quoted(zero.reason));
  return text;
}

}  // namespace ecs::laser
