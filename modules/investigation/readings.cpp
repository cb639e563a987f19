#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "commissioning/models/view.hpp"
#include "model/data/sensor_noise.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/fit.hpp"
#include "model/planning/run.hpp"
#include "modules/investigation/investigation.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::string_view kZeroName = "zero of run ";
constexpr double kSameParked_mm = 1e-3;

std::string column_of_zero(int number) { return fmt::format("zero_{}", number); }

model::EffectInstance zero_effect(Sense sense, int number, bool offset, bool slope) {
  model::EffectInstance effect;
  effect.id = model::effect_named("user");
  effect.name = fmt::format("{}{}", kZeroName, number);
  const std::string column = column_of_zero(number);
  std::string formula;
  if (offset) formula = fmt::format("c * {}", column);
  if (slope) formula += fmt::format("{}k * {} * p_mm / 1000", offset ? " + " : "", column);
  effect.formulas = {{sense, formula}};
  if (offset) effect.user.push_back({"c", "um", std::nullopt, 0.0, std::nullopt, std::nullopt});
  if (slope) effect.user.push_back({"k", "um_per_m", std::nullopt, 0.0, std::nullopt, std::nullopt});
  return effect;
}

/// What every measured curve has of this kind: the model takes the zero or the slope of the first run itself.
bool has_usual(const model::Model& model, const laser::Reading& reading, bool offset) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    if (effect.is_user() || !effect.traits().is_usual || effect.traits().of_approach || effect.sense != reading.sense)
      return false;
    return effect.traits().shows_at_zero == offset && (offset || effect.axis == reading.axis);
  });
}

/// Where a long axis grows by 10 um for a degree and is read to 0.1 um, the scatter of a sensor that without_noise()
/// takes for good (0.02 degC) is the larger one; hence ten times the temperatures.
void smooth_course(laser::MeasurementSet& set, const std::string& sensor) {
  constexpr double kFiner = 10.0;
  std::vector<laser::Reading*> read;
  std::vector<double> time_s, degC;
  for (laser::Reading& reading : set.readings) {
    const auto shown = reading.sensors_degC.find(sensor);
    if (shown == reading.sensors_degC.end() || !reading.time_s) continue;
    read.push_back(&reading);
    time_s.push_back(*reading.time_s);
    degC.push_back(kFiner * shown->second);
  }
  const auto course = model::without_noise(std::vector<int>(read.size(), 0), time_s, degC);
  for (std::size_t k = 0; course && k < read.size(); ++k) read[k]->sensors_degC[sensor] = course->degC[k] / kFiner;
}

laser::MeasurementSet with_smooth_inputs(laser::MeasurementSet set, const params::Machine& machine) {
  for (const std::string& sensor : machine.inputs)
    if (!sensor.empty()) smooth_course(set, sensor);
  return set;
}

bool same_line(const laser::Reading& a, const laser::Reading& b) {
  if (a.axis != b.axis || a.sense != b.sense) return false;
  for (const Axis other : kAllAxes)
    if (other != a.axis && std::abs(a.position_mm[index_of(other)] - b.position_mm[index_of(other)]) > kSameParked_mm)
      return false;
  return true;
}

}  // namespace

bool is_zero_of_run(std::string_view effect_name) {
  if (effect_name.starts_with("user:")) effect_name.remove_prefix(5);
  return effect_name.starts_with(kZeroName);
}

void InvestigationReadings::add(laser::MeasurementSet run, double pause_minutes, bool against_square) {
  if (run.readings.empty()) return;
  const laser::Reading& first = run.readings.front();
  const bool known_sense = std::any_of(all_.readings.begin(), all_.readings.end(),
                                       [&](const laser::Reading& r) { return r.sense == first.sense; });
  const bool straight_edge = !against_square && !is_rotation(first.sense) && direction_of(first.sense) != first.axis;
  const int number = static_cast<int>(zeros_.size()) + 1;
  zeros_.push_back({first.sense, number, known_sense || !has_usual(base_, first, true),
                    straight_edge && (known_sense || !has_usual(base_, first, false))});
  int last_run = 0;
  for (const laser::Reading& reading : all_.readings)
    if (same_line(reading, first)) last_run = std::max(last_run, reading.run);
  const bool timed = std::all_of(run.readings.begin(), run.readings.end(), [](const auto& r) { return r.time_s; });
  const double begins_s = timed ? *run.readings.front().time_s : 0.0;
  const double later_s = timed && !all_.readings.empty() && begins_s <= last_s_
                             ? last_s_ + model::kSecondsAMinute * pause_minutes - begins_s
                             : 0.0;
  for (laser::Reading& old : all_.readings) old.extras[column_of_zero(number)] = 0.0;
  int row = static_cast<int>(all_.readings.size());
  for (laser::Reading& reading : run.readings) {
    reading.row = ++row;
    reading.run += last_run;
    if (reading.time_s) last_s_ = std::max(last_s_, *reading.time_s += later_s);
    for (const Zero& zero : zeros_) reading.extras[column_of_zero(zero.number)] = zero.number == number ? 1.0 : 0.0;
    all_.readings.push_back(std::move(reading));
  }
}

model::Model InvestigationReadings::model_with_zeros() const {
  model::Model model = base_;
  for (const Zero& zero : zeros_)
    if (zero.offset || zero.slope)
      model.effects.push_back(zero_effect(zero.sense, zero.number, zero.offset, zero.slope));
  return model;
}

model::Observations InvestigationReadings::observations(const params::Machine& machine) const {
  return model::observations_of(with_smooth_inputs(all_, machine), base_, machine);
}

model::Observations InvestigationReadings::observations_of_unit(const params::Machine& machine, Sense sense,
                                                                bool clock) const {
  laser::MeasurementSet known = with_smooth_inputs(all_, machine);
  std::erase_if(known.readings, [&](const laser::Reading& reading) { return reading.sense != sense; });
  for (laser::Reading& reading : known.readings) {
    if (!clock) reading.time_s.reset();
    std::erase_if(reading.sensors_degC, [&](const auto& sensor) {
      return std::find(machine.inputs.begin(), machine.inputs.end(), sensor.first) == machine.inputs.end();
    });
  }
  return model::observations_of(known, base_, machine);
}

std::vector<Sense> InvestigationReadings::senses() const {
  std::vector<Sense> senses;
  for (const laser::Reading& reading : all_.readings)
    if (std::find(senses.begin(), senses.end(), reading.sense) == senses.end()) senses.push_back(reading.sense);
  return senses;
}

model::Model without_zeros(model::Model model) {
  std::erase_if(model.effects,
                [](const model::EffectInstance& effect) { return effect.is_user() && is_zero_of_run(effect.name); });
  return model;
}

namespace {

constexpr int kPlaces = 101;
constexpr const char* kSlope = "um_per_m";

bool is_slope(const model::EffectInstance& effect) {
  const model::EffectTraits& traits = effect.traits();
  return !effect.is_user() && traits.is_usual && !traits.of_approach && !traits.shows_at_zero;
}

/// Places along the line from both sides, the other axes where the effects count from.
laser::MeasurementSet places_of(const InvestigatedLine& line, const params::MachineAxis& axis) {
  laser::MeasurementSet set;
  for (const Approach approach : {Approach::forward, Approach::reverse})
    for (int i = 0; i < kPlaces; ++i) {
      laser::Reading reading;
      reading.axis = line.axis;
      reading.sense = line.sense;
      for (const Axis a : kAllAxes)
        reading.position_mm[index_of(a)] = axis.measurement_line_mm[index_of(a)].value_or(0.0);
      reading.position_mm[index_of(line.axis)] = std::lerp(axis.travel_mm[0], axis.travel_mm[1], i / (kPlaces - 1.0));
      reading.approach = approach;
      reading.row = static_cast<int>(set.readings.size()) + 1;
      set.readings.push_back(reading);
    }
  return set;
}

}  // namespace

Result<void> make_level(model::Model& model, const InvestigatedLine& line, const params::Machine& machine) {
  const auto& axis = machine.axes[index_of(line.axis)];
  const auto of_line = [&](const model::EffectInstance& effect) {
    return effect.axis == line.axis && effect.sense == line.sense && is_carried(effect, machine);
  };
  const auto slope = std::find_if(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    return of_line(effect) && is_slope(effect) && !effect.parameters.contains(kSlope) && effect.fitted.contains(kSlope);
  });
  if (!axis || slope == model.effects.end()) return {};
  model::Model curve = model;
  std::erase_if(curve.effects, [&](const model::EffectInstance& effect) { return !of_line(effect); });
  const laser::MeasurementSet set = places_of(line, *axis);
  const model::Observations at = model::observations_of(set, curve, machine);
  ECS_TRY(values, model::predicted(curve, at));
  const double middle_mm = 0.5 * (axis->travel_mm[0] + axis->travel_mm[1]);
  double moment = 0.0, inertia = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double arm_mm = at.position_mm[k][index_of(line.axis)] - middle_mm;
    moment += arm_mm * values[k];
    inertia += arm_mm * arm_mm;
  }
  if (inertia > 0.0) slope->fitted[kSlope] -= moment / inertia * kMmPerM;
  return {};
}

std::vector<SetMember> credible_set_of(const model::Candidate& candidate) {
  std::vector<SetMember> set = candidate.set;
  std::erase_if(set, [](const SetMember& member) { return is_zero_of_run(member.name); });
  if (set.empty()) set.push_back({to_text(candidate.effect), candidate.probability});
  return set;
}

std::vector<SetMember> members_left(const model::Diagnosis& diagnosis) {
  std::vector<SetMember> left;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    for (SetMember& member : credible_set_of(candidate))
      if (std::none_of(left.begin(), left.end(), [&](const SetMember& m) { return m.name == member.name; }))
        left.push_back(std::move(member));
  }
  return left;
}

bool causes_are_single(const model::Diagnosis& diagnosis) {
  bool any = false;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    any = true;
    if (credible_set_of(candidate).size() > 1) return false;
  }
  return any;
}

namespace {

std::string micrometres(const std::optional<double>& um) { return um ? fmt::format("{:.3f} um", *um) : "unknown"; }

Cell programme_cell(const IsoProgramme& programme) {
  const bool one = programme.lines == 1;
  return record_cell(
      "reference programme of the same {what}: {runs} bidirectional runs over {targets} targets, {dwell_s} s dwell and "
      "trigger, {set_up_minutes} min set-up per line, {minutes} min",
      "lines"_is(programme.lines), "runs"_is(IsoProgramme::kRuns, fmt::format("{}", IsoProgramme::kRuns)),
      "targets"_is(programme.targets), "dwell_s"_is(programme.dwell_s, fmt::format("{:g}", programme.dwell_s)),
      "set_up_minutes"_is(programme.set_up_minutes, fmt::format("{:g}", programme.set_up_minutes)),
      "what"_shown(one ? "line" : fmt::format("{} lines", programme.lines)), "minutes"_shown(programme.minutes, 0));
}

Cell cause_cell(const InvestigatedCause& cause) {
  Cell parameters{Json::object(), parameters_text(cause.parameters)};
  for (const model::ParameterEstimate& one : cause.parameters) parameters.json[one.name] = number_or_null(one.value);
  Cell set{Json::array(), {}};
  for (const SetMember& member : cause.set) {
    const std::string& name = member.place.empty() ? member.name : member.place;
    set.json.push_back(object_of("name"_is(name), "probability"_is(member.probability)));
    set.text += fmt::format("{}{} {:.2f}", set.text.empty() ? "; one of " : ", ", name, member.probability);
  }
  if (cause.set.size() < 2) set.text.clear();
  Cell cell = record_cell("{name}, probability {probability}, {rms_um} um rms: {parameters}{set}",
                          "name"_is(cause.name), "parameters"_is(parameters), "probability"_is(cause.probability, 2),
                          "rms_um"_is(cause.rms_um, 2), "set"_is(set));
  cell.text = paragraph(cell.text, 2, 4);
  return cell;
}

Cell micrometres_cell(const std::optional<double>& um) { return {number_or_null(um), micrometres(um)}; }

std::string verdict_text(const Investigation& investigation) {
  if (!investigation.verdict) return "No measurement was made.";
  switch (*investigation.verdict) {
    case model::Verdict::adequate:
      return "No effect is missing from the model: the residual is noise.";
    case model::Verdict::missing_effect:
      return fmt::format("{} missing from the model:",
                         investigation.causes.size() == 1 ? "One cause was" : "Causes were");
    case model::Verdict::partly_explained:
      return "A cause is proved, but it does not explain the whole residual:";
    case model::Verdict::likely_effect:
      return "Probably missing from the model, but not proved:";
    case model::Verdict::cannot_tell:
      return "These data cannot show whether an effect is missing from the model.";
    case model::Verdict::unexplained_structure:
      if (!investigation.causes.empty()) return "Proved, but only the smaller part of the residual:";
      break;
  }
  return "No proved cause explains the residual, which is not noise.";
}

}  // namespace

std::string ledger_numbers_head() {
  return fmt::format("{:>2} {:>5} {:>6} {:>7} {:>6}", "", "min", "total", "rms um", "causes");
}

std::string ledger_numbers(std::size_t number, const InvestigationStep& step, double total_minutes) {
  return fmt::format("{:>2} {:>5.1f} {:>6.1f} {:>7.3f} {:>6}", number, step.minutes, total_minutes, step.rms_um,
                     step.set.size());
}

std::string ledger_head() { return ledger_numbers_head() + "  measured, with the causes that remain"; }

std::string ledger_line(std::size_t number, const InvestigationStep& step, double total_minutes) {
  const std::string head = ledger_numbers(number, step, total_minutes) + "  ";
  const std::string below(columns_of(head), ' ');
  std::string text = paragraph_after(head, step.measured);
  if (step.set.empty()) {
    text += paragraph_after(below, title_of(step.verdict));
  } else {
    std::vector<std::string> members;
    for (const SetMember& member : step.set)
      members.push_back(fmt::format("{} (probability {:.2f})", member.name, member.probability));
    text += paragraph_after(below, fmt::format("remaining: {}", fmt::join(members, ", ")));
  }
  text.pop_back();
  return text;
}

Cell step_cell(const InvestigationStep& step) {
  return record_cell({}, "minutes"_is(step.minutes), "measured"_is(step.measured), "readings"_is(step.readings),
                     "verdict"_is(name_of(step.verdict)),
                     "set"_is(list_cell(step.set,
                                        [](const SetMember& member) {
                                          return record_cell({}, "name"_is(member.name),
                                                             "probability"_is(member.probability, 2));
                                        })),
                     "rms_um"_is(step.rms_um));
}

Cell investigation_cell(const Investigation& investigation) {
  const auto& verdict = investigation.verdict;
  const AnswerFields fields = described(
      "steps"_is(list_cell(investigation.steps, step_cell)),
      "verdict"_is(verdict ? Json(name_of(*verdict)) : Json(nullptr), paragraph(verdict_text(investigation))),
      "causes"_is(list_cell(investigation.causes, cause_cell)), "minutes"_is(investigation.minutes, 0),
      "programme_minutes"_is(investigation.programme.minutes), "programme"_is(programme_cell(investigation.programme)),
      "rms_before_um"_is(micrometres_cell(investigation.rms_before_um)),
      "rms_compensated_um"_is(micrometres_cell(investigation.rms_compensated_um)),
      "compensated_minutes"_is(investigation.compensated_minutes, 0),
      "notes"_is(investigation.notes, notes_text(investigation.notes)));
  std::string text = laid_out("{verdict}{causes}", fields);
  if (verdict)
    text +=
        paragraph(laid_out("measured in {minutes} min; for comparison: {programme}", fields)) +
        paragraph(laid_out(investigation.rms_compensated_um
                               ? "error: {rms_before_um} rms before, {rms_compensated_um} with the new map, measured "
                                 "again in {compensated_minutes} min"
                               : "error: {rms_before_um} rms before, {rms_compensated_um} with the new map",
                           fields));
  return {object_of(fields), text + laid_out("{notes}", fields)};
}

std::string summary_text(const Investigation& investigation) { return investigation_cell(investigation).text; }

}  // namespace ecs::commissioning
