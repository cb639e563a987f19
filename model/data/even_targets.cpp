#include "model/data/even_targets.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/moved_targets.hpp"

namespace ecs::model {
namespace {

/// ", the screw pitch of 10 mm among them": pitches of the axis that the targets do not show.
std::string hidden_pitches(const Observations& data, Axis axis, double least_mm) {
  const auto& facts = data.machine.axes[index_of(axis)];
  if (!facts) return "";
  std::string text;
  const auto add = [&](const std::optional<double>& pitch_mm, const char* name) {
    if (pitch_mm && *pitch_mm < least_mm) text += fmt::format(", the {} of {:g} mm among them", name, *pitch_mm);
  };
  add(facts->screw_pitch_mm, "screw pitch");
  add(facts->scale_pitch_mm, "scale pitch");
  return text;
}

}  // namespace

std::vector<EvenTargets> even_targets(const Observations& data) {
  std::map<std::pair<Axis, Sense>, std::vector<double>> targets_mm;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!data.on_path(k))
      targets_mm[{data.axis[k], data.sense[k]}].push_back(data.position_mm[k][index_of(data.axis[k])]);
  std::map<std::pair<Axis, double>, std::string> senses;  // by axis and step
  for (const auto& [line, targets] : targets_mm) {
    const auto step_mm = even_step_mm(targets);
    if (!step_mm) continue;
    std::string& names = senses[{line.first, std::round(*step_mm * 1e3) / 1e3}];
    names += (names.empty() ? "" : ", ") + std::string(name_of(line.second));
  }
  std::vector<EvenTargets> all;
  for (const auto& [line, names] : senses) {
    const auto [axis, step_mm] = line;
    const auto& facts = data.machine.axes[index_of(axis)];
    all.push_back({axis, step_mm, names, hidden_pitches(data, axis, 2.0 * step_mm),
                   data.rotary || (facts && (facts->screw_pitch_mm || facts->scale_pitch_mm))});
  }
  return all;
}

std::optional<std::string> even_targets_note(const Observations& data) {
  std::string note;
  for (const EvenTargets& one : even_targets(data))
    note += fmt::format(
        "{}targets are even at {:g} {} along {} ({}): periods below {:g} {} cannot be told from longer ones{}",
        note.empty() ? "" : "; ", one.step_mm, data.position_unit(), data.letter(one.axis), one.senses,
        2.0 * one.step_mm, data.position_unit(), one.hidden_pitches);
  if (note.empty()) return std::nullopt;
  return note + "; targets moved off equal steps by a tenth of the step or more show them (ISO 230-2:2014, 5.3.2)";
}

}  // namespace ecs::model
