#include "modules/report/diagnosis.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/names/commissioning.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/json.hpp"
#include "model/effects/definition.hpp"
#include "modules/report/markup.hpp"

namespace ecs::app {
namespace {

const Json& member(const Json& object, const char* key) {
  static const Json nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}
std::size_t count_in(const Json& object, const char* key) {
  const auto value = number_at(object, key);
  return value && *value > 0.0 && *value < 1e12 ? static_cast<std::size_t>(*value) : 0;
}
std::vector<std::string> words_in(const Json& object, const char* key) {
  std::vector<std::string> words;
  for (const Json& one : member(object, key))
    if (one.is_string()) words.push_back(one.get<std::string>());
  return words;
}

std::string unit_of(const std::optional<model::EffectInstance>& effect, std::string_view name) {
  if (effect)
    for (const model::ParameterDefinition& parameter : effect->definition().parameters)
      if (model::shown_name(parameter.name, *effect) == name) return model::unit_of(*effect, parameter);
  return "";
}

/// Without those that are nothing.
std::vector<std::string> parameters_in(const Json& object, const std::optional<model::EffectInstance>& effect) {
  std::vector<std::string> all;
  const Json& sigmas = member(object, "sigma");
  for (const auto& [name, value] : member(object, "parameters").items()) {
    if (!value.is_number()) continue;
    const auto sigma = sigmas.is_object() ? number_at(sigmas, name.c_str()) : std::nullopt;
    if (value.get<double>() != 0.0 || sigma)
      all.push_back(parameter_text(name, unit_of(effect, name), value.get<double>(), sigma));
  }
  return all;
}

ReportedEffect effect_of(const Json& object) {
  ReportedEffect out;
  out.place = text_at(object, "name");
  const auto effect = effect_in(object);
  if (effect) {
    out.place = place_text(*effect);
    out.title = title_of(*effect);
    out.facts = commissioning::facts_of(effect->definition());
  }
  const bool likely = text_at(object, "standing") == name_of(model::Standing::likely);
  out.named = likely || member(object, "named") == Json(true);
  out.but = text_at(object, "but");
  if (member(object, "undetermined") == Json(true))
    out.parameters.emplace_back("size not determined by these data");
  else if (member(object, "parameters").is_object())
    out.parameters = parameters_in(object, effect);
  out.rms_after_um = number_at(object, "rms_after_um");
  out.explained = number_at(object, "explained");
  out.held_out_before_um = number_at(object, "held_out_rms_before_um");
  out.held_out_after_um = number_at(object, "held_out_rms_um");
  out.rivals = words_in(object, "indistinguishable_from");
  out.because = text_at(object, "because");
  out.next_measurement = text_at(object, "next_measurement");
  return out;
}

/// Of an answer that was saved without a headline.
std::string headline_from_ids(const ReportedDiagnosis& diagnosis) {
  std::vector<std::string> named;
  for (const ReportedEffect& effect : diagnosis.effects)
    if (effect.named) named.push_back(effect.place);
  return named.empty() ? fmt::format("Verdict: {}.", diagnosis.verdict)
                       : fmt::format("Verdict: {}, {}.", diagnosis.verdict, fmt::join(named, " and "));
}

/// @pre an object
std::optional<ReportedDiagnosis> diagnosis_in(const Json& object) {
  ReportedDiagnosis out;
  out.verdict = text_at(object, "verdict");
  const auto rms = number_at(object, "rms_um");
  const auto known = {"adequate",      "missing_effect", "partly_explained", "unexplained_structure",
                      "likely_effect", "cannot_tell"};
  if (!rms || std::find(known.begin(), known.end(), out.verdict) == known.end()) return std::nullopt;
  out.readings = count_in(object, "observations");
  out.rms_um = *rms;
  out.rms_after_um = number_at(object, "rms_after_um");
  out.noise_um = number_at(object, "noise_um").value_or(0.0);
  out.noise_replicates = count_in(object, "blanks");
  for (const Json& one : member(object, "candidates"))
    if (one.is_object()) out.effects.push_back(effect_of(one));
  std::stable_sort(out.effects.begin(), out.effects.end(),
                   [](const ReportedEffect& a, const ReportedEffect& b) { return a.named && !b.named; });
  for (const Json& one : member(object, "where"))
    if (one.is_object()) out.where.push_back({text_at(one, "variable"), number_at(one, "strength").value_or(0.0)});
  for (const Json& one : member(object, "left"))
    if (one.is_object() && !text_at(one, "is").empty())
      out.left.push_back(fmt::format("{}: {}. {}.", words_for_property(text_at(one, "property")),
                                     words_for_answer(text_at(one, "property"), text_at(one, "is")),
                                     text_at(one, "because")));
  if (const Json& formula = member(object, "formula"); formula.is_object() && member(formula, "formula").is_object())
    for (const auto& [sense, text] : member(formula, "formula").items())
      if (text.is_string()) out.formula = fmt::format("{} = {}", sense, text.get<std::string>());
  out.notes = words_in(object, "notes");
  out.headline = text_at(object, "headline");
  if (out.headline.empty()) out.headline = headline_from_ids(out);
  return out;
}

}  // namespace

std::string parameter_text(std::string_view name, std::string_view unit, double value,
                           const std::optional<double>& sigma) {
  const std::string words = model::spoken_name(name, unit);
  std::string number = few_digits(value);
  if (sigma && *sigma > 0.0) {
    const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(*sigma))), 0, 6);
    number = fmt::format("{} ± {}", number_text(value, decimals), number_text(*sigma, decimals));
  }
  return fmt::format("{}{}{}{}{}", words, words.empty() ? "" : " ", number, unit.empty() ? "" : "\u202f",
                     unit_text(unit));
}

ReportedDiagnosis reported(const model::Diagnosis& diagnosis) {
  return diagnosis_in(diagnosis_cell(diagnosis).json).value_or(ReportedDiagnosis{});
}

Result<ReportedDiagnosis> parse_diagnosis(std::string_view json, const std::string& name) {
  if (auto why = why_no_text(json, name)) return tl::unexpected(std::move(*why));
  const Json object = Json::parse(json, nullptr, false);
  auto diagnosis = object.is_object() ? diagnosis_in(object) : std::nullopt;
  if (!diagnosis)
    return problem_at(name, 0, 0, "expected the answer of `ecs model diagnose --json`, with verdict and rms_um");
  return std::move(*diagnosis);
}

Result<ReportedDiagnosis> read_diagnosis(const std::filesystem::path& path) {
  ECS_TRY(content, read_file(path));
  return parse_diagnosis(content, path.string());
}

}  // namespace ecs::app
