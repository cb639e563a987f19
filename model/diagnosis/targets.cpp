#include "model/diagnosis/targets.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/moved_targets.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {
namespace {

constexpr int kTargetDigits = 5;

/// An axis whose targets, all runs and lines of some senses together, lie at equal steps: a period below two steps has
/// aliases (Nyquist).
struct EvenTargets {
  Axis axis = Axis::X;
  double step_mm = 0.0;  ///< of a rotary axis [deg]
  std::vector<Sense> senses;
};

std::vector<EvenTargets> even_targets(const Observations& data) {
  std::map<std::pair<Axis, Sense>, std::vector<double>> targets_mm;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!data.on_path(k))
      targets_mm[{data.axis[k], data.sense[k]}].push_back(data.position_mm[k][index_of(data.axis[k])]);
  std::map<std::pair<Axis, double>, std::vector<Sense>> senses;  // by axis and step
  for (const auto& [line, targets] : targets_mm)
    if (const auto step_mm = even_step_mm(targets))
      senses[{line.first, std::round(*step_mm * 1e6) / 1e6}].push_back(line.second);
  std::vector<EvenTargets> all;
  for (const auto& [line, of] : senses) all.push_back({line.first, line.second, of});
  return all;
}

/// ", which hides the screw pitch of 10 mm": pitches of the axis that the targets do not show; nothing where the
/// machine file gives none, or they turn.
std::optional<std::string> hidden_pitches(const Observations& data, const EvenTargets& targets) {
  const auto& facts = data.machine.axes[index_of(targets.axis)];
  if (data.rotary || !facts || (!facts->screw_pitch_mm && !facts->scale_pitch_mm)) return std::nullopt;
  std::string text;
  const auto add = [&](const std::optional<double>& pitch_mm, const char* name) {
    if (pitch_mm && *pitch_mm < 2.0 * targets.step_mm)
      text += fmt::format("{} the {} of {:g} mm", text.empty() ? ", which hides" : " and", name, *pitch_mm);
  };
  add(facts->screw_pitch_mm, "screw pitch");
  add(facts->scale_pitch_mm, "scale pitch");
  return text;
}

/// Behind the periods that even targets do not show; nothing where the known pitches of the axis are not among them.
std::optional<std::string> undetected(const Observations& data, const EvenTargets& targets) {
  if (data.rotary) {
    const auto steps = steps_a_turn(targets.step_mm);
    return steps ? fmt::format(
                       ", where a wave with N periods per turn looks like one with {0} - N periods, and a wave "
                       "with {0} periods does not show",
                       *steps)
                 : "";
  }
  const auto hidden = hidden_pitches(data, targets);
  if (!hidden)
    return fmt::format(
        ", and {} the pitch of the {} screw or scale",
        data.machine.axes[index_of(targets.axis)] ? "the machine file does not state" : "no machine file states",
        data.letter(targets.axis));
  return hidden->empty() ? std::nullopt : hidden;
}

/// The pitch of the screw, if all targets of the axis are whole pitches apart, within a fiftieth.
std::optional<double> pitch_between(const Observations& data, Axis axis, const std::set<double>& targets_mm) {
  constexpr double kInStep = 0.02;
  const auto& facts = data.machine.axes[index_of(axis)];
  if (data.rotary || !facts || !facts->screw_pitch_mm || targets_mm.size() < kFewestWaveTargets) return std::nullopt;
  for (const double target_mm : targets_mm) {
    const double turns = (target_mm - *targets_mm.begin()) / *facts->screw_pitch_mm;
    if (std::abs(turns - std::round(turns)) > kInStep) return std::nullopt;
  }
  return facts->screw_pitch_mm;
}

}  // namespace

std::map<Axis, std::set<double>> targets_of(const Observations& data) {
  std::map<Axis, std::set<double>> targets_mm;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!data.on_path(k)) targets_mm[data.axis[k]].insert(data.position_mm[k][index_of(data.axis[k])]);
  return targets_mm;
}

bool is_at_one_target(const Observations& data) {
  return std::ranges::any_of(targets_of(data), [](const auto& of) { return of.second.size() == 1; });
}

std::string reservation_for(const Observations& data, bool names_a_wave) {
  std::string text;
  for (const auto& [axis, targets] : targets_of(data))
    if (targets.size() == 1)
      text +=
          fmt::format("{}All readings along {} are at one target: errors that depend on position cannot be detected.",
                      text.empty() ? "" : " ", data.letter(axis));
  const std::vector<EvenTargets> even = even_targets(data);
  for (const auto& [axis, targets] : targets_of(data))
    if (const auto pitch_mm = pitch_between(data, axis, targets);
        pitch_mm && std::ranges::find(even, axis, &EvenTargets::axis) == even.end())
      text += fmt::format(
          "{}All targets along {} are whole screw pitches ({:g} mm) apart: an error with this period cannot be "
          "detected.",
          text.empty() ? "" : " ", data.letter(axis), *pitch_mm);
  for (const EvenTargets& one : even)
    if (const auto behind = undetected(data, one))
      text += fmt::format("{}Periods shorter than {} {} {} {} {}: the targets are equally spaced at {} {}{}.",
                          text.empty() ? "" : " ", in_digits(2.0 * one.step_mm, kTargetDigits), data.position_unit(),
                          data.rotary ? "about" : "along", data.letter(one.axis),
                          names_a_wave && !data.rotary ? "look like longer ones or do not show" : "cannot be detected",
                          in_digits(one.step_mm, kTargetDigits), data.position_unit(), *behind);
  return text;
}

std::optional<std::string> even_targets_note(const Observations& data) {
  std::string note;
  for (const EvenTargets& one : even_targets(data)) {
    std::vector<std::string_view> senses;
    for (const Sense sense : one.senses) senses.push_back(name_of(sense));
    note += fmt::format(
        "{}targets are equally spaced at {} {} {} {} ({}): periods shorter than {} {} cannot be distinguished "
        "from longer ones{}",
        note.empty() ? "" : "; ", in_digits(one.step_mm, kTargetDigits), data.position_unit(),
        data.rotary ? "about" : "along", data.letter(one.axis), fmt::join(senses, ", "),
        in_digits(2.0 * one.step_mm, kTargetDigits), data.position_unit(), hidden_pitches(data, one).value_or(""));
  }
  if (note.empty()) return std::nullopt;
  return note +
         ". To detect such periods, displace the targets by a tenth of the spacing or more (ISO 230-2:2014, 5.2)";
}

}  // namespace ecs::model
