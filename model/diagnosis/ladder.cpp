// Rival models of equal size by the difference of their χ²: the likelihood ratio of models that are not nested (Cox
// 1961; Vuong 1989).
#include "model/diagnosis/ladder.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/core.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/search.hpp"
#include "model/regression/candidates.hpp"
#include "model/regression/needs.hpp"

namespace ecs::model {

bool is_requested(const EffectInstance& effect, const AddRequest& request) {
  if (effect.id != request.id || effect.ball != request.ball || effect.line != request.line ||
      effect.from_run != request.from_run)
    return false;
  if (request.axis && (effect.axis != request.axis || effect.rotary != request.rotary)) return false;
  if (request.sense && effect.sense != request.sense) return false;
  if (request.code && effect.code != request.code) return false;
  if (request.approach && effect.approach != *request.approach) return false;
  if (!request.sensor.empty() && effect.sensor != request.sensor) return false;
  return request.sensor2.empty() || effect.sensor2 == request.sensor2;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Instances the request allows: those that the data show, else the one that it spells out.
std::vector<EffectInstance> places_for(const Model& model, const Observations& data, const AddRequest& request) {
  if (request.as_named) return {*request.as_named};
  std::vector<EffectInstance> list;
  for (const EffectInstance& effect : candidate_instances(data))
    if (is_requested(effect, request)) list.push_back(effect);
  for (const EffectInstance& effect : model.candidates)
    if (effect.id == request.id && (request.name.empty() || effect.name == request.name)) list.push_back(effect);
  if (!list.empty() || request.id->place == Place::formulas) return list;
  if ((request.axis && (request.sense || request.code)) || (request.id->place == Place::set_up && request.sense) ||
      request.id->place == Place::artefact) {
    EffectInstance effect;
    effect.id = request.id;
    effect.axis = request.axis;
    effect.rotary = request.rotary;
    effect.sense = request.sense;
    effect.code = request.code;
    effect.approach = request.approach.value_or(ApproachMode::both);
    effect.sensor = request.sensor;
    effect.sensor2 = request.sensor2;
    effect.ball = request.ball;
    effect.line = request.line;
    effect.from_run = request.from_run;
    list.push_back(effect);
  }
  return list;
}

struct State {
  Assembly assembly;
  CoreFit core;
};

Result<State> state_of(const Model& model, const Regressors& regressors) {
  ECS_TRY(assembly, Assembly::of(with_best_starts(model, regressors), regressors));
  State state{std::move(assembly), {}};
  state.core = fitted(state.assembly, regressors, {});
  return state;
}

/// "cyclic:X:EX@17.14, reverse" for each other period that fits the readings as well, with commas between them.
std::string other_periods(const EffectInstance& wave, const Observations& data) {
  std::vector<std::string> names;
  const std::string name = to_text(wave);
  for (const double period : aliases_of(wave, data))
    names.push_back(fmt::format("{}@{:.6g}{}", name, period, place_text(wave).substr(name.size())));
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The best of the places by score, as an instance with its nonlinear value.
std::optional<EffectInstance> best_place(const State& state, const Regressors& regressors,
                                         const std::vector<EffectInstance>& places) {
  const Observations& data = regressors.data();
  const Whitener whitener(data, state.core.noise, state.core.left_out);
  const VectorXd y = Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()));
  std::vector<EffectInstance> library, user;
  for (const EffectInstance& place : places) (place.is_user() ? user : library).push_back(place);
  if (library.empty()) return user.empty() ? std::nullopt : std::optional(user.front());
  const Search search(regressors, whitener, state.assembly.columns(), y - state.assembly.fixed(data.size()), library);
  const auto found = search.expand(search.base(), library.size());
  if (found.empty()) return library.front();
  return effect_of(search.families()[found.front().family].effect, found.front());
}

/// Why no reading shows the effect, where the data lack what it reads; "" if they do not.
std::string lacking_text(const Observations& data, const EffectInstance& effect) {
  if (!effect.sensor.empty() && !data.sensors_degC.contains(effect.sensor)) {
    std::vector<std::string> sensors;
    for (const auto& each : data.sensors_degC) sensors.push_back(each.first);
    return fmt::format("these data have no sensor {}; they have {}", effect.sensor,
                       sensors.empty() ? "none" : fmt::format("{}", fmt::join(sensors, ", ")));
  }
  const std::string_view lacking = what_is_lacking(data, effect.definition());
  return lacking.empty() ? "" : fmt::format("it needs {}, which these data do not have", lacking);
}

/// Whether the fit of one of two effects of the model marks that these readings do not separate them.
bool are_exchangeable(const EffectInstance& a, const EffectInstance& b) {
  const auto names = [](const EffectInstance& one, const EffectInstance& other) {
    return one.undetermined && std::ranges::find(*one.undetermined, to_text(other)) != one.undetermined->end();
  };
  return names(a, b) || names(b, a);
}

/// Effects of the model that do on these readings what this one does, and the measurement that separates them; "" where
/// there are none.
/// @param effect  as fitted beside them
std::string inseparable_text(const Model& model, const EffectInstance& effect) {
  std::vector<EffectInstance> others;
  std::vector<std::string> names;
  for (const EffectInstance& one : model.effects)
    if (are_exchangeable(one, effect)) {
      others.push_back(one);
      names.push_back(to_text(one));
    }
  if (others.empty()) return "";
  const auto is_offset = [](const EffectInstance& one) { return one.id == effect_named("offset"); };
  const bool constants = is_offset(effect) && std::ranges::all_of(others, is_offset);
  return fmt::format("these data cannot distinguish it from {} of the model. {}", fmt::join(names, ", "),
                     constants ? "One of them is enough." : separating_measurement(effect, others));
}

}  // namespace

AddRequest request_of(const EffectInstance& effect) {
  AddRequest request{effect.id,     effect.axis,    effect.rotary, effect.sense, effect.code, effect.approach,
                     effect.sensor, effect.sensor2, effect.name,   effect.ball,  effect.line, effect.from_run};
  request.as_named = effect;
  return request;
}

std::vector<std::string> alternatives_in(const std::string& tied_with) {
  std::vector<std::string> names;
  for (const std::string_view part : split(tied_with, ',')) {
    const std::string name(trimmed(part));
    if (approach_mode_named(name.substr(0, name.find(' '))) && !names.empty())
      names.back() += ", " + name;
    else
      names.push_back(name);
  }
  return names;
}

namespace {

/// Takes what follows `mark` off the end of a name.
std::string cut_off(std::string& name, std::string_view mark) {
  const std::size_t at = name.find(mark);
  if (at == std::string::npos) return {};
  std::string rest = name.substr(at + mark.size());
  name.erase(at);
  return rest;
}

/// Of a name without approach and sensors.
Result<AddRequest> request_at(std::string_view text) {
  constexpr std::string_view kFromRun = "run";
  const auto parts = split(text, ':');
  AddRequest request;
  const EffectId id = effect_named(parts.front());
  if (!id) {
    std::vector<std::string> names;
    for (const EffectDefinition& definition : effect_library()) names.emplace_back(definition.id);
    const std::string like = nearest_word(parts.front(), names);
    return problem(ProblemKind::usage, fmt::format("no effect \"{}\"; {}", parts.front(),
                                                   like.empty() ? std::string("`ecs model effects` lists all effects")
                                                                : fmt::format("did you mean \"{}\"?", like)));
  }
  request.id = id;
  if (id->place == Place::formulas) {
    if (parts.size() > 1) request.name = std::string(text.substr(text.find(':') + 1));
    return request;
  }
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::string_view part = parts[i];
    if (part.empty()) continue;
    const auto sense = sense_named(part);
    const auto code = component_of(part);
    if (const auto axis = laser::axis_named(part)) {
      request.axis = axis->axis;
      request.rotary = axis->rotary;
      if (axis->rotary && !id->traits.on_rotary_axes)
        return problem(ProblemKind::usage,
                       fmt::format("{} applies to linear axes only: {} is a rotary axis", id->id, part));
    } else if (const auto coded = code_named(id, part); coded && coded->axis) {
      request.axis = coded->axis;
      request.rotary = true;
      request.sense = coded->sense;
    } else if (sense && id->place != Place::location && (id->place != Place::set_up || is_rotation(*sense))) {
      request.sense = sense;
    } else if (const auto number = number_in(part);
               (id->place == Place::artefact || id->traits.of_lines) && number && *number >= 1.0) {
      (id->traits.of_lines ? request.line : request.ball) = static_cast<int>(*number);
    } else if (const auto run = number_in(part.substr(std::min<std::size_t>(part.size(), kFromRun.size())));
               id->traits.of_lines && part.starts_with(kFromRun) && run && *run >= 1.0) {
      request.from_run = static_cast<int>(*run);
    } else if (code) {
      request.code = code;
    } else {
      return problem(ProblemKind::usage,
                     fmt::format("{}: \"{}\" is not an axis, sense or code that {} can have; expected "
                                 "EFFECT[:axis[:sense or code]], such as cyclic:X:EX",
                                 text, part, id->id));
    }
  }
  if (id->place == Place::set_up || id->place == Place::artefact) request.axis = std::nullopt;  // it has none
  if (id->place == Place::artefact) request.rotary = true;
  return request;
}

}  // namespace

Result<AddRequest> parse_add_request(std::string_view text) {
  if (text.starts_with("user:")) return request_at(text);
  std::string name(text);
  std::string sensor = cut_off(name, " with ");
  const std::string approach = cut_off(name, ", ");
  ECS_TRY(request, request_at(name));
  request.sensor2 = cut_off(sensor, " and ");
  request.sensor = sensor;
  request.approach = approach_mode_named(approach);
  if (approach.empty() || request.approach) return request;
  return problem(ProblemKind::usage,
                 fmt::format("{}: expected both, forward or reverse behind the comma, got \"{}\"", text, approach));
}

Result<Added> add_effect(const Model& model, const Observations& data, const AddRequest& request,
                         const std::string& data_name) {
  if (data.size() == 0) return problem(ProblemKind::bad_input, "no readings to fit");
  const Regressors regressors(data);
  ECS_TRY(before, state_of(model, regressors));
  const auto places = places_for(model, data, request);
  const std::string_view lacking = what_is_lacking(data.motions(), *request.id);
  if (places.empty() && !lacking.empty())
    return problem(ProblemKind::usage,
                   fmt::format("{}: it needs {}, which these data do not have", name_of(request.id), lacking));
  if (places.empty())
    return problem(
        ProblemKind::usage,
        fmt::format("{}: these data cannot show it there (`ecs model diagnose` lists their axes, senses and columns)",
                    name_of(request.id)));
  auto effect = request.as_named ? request.as_named : best_place(before, regressors, places);
  if (!effect) return problem(ProblemKind::usage, fmt::format("{}: no place to add it", name_of(request.id)));
  Added added;
  added.model = model;
  added.model.effects.push_back(*effect);
  ECS_TRY(after, state_of(added.model, regressors));
  const Fit fit = reported(after.assembly, regressors, after.core);
  added.model = with_values(added.model, fit);
  added.model.effects.back().tied_with = other_periods(added.model.effects.back(), data);
  take_compensation(added.model, data);
  if (fit.effects.back().readings == 0 || fit.effects.back().rms_um == 0.0) {
    const bool is_there =
        std::ranges::any_of(model.effects, [&](const EffectInstance& one) { return same_candidate(one, *effect); });
    const std::string why = note_of_no_reading(*effect, data, regressors.acting(*effect)),
                      unread = lacking_text(data, *effect), same = inseparable_text(model, fit.effects.back().effect);
    return problem(
        ProblemKind::usage,
        !is_there && unread.empty() && !why.empty()
            ? why
            : fmt::format("{}: {}", to_text(*effect),
                          is_there          ? "it is in the model already"
                          : !unread.empty() ? unread
                          : !same.empty()   ? same
                                            : "no reading of these data depends on it (`ecs laser show` lists their "
                                              "axes, senses and columns)"));
  }
  added.effect = fit.effects.back();
  added.effect.effect.tied_with = added.model.effects.back().tied_with;
  added.rms_before_um = rms_of(before.core.residual);
  added.rms_after_um = fit.rms_um;
  added.noise_um = fit.noise.noise_um;
  added.noise_is_upper_limit = fit.noise.is_upper_limit();
  const MatrixXd columns = after.assembly.columns();
  const VectorXd target = Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size())) -
                          after.assembly.fixed(data.size());
  const VectorXd& residual = before.core.residual;
  added.step = rung_of(to_text(*effect), data_name, {residual.begin(), residual.end()}, fit, data);
  added.step.held_out_rms_um =
      held_out_rms(data, after.core.noise, after.core.left_out, parts_of(data), columns, target);
  added.model.history.push_back(added.step);
  return added;
}

Result<Model> undo(const Model& model) {
  if (model.history.empty() || model.effects.empty())
    return problem(ProblemKind::refused, "nothing to undo: no effect has been added to this model");
  const std::string last = model.history.back().effect;
  Model before = model;
  for (std::size_t i = before.effects.size(); i-- > 0;) {
    if (to_text(before.effects[i]) != last) continue;
    before.undone.push_back(before.effects[i]);
    before.effects.erase(before.effects.begin() + static_cast<std::ptrdiff_t>(i));
    before.history.pop_back();
    return before;
  }
  return problem(ProblemKind::refused,
                 fmt::format("nothing to undo: the last step added {}, which the model no longer has", last));
}

Result<WhatIf> what_if(const Model& model, const Observations& data) {
  ECS_TRY(fitted_model, fit(model, data));
  WhatIf what;
  std::vector<double> left(data.reading), of_measurement(data.size(), 0.0);
  for (const EffectFit& effect : fitted_model.effects) {
    const bool carried = is_carried(effect.effect, data.machine);
    const bool measured = is_of_measurement(effect.effect);
    double peak_um = 0.0;
    for (const double contribution : effect.contribution) peak_um = std::max(peak_um, std::abs(contribution));
    what.shares.push_back({to_text(effect.effect), effect.rms_um, peak_um, carried, measured,
                           how_compensated(effect.effect, data.machine)});
    for (std::size_t k = 0; k < left.size(); ++k) {
      if (carried) left[k] -= effect.contribution[k];
      if (measured) of_measurement[k] += effect.contribution[k];
    }
  }
  double now = 0.0, after = 0.0, machine = 0.0, measurement = 0.0;
  for (std::size_t k = 0; k < left.size(); ++k) {
    now += data.reading[k] * data.reading[k];
    after += left[k] * left[k];
    machine += (left[k] - of_measurement[k]) * (left[k] - of_measurement[k]);
    measurement += of_measurement[k] * of_measurement[k];
    what.peak_after_um = std::max(what.peak_after_um, std::abs(left[k]));
  }
  const double n = std::max(1.0, static_cast<double>(left.size()));
  what.rms_now_um = std::sqrt(now / n);
  what.rms_after_um = std::sqrt(after / n);
  what.machine_um = std::sqrt(machine / n);
  what.measurement_um = std::sqrt(measurement / n);
  return what;
}

namespace {

/// Difference of χ² that decides: five standard deviations, as for what a fit takes for determined.
constexpr double kDecides = 25.0;

/// Of a name as place_text() writes it; nothing for one that is no effect of the library.
/// @param effect  that it is an alternative of: with "@17.14" behind its name, with that period
std::optional<AddRequest> request_for(const std::string& name, const EffectInstance& effect) {
  if (const std::size_t at = name.find('@'); at != std::string::npos) {
    const std::string searched(effect.definition().searched_parameter());
    const std::string value = name.substr(at + 1);
    const auto period = number_in(std::string_view(value).substr(0, value.find(',')));
    if (!period || searched.empty()) return std::nullopt;
    EffectInstance other = effect;
    other.parameters[searched] = *period;
    other.fitted.clear();
    return request_of(other);
  }
  auto request = parse_add_request(name);
  if (!request) return std::nullopt;
  if (!request->approach) request->approach = ApproachMode::both;
  return *request;
}

/// The model with the effect of that name in place of `held`; nothing where the readings cannot show it.
std::optional<Added> with_named(const Model& without, const EffectInstance& held, const std::string& name,
                                const Observations& data) {
  const auto request = request_for(name, held);
  if (!request) return std::nullopt;
  auto added = add_effect(without, data, *request, "");
  if (!added || added->effect.readings == 0) return std::nullopt;
  return std::move(*added);
}

struct Tie {
  std::vector<std::string> out, open, better;
  Undecided undecided;
};

Tie judged(const Model& model, std::size_t effect, const Observations& data, double noise_um) {
  Tie tie;
  Model& without = tie.undecided.without = model;
  without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  const EffectInstance& held = model.effects[effect];
  // Σ r² over the noise's variance
  const auto chi2 = [&](const Added& with) {
    return static_cast<double>(data.size()) * std::pow(with.rms_after_um / noise_um, 2);
  };
  const auto keep = [&](const Added& with) {
    EffectInstance one = with.model.effects.back();
    if (const auto period = one.parameters.extract(std::string(one.definition().searched_parameter())))
      one.fitted[period.key()] = period.mapped();  // of another wave
    tie.undecided.possible.push_back(std::move(one));
  };
  const auto own = with_named(without, held, place_text(held), data);
  if (own) keep(*own);
  for (const std::string& name : alternatives_in(held.tied_with)) {
    const auto other = own ? with_named(without, held, name, data) : std::nullopt;
    const double worse = other ? chi2(*other) - chi2(*own) : 0.0;
    (worse > kDecides ? tie.out : worse < -kDecides ? tie.better : tie.open).push_back(name);
    if (other && worse <= kDecides) keep(*other);
  }
  return tie;
}

}  // namespace

Result<DecidedTies> decided_ties(const Model& model, const Observations& data) {
  DecidedTies decided{model, {}};
  if (std::ranges::all_of(model.effects, [](const auto& effect) { return effect.tied_with.empty(); })) return decided;
  ECS_TRY(now, fit(model, data));
  if (!(now.noise.noise_um > 0.0)) return decided;
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
    EffectInstance& effect = decided.model.effects[i];
    if (effect.tied_with.empty()) continue;
    const Tie tie = judged(model, i, data, now.noise.noise_um);
    const std::string name = place_text(effect);
    if (!tie.better.empty()) {
      decided.notes.push_back(fmt::format("these readings favour {} over {}: remove {}, then add it",
                                          fmt::join(tie.better, " or "), name, name));
    } else if (!tie.out.empty()) {
      effect.tied_with = fmt::format("{}", fmt::join(tie.open, ", "));
      decided.notes.push_back(
          fmt::format("these readings rule out {}: {}", fmt::join(tie.out, ", "),
                      tie.open.empty() ? "it is " + name
                                       : fmt::format("{} (or {}) is still open", name, fmt::join(tie.open, ", "))));
    }
  }
  return decided;
}

namespace {

/// The effect with all others of the model that these readings separate neither from it nor from one of those.
std::vector<std::size_t> exchangeable_with(const std::vector<EffectFit>& effects, std::size_t first) {
  std::vector<std::size_t> group{first};
  for (std::size_t g = 0; g < group.size(); ++g)
    for (std::size_t i = 0; i < effects.size(); ++i)
      if (std::ranges::find(group, i) == group.end() && are_exchangeable(effects[group[g]].effect, effects[i].effect))
        group.push_back(i);
  std::ranges::sort(group);
  return group;
}

/// Those of a group that explain the readings as well as the whole model does, each in place of the group.
Undecided each_alone(const Model& model, const std::vector<std::size_t>& group, const Observations& data,
                     const Fit& now) {
  Undecided undecided{model, {}};
  for (auto i = group.rbegin(); i != group.rend(); ++i)
    undecided.without.effects.erase(undecided.without.effects.begin() + static_cast<std::ptrdiff_t>(*i));
  for (const std::size_t i : group) {
    const auto alone = add_effect(undecided.without, data, request_of(model.effects[i]), "");
    if (!alone) continue;
    const double worse = std::pow(alone->rms_after_um, 2) - std::pow(now.rms_um, 2);
    if (static_cast<double>(data.size()) * worse > kDecides * std::pow(now.noise.noise_um, 2)) continue;
    undecided.possible.push_back(alone->model.effects.back());
    undecided.possible.back().undetermined.reset();
  }
  return undecided;
}

/// Of a group of which each one alone does what all do, one question; else one for each pair of them.
void ask_exchangeable(const Model& model, const std::vector<std::size_t>& group, const Observations& data,
                      const Fit& now, std::vector<Undecided>& list) {
  if (Undecided all = each_alone(model, group, data, now); all.possible.size() == group.size())
    return list.push_back(std::move(all));
  for (std::size_t i = 0; i < group.size(); ++i)
    for (std::size_t j = i + 1; j < group.size(); ++j)
      if (are_exchangeable(now.effects[group[i]].effect, now.effects[group[j]].effect))
        if (Undecided two = each_alone(model, {group[i], group[j]}, data, now); two.possible.size() > 1)
          list.push_back(std::move(two));
}

}  // namespace

std::vector<Undecided> undecided_effects(const Model& model, const Observations& data) {
  std::vector<Undecided> list;
  if (!data.through_chain.empty()) return list;
  const auto now = fit(model, data);
  if (!now || !(now->noise.noise_um > 0.0)) return list;
  std::vector<bool> asked(model.effects.size(), false);
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
    if (!model.effects[i].tied_with.empty())
      if (Tie tie = judged(model, i, data, now->noise.noise_um); tie.undecided.possible.size() > 1)
        list.push_back(std::move(tie.undecided));
    const std::vector<std::size_t> group = exchangeable_with(now->effects, i);
    if (asked[i] || group.size() < 2) continue;
    for (const std::size_t one : group) asked[one] = true;
    ask_exchangeable(model, group, data, *now, list);
  }
  return list;
}

std::string undecided_text(const Model& model, const Observations& data) {
  std::string text;
  for (const Undecided& one : undecided_effects(model, data)) {
    std::vector<std::string> names;
    for (const EffectInstance& effect : one.possible) {
      names.push_back(place_text(effect));
      if (const auto value = searched_value(effect); value && effect.traits().periodic)
        names.back() += fmt::format(" at {:.4g}", *value);
    }
    text += fmt::format(" These readings do not distinguish causes listed in the model: {}.", fmt::join(names, " or "));
  }
  return text;
}

}  // namespace ecs::model
