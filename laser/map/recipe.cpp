#include "laser/map/recipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/clock.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "laser/findings.hpp"
#include "laser/groups.hpp"
#include "laser/measurement_set.hpp"

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
    if (taken) reader_.complain(table, fmt::format("{} occurs twice in the recipe: keep only one", *code));
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
    if (reason.empty()) reader_.complain(table, "reason: state why the component is assumed to be zero");
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

namespace {

/// One measurement line found in a file.
struct MeasuredLine {
  std::filesystem::path file;
  Axis axis;
  Sense sense;
  Vector3 parked_mm;
  bool square = false;  ///< an indicator against a square: for squareness only
  bool used = false;
};

/// The first axis that stood elsewhere than on the measurement line of the parameters.
std::optional<Axis> axis_off_line(const MeasuredLine& line, const UnitParameters& p) {
  for (const Axis a : kAllAxes) {
    if (a == line.axis || !p.axis_present[index_of(a)]) continue;
    const double expected_mm = p.measurement_lines_mm[index_of(line.axis)][index_of(a)];
    if (std::abs(line.parked_mm[index_of(a)] - expected_mm) > kSameLine_mm) return a;
  }
  return std::nullopt;
}

bool on_line(const MeasuredLine& line, const UnitParameters& p) { return !axis_off_line(line, p); }

/// The rotation that the difference of two parallel lines shows: about the normal of sense and offset.
std::optional<Sense> rotation_shown(const MeasuredLine& a, const MeasuredLine& b) {
  std::optional<Axis> offset;
  for (const Axis axis : kAllAxes) {
    if (axis == a.axis || std::abs(a.parked_mm[index_of(axis)] - b.parked_mm[index_of(axis)]) <= kSameLine_mm) continue;
    if (offset) return std::nullopt;
    offset = axis;
  }
  if (!offset || is_rotation(a.sense) || direction_of(a.sense) == *offset) return std::nullopt;
  return static_cast<Sense>(3 + (3 - index_of(*offset) - index_of(direction_of(a.sense))));
}

class Suggestion {
 public:
  Suggestion(std::vector<MeasuredLine> lines, const UnitParameters& parameters)
      : lines_(std::move(lines)), parameters_(parameters), needed_(components_needed(parameters)) {}

  MapRecipe recipe() {
    for (std::size_t i = 0; i < kCurves; ++i) take_direct(static_cast<Component>(i));
    for (std::size_t i = 0; i < kCurves; ++i) take_rotation(static_cast<Component>(i));
    for (std::size_t i = kCurves; i < kComponents; ++i) take_square(static_cast<Component>(i));
    return std::move(recipe_);
  }

  [[nodiscard]] std::vector<std::string> unused() const {
    std::vector<std::string> names;
    for (const MeasuredLine& line : lines_)
      if (!line.used)
        names.push_back(fmt::format("{} ({} along {}): {}", line.file.filename().string(), name_of(line.sense),
                                    letter_of(line.axis), reason_against(line)));
    return names;
  }

 private:
  [[nodiscard]] bool wanted(Component c) const {
    return needed_.contains(c) &&
           std::ranges::none_of(recipe_.components, [&](const ComponentRecipe& made) { return made.component == c; });
  }

  /// Why a line serves nothing.
  [[nodiscard]] std::string reason_against(const MeasuredLine& line) const {
    if (!parameters_.axis_present[index_of(line.axis)]) return fmt::format("there is no axis {}", letter_of(line.axis));
    if (line.square) return "that squareness is not needed, or another file provides it";
    const Component c = curve_of(line.sense, line.axis);
    if (!needed_.contains(c))
      return fmt::format("{} is not needed with compensation.scope and configuration.axes of the parameters",
                         name_of(c));
    if (const auto off = is_angular(c) ? std::nullopt : axis_off_line(line, parameters_))
      return fmt::format(
          "it was measured at {0} {1:.6g} (or the file does not state {0}), the measurement line of {2} in the "
          "parameters "
          "is at {3} {4:.6g}: give the place where it was measured (--parked), or measure a second line parallel to it",
          letter_of(*off), line.parked_mm[index_of(*off)], letter_of(line.axis), letter_of(*off),
          parameters_.measurement_lines_mm[index_of(line.axis)][index_of(*off)]);
    return fmt::format("another file provides {}", name_of(c));
  }

  void add(Component c, std::vector<std::filesystem::path> files) {
    ComponentRecipe made;
    made.component = c;
    made.files = std::move(files);
    recipe_.components.push_back(std::move(made));
  }

  void take_direct(Component c) {
    if (!wanted(c)) return;
    for (MeasuredLine& line : lines_) {
      if (line.square || line.axis != moving_axis(c) || line.sense != sense_of(c)) continue;
      if (!is_angular(c) && !on_line(line, parameters_)) continue;
      line.used = true;
      return add(c, {line.file});
    }
  }

  void take_rotation(Component c) {
    if (!wanted(c) || !is_angular(c)) return;
    for (MeasuredLine& first : lines_)
      for (MeasuredLine& second : lines_) {
        if (first.square || second.square || !on_line(first, parameters_) || first.axis != moving_axis(c)) continue;
        if (second.axis != first.axis || second.sense != first.sense) continue;
        if (rotation_shown(first, second) != sense_of(c)) continue;
        second.used = true;
        return add(c, {first.file, second.file});
      }
  }

  void take_square(Component c) {
    if (!wanted(c)) return;
    for (MeasuredLine& line : lines_) {
      if (!line.square || squareness_shown(line.axis, line.sense) != c) continue;
      line.used = true;
      return add(c, {line.file});
    }
  }

  std::vector<MeasuredLine> lines_;
  const UnitParameters& parameters_;
  ComponentSet needed_;
  MapRecipe recipe_;
};

}  // namespace

bool is_square(const MeasurementSet& set) {
  return metadata_value(set, "instrument").value_or("").find("square") != std::string::npos;
}

std::optional<Component> squareness_shown(Axis axis, Sense sense) {
  if (is_rotation(sense) || direction_of(sense) == axis) return std::nullopt;
  constexpr std::array kByNormal{Component::A0Z, Component::B0Z, Component::C0Y};  // of the axis normal to both
  return kByNormal[3 - index_of(axis) - index_of(direction_of(sense))];
}

Result<SuggestedRecipe> suggest_recipe(const std::vector<std::filesystem::path>& files,
                                       const UnitParameters& parameters, const FileReader& read) {
  std::vector<MeasuredLine> lines;
  std::vector<Problem> problems;
  for (const std::filesystem::path& file : files) {
    const auto imported = read(file);
    if (!imported) {
      problems.push_back(imported.error());
      continue;
    }
    const bool square = is_square(imported->set);
    for (const Group& group : groups_of(imported->set))
      lines.push_back({file, group.axis, group.sense, group.parked_mm, square, false});
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  Suggestion suggestion(std::move(lines), parameters);
  SuggestedRecipe suggested;
  suggested.recipe = suggestion.recipe();
  suggested.unused = suggestion.unused();
  return suggested;
}

}  // namespace ecs::laser
