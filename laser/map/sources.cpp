#include "laser/map/sources.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "laser/groups.hpp"
#include "laser/measured_machine.hpp"

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
  ECS_TRY(bytes, read_file(path));
  ECS_TRY(imported, read_(path));
  Loaded loaded{std::move(imported.set), sha256_hex(bytes)};
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

}  // namespace ecs::laser
