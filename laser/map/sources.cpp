// The files of a map, and the recipe that a set of files suggests by itself.
#include "laser/map/sources.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "laser/groups.hpp"
#include "laser/map/recipe.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {
namespace {

std::string parked_text(const Group& group) {
  std::string text;
  for (const Axis a : kAllAxes)
    if (a != group.axis)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", letter_of(a), group.parked_mm[index_of(a)]);
  return text;
}

std::string contents_of(const MeasurementSet& set) {
  std::string text;
  for (const Group& group : groups_of(set))
    text += fmt::format("{}{} along {} at {}", text.empty() ? "" : "; ", name_of(group.sense), letter_of(group.axis),
                        parked_text(group));
  return text.empty() ? "no readings" : text;
}

std::string text_of(const std::vector<Wanted>& wanted) {
  std::string text;
  for (const Wanted& want : wanted)
    text += fmt::format("{}{} along {}", text.empty() ? "" : " or ", name_of(want.sense), letter_of(want.axis));
  return text;
}

Result<Group> group_in(const MeasurementSet& set, const std::filesystem::path& path, Component component,
                       const std::vector<Wanted>& wanted) {
  std::vector<Group> fitting;
  for (const Group& group : groups_of(set))
    for (const Wanted& want : wanted)
      if (group.axis == want.axis && group.sense == want.sense) fitting.push_back(group);
  if (fitting.empty())
    return tl::unexpected(
        refusal(path, component, fmt::format("expected readings of {}, found {}", text_of(wanted), contents_of(set))));
  for (const Group& group : fitting)
    if (group.compensated.value_or(false))
      return tl::unexpected(
          refusal(path, component,
                  "the readings were taken with compensation active (compensated = 1): a map needs the "
                  "machine's own error; switch the unit to integration mode and measure again"));
  if (fitting.size() > 1)
    return tl::unexpected(refusal(path, component,
                                  fmt::format("expected one measurement line of {}, found {}: split the file",
                                              text_of(wanted), contents_of(set))));
  return fitting.front();
}

double range_of(const MeasurementSet& set, const Group& group) {
  double lowest = set.readings[group.readings.front()].error;
  double highest = lowest;
  for (const std::size_t i : group.readings) {
    lowest = std::min(lowest, set.readings[i].error);
    highest = std::max(highest, set.readings[i].error);
  }
  return highest - lowest;
}

/// The readings of all other runs; refused if the file has no such run.
Result<Selection> without_runs(const MeasurementSet& set, const std::vector<int>& runs) {
  std::vector<Exclusion> exclusions;
  for (const int run : runs) {
    Exclusion exclusion;
    exclusion.run = run;
    exclusions.push_back(exclusion);
  }
  Selection selection = selected(set, exclusions);
  std::set<int> there;
  for (const Reading& reading : set.readings) there.insert(reading.run);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (selection.left_out[i] == 0)
      return problem(ProblemKind::refused, fmt::format("run {} is to be left out, but the file has runs {}", runs[i],
                                                       fmt::join(there, ", ")));
  return selection;
}

void remember(std::map<std::string, std::string>& seen, const std::string& value, const std::filesystem::path& path) {
  if (!value.empty()) seen.emplace(value, path.filename().string());
}

}  // namespace

Problem refusal(const std::filesystem::path& file, Component component, const std::string& why) {
  return Problem{ProblemKind::refused, fmt::format("{}: {}", name_of(component), why), file.string(), 0, 0, {}};
}

Result<const MeasuredFiles::Loaded*> MeasuredFiles::load(const std::filesystem::path& path) {
  if (const auto known = files_.find(path); known != files_.end()) return &known->second;
  ECS_TRY(imported, read_(path));
  Loaded loaded{std::move(imported.set), std::move(imported.sha256)};
  const MeasuredMachine machine = measured_machine(loaded.set.metadata);
  remember(machines_, machine.name, path);
  remember(serial_numbers_, machine.serial_number, path);
  return &files_.emplace(path, std::move(loaded)).first->second;
}

Result<SourceCurve> MeasuredFiles::curve(const std::filesystem::path& path, Component component,
                                         const std::vector<Wanted>& wanted, const std::vector<int>& exclude_runs) {
  ECS_TRY(loaded, load(path));
  const auto selection = without_runs(loaded->set, exclude_runs);
  if (!selection) return tl::unexpected(refusal(path, component, selection.error().message));
  ECS_TRY(group, group_in(selection->chosen, path, component, wanted));
  auto curve = averaged(selection->chosen, group);
  if (!curve) return tl::unexpected(refusal(path, component, curve.error().message));
  if (curve->points.size() < 2)
    return tl::unexpected(refusal(path, component, "expected at least two targets, found one"));
  SourceCurve source;
  source.curve = std::move(*curve);
  source.source = {std::string(name_of(component)), path.filename().string(), loaded->sha256};
  source.band = range_of(selection->chosen, group);
  source.readings = group.readings.size();
  source.repeatability = repeatability_of(selection->chosen, group);
  return source;
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
