// The recipe that a set of files suggests by itself.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "laser/groups.hpp"
#include "laser/map/recipe.hpp"
#include "laser/map/sources.hpp"

namespace ecs::laser {
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

/// Squareness that an indicator run of `sense` along `axis` shows; nothing for the axis's own direction.
std::optional<Component> squareness_shown(Axis axis, Sense sense) {
  if (is_rotation(sense) || direction_of(sense) == axis) return std::nullopt;
  switch (3 - index_of(axis) - index_of(direction_of(sense))) {  // the axis normal to both
    case 0:
      return Component::A0Z;
    case 1:
      return Component::B0Z;
    default:
      return Component::C0Y;
  }
}

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
    return needed_.contains(c) && std::none_of(recipe_.components.begin(), recipe_.components.end(),
                                               [&](const ComponentRecipe& made) { return made.component == c; });
  }

  /// Why a line serves nothing.
  [[nodiscard]] std::string reason_against(const MeasuredLine& line) const {
    if (!parameters_.axis_present[index_of(line.axis)]) return fmt::format("there is no axis {}", letter_of(line.axis));
    if (line.square) return "that squareness is not needed, or another file serves it";
    const Component c = curve_of(line.sense, line.axis);
    if (!needed_.contains(c)) return fmt::format("{} is not needed in this scope", name_of(c));
    if (const auto off = is_angular(c) ? std::nullopt : axis_off_line(line, parameters_))
      return fmt::format(
          "it was measured at {} {:.6g}, the measurement line of {} in the parameters is at {} {:.6g}, and no rotation "
          "can be found from it",
          letter_of(*off), line.parked_mm[index_of(*off)], letter_of(line.axis), letter_of(*off),
          parameters_.measurement_lines_mm[index_of(line.axis)][index_of(*off)]);
    return fmt::format("another file serves {}", name_of(c));
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
    const bool square = metadata_value(imported->set, "instrument").value_or("").find("square") != std::string::npos;
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
