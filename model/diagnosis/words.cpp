// Sentences from numbers; no method of its own.
#include "model/diagnosis/words.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/args.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "model/diagnosis/targets.hpp"
#include "model/diagnosis/trial.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Targets a period that show its shape, and a period to suggest where none was fitted.
constexpr double kTargetsAPeriod = 10.0, kUsualPeriod_mm = 10.0, kUsualPeriod_deg = 360.0;
/// Less of the residual is no evidence in words, whatever a test says: a person sees no difference.
constexpr double kLeastShareSaid = 0.01;
/// Variables that a headline names: the strongest, and others of at least this share of the residual variance.
constexpr std::size_t kMostVariables = 3;
constexpr double kWorthNaming = 0.1;

/// In front of a pitch that the readings exclude.
constexpr std::string_view kNoPitch = "certainly not ";

std::string percent(double share) { return fmt::format("{:.3g} %", kPercent * share); }

/// "one turn", "1/3 turn" for a period of a rotary axis; "the pitch of the X screw", "1/2 of the pitch of the X scale"
/// for one that matches a fact of the machine, "certainly not …" where the readings exclude that; "" if none does.
std::string pitch_text(const EffectInstance& effect, const std::optional<double>& sigma_mm, const Observations& data) {
  if (const double order = waves_a_turn(effect); order > 0.0)
    return order == 1.0 ? "one turn" : fmt::format("1/{:.0f} turn", order);
  const auto match = pitch_matching(effect, sigma_mm, data);
  if (!match) return "";
  std::string text = fmt::format("{}the pitch of the {} {}",
                                 match->times > 1   ? fmt::format("{} times ", match->times)
                                 : match->parts > 1 ? fmt::format("1/{} of ", match->parts)
                                                    : "",
                                 axis_letter(effect), match->is_of_scale ? "scale" : "screw");
  if (!match->is_excluded) return text;
  return fmt::format("{}{}, {:.6g} mm by the machine file: check this", kNoPitch, text, match->expected_mm);
}

std::string axis_word(const EffectInstance& effect) {
  return effect.axis ? std::string(1, axis_letter(effect)) : std::string("the axis");
}

/// Two significant digits, whole numbers in full.
std::string size_text(double value, std::string_view unit) {
  const int decimals =
      value == 0.0 ? 0 : std::clamp(1 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 9);
  return fmt::format("{:.{}f}{}{}", value, decimals, unit.empty() ? "" : " ", unit);
}

/// "90 s", "25 min", "3.5 h"
std::string duration_text(double s) {
  constexpr double kMinute_s = 60.0, kHour_s = 3600.0, kLong = 2.0;
  if (s < kLong * kMinute_s) return fmt::format("{:.0f} s", s);
  return s < kLong * kHour_s ? fmt::format("{:.0f} min", s / kMinute_s) : fmt::format("{:.1f} h", s / kHour_s);
}

/// Of the readings that the effect acts on, inside a sentence.
std::string where_word(const EffectInstance& effect) {
  if (!effect.sense) return effect.axis ? fmt::format("readings along {}", axis_letter(effect)) : "readings";
  std::string text = readings_word(*effect.sense, effect.axis, effect.rotary);
  if (text.starts_with('A')) text.front() = 'a';  // "Angles"
  return text + (effect.line > 1 ? fmt::format(" in line {}", effect.line) : "") +
         (effect.from_run > 0 ? fmt::format(" from run {}", effect.from_run) : "");
}

/// After "an error in": "X positioning", "Y deviations along X".
std::string error_word(const EffectInstance& effect) {
  constexpr std::string_view kPositions = " positions";
  std::string text = where_word(effect);
  if (const std::size_t at = text.find(kPositions); at != std::string::npos)
    text.replace(at, kPositions.size(), " positioning");
  return text;
}

/// "t_spindle_degC" → "spindle"
std::string sensor_word(std::string name) {
  if (name.empty()) return "sensor";
  if (name.starts_with("t_")) name.erase(0, 2);
  if (name.ends_with("_degC")) name.erase(name.size() - 5);
  return name;
}

/// "X and Y" for the angle C0Y, which turns about Z.
std::string pair_word(const EffectInstance& effect) {
  const char about = effect.code ? static_cast<char>('X' + (name_of(*effect.code)[0] - 'A')) : 'Z';
  std::string pair;
  for (const Axis axis : kAllAxes)
    if (letter_of(axis) != about) pair += fmt::format("{}{}", pair.empty() ? "" : " and ", letter_of(axis));
  return pair;
}

std::string map_word(const EffectInstance& effect) {
  if (effect.code) return fmt::format("table {} of the map", name_of(*effect.code));
  return effect.axis ? fmt::format("map of {}", letter_of(*effect.axis)) : "map";
}

/// The data do not say so much as its sign.
bool is_guess(const ParameterEstimate& parameter) {
  return parameter.sigma && *parameter.sigma > std::abs(parameter.value);
}

/// A number that the data do not determine is none to be told.
bool is_known(const ParameterEstimate& parameter) { return !parameter.undetermined && !is_guess(parameter); }

std::string value_of(const EffectInstance& effect, const ParameterEstimate& parameter, const Observations& data) {
  const std::string& unit = parameter.unit;
  if (parameter.name != effect.definition().searched_parameter()) {
    if (!is_known(parameter)) return "an undetermined amount";
    return size_text(parameter.value, unit) + (effect.traits().is_curve ? " rms" : "");
  }
  const std::string pitch = pitch_text(effect, parameter.sigma, data);
  std::string text = fmt::format("{:#.4g} {}", parameter.value, unit);
  if (pitch.empty()) return text;
  return pitch.starts_with(kNoPitch) ? fmt::format("{} ({})", text, pitch) : fmt::format("{}, {}", text, pitch);
}

/// What a size is of, where an effect has several of one kind: "scale of X ", else "".
std::string_view meaning_word(const EffectInstance& effect, const ParameterEstimate& parameter) {
  const auto& parameters = effect.definition().parameters;
  const auto found = std::ranges::find_if(parameters, [&](const auto& one) { return one.name == parameter.name; });
  return effect.definition().place == Place::artefact && found != parameters.end() ? found->meaning : "";
}

/// All that is known and not nothing: "12 um and 4.5 um/m".
std::string sizes_word(const EffectInstance& effect, const std::vector<ParameterEstimate>& parameters,
                       const Observations& data) {
  std::string sizes;
  for (const ParameterEstimate& one : parameters)
    if (one.value != 0.0 && is_known(one) && one.name != effect.definition().searched_parameter()) {
      const std::string_view meaning = meaning_word(effect, one);
      sizes += fmt::format("{}{}{}{}{}", sizes.empty() ? "" : " and ", effect.is_user() ? one.name + " " : "", meaning,
                           meaning.empty() ? "" : " ", value_of(effect, one, data));
    }
  return sizes.empty() ? "an undetermined amount" : sizes;
}

/// "run and x_mm": what the residual depends on most.
std::string variables_text(const Diagnosis& diagnosis) {
  std::vector<std::string> variables;
  for (const Dependence& one : diagnosis.where)
    if (variables.size() < kMostVariables && (variables.empty() || one.strength >= kWorthNaming))
      variables.push_back(one.variable);
  return fmt::format("{}", fmt::join(variables, " and "));
}

auto named_at(const std::string& place, const Diagnosis& diagnosis) {
  return std::ranges::count_if(
      diagnosis.candidates, [&](const Candidate& one) { return one.in_answer() && place_text(one.effect) == place; });
}

/// Its place, and its period where two waves act at one place.
std::string id_text(const Candidate& candidate, const Diagnosis& diagnosis) {
  std::string id = place_text(candidate.effect);
  if (const auto value = searched_value(candidate.effect); value && named_at(id, diagnosis) > 1)
    id += fmt::format(" at {:.4g}", *value);
  return id;
}

/// "41 %", "5.8 %"; of what is outside the credible set "less than 1 %".
std::string probability_text(double probability) {
  constexpr double kOutside = 0.01, kWhole = 0.1;
  if (probability < kOutside) return "less than 1 %";
  return probability < kWhole ? fmt::format("{:.1f} %", kPercent * probability)
                              : fmt::format("{:.0f} %", kPercent * probability);
}

/// "Lost motion" inside a sentence.
std::string with_small_letter(std::string_view title) {
  std::string text(title);
  if (!text.empty() && !text.starts_with("Abbe"))
    text.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
  return text;
}

/// Whether its rivals are the same effect, each by another sensor.
bool differs_in_sensor_only(const Candidate& candidate) {
  const std::vector<EffectInstance> open = candidate.open_rivals();
  return !open.empty() && std::ranges::all_of(open, [&](const EffectInstance& rival) {
    return follows_other_sensor(rival, candidate.effect);
  });
}

/// Of proved effects of which the sensor is open; "" where there are none.
std::string open_sensors_text(const Diagnosis& diagnosis) {
  std::string text;
  for (const Candidate& one : diagnosis.candidates)
    if (one.named && differs_in_sensor_only(one))
      text += fmt::format("{}The {} is proved, but not which sensor it follows.", text.empty() ? "" : " ",
                          with_small_letter(one.effect.definition().title));
  return text;
}

/// " of -12 um/m": of a rival that is the same effect at another place, such as the second scale of a circle; else "".
/// Both have one size and explain the same, so their sizes have one ratio, alone and beside other effects.
std::string like_size_text(const EffectInstance& rival, const Candidate& candidate, const Diagnosis& diagnosis) {
  const auto one = std::ranges::find_if(
      diagnosis.candidates, [&](const Candidate& other) { return place_text(other.effect) == place_text(rival); });
  if (rival.id != candidate.effect.id || one == diagnosis.candidates.end() || one->parameters.size() != 1 ||
      candidate.parameters.size() != 1 || candidate.size_alone == 0.0 || !is_known(candidate.parameters.front()))
    return {};
  const ParameterEstimate& own = candidate.parameters.front();
  return " of " + size_text(own.value * one->size_alone / candidate.size_alone, own.unit);
}

/// Not in the positions of its axis, where a slope is an error of the scale.
bool is_across(const EffectInstance& effect) {
  if (!effect.sense) return false;
  return is_rotation(*effect.sense) || (effect.axis && direction_of(*effect.sense) != *effect.axis);
}

/// The finding with its id in brackets. Beside it, likeliest first, what these data cannot tell from it and what is
/// more probable than it, unless that is named itself.
/// @param part  of the answer that is one cause with it; null: none
std::string with_alternatives(const std::string& finding, const Candidate& candidate, const Candidate* part,
                              const Diagnosis& diagnosis) {
  const std::string id = id_text(candidate, diagnosis) + (part != nullptr ? " and " + id_text(*part, diagnosis) : "");
  std::map<std::string, double> probabilities;
  for (const SetMember& member : candidate.set) probabilities[member.place] += member.probability;
  const std::string own = place_text(candidate.effect);
  const double own_probability = probabilities.try_emplace(own, candidate.probability).first->second;
  std::map<std::string, std::string> others;  // what each is called
  for (const EffectInstance& rival : candidate.open_rivals())
    others[place_text(rival)] =
        std::string(rival.id == effect_named("scale") && is_across(rival) ? "slope" : rival.definition().title) +
        like_size_text(rival, candidate, diagnosis);
  for (const auto& [place, probability] : probabilities)
    if (probability > own_probability + kEqualShare) others.try_emplace(place);
  std::erase_if(others, [&](const auto& other) {
    const std::string& place = other.first;
    const bool is_third_approach = part != nullptr && place.starts_with(to_text(candidate.effect));
    return place == own || is_third_approach || named_at(place, diagnosis) > 0;
  });
  if (others.empty()) return fmt::format("{} ({})", finding, id);
  if (part == nullptr && differs_in_sensor_only(candidate)) {
    std::string sensors;
    for (const EffectInstance& rival : candidate.open_rivals())
      sensors +=
          fmt::format(", or with {}, {}", sensors_text(rival), probability_text(probabilities[place_text(rival)]));
    return fmt::format("{} ({}, {}{})", finding, id, probability_text(own_probability), sensors);
  }
  std::vector<std::pair<double, std::string>> causes{
      {own_probability, fmt::format("{} ({}, {})", finding, id, probability_text(own_probability))}};
  for (const auto& [place, title] : others) {
    const std::string probability = probability_text(probabilities[place]);
    causes.emplace_back(probabilities[place],
                        title.empty() ? fmt::format("{} ({})", place, probability)
                                      : fmt::format("{} ({}, {})", with_small_letter(title), place, probability));
  }
  sort_greatest_first(causes, [](const auto& cause) { return cause.first; });
  std::vector<std::string> texts;
  for (auto& [probability, text] : causes) texts.push_back(std::move(text));
  return fmt::format("one of {} causes that these data cannot distinguish: {}", texts.size(),
                     fmt::join(texts, ", or "));
}

/// ", or a different period that fits equally well"; of a rotary axis ", or 11 or 13 waves per turn, which fit equally
/// well".
std::string other_periods_text(const Candidate& candidate) {
  constexpr std::size_t kMostListed = 3;
  const auto values = candidate.parameters_set.find(std::string(candidate.effect.definition().searched_parameter()));
  if (!candidate.effect.traits().periodic || values == candidate.parameters_set.end()) return "";
  const std::size_t others = values->second.size() - 1;
  if (candidate.effect.rotary && others > 0 && others <= kMostListed) {
    std::vector<std::string> orders;
    for (const double period_deg : std::span(values->second).subspan(1))
      orders.push_back(fmt::format("{:.0f}", kUsualPeriod_deg / period_deg));
    return fmt::format(", or {} waves per turn, which {} equally well", fmt::join(orders, " or "),
                       others == 1 ? "fits" : "fit");
  }
  if (others < 2) return others == 1 ? ", or a different period that fits equally well" : "";
  return fmt::format(", or one of {} other periods that fit equally well", others);
}

/// Of a wave of which the readings cover less than half a period: an offset and a slope together absorb over four
/// fifths of its variance there. Else "".
std::string short_range_text(const EffectInstance& effect, const Observations& data) {
  constexpr double kHalf = 0.5;
  const auto period = searched_value(effect);
  if (!effect.traits().periodic || !effect.axis || !period || !data.paths.empty()) return "";
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.axis[k] != *effect.axis) continue;
    low = std::min(low, data.p_mm(k, *effect.axis));
    high = std::max(high, data.p_mm(k, *effect.axis));
  }
  if (high - low >= kHalf * *period || high < low) return "";
  return fmt::format(
      ". The readings cover {:.3g} {}, less than half of the period. There, an offset or a slope of the model can "
      "absorb most of the wave, so its amplitude can far exceed the residual",
      high - low, data.position_unit());
}

NamedWave wave_of(const Candidate& candidate) { return larger_wave({candidate.effect, candidate.parameters}); }

/// ", and of +-2.0 um only when moving reverse: one cause …", behind a wave of another approach with its period.
std::string part_text(const NamedWave& wave, const Observations& data) {
  const ApproachMode approach = wave.effect.approach;
  return fmt::format(
      ", and of +-{}{}: one cause that differs between the directions, such as lost motion that varies along the "
      "travel",
      value_of(wave.effect, wave.size(), data),
      approach == ApproachMode::both ? "" : fmt::format(" only when moving {}", name_of(approach)));
}

std::string findings_text(const Diagnosis& diagnosis, const Observations& data, bool likely) {
  std::vector<std::string> findings;
  std::set<const Candidate*> told;
  for (const Candidate& candidate : diagnosis.candidates) {
    if ((likely ? candidate.standing != Standing::likely : !candidate.named) || told.contains(&candidate)) continue;
    std::string text = finding_text(candidate.effect, candidate.parameters, data);
    const auto part = std::ranges::find_if(diagnosis.candidates, [&](const Candidate& other) {
      return other.standing == candidate.standing && are_one_wave(wave_of(other).effect, wave_of(candidate).effect);
    });
    const Candidate* const other = part == diagnosis.candidates.end() ? nullptr : &*part;
    if (other != nullptr) text += part_text(wave_of(*other), data);
    told.insert(other);
    text += other_periods_text(candidate);
    if (may_be_wave(candidate.effect, data)) text += " (on so few targets, a periodic error can look the same)";
    findings.push_back(with_alternatives(text, candidate, other, diagnosis));
  }
  return fmt::format("{}", fmt::join(findings, "; and "));
}

/// "Probably ...: not proved, because ... Measure ... to be sure."; "" where nothing is likely.
std::string likely_text(const Diagnosis& diagnosis, const Observations& data) {
  const auto first =
      std::ranges::find_if(diagnosis.candidates, [](const Candidate& one) { return one.standing == Standing::likely; });
  if (first == diagnosis.candidates.end()) return "";
  return fmt::format("Probably {}{}: not proved, because {}. {} to be sure.",
                     diagnosis.candidates.front().named ? "also " : "", findings_text(diagnosis, data, true),
                     first->but, first->decide);
}

std::string structure_text(const Diagnosis& diagnosis) {
  const std::string variables = variables_text(diagnosis);
  if (variables.empty() && !diagnosis.best_sum_leaves)
    return "The residual is not noise, but no dependence stands out: see the notes.";
  return fmt::format(
      "The residual is not noise{}{}{}.",
      diagnosis.best_sum_leaves ? ", and no effects of the library, alone or together, explain all of it" : "",
      variables.empty() ? "" : ": it depends on ", variables);
}

/// Columns that a candidate fits.
std::size_t fitted_columns(const Candidate& candidate) {
  return std::max(candidate.tried_at.coefficients.size(), std::size_t{1}) +
         static_cast<std::size_t>(is_searched(candidate.effect));
}

double share_alone(const Candidate& candidate) {
  const double before = candidate.kept_rms_before_um;
  return before > 0.0 ? 1.0 - std::pow(candidate.kept_rms_after_um / before, 2) : 0.0;
}

/// Numbers as they are printed, so that no sentence calls equal ones a fall.
bool falls(double before_um, double after_um) {
  return after_um < before_um && in_digits(before_um) != in_digits(after_um);
}

bool held_out_falls(const Candidate& candidate) {
  return candidate.held_out_rms_um && candidate.held_out_rms_before_um &&
         falls(*candidate.held_out_rms_before_um, *candidate.held_out_rms_um);
}

/// Whether a candidate needs no company: it explains, and predicts what it was not fitted to.
bool proved_alone(const Candidate& candidate, const Diagnosis& diagnosis) {
  return explains_alone(candidate, diagnosis) && (!candidate.held_out_rms_um || held_out_falls(candidate));
}

std::string chance_text(const Candidate& candidate, const Diagnosis& diagnosis) {
  const std::string_view sets = name_of_replicates(diagnosis);
  if (candidate.false_naming * static_cast<double>(diagnosis.noise_replicates) < 1.0)
    return fmt::format("; in none of {} {} did an effect explain as much", diagnosis.noise_replicates, sets);
  if (candidate.false_naming >= 1.0) return "";
  return fmt::format("; in {:.2g} % of {} an effect explained as much", kPercent * candidate.false_naming, sets);
}

std::string held_out_text(double before_um, double after_um, const Diagnosis& diagnosis) {
  return fmt::format(", on held-out readings from {} to {} {}", in_digits(before_um), in_digits(after_um),
                     diagnosis.noise.unit);
}

/// What the candidate does alone beside the model.
std::string evidence_alone(const Candidate& candidate, const Diagnosis& diagnosis) {
  const bool explains = explains_alone(candidate, diagnosis);
  const bool fell = falls(candidate.kept_rms_before_um, candidate.kept_rms_after_um);
  if (!explains && !(candidate.in_answer() && fell && held_out_falls(candidate))) {
    const double share = std::max(0.0, share_alone(candidate));
    return fmt::format(
        "Alone it explains {} of the residual{}", percent(share),
        share < kLeastShareSaid ? ", too little to be evidence on its own" : ", no more than noise would");
  }
  std::string text =
      fmt::format("With it the residual{} falls from {} to {} {} rms ({} explained; noise {} {})",
                  diagnosis.outliers.empty() ? "" : " without the outliers", in_digits(candidate.kept_rms_before_um),
                  in_digits(candidate.kept_rms_after_um), diagnosis.noise.unit, percent(share_alone(candidate)),
                  in_digits(diagnosis.noise.noise_um), diagnosis.noise.unit);
  if (held_out_falls(candidate))
    text += held_out_text(*candidate.held_out_rms_before_um, *candidate.held_out_rms_um, diagnosis);
  else if (candidate.held_out_rms_um)
    return text + "; alone it does not predict held-out readings";
  return explains ? text + chance_text(candidate, diagnosis) : text;
}

/// What all named effects do where this one alone does not prove itself.
std::string evidence_together(const Candidate& candidate, const Diagnosis& diagnosis, const JointProof& joint) {
  std::vector<std::string> others;
  bool none_alone = true;
  std::size_t named = 0;
  for (const Candidate& one : diagnosis.candidates) {
    if (!one.in_answer()) continue;
    ++named;
    none_alone = none_alone && !proved_alone(one, diagnosis);
    if (&one != &candidate) others.push_back(id_text(one, diagnosis));
  }
  std::string text = fmt::format("Together with {}, ", fmt::join(others, " and "));
  if (falls(candidate.kept_rms_before_um, joint.rms_after_um))
    text += fmt::format("this effect reduces the residual from {} to", in_digits(candidate.kept_rms_before_um));
  else
    text += "the residual is";
  text += fmt::format(" {} {} rms (noise {} {})", in_digits(joint.rms_after_um), diagnosis.noise.unit,
                      in_digits(diagnosis.noise.noise_um), diagnosis.noise.unit);
  if (falls(joint.held_out_rms_before_um, joint.held_out_rms_um))
    text += held_out_text(joint.held_out_rms_before_um, joint.held_out_rms_um, diagnosis);
  return text + (!none_alone ? "; alone it does not" : named == 2 ? "; neither alone does" : "; none alone does");
}

/// ", and of +-1.2 um with a period of 5.000 mm": the smaller of a wave and its second harmonic, where its size is
/// known to a third.
std::string smaller_wave_text(const NamedWave& wave, const Observations& data) {
  constexpr double kSigmas = 3.0;
  const auto smaller = smaller_wave(wave);
  if (!smaller) return "";
  const ParameterEstimate& size = smaller->size();
  if (size.undetermined || !size.sigma || size.value < kSigmas * *size.sigma) return "";
  return fmt::format(", and of +-{}, period {}", value_of(smaller->effect, size, data),
                     value_of(smaller->effect, smaller->period(), data));
}

}  // namespace

bool is_undetermined(const EffectInstance& effect, const std::vector<ParameterEstimate>& parameters) {
  if (std::ranges::any_of(parameters, &ParameterEstimate::undetermined)) return true;
  const auto is_known_size = [&](const ParameterEstimate& one) {
    const auto& all = effect.definition().parameters;
    const auto found = std::ranges::find(all, one.name, &ParameterDefinition::name);
    const bool is_size = found == all.end() || (found->coding != Coding::searched && found->coding != Coding::phase);
    return is_size && !is_guess(one);
  };
  return !parameters.empty() && std::ranges::none_of(parameters, is_known_size);
}

bool follows_other_sensor(const EffectInstance& a, const EffectInstance& b) {
  return same_place(a, b) && a.approach == b.approach && !same_sensors(a, b);
}

std::string in_digits(double value, int digits) {
  return shortest(number_in(fmt::format("{:.{}g}", value, digits)).value_or(value));
}

std::string ball_text(const EffectInstance& effect, const Observations& data) {
  const bool turns = effect.id == effect_named("ball_on_table");
  if (effect.is_user() || (!turns && effect.id != effect_named("ball_in_spindle"))) return {};
  const std::vector<Vector3>& all_mm = turns ? data.balls_mm : data.tools_mm;
  const auto number = static_cast<std::size_t>(effect.ball);
  if (all_mm.size() < 2 || number < 1 || number > all_mm.size()) return {};
  const Vector3& mm = all_mm[number - 1];
  const auto is_here = [&](const Vector3& one) {
    return std::hypot(one[0] - mm[0], one[1] - mm[1], one[2] - mm[2]) < kSameBall_mm;
  };
  const auto set_up = std::count_if(all_mm.begin(), all_mm.begin() + effect.ball, is_here);
  const bool set_up_again = turns && std::ranges::count_if(all_mm, is_here) > 1;
  return fmt::format("ball {} {} X {}, Y {}, Z {} mm{})", number,
                     turns ? "on the table (nominally at" : "in the spindle (tool offset", in_digits(mm[0], 4),
                     in_digits(mm[1], 4), in_digits(mm[2], 4), set_up_again ? fmt::format(", set-up {}", set_up) : "");
}

std::string finding_text(const EffectInstance& found_effect, const std::vector<ParameterEstimate>& found_parameters,
                         const Observations& data) {
  const auto [effect, parameters] = larger_wave({found_effect, found_parameters});
  const EffectDefinition& definition = effect.definition();
  fmt::dynamic_format_arg_store<fmt::format_context> words;
  const auto word = [&words](std::string_view name, const std::string& text) {
    words.push_back(fmt::arg(std::string(name).c_str(), text));
  };
  for (const ParameterDefinition& parameter : definition.parameters) {
    const auto found =
        std::ranges::find_if(parameters, [&](const ParameterEstimate& one) { return one.name == parameter.name; });
    word(parameter.name, found == parameters.end() ? "an unknown amount" : value_of(effect, *found, data));
  }
  word("where", error_word(effect));
  word("readings", where_word(effect));
  word("slope", is_across(effect) ? "slope" : "scale error");
  word("axis", effect.axis ? std::string(1, axis_letter(effect)) : "The");
  word("code", std::string(code_text(effect)));
  word("pair", pair_word(effect));
  word("turn", std::string(1, letter_of(effect.sense ? direction_of(*effect.sense) : Axis::Z)));
  word("map", map_word(effect));
  word("sensor", sensor_word(effect.sensor));
  word("sensor2", sensor_word(effect.sensor2));
  word("name", effect.name);
  word("sizes", sizes_word(effect, parameters, data));
  std::string text = fmt::vformat(definition.headline, words);
  if (const std::string ball = ball_text(effect, data); !ball.empty())
    for (const std::string_view one : {"the ball on the table", "the ball in the spindle"})
      if (const std::size_t at = text.find(one); at != std::string::npos) text.replace(at, one.size(), ball);
  if (const auto lag = std::ranges::find(parameters, kLag, &ParameterEstimate::name); lag != parameters.end())
    text += fmt::format(", following it with a time constant of {}", duration_text(lag->value));
  constexpr std::string_view kEverywhere = "equal at every position";
  if (const std::size_t at = text.find(kEverywhere); at != std::string::npos && effect.axis)
    if (const auto targets = targets_of(data); targets.contains(*effect.axis) && targets.at(*effect.axis).size() == 1)
      text.replace(at, kEverywhere.size(), "measured at one target only");
  if (const std::size_t sign = text.find("+-an "); sign != std::string::npos) text.erase(sign, 2);
  constexpr std::string_view kNegative = "read -", kLate = " late ";
  if (const std::size_t sign = text.find(kNegative), late = text.find(kLate);
      sign < late && late != std::string::npos) {
    text.replace(late, kLate.size(), " early ");
    text.erase(sign + kNegative.size() - 1, 1);
  }
  text += smaller_wave_text({found_effect, found_parameters}, data);
  if (effect.approach != ApproachMode::both) text += fmt::format(", only when moving {}", name_of(effect.approach));
  return text;
}

std::string readings_word(Sense sense, std::optional<Axis> axis, bool rotary) {
  if (axis && rotary) {
    const char letter = laser::letter_of(*axis, rotary);
    if (is_rotation(sense) && direction_of(sense) == *axis) return fmt::format("{} positions", letter);
    return fmt::format("{} {} over {}", is_rotation(sense) ? "Angles" : "Deviations", name_of(sense), letter);
  }
  if (is_rotation(sense))
    return axis ? fmt::format("Angles {} along {}", name_of(sense), letter_of(*axis))
                : fmt::format("Angles {}", name_of(sense));
  const char direction = letter_of(direction_of(sense));
  if (!axis || letter_of(*axis) == direction) return fmt::format("{} positions", direction);
  return fmt::format("{} deviations along {}", direction, letter_of(*axis));
}

bool names_a_wave(const Diagnosis& diagnosis) {
  return std::ranges::any_of(diagnosis.candidates,
                             [](const Candidate& one) { return one.in_answer() && one.effect.traits().periodic; });
}

std::string headline_for(const Diagnosis& d, const Observations& data, const std::string& bad_run, bool within_pass) {
  std::string text = bad_run;
  const auto add = [&text](const std::string& sentence) {
    if (!sentence.empty()) text += (text.empty() ? "" : " ") + sentence;
  };
  switch (d.verdict) {
    case Verdict::adequate:
      add(fmt::format("{}: {}{} is noise{}.",
                      d.reservation.empty() ? "The model explains the readings" : "No further effect is detected",
                      d.outliers.empty() ? "" : "apart from outliers ",
                      d.reservation.empty() ? "its residual" : "the residual of the model",
                      within_pass ? " within each pass" : ""));
      add(d.reservation);
      break;
    case Verdict::missing_effect:
    case Verdict::partly_explained:
      add(fmt::format("Found: {}.", findings_text(d, data, false)));
      add(open_sensors_text(d));
      if (d.verdict == Verdict::partly_explained) add("That is proved, but the residual contains more.");
      add(likely_text(d, data));
      if (names_a_wave(d) || is_at_one_target(data)) add(d.reservation);
      break;
    case Verdict::likely_effect:
      add(likely_text(d, data));
      if (names_a_wave(d) || is_at_one_target(data)) add(d.reservation);
      break;
    case Verdict::cannot_tell:
      add(d.reservation);
      add(fmt::format("These data cannot show whether an effect is missing: {}.", d.cannot_tell));
      break;
    default:
      add(structure_text(d));
      if (const std::string proved = findings_text(d, data, false); !proved.empty())
        add(fmt::format("Found: {}. That is proved, but {}.", proved,
                        explainable_share(d.rms_um, d.rms_after_um, d.noise.noise_um) < kPartExplained
                            ? "it is the lesser part"
                        : names_a_wave(d) ? "the waves are only the first terms of another shape"
                                          : "the residual contains more"));
      add(likely_text(d, data));
  }
  return text;
}

bool explains_alone(const Candidate& candidate, const Diagnosis& diagnosis) {
  const double by_noise = static_cast<double>(fitted_columns(candidate)) /
                          static_cast<double>(std::max<std::size_t>(diagnosis.observations, 1));
  return falls(candidate.kept_rms_before_um, candidate.kept_rms_after_um) &&
         share_alone(candidate) >= std::max(kLeastShareSaid, by_noise);
}

std::string reason_for(const Candidate& candidate, const Diagnosis& diagnosis, const Observations& data,
                       const std::optional<JointProof>& joint) {
  std::string text = candidate.in_answer() && joint && !proved_alone(candidate, diagnosis)
                         ? evidence_together(candidate, diagnosis, *joint)
                         : evidence_alone(candidate, diagnosis);
  for (const ParameterEstimate& one : candidate.parameters)
    if (const std::string pitch = pitch_text(candidate.effect, one.sigma, data);
        one.name == candidate.effect.definition().searched_parameter() && !pitch.empty())
      text += fmt::format("; the period of {:.5g} {} is {}", one.value, data.position_unit(), pitch);
  if (candidate.in_answer()) text += short_range_text(candidate.effect, data);
  if (candidate.in_answer() && std::ranges::any_of(candidate.parameters, &ParameterEstimate::undetermined))
    text += fmt::format(
        ". An error of this shape is {}, but not how large it is: other effects of the model can take over part of it",
        name_of(candidate.standing));
  return text + fmt::format(". How to recognise it: {}.", candidate.effect.definition().tells_apart);
}

std::string separating_measurement(const EffectInstance& effect, const std::vector<EffectInstance>& rivals) {
  const SeparatingMeasurement* chosen = &effect.definition().separated_by;
  for (const EffectInstance& rival : rivals) {
    const SeparatingMeasurement& other = rival.definition().separated_by;
    if (other.also_for_rivals && other.precedence < chosen->precedence) chosen = &other;
  }
  const double usual = effect.rotary ? kUsualPeriod_deg : kUsualPeriod_mm;
  const double period = effect.traits().periodic ? searched_value(effect).value_or(usual) : 0.0;
  return fmt::format(
      fmt::runtime(chosen->sentence), fmt::arg("axis", axis_word(effect)),
      fmt::arg("tenth", fmt::format("{} {}", in_digits(period / kTargetsAPeriod), laser::target_unit(effect.rotary))));
}

std::optional<std::string> sensor_noise_note(const Diagnosis& diagnosis, const Observations& data, bool unexplained) {
  if (!data.history || data.history->without_noise.empty()) return std::nullopt;
  const auto follows = [](const EffectInstance& effect, const std::string& sensor) {
    return effect.traits().has_lag && (effect.sensor == sensor || effect.sensor2 == sensor ||
                                       (effect.sensor.empty() && sensor == kMaterialSensor));
  };
  std::vector<std::string> sensors;
  bool hides = unexplained;
  for (const auto& [sensor, course] : data.history->without_noise) {
    bool is_followed = unexplained;
    for (const Candidate& one : diagnosis.candidates) {
      if (!one.in_answer()) continue;
      const bool of_rival = std::ranges::any_of(
          one.rivals, [&follows, &of = sensor](const EffectInstance& rival) { return follows(rival, of); });
      hides = hides || of_rival;
      is_followed = is_followed || of_rival || follows(one.effect, sensor);
    }
    if (is_followed) sensors.push_back(fmt::format("{} ({:.2g} degC)", sensor, course.noise_degC));
  }
  if (sensors.empty()) return std::nullopt;
  const bool several = sensors.size() > 1;
  return fmt::format(
      "{} {} noisy or coarse and {} smoothed{}", fmt::join(sensors, " and "), several ? "are" : "is",
      several ? "were" : "was",
      hides ? ". The cause may therefore be another temperature. Repeat with sensors of lower noise" : "");
}

}  // namespace ecs::model
