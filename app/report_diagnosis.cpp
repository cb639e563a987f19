#include "app/report_diagnosis.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/model_json.hpp"
#include "app/model_view.hpp"
#include "base/file.hpp"

namespace ecs::app {
namespace {

const Json& member(const Json& object, const char* key) {
  static const Json nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}
std::string word_in(const Json& object, const char* key) {
  const Json& value = member(object, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}
std::optional<double> number_in(const Json& object, const char* key) {
  const Json& value = member(object, key);
  if (!value.is_number()) return std::nullopt;
  return value.get<double>();
}
std::size_t count_in(const Json& object, const char* key) {
  const auto value = number_in(object, key);
  return value && *value > 0.0 && *value < 1e12 ? static_cast<std::size_t>(*value) : 0;
}
std::vector<std::string> words_in(const Json& object, const char* key) {
  std::vector<std::string> words;
  for (const Json& one : member(object, key))
    if (one.is_string()) words.push_back(one.get<std::string>());
  return words;
}

std::vector<std::string> parameters_in(const Json& object) {
  std::vector<std::string> all;
  const Json& sigmas = member(object, "sigma");
  for (const auto& [name, value] : member(object, "parameters").items()) {
    if (!value.is_number()) continue;
    const auto sigma = sigmas.is_object() ? number_in(sigmas, name.c_str()) : std::nullopt;
    all.push_back(sigma ? fmt::format("{} {} ± {}", name, few_digits(value.get<double>(), 4), few_digits(*sigma, 2))
                        : fmt::format("{} {}", name, few_digits(value.get<double>(), 3)));
  }
  return all;
}

ReportedEffect effect_of(const Json& object) {
  ReportedEffect out;
  out.place = word_in(object, "name");
  if (const auto effect = effect_in(object)) {
    out.place = place_text(*effect);
    out.title = model::info_of(effect->id).title;
  }
  out.named = member(object, "named") == Json(true);
  if (member(object, "parameters").is_object()) out.parameters = parameters_in(object);
  out.rms_after_um = number_in(object, "rms_after_um");
  out.explainable_share = number_in(object, "explainable_share");
  out.held_out_before_um = number_in(object, "held_out_rms_before_um");
  out.held_out_after_um = number_in(object, "held_out_rms_um");
  out.false_naming = number_in(object, "false_naming");
  out.rivals = words_in(object, "indistinguishable_from");
  out.because = word_in(object, "because");
  out.next_measurement = word_in(object, "next_measurement");
  return out;
}

/// @pre an object
std::optional<ReportedDiagnosis> diagnosis_in(const Json& object) {
  ReportedDiagnosis out;
  out.verdict = word_in(object, "verdict");
  const auto rms = number_in(object, "rms_um");
  const auto known = {"adequate", "missing_effect", "unexplained_structure"};
  if (!rms || std::find(known.begin(), known.end(), out.verdict) == known.end()) return std::nullopt;
  out.readings = count_in(object, "observations");
  out.rms_um = *rms;
  out.rms_after_um = number_in(object, "rms_after_um");
  out.noise_um = number_in(object, "noise_um").value_or(0.0);
  out.blanks = count_in(object, "blanks");
  for (const Json& one : member(object, "candidates"))
    if (one.is_object()) out.effects.push_back(effect_of(one));
  std::stable_sort(out.effects.begin(), out.effects.end(),
                   [](const ReportedEffect& a, const ReportedEffect& b) { return a.named && !b.named; });
  for (const Json& one : member(object, "where"))
    if (one.is_object()) out.where.push_back({word_in(one, "variable"), number_in(one, "strength").value_or(0.0)});
  out.notes = words_in(object, "notes");
  return out;
}

}  // namespace

ReportedDiagnosis reported(const model::Diagnosis& diagnosis) {
  return diagnosis_in(json_of(diagnosis)).value_or(ReportedDiagnosis{});
}

Result<ReportedDiagnosis> parse_diagnosis(std::string_view json, const std::string& name) {
  const Json object = Json::parse(json, nullptr, false);
  auto diagnosis = object.is_object() ? diagnosis_in(object) : std::nullopt;
  if (!diagnosis)
    return problem_at(name, 0, 0, "expected the answer of `ecs model diagnose --json`, with verdict and rms_um");
  return std::move(*diagnosis);
}

Result<ReportedDiagnosis> read_diagnosis(const std::filesystem::path& path) {
  const auto content = read_file(path);
  if (!content) return tl::unexpected(content.error());
  return parse_diagnosis(*content, path.string());
}

}  // namespace ecs::app
