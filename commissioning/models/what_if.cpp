#include "commissioning/models/what_if.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {
namespace {

using model::Observations;

/// Readings less every effect that the unit can compensate.
std::vector<double> left_over(const model::Fit& fit, const Observations& data) {
  std::vector<double> left = data.reading;
  for (const model::EffectFit& effect : fit.effects) {
    if (!is_carried(effect.effect, data.machine)) continue;
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= effect.contribution[k];
  }
  return left;
}

struct Sums {
  double now = 0.0, predicted = 0.0, achieved = 0.0;
  std::size_t before = 0, after = 0;
  std::string axes{};
};

/// Path, sense, axis and direction: lines first.
using Direction = std::tuple<std::string, Sense, Axis, int>;

Sums& sums_of(std::map<Direction, Sums>& groups, const Observations& data, std::size_t k) {
  Sums& sums = groups[{data.path_name(k), data.sense[k], data.axis[k], -data.approach[k]}];
  if (data.on_path(k)) sums.axes = axes_of(data.path_of(k));
  return sums;
}

double root_mean(double sum, std::size_t count) {
  return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

std::vector<AfterDirection> after_by_direction(const model::Fit& fit, const Observations& before,
                                               const Observations& after) {
  std::map<Direction, Sums> groups;
  const std::vector<double> left = left_over(fit, before);
  for (std::size_t k = 0; k < before.size(); ++k) {
    Sums& sums = sums_of(groups, before, k);
    sums.now += before.reading[k] * before.reading[k];
    sums.predicted += left[k] * left[k];
    ++sums.before;
  }
  for (std::size_t k = 0; k < after.size(); ++k) {
    Sums& sums = sums_of(groups, after, k);
    sums.achieved += after.reading[k] * after.reading[k];
    ++sums.after;
  }
  std::vector<AfterDirection> list;
  for (const auto& [key, sums] : groups) {
    AfterDirection one{std::get<1>(key),
                       std::get<2>(key),
                       -std::get<3>(key),
                       root_mean(sums.now, sums.before),
                       root_mean(sums.predicted, sums.before),
                       {},
                       sums.before,
                       sums.after,
                       std::get<0>(key),
                       sums.axes};
    if (sums.after > 0) one.achieved_um = root_mean(sums.achieved, sums.after);
    list.push_back(one);
  }
  return list;
}

namespace {

/// Sizes beyond this many standard deviations are no scatter; smaller shares of the squares are not worth a sentence.
constexpr double kFarFromZero = 4.0, kWorthTelling = 0.05;

/// One column taken out of what is left: its size, and what the squares fall by.
struct TakenOut {
  double size = 0.0;
  double squares = 0.0;
};
TakenOut take_out(const std::vector<double>& column, std::vector<double>& left) {
  double own = 0.0, with = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    own += column[i] * column[i];
    with += column[i] * left[i];
  }
  if (own <= 0.0) return {};
  for (std::size_t i = 0; i < left.size(); ++i) left[i] -= with / own * column[i];
  return {with / own, with * with / own};
}

std::vector<double> about_mean(std::vector<double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  for (double& value : values) value -= sum / static_cast<double>(values.size());
  return values;
}

/// Constant, slope and difference of the directions of readings of one sense along one axis, one after the other.
/// @param predicted  the same of what the compensation was predicted to leave
void add_parts(const Observations& after, const std::vector<std::size_t>& rows, const std::vector<RestPart>& predicted,
               std::vector<RestPart>& parts) {
  constexpr double kFitted = 3.0, kAsPredicted = 0.5;
  const Sense sense = after.sense[rows.front()];
  const Axis axis = after.axis[rows.front()];
  std::vector<double> left, place, side;
  for (const std::size_t k : rows) {
    left.push_back(after.reading[k]);
    place.push_back(after.p_mm(k, axis) / (after.rotary ? 1.0 : 1000.0));
    side.push_back(static_cast<double>(after.approach[k]) / 2.0);
  }
  const TakenOut constant = take_out(std::vector<double>(rows.size(), 1.0), left);
  const TakenOut slope = take_out(about_mean(std::move(place)), left);
  const TakenOut reversal = take_out(about_mean(std::move(side)), left);
  double squares = 0.0;
  for (const double value : left) squares += value * value;
  const double variance = squares / std::max(1.0, static_cast<double>(rows.size()) - kFitted);
  const std::string_view unit = laser::unit_of(sense);
  const std::string of = model::readings_word(sense, axis, after.rotary);
  const auto add = [&](const char* shape, const TakenOut& taken, const std::string& part, std::string_view cause) {
    if (taken.squares <= kFarFromZero * kFarFromZero * variance) return;
    const double rms_um = root_mean(taken.squares, after.size());
    const std::string share =
        rows.size() < after.size() ? fmt::format(" ({} of the {} readings)", rows.size(), after.size()) : std::string();
    const bool is_predicted = std::ranges::any_of(predicted, [&](const RestPart& one) {
      return one.shape == shape && one.sense == sense && one.axis == axis &&
             std::abs(one.size - taken.size) < kAsPredicted * std::abs(taken.size);
    });
    constexpr std::string_view kBefore = "it was there before, and the unit does not compensate it";
    const std::string why = !is_predicted         ? std::string(cause)
                            : &taken == &constant ? std::string(kBefore)
                                                  : fmt::format("{}; {}", cause, kBefore);
    parts.push_back({shape, sense, axis, taken.size, rms_um,
                     fmt::format("{}{} contributes {} {} to this rms: {}.", part, share, model::in_digits(rms_um, 2),
                                 after.reading_unit(), why)});
  };
  add("constant", constant, fmt::format("A constant shift of {} by {:+.2g} {}", of, constant.size, unit),
      "the zero of the laser or the datum has changed");
  add("slope", slope, fmt::format("A slope of {:+.2g} {}/{} of {}", slope.size, unit, after.rotary ? "deg" : "m", of),
      !after.rotary && !is_rotation(sense) && direction_of(sense) != axis
          ? "alignment of the straight edge or optics, or squareness"
          : "scale or temperature");
  add("reversal", reversal,
      fmt::format("A difference of {:+.2g} {} between forward and reverse of {}", reversal.size, unit, of),
      "lost motion");
}

/// Largest first; those that stand out of the scatter of their line and are a twentieth of the squares at least.
std::vector<RestPart> parts_of_rest(const Observations& after, const std::vector<RestPart>& predicted) {
  std::map<std::tuple<Sense, Axis>, std::vector<std::size_t>> lines;
  double squares = 0.0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    squares += after.reading[k] * after.reading[k];
    if (!after.on_path(k)) lines[{after.sense[k], after.axis[k]}].push_back(k);
  }
  std::vector<RestPart> parts;
  for (const auto& [line, rows] : lines) add_parts(after, rows, predicted, parts);
  const double least_um = std::sqrt(kWorthTelling) * root_mean(squares, after.size());
  std::erase_if(parts, [&](const RestPart& part) { return part.rms_um < least_um; });
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.rms_um > b.rms_um; });
  return parts;
}

Result<std::optional<Achieved>> achieved(MessageSink& messages, const ModelWork& work,
                                         const std::vector<std::string>& after, const ImportArguments& import) {
  if (after.empty()) return std::optional<Achieved>();
  ECS_TRY(set, measured_in(messages, after, import));
  const std::size_t all = set.readings.size();
  std::erase_if(set.readings, [](const laser::Reading& r) { return !r.compensated.value_or(true); });
  if (set.readings.empty())
    return problem_at(after.front(), 0, 0,
                      "expected readings taken with compensation active (compensated = 1), found none");
  Achieved out{model::as_measured(model::observations_of(set, work.model, work.machine)), 0.0, 0.0,
               all - set.readings.size()};
  double square = 0.0;
  for (const double reading : out.data.reading) {
    square += reading * reading;
    out.peak_um = std::max(out.peak_um, std::abs(reading));
  }
  out.rms_um = std::sqrt(square / static_cast<double>(out.data.size()));
  return std::optional(std::move(out));
}

Cell effects_cell(const WhatIfAnswer& answer) {
  Cell effects{Json::array(), fmt::format("{} {:>9}  {}\n", padded("effect", 34), rms_heading(answer.unit),
                                          "compensated by, or why not")};
  for (const model::WhatIf::Share& share : answer.what.shares) {
    const AnswerFields fields = described(
        "effect"_is(share.effect, padded(name_with_alternatives(answer.model, share.effect), 34)),
        "rms_um"_is(share.rms_um, 3), "carried"_is(share.carried, "", share.of_measurement ? "" : "NOT COMPENSATED: "),
        "of_measurement"_is(share.of_measurement), "peak_um"_is(share.peak_um, ""), "how"_is(share.how));
    effects.add({object_of(fields),
                 paragraph_after(laid_out("{effect} {rms_um:>9}  ", fields), laid_out("{carried}{how}", fields))});
  }
  if (!answer.what.shares.empty())
    effects.text += paragraph(
        "rms: over the readings on which the effect acts; the sentences at the top are for all readings. The rms "
        "values of "
        "independent causes add as squares; causes that partly cancel give less, possibly less than one of them "
        "alone.");
  return effects;
}

Cell directions_cell(const WhatIfAnswer& answer) {
  const std::string unit = fmt::format("[{}]", answer.unit);
  Cell directions{Json::array(), fmt::format("{:>31} {:>10} {:>10}", "", "rms before", "predicted")};
  directions.text += answer.achieved ? fmt::format(" {:>10} {:>14}\n", "achieved", "achieved /") : "\n";
  directions.text += fmt::format("sense axis direction   readings {0:>10} {0:>10}", unit);
  directions.text += answer.achieved ? fmt::format(" {:>10} {:>14}\n", unit, "predicted") : "\n";
  for (const AfterDirection& one : answer.directions) {
    const bool compared = one.achieved_um && one.predicted_um > 0.0;
    const double ratio = compared ? *one.achieved_um / one.predicted_um : 0.0;
    directions.add(record_cell(
        "{sense:<5} {axis:<4} {approach:<11} {readings:>8} {rms_now_um:>10} "
        "{rms_after_um:>10}{achieved_rms_um}{ratio}\n",
        "sense"_is(one.path.empty() ? std::string(name_of(one.sense)) : one.path),
        "axis"_is(one.path.empty() ? axis_json(one.axis, answer.rotary) : one.axes),
        "approach"_is(one.approach, std::string(direction_text(one.approach))), "rms_now_um"_is(one.now_um, 3),
        "rms_after_um"_is(one.predicted_um, 3),
        "achieved_rms_um"_is(one.achieved_um
                                 ? Cell{number_or_null(one.achieved_um), fmt::format(" {:>10.3f}", *one.achieved_um)}
                                 : null_cell()),
        "ratio"_shown(compared ? fmt::format(" {:>14.2f}", ratio) : ""), "readings"_is(one.readings),
        "readings_after"_is(one.readings_after)));
  }
  return directions;
}

/// "A constant shift of Z positions by -0.5 um (126 of the 426 readings) contributes 0.33 um to this rms: the zero …"
Cell rest_cell(const WhatIfAnswer& answer) {
  Cell list{Json::array(), ""};
  for (const RestPart& part : answer.achieved->rest) {
    list.text += " " + part.text;
    list.json.push_back(object_of("shape"_is(part.shape), "sense"_is(name_of(part.sense)),
                                  "axis"_is(axis_json(part.axis, answer.rotary)), "size"_is(part.size),
                                  "rms_um"_is(part.rms_um)));
  }
  return list;
}

Cell achieved_cell(const WhatIfAnswer& answer) {
  if (!answer.achieved) return null_cell();
  const Achieved& achieved = *answer.achieved;
  Cell cell = record_cell(
      "Measured again: {readings} readings, rms {rms_um} {unit} (peak {peak_um} {unit}): {of_predicted} times the "
      "predicted rms.{rest}",
      "unit"_shown(answer.unit), "rms_um"_is(achieved.rms_um, 3), "peak_um"_is(achieved.peak_um, 3),
      "readings"_is(achieved.data.size()), "rest"_is(rest_cell(answer)),
      "of_predicted"_is(achieved.rms_um / answer.what.rms_after_um,
                        fmt::format("{:.2f}", achieved.rms_um / std::max(1e-12, answer.what.rms_after_um))));
  cell.text = paragraph(cell.text);
  return cell;
}

/// A line that compensation would make worse: what the unit carries cancels there what it does not.
std::vector<std::string> made_worse(const std::vector<AfterDirection>& directions, bool rotary) {
  constexpr double kWorse = 1.05;
  std::vector<std::string> notes;
  for (const AfterDirection& one : directions)
    if (one.predicted_um > kWorse * one.now_um)
      notes.push_back(fmt::format(
          "compensation with this model would increase {}, {}, {} -> {}: there the effects that the unit can "
          "compensate cancel other effects, or errors that the model lacks",
          one.path.empty() ? fmt::format("{} along {}", name_of(one.sense), laser::letter_of(one.axis, rotary))
                           : one.path,
          direction_text(one.approach), model::in_digits(one.now_um), model::in_digits(one.predicted_um)));
  return notes;
}

std::vector<std::string> notes_on(const ModelWork& work, const model::WhatIf& what,
                                  const std::optional<Achieved>& after, const std::vector<AfterDirection>& directions) {
  std::vector<std::string> notes = made_worse(directions, work.data.rotary);
  for (const model::EffectInstance& effect : work.model.effects)
    if (const std::string periods = other_periods_text(effect);
        !periods.empty() && is_carried(effect, work.data.machine))
      notes.push_back(periods);
  if (!work.data.clock_note.empty()) notes.push_back(work.data.clock_note);
  const std::string_view unit = work.data.reading_unit();
  for (std::size_t i = 0; i < what.shares.size(); ++i)  // in the order of the model
    if (what.shares[i].carried && !measurement_alternatives(work.model.effects[i]).empty())
      notes.push_back(cost_if_of_measurement(
          work.model.effects[i], fmt::format("{} {} rms, up to {} {},", model::in_digits(what.shares[i].rms_um), unit,
                                             model::in_digits(what.shares[i].peak_um), unit)));
  const auto compensated = std::count(work.data.compensated.begin(), work.data.compensated.end(), true);
  if (compensated > 0)
    notes.push_back(fmt::format("{} of the {} readings were taken with compensation active: {}", compensated,
                                work.data.size(),
                                work.data.of_map.empty() ? "for them this is the error after a further map"
                                                         : "the map was subtracted from them"));
  if (after && after->left_out > 0)
    notes.push_back(fmt::format("{} readings of --after are marked compensated = 0 and ignored", after->left_out));
  return notes;
}

}  // namespace

Result<WhatIfAnswer> what_if_answer(MessageSink& messages, const ModelWork& work, const std::string& model_file,
                                    const std::vector<std::string>& after, const ImportArguments& import) {
  ECS_TRY(again, achieved(messages, work, after, import));
  ECS_TRY(fit, in_file(model::fit(work.model, work.data), model_file));
  ECS_TRY(what, in_file(model::what_if(work.model, work.data), model_file));
  std::vector<AfterDirection> directions =
      after_by_direction(fit, work.data, again ? (*again).data : model::Observations{});
  if (again && std::ranges::none_of(
                   directions, [](const AfterDirection& one) { return one.readings > 0 && one.readings_after > 0; }))
    return problem_at(after.front(), 0, 0,
                      "no line of this file is among the lines measured before: there is nothing to compare. Give the "
                      "same lines, measured again on the same machine");
  if (again) {
    model::Observations predicted = work.data;
    predicted.reading = left_over(fit, work.data);
    again->rest = parts_of_rest(again->data, parts_of_rest(predicted, {}));
  }
  std::vector<std::string> notes = notes_on(work, what, again, directions);
  return WhatIfAnswer{
      what, std::move(directions), again, std::move(notes), work.model, work.data.rotary, work.data.reading_unit()};
}

std::string what_if_summary(const model::WhatIf& what, const model::Model& model, std::string_view unit) {
  std::string text = fmt::format(
      "Compensation by the unit would {} the rms of the readings from {:.3f} to {:.3f} {} (peak then {:.3f} {}), noise "
      "included.",
      what.rms_after_um > what.rms_now_um ? "increase" : "reduce", what.rms_now_um, what.rms_after_um, unit,
      what.peak_after_um, unit);
  if (std::ranges::none_of(what.shares, &model::WhatIf::Share::carried))
    text = fmt::format("The unit can compensate no effect of this model: the rms of the readings stays at {:.3f} {}.",
                       what.rms_now_um, unit);
  std::vector<std::string> machine, measurement;
  for (const model::WhatIf::Share& share : what.shares)
    if (!share.carried)
      (share.of_measurement ? measurement : machine).push_back(name_with_alternatives(model, share.effect));
  const std::string rest = fmt::format("{}noise and errors of the machine that the model does not explain",
                                       machine.empty() ? "" : fmt::format("{}, ", fmt::join(machine, ", ")));
  if (measurement.empty())
    return text + fmt::format(" The remaining {:.3f} {} rms would consist of {}.", what.machine_um, unit, rest);
  return text + fmt::format(
                    " Of the remaining {:.3f} {} rms, {:.3f} {} come from the measurement, not from the "
                    "machine: {}. Without them {:.3f} {} rms remain: {}.",
                    what.rms_after_um, unit, what.measurement_um, unit, fmt::join(measurement, ", "), what.machine_um,
                    unit, rest);
}

Cell what_if_cell(const WhatIfAnswer& answer) {
  const std::string summary = paragraph(what_if_summary(answer.what, answer.model, answer.unit));
  return record_cell("{summary}{achieved}\n{effects}\n{directions}{notes}", "summary"_shown(summary),
                     "rms_now_um"_is(answer.what.rms_now_um), "rms_after_um"_is(answer.what.rms_after_um),
                     "peak_after_um"_is(answer.what.peak_after_um), "machine_um"_is(answer.what.machine_um),
                     "measurement_um"_is(answer.what.measurement_um), "effects"_is(effects_cell(answer)),
                     "directions"_is(directions_cell(answer)), "achieved"_is(achieved_cell(answer)),
                     "notes"_is(answer.notes, notes_text(answer.notes)));
}

}  // namespace ecs::commissioning
