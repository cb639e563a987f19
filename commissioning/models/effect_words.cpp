#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "commissioning/models/view.hpp"
#include "commissioning/models/what_if.hpp"
#include "model/diagnosis/words.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kEnoughSigmas = 3.0;     ///< of a value that differs from zero
constexpr double kProvingEValue = 100.0;  ///< as the verdict asks

std::string judged(const std::string& text, bool holds) {
  return fmt::format("{}: {}", text, holds ? "fulfilled" : "not fulfilled");
}

std::vector<std::string> places_of(const std::vector<model::EffectInstance>& effects) {
  std::vector<std::string> places;
  for (const model::EffectInstance& effect : effects) places.push_back(place_text(effect));
  return places;
}

std::string parameter_evidence(const model::ParameterEstimate& one) {
  if (!one.sigma || *one.sigma <= 0.0 || one.held) return {};
  return judged(value_text(one), std::abs(one.value) > kEnoughSigmas * *one.sigma);
}

/// The alternatives of an effect that are errors of the measurement, at its own place.
std::vector<std::pair<std::string, model::EffectInstance>> alternatives_of_measurement(
    const model::EffectInstance& effect) {
  std::vector<std::pair<std::string, model::EffectInstance>> found;
  for (const std::string_view part : split(effect.tied_with, ',')) {
    const std::string name(trimmed(part));
    model::EffectInstance other = effect;
    other.id = model::effect_named(name.substr(0, name.find(':')));
    if (other.id != nullptr && other.traits().of_measurement) found.emplace_back(name, std::move(other));
  }
  return found;
}

}  // namespace

std::string title_of(const model::EffectInstance& effect) {
  const model::EffectDefinition& definition = effect.definition();
  std::string title(definition.title);
  if (const std::size_t at = title.find("the ball"); at != std::string::npos && effect.ball > 1)
    return title.replace(at, std::string_view("the ball").size(), fmt::format("ball {}", effect.ball));
  const bool along = !effect.sense || !effect.axis ||
                     (direction_of(*effect.sense) == *effect.axis && is_rotation(*effect.sense) == effect.rotary);
  if (along || definition.parameters.size() != 1 || !effect.traits().is_usual || effect.traits().of_approach)
    return title;
  std::string meaning(definition.parameters.front().meaning);
  meaning.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(meaning.front())));
  if (is_rotation(*effect.sense)) return meaning.substr(0, meaning.find(" ("));
  constexpr std::string_view kAcross = "across the axis: ";
  if (const auto at = meaning.find(kAcross); at != std::string::npos) meaning.erase(at, kAcross.size());
  return meaning;
}

std::string_view carrier_text(model::Carrier carrier) {
  switch (carrier) {
    case model::Carrier::error_map:
      return "error map";
    case model::Carrier::parameters:
      return "parameters";
    case model::Carrier::inputs:
      return "thermal rows";
    case model::Carrier::set_up:
      return "remove the cause";
    case model::Carrier::none:
      break;
  }
  return "no";
}

std::vector<EffectFact> facts_of(const model::EffectDefinition& effect) {
  return {{"formula", std::string(effect.formula)},
          {"cause", std::string(effect.cause)},
          {"distinguished by", std::string(effect.tells_apart)},
          {"check", std::string(effect.check)},
          {"compensated", fmt::format("{} ({})", carrier_text(effect.carrier), effect.how)}};
}

std::vector<EffectFact> details_of(const model::Candidate& candidate) {
  const model::EffectDefinition& definition = candidate.effect.definition();
  std::vector<EffectFact> facts{
      {"effect", fmt::format("{} ({})", title_of(candidate.effect), place_text(candidate.effect))}};
  for (EffectFact& fact : facts_of(definition)) facts.push_back(std::move(fact));
  facts.push_back({"values", parameters_text(candidate.parameters)});
  const auto rivals = places_of(candidate.rivals);
  facts.push_back({"could also be", rivals.empty() ? "no other effect of the library, within the noise"
                                                   : fmt::format("{}", fmt::join(rivals, ", "))});
  if (!candidate.but.empty()) facts.push_back({"not proved", candidate.but});
  if (!candidate.decide.empty()) facts.push_back({"to decide", candidate.decide});
  if (!candidate.next_measurement.empty()) facts.push_back({"next measurement", candidate.next_measurement});
  return facts;
}

std::vector<EffectFact> evidence_of(const model::Candidate& candidate, const model::Diagnosis& diagnosis) {
  std::vector<EffectFact> facts;
  facts.push_back({"present model", "lack-of-fit test: " + lack_of_fit_cell(diagnosis.lack_of_fit).text});
  if (candidate.in_answer() && diagnosis.lack_of_fit_after)
    facts.push_back(
        {"with the named effects", "lack-of-fit test: " + lack_of_fit_cell(diagnosis.lack_of_fit_after).text});
  facts.push_back(
      {"residual", fmt::format("{:.3f} -> {:.3f} {} rms, {:.1f} % explained; noise {:.3f} {}", diagnosis.rms_um,
                               candidate.rms_after_um, diagnosis.noise.unit, 100.0 * candidate.shown_explained(),
                               diagnosis.noise.noise_um, diagnosis.noise.unit)});
  if (candidate.held_out_rms_um && candidate.held_out_rms_before_um)
    facts.push_back(
        {"held out", judged(fmt::format("{:.3f} -> {:.3f} {} on held-out readings", *candidate.held_out_rms_before_um,
                                        *candidate.held_out_rms_um, diagnosis.noise.unit),
                            *candidate.held_out_rms_um < *candidate.held_out_rms_before_um)});
  if (model::explains_alone(candidate, diagnosis)) {
    facts.push_back({"by chance", judged(fmt::format("{} of {} fit as well", chance_text(candidate, diagnosis),
                                                     model::name_of_replicates(diagnosis)),
                                         candidate.false_naming <= 0.01)});
    facts.push_back({"nominal test", judged(fmt::format("p = {:.1g}", candidate.p_value), candidate.p_value < 0.01)});
  } else {
    facts.push_back({"by chance", "it explains no more than noise would: not fulfilled"});
  }
  if (candidate.e_value)
    facts.push_back({"e-value", judged(fmt::format("{:.3g}; {:g} is required", *candidate.e_value, kProvingEValue),
                                       *candidate.e_value >= kProvingEValue)});
  for (const model::ParameterEstimate& one : candidate.parameters)
    if (std::string text = parameter_evidence(one); !text.empty()) facts.push_back({shown_name(one), std::move(text)});
  return facts;
}

std::string name_with_alternatives(const model::EffectInstance& effect) {
  if (effect.tied_with.empty()) return place_text(effect);
  return fmt::format("{} (or {})", place_text(effect), effect.tied_with);
}

std::string name_with_alternatives(const model::Model& model, const std::string& name) {
  const auto found = std::find_if(model.effects.begin(), model.effects.end(),
                                  [&](const model::EffectInstance& effect) { return to_text(effect) == name; });
  return found == model.effects.end() || found->tied_with.empty() ? name : name_with_alternatives(*found);
}

std::string measurement_alternatives(const model::EffectInstance& effect) {
  std::vector<std::string> names;
  for (const auto& [name, other] : alternatives_of_measurement(effect)) names.push_back(name);
  return fmt::format("{}", fmt::join(names, " or "));
}

std::string cost_if_of_measurement(const model::EffectInstance& effect, const std::string& amount) {
  std::vector<model::EffectInstance> others;
  for (const auto& [name, other] : alternatives_of_measurement(effect)) others.push_back(other);
  return fmt::format(
      "{} may be {}, an error of the measurement. If it is, compensation adds {} to the machine. Decide this first: {}",
      place_text(effect), measurement_alternatives(effect), amount, model::separating_measurement(effect, others));
}

std::string other_periods_text(const model::EffectInstance& effect) {
  std::vector<std::string_view> periods;
  for (const std::string_view part : split(effect.tied_with, ','))
    if (const auto at = part.find('@'); at != std::string_view::npos) periods.push_back(trimmed(part.substr(at + 1)));
  if (periods.empty()) return "";
  const std::string_view unit = laser::target_unit(effect.rotary);
  return fmt::format(
      "{}: a period of {} {} fits the readings as well as {:.4g} {}. With a wrong period, compensation adds error "
      "between the targets. Decide this first: measure the line at targets displaced from equal steps by a tenth of "
      "the step or more (ISO 230-2:2014, 5.2), and fit the model to these readings too",
      place_text(effect), fmt::join(periods, " or "), unit,
      given_or_fitted(effect, effect.definition().searched_parameter()).value_or(0.0), unit);
}

void keep_alternatives(model::EffectInstance& effect, const std::vector<model::EffectInstance>& alternatives) {
  std::vector<std::string> names = places_of(alternatives);
  if (!names.empty() && !effect.tied_with.empty()) names.push_back(effect.tied_with);  // other periods
  effect.tied_with = fmt::format("{}", fmt::join(names, ", "));
}

namespace {

/// What tells an effect from others of the same name: the value that was sought for it, "@0.25", else its place.
std::string value_text(const model::EffectInstance& effect, std::size_t place) {
  const std::string searched(effect.definition().searched_parameter());
  for (const auto* values : {&effect.parameters, &effect.fitted})
    if (const auto found = values->find(searched); found != values->end()) return fmt::format("@{:.4g}", found->second);
  return fmt::format("@{}", place + 1);
}

}  // namespace

Result<std::size_t> effect_in(const model::Model& model, const std::string& name) {
  std::vector<std::string> names;
  for (const model::EffectInstance& effect : model.effects) names.push_back(place_text(effect));
  const std::vector<std::string> alone = names;
  for (const std::string& one : alone)
    if (std::count(alone.begin(), alone.end(), one) > 1)
      for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == one) names[i] += value_text(model.effects[i], i);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const auto has_name = [&](const model::EffectInstance& effect) { return to_text(effect) == name; };
  if (std::ranges::count_if(model.effects, has_name) == 1)  // without its sensor or approach
    return static_cast<std::size_t>(std::ranges::find_if(model.effects, has_name) - model.effects.begin());
  for (std::size_t i = 0; i < names.size(); ++i)
    for (const std::string& alternative : model::alternatives_in(model.effects[i].tied_with))
      if (alternative == name)
        return problem(ProblemKind::usage,
                       "{0} is an alternative to {1}: to keep it in place of {1}, use `ecs model remove`, then "
                       "`ecs model add`",
                       name, names[i]);
  return problem(ProblemKind::usage, "expected an effect of the model: {}; found \"{}\"", fmt::join(names, ", "), name);
}

Result<WithoutEffect> without_effect(const model::Model& model, const model::Observations& data, std::size_t effect,
                                     const model::Fit& before, const std::string& data_name) {
  if (model.effects.size() == 1) return problem(ProblemKind::refused, "a model must keep at least one effect");
  WithoutEffect without{model, {}, place_text(model.effects[effect]), before.rms_um};
  without.model.effects.erase(without.model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  ECS_TRY(fit, model::fit(without.model, data));
  without.fit = std::move(fit);
  without.model.history.push_back(
      rung_of("without " + to_text(model.effects[effect]), data_name, before.residual, without.fit, data));
  return without;
}

}  // namespace ecs::commissioning
