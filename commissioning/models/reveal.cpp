#include "commissioning/models/reveal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/json.hpp"
#include "base/sealed.hpp"
#include "commissioning/models/view.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::array<std::string_view, 5> kKinds{"blank", "single", "pair", "out_of_library", "confounded"};

Problem not_of_form(const std::string& file, const std::string& why) {
  return {ProblemKind::bad_input, why, file, 0, 0, {}};
}

Result<Json> object_in(std::string_view text, const std::string& file) {
  Json object = Json::parse(text, nullptr, false);
  if (object.is_object()) return object;
  return tl::unexpected(not_of_form(file, "expected one JSON object"));
}

std::string word(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<double> number(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

std::vector<std::string> words(const Json& object, const char* key) {
  std::vector<std::string> list;
  if (const auto found = object.find(key); found != object.end() && found->is_array())
    for (const Json& one : *found)
      if (one.is_string()) list.push_back(one.get<std::string>());
  return list;
}

std::map<std::string, double> numbers(const Json& object, const char* key) {
  std::map<std::string, double> values;
  if (const auto found = object.find(key); found != object.end() && found->is_object())
    for (const auto& [name, value] : found->items())
      if (value.is_number()) values[name] = value.get<double>();
  return values;
}

Json list(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : Json::array();
}

HiddenEffect hidden_effect(const Json& object) {
  HiddenEffect effect;
  effect.name = word(object, "name");
  if (const auto place = effect_in(object); place && effect.name.empty()) effect.name = to_text(*place);
  effect.approach = model::approach_mode_named(word(object, "approach"));
  effect.sensor = word(object, "sensor");
  effect.sensor2 = word(object, "sensor2");
  effect.parameters = numbers(object, "parameters");
  effect.rms_um = number(object, "rms_um").value_or(0.0);
  effect.snr = number(object, "snr").value_or(0.0);
  return effect;
}

Result<HiddenTruth> truth_in(const std::string& text, const std::string& file) {
  ECS_TRY(object, object_in(text, file));
  const auto kind = std::find(kKinds.begin(), kKinds.end(), word(object, "kind"));
  if (kind == kKinds.end())
    return tl::unexpected(
        not_of_form(file, fmt::format("kind: expected {}, got \"{}\"", fmt::join(kKinds, ", "), word(object, "kind"))));
  HiddenTruth truth;
  truth.kind = static_cast<HiddenKind>(kind - kKinds.begin());
  truth.noise_um = number(object, "noise_um").value_or(0.0);
  for (const Json& one : list(object, "effects")) truth.effects.push_back(hidden_effect(one));
  truth.group = words(object, "group");
  truth.variables = words(object, "variables");
  truth.true_model_rms_um = number(object, "true_model_rms_um").value_or(0.0);
  truth.text = word(object, "text");
  truth.json = one_line(object);
  const std::size_t needed = truth.kind == HiddenKind::single ? 1 : (truth.kind == HiddenKind::pair ? 2 : 0);
  if (truth.effects.size() < needed)
    return tl::unexpected(
        not_of_form(file, fmt::format("effects: expected {}, found {}", needed, truth.effects.size())));
  if (truth.kind == HiddenKind::confounded && truth.group.empty())
    return tl::unexpected(not_of_form(file, "group: expected the effects that do the same, found none"));
  return truth;
}

/// What the truth says of approach and sensor agrees with the candidate.
bool details_agree(const HiddenEffect& hidden, const FoundEffect& found) {
  if (hidden.approach && *hidden.approach != found.effect.approach) return false;
  if (hidden.sensor2.empty()) return hidden.sensor.empty() || hidden.sensor == found.effect.sensor;
  const std::set<std::string> pair{found.effect.sensor, found.effect.sensor2};  // the sign is in the coefficient
  return pair == std::set<std::string>{hidden.sensor, hidden.sensor2};
}

bool lists(const FoundEffect& found, const std::string& name) {
  return std::find(found.group.begin(), found.group.end(), name) != found.group.end();
}

bool is_answer(const HiddenEffect& hidden, const FoundEffect& found) {
  return (to_text(found.effect) == hidden.name && details_agree(hidden, found)) || lists(found, hidden.name);
}

bool named_somewhere(const HiddenEffect& hidden, const FoundAnswer& answer) {
  return std::any_of(answer.candidates.begin(), answer.candidates.end(),
                     [&](const FoundEffect& one) { return one.named && is_answer(hidden, one); });
}

std::string first_name(const FoundAnswer& answer) {
  return answer.candidates.empty() ? "nothing" : to_text(answer.candidates.front().effect);
}

struct Judged {
  bool right = false;
  std::string why;
};

/// What is named, or likely, leaves noise or is the first thought.
bool says_all(const FoundAnswer& answer) {
  return answer.verdict == "missing_effect" || answer.verdict == "likely_effect";
}

Judged judged_single(const HiddenTruth& truth, const FoundAnswer& answer) {
  const HiddenEffect& hidden = truth.effects.front();
  if (!says_all(answer) || answer.candidates.empty())
    return {false, fmt::format("{} was not named: the verdict is {}", hidden.name, answer.verdict)};
  const FoundEffect& first = answer.candidates.front();
  if (lists(first, hidden.name) && to_text(first.effect) != hidden.name)
    return {true, fmt::format("{} belongs to the group of {}", hidden.name, to_text(first.effect))};
  if (is_answer(hidden, first)) return {true, hidden.name + " is named first"};
  if (to_text(first.effect) == hidden.name) return {false, hidden.name + " is named, with another approach or sensor"};
  return {false, fmt::format("{} was hidden, {} is named first", hidden.name, to_text(first.effect))};
}

Judged judged_pair(const HiddenTruth& truth, const FoundAnswer& answer) {
  std::vector<std::string> missed;
  for (const HiddenEffect& hidden : truth.effects)
    if (!named_somewhere(hidden, answer)) missed.push_back(hidden.name);
  if (!says_all(answer)) return {false, "the verdict is " + answer.verdict};
  if (missed.empty()) return {true, "both are named"};
  return {false, fmt::format("not named: {}", fmt::join(missed, ", "))};
}

Judged judged_confounded(const HiddenTruth& truth, const FoundAnswer& answer) {
  if (answer.candidates.empty()) return {false, "nothing is named: the verdict is " + answer.verdict};
  std::vector<std::string> found = answer.candidates.front().group, wanted = truth.group;
  found.push_back(first_name(answer));
  for (auto* names : {&found, &wanted}) {
    std::sort(names->begin(), names->end());
    names->erase(std::unique(names->begin(), names->end()), names->end());
  }
  if (found == wanted) return {true, fmt::format("the whole group and nothing else: {}", fmt::join(wanted, ", "))};
  return {false, fmt::format("the group is {}, named are {}", fmt::join(wanted, ", "), fmt::join(found, ", "))};
}

Judged judged(const HiddenTruth& truth, const FoundAnswer& answer) {
  switch (truth.kind) {
    case HiddenKind::blank:
      if (answer.verdict == "adequate") return {true, "nothing was hidden and nothing is named"};
      return {false, fmt::format("nothing was hidden, but the verdict is {} ({})", answer.verdict, first_name(answer))};
    case HiddenKind::single:
      return judged_single(truth, answer);
    case HiddenKind::pair:
      return judged_pair(truth, answer);
    case HiddenKind::out_of_library:
      if (answer.verdict == "unexplained_structure") return {true, "structure outside the library is reported as such"};
      return {false, fmt::format("structure outside the library, but the verdict is {} ({})", answer.verdict,
                                 first_name(answer))};
    default:
      return judged_confounded(truth, answer);
  }
}

/// Phases count modulo one turn.
double nearest_value(const std::string& name, double found, double hidden) {
  if (!name.ends_with("_rad")) return found;
  return hidden + std::remainder(found - hidden, 2.0 * std::numbers::pi);
}

std::vector<ParameterScore> parameter_scores(const HiddenTruth& truth, const FoundAnswer& answer) {
  std::vector<ParameterScore> scores;
  for (const HiddenEffect& hidden : truth.effects)
    for (const FoundEffect& found : answer.candidates) {
      if (!found.named || to_text(found.effect) != hidden.name || !details_agree(hidden, found)) continue;
      // The other order of a pair of sensors turns the sign of their difference.
      const double sign = !hidden.sensor2.empty() && hidden.sensor != found.effect.sensor ? -1.0 : 1.0;
      for (const auto& [name, value] : hidden.parameters) {
        const auto estimate = found.parameters.find(name);
        if (estimate == found.parameters.end()) continue;
        ParameterScore score{hidden.name, name, value, nearest_value(name, sign * estimate->second, value), {}};
        if (const auto sigma = found.sigma.find(name); sigma != found.sigma.end()) score.sigma = sigma->second;
        scores.push_back(score);
      }
    }
  return scores;
}

}  // namespace

std::string_view name_of(HiddenKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::optional<double> ParameterScore::sigmas_off() const {
  if (!sigma || *sigma <= 0.0) return std::nullopt;
  return (found - hidden) / *sigma;
}

Result<HiddenTruth> truth_of(const std::string& folder) {
  const std::filesystem::path at(folder);
  std::error_code error;
  if (std::filesystem::exists(at / "truth.sealed", error)) {
    const std::string file = (at / "truth.sealed").string();
    ECS_TRY(text, read_file(file));
    ECS_TRY(opened, unsealed(text, file));
    return truth_in(opened, file);
  }
  const std::string file = (at / "truth.json").string();
  const auto text = read_file(file);
  if (!text)
    return tl::unexpected(not_of_form(folder, "no hidden case: expected truth.sealed or truth.json in this folder"));
  return truth_in(*text, file);
}

Result<FoundAnswer> answer_in(std::string_view text, const std::string& file) {
  ECS_TRY(object, object_in(text, file));
  FoundAnswer answer;
  answer.verdict = word(object, "verdict");
  if (answer.verdict.empty())
    return tl::unexpected(not_of_form(file, "expected the JSON of `ecs model diagnose --json`, found no verdict"));
  for (const Json& one : list(object, "candidates")) {
    const auto effect = one.is_object() ? effect_in(one) : std::nullopt;
    if (!effect) return tl::unexpected(not_of_form(file, "candidates: expected effects of the library"));
    const auto named = one.find("named");
    const bool likely = word(one, "standing") == "likely";
    answer.candidates.push_back({*effect, likely || named == one.end() || !named->is_boolean() || named->get<bool>(),
                                 words(one, "indistinguishable_from"), numbers(one, "parameters"),
                                 numbers(one, "sigma")});
  }
  for (const Json& one : list(object, "where"))
    if (one.is_object()) answer.where.push_back(word(one, "variable"));
  answer.rms_after_um = number(object, "rms_after_um");
  if (!answer.rms_after_um && !list(object, "candidates").empty())
    answer.rms_after_um = number(list(object, "candidates").front(), "rms_after_um");
  return answer;
}

Score score_of(const HiddenTruth& truth, const FoundAnswer& answer) {
  const Judged judgement = judged(truth, answer);
  Score score{judgement.right, judgement.why, parameter_scores(truth, answer), {}};
  if (truth.true_model_rms_um > 0.0 && answer.rms_after_um)
    score.rms_ratio = *answer.rms_after_um / truth.true_model_rms_um;
  return score;
}

}  // namespace ecs::commissioning
