#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "model/planning/run.hpp"
#include "modules/investigation/investigation.hpp"

namespace ecs::commissioning {
namespace {

using model::MeasurementProposal;

constexpr double kProgrammeStep_mm = 50.0;
constexpr double kFewestProgrammeTargets = 25.0;
/// Targets of the first look, as a share of those of the programme, and its runs: half on moved places still show a
/// period that is no pitch; the second run tells what repeats from noise.
constexpr double kShareOfTargets = 0.52;
constexpr int kLookRuns = 2;
/// Runs of a look at the cold and at the warm machine, and how many of them begin warmer than the one before; between
/// two of them a body with a time constant of half an hour comes by a tenth to a quarter nearer to its end.
constexpr int kWarmRuns = 5, kWarmerRuns = 2;
constexpr double kLeastBetween_min = 2.0, kMostBetween_min = 8.0;
/// The targets are moved by at most this share of the step, twice what ISO 230-2 asks for.
constexpr double kMoved = 0.2;
constexpr double kGoldenRatio = 0.6180339887498949;  ///< multiples of it fill 0 … 1 evenly (Weyl 1916)
constexpr double kMostOverrun = 0.02;                ///< of the travel, at either end

const params::MachineAxis& facts_of(const params::Machine& machine, Axis axis) { return *machine.axes[index_of(axis)]; }

std::size_t programme_targets(const params::Machine& machine, Axis axis) {
  const auto [low_mm, high_mm] = facts_of(machine, axis).travel_mm;
  return static_cast<std::size_t>(
      std::max(kFewestProgrammeTargets, std::floor((high_mm - low_mm) / kProgrammeStep_mm) + 1.0));
}

/// @param moved  share of the step
std::vector<double> targets_between(double low_mm, double high_mm, std::size_t count, double moved) {
  std::vector<double> targets;
  const double step_mm = (high_mm - low_mm) / (static_cast<double>(count) - 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i) * kGoldenRatio;
    const double shift = moved * (2.0 * (place - std::floor(place)) - 1.0);
    targets.push_back(
        std::clamp(model::to_micrometre(low_mm + step_mm * (static_cast<double>(i) + shift)), low_mm, high_mm));
  }
  return targets;
}

MeasurementProposal run_on(const InvestigatedLine& line, const params::Machine& machine, std::size_t targets, int runs,
                           const model::MeasuringTimes& times) {
  MeasurementProposal run;
  run.axis = line.axis;
  run.sense = line.sense;
  run.against_square = line.against_square;
  if (!is_rotation(line.sense) && direction_of(line.sense) != line.axis) run.reversed = false;
  run.runs = runs;
  const params::MachineAxis& axis = facts_of(machine, line.axis);
  const auto [low_mm, high_mm] = axis.travel_mm;
  run.overrun_mm = std::min(run.overrun_mm, kMostOverrun * (high_mm - low_mm));
  run.targets_mm = targets_between(low_mm + run.overrun_mm, high_mm - run.overrun_mm, targets, kMoved);
  for (const Axis a : kAllAxes)
    if (a != line.axis) run.parked_mm[index_of(a)] = axis.measurement_line_mm[index_of(a)].value_or(0.0);
  run.set_up_minutes = times.line_minutes;
  run.minutes = minutes_of(run, times);
  return run;
}

void add(std::vector<InvestigatedLine>& lines, const params::Machine& machine, const InvestigatedLine& line) {
  const auto known = std::find_if(lines.begin(), lines.end(), [&](const InvestigatedLine& other) {
    return other.axis == line.axis && other.sense == line.sense;
  });
  if (known != lines.end())
    known->against_square = known->against_square || line.against_square;
  else if (machine.axes[index_of(line.axis)])
    lines.push_back(line);
}

std::string sentence_of(const MeasurementProposal& look, const std::string& parked) {
  return fmt::format(
      "Measure {} along {}{}, {}{}: {} targets from {:g} to {:g} mm, both ways, {} {}{}, feed {:g} mm/min, {}{}; "
      "about {:.0f} min.",
      name_of(look.sense), letter_of(look.axis), look.against_square ? " against a square" : "", look.condition,
      look.load_kg ? fmt::format(" of {:g} kg", *look.load_kg) : "", look.targets_mm.size(), look.targets_mm.front(),
      look.targets_mm.back(), look.runs, look.runs == 1 ? "run" : "runs",
      look.warming ? fmt::format(", {:.1f} min apart, of which {} of warming and {} of cooling", look.warming->minutes,
                                 look.warming->runs, look.runs - 1 - look.warming->runs)
                   : "",
      look.feed_mm_min, look.dwell_s > 0.0 ? fmt::format("{:g} s dwell", look.dwell_s) : "readings on the fly", parked,
      look.minutes);
}

/// The optics stand on the line already, the machine is as it is.
MeasurementProposal again(MeasurementProposal look, const model::MeasuringTimes& times) {
  if (std::exchange(look.warming, std::nullopt)) look.runs = kLookRuns;
  look.set_up_minutes = times.start_minutes;
  look.minutes = minutes_of(look, times);
  look.sentence = sentence_of(look, "");
  return look;
}

std::string parked_text(const MeasurementProposal& look, const params::Machine& machine) {
  std::string parked;
  for (const Axis a : kAllAxes)
    if (a != look.axis && machine.axes[index_of(a)])
      parked += fmt::format("{} {} {:g}", parked.empty() ? "" : ",", letter_of(a), look.parked_mm[index_of(a)]);
  return parked.empty() ? "" : fmt::format(" (parked at{})", parked);
}

Sense positioning_sense(Axis axis) { return static_cast<Sense>(index_of(axis)); }

/// A squareness shows in readings along its second axis against a square nulled along the first.
InvestigatedLine line_of(Component squareness) {
  return {squareness == Component::C0Y ? Axis::Y : Axis::Z, squareness == Component::A0Z ? Sense::EY : Sense::EX, true};
}

}  // namespace

std::vector<InvestigatedLine> lines_of_model(const model::Model& model, const params::Machine& machine) {
  std::vector<InvestigatedLine> lines;
  for (const model::EffectInstance& effect : model.effects)
    if (effect.code && is_squareness(*effect.code))
      add(lines, machine, line_of(*effect.code));
    else if (effect.axis)
      add(lines, machine, {*effect.axis, effect.sense.value_or(positioning_sense(*effect.axis))});
  if (lines.empty())
    for (const Axis a : kAllAxes) add(lines, machine, {a, positioning_sense(a)});
  return lines;
}

std::vector<InvestigatedLine> other_lines(const std::vector<InvestigatedLine>& lines, const params::Machine& machine) {
  std::vector<InvestigatedLine> all = lines;
  for (const Axis a : kAllAxes) add(all, machine, {a, positioning_sense(a)});
  return {all.begin() + static_cast<std::ptrdiff_t>(lines.size()), all.end()};
}

model::MeasuringTimes workshop_times() {
  constexpr double kNewRun = 1.0, kNewLine = 3.0, kAlign = 3.0, kLoad = 5.0;
  model::MeasuringTimes times;
  times.start_minutes = kNewRun;
  times.line_minutes = kNewLine;
  times.align_minutes = kAlign;
  times.load_minutes = kLoad;
  return times;
}

MeasurementProposal first_look(const InvestigatedLine& line, const params::Machine& machine,
                               const model::MeasuringTimes& times) {
  const double all = static_cast<double>(programme_targets(machine, line.axis));
  MeasurementProposal look =
      run_on(line, machine, static_cast<std::size_t>(std::ceil(kShareOfTargets * all)), kLookRuns, times);
  look.condition = kFirstLook;
  look.sentence = sentence_of(look, parked_text(look, machine));
  return look;
}

bool follows_temperatures(const params::Machine& machine) {
  return std::any_of(machine.inputs.begin(), machine.inputs.end(), [](const auto& sensor) { return !sensor.empty(); });
}

std::optional<MeasurementProposal> look_cold_and_warm(const MeasurementProposal& look, const params::Machine& machine,
                                                      const model::MeasuringTimes& times, double minutes) {
  MeasurementProposal warm = look;
  warm.condition = fmt::format("{}, cold and warm", kFirstLook);
  warm.runs = kWarmRuns;
  warm.warming = model::Warming{.runs = kWarmerRuns};
  const double between = (minutes - minutes_of(warm, times)) / (kWarmRuns - 1);
  if (between < kLeastBetween_min) return std::nullopt;
  warm.warming->minutes = std::min(between, kMostBetween_min);
  warm.minutes = minutes_of(warm, times);
  warm.sentence = sentence_of(warm, parked_text(warm, machine));
  return warm;
}

MeasurementProposal look_later(const MeasurementProposal& look, const params::Machine& machine) {
  MeasurementProposal later = look;
  later.condition = "cold and warm again, hours later";
  later.sentence = sentence_of(later, parked_text(later, machine));
  return later;
}

MeasurementProposal look_between(const MeasurementProposal& look, const model::MeasuringTimes& times) {
  MeasurementProposal between = look;
  between.condition = "targets between those of the first look";
  between.targets_mm.clear();
  for (std::size_t i = 1; i < look.targets_mm.size(); ++i)
    between.targets_mm.push_back(model::to_micrometre(0.5 * (look.targets_mm[i - 1] + look.targets_mm[i])));
  return again(std::move(between), times);
}

MeasurementProposal look_in_motion(const MeasurementProposal& look, const model::MeasuringTimes& times) {
  MeasurementProposal moving = look;
  moving.condition = "on the fly";
  moving.dwell_s = 0.0;
  moving.trigger_s = 0.0;
  moving.runs = 1;
  return again(std::move(moving), times);
}

MeasurementProposal look_with_load(const MeasurementProposal& look, const model::MeasuringTimes& times, bool is_on) {
  MeasurementProposal loaded = look;
  loaded.condition = kWithLoad;
  loaded.load_kg = model::kTypicalLoad_kg;
  loaded.runs = 1;
  loaded = again(std::move(loaded), times);
  if (is_on) return loaded;
  loaded.set_up_minutes += times.load_minutes;
  loaded.minutes += times.load_minutes;
  return loaded;
}

MeasurementProposal look_turned_over(const MeasurementProposal& look, const model::MeasuringTimes& times) {
  MeasurementProposal turned = look;
  turned.condition = model::kTurnedOver;
  turned.reversed = true;
  turned.runs = 1;
  turned = again(std::move(turned), times);
  turned.set_up_minutes += times.align_minutes;
  turned.minutes += times.align_minutes;
  return turned;
}

IsoProgramme iso_programme(const std::vector<InvestigatedLine>& lines, const params::Machine& machine,
                           const model::MeasuringTimes& times) {
  IsoProgramme programme;
  for (const InvestigatedLine& line : lines) {
    const MeasurementProposal run =
        run_on(line, machine, programme_targets(machine, line.axis), IsoProgramme::kRuns, times);
    programme.targets += run.targets_mm.size();
    programme.lines += 1;
    programme.dwell_s = run.dwell_s + run.trigger_s;
    programme.set_up_minutes = run.set_up_minutes;
    programme.minutes += run.minutes;
  }
  return programme;
}

}  // namespace ecs::commissioning
