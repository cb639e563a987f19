#include "commissioning/models/json.hpp"

#include "base/json.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {
namespace {

using model::Candidate;
using model::Diagnosis;
using model::EffectInstance;
using model::ParameterEstimate;

std::string word_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Json candidate_json(const Candidate& candidate) {
  Json object = json_of(candidate.effect);
  Json values = Json::object(), sigmas = Json::object();
  for (const ParameterEstimate& one : candidate.parameters) {
    values[one.name] = number_or_null(one.value);
    sigmas[one.name] = number_or_null(one.sigma);
  }
  object["parameters"] = std::move(values);
  object["sigma"] = std::move(sigmas);
  object["named"] = candidate.named;
  object["rms_after_um"] = number_or_null(candidate.rms_after_um);
  object["explained"] = number_or_null(candidate.explained);
  object["explainable_share"] = number_or_null(candidate.explainable_share);
  object["p_value"] = number_or_null(candidate.p_value);
  object["false_naming"] = number_or_null(candidate.false_naming);
  object["held_out_rms_um"] = number_or_null(candidate.held_out_rms_um);
  object["held_out_rms_before_um"] = number_or_null(candidate.held_out_rms_before_um);
  object["skipped"] = candidate.skipped;
  object["indistinguishable_from"] = candidate.indistinguishable_from;
  object["because"] = candidate.because;
  object["next_measurement"] = candidate.next_measurement;
  if (!candidate.effect.curve.empty()) object["curve"] = json_of(candidate.effect.curve);
  return object;
}

Json numbers_json(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number_or_null(value));
  return out;
}

Json dependence_json(const model::Dependence& one) {
  return {{"variable", one.variable},
          {"strength", number_or_null(one.strength)},
          {"p_value", number_or_null(one.p_value)},
          {"at", numbers_json(one.at)},
          {"mean_um", numbers_json(one.mean_um)}};
}

}  // namespace

std::string axis_json(Axis axis) { return std::string(1, letter_of(axis)); }

Json position_json(const Vector3& position_mm) {
  return {{"x_mm", number_or_null(position_mm[0])},
          {"y_mm", number_or_null(position_mm[1])},
          {"z_mm", number_or_null(position_mm[2])}};
}

Json json_of(const EffectInstance& effect) {
  Json out{{"effect", name_of(effect.id)},
           {"axis", effect.axis ? Json(axis_json(*effect.axis)) : Json(nullptr)},
           {"sense", effect.sense ? Json(name_of(*effect.sense)) : Json(nullptr)},
           {"approach", name_of(effect.approach)},
           {"code", effect.code ? Json(name_of(*effect.code)) : Json(nullptr)},
           {"sensor", text_or_null(effect.sensor)},
           {"name", to_text(effect)}};
  if (!effect.sensor2.empty()) out["sensor2"] = effect.sensor2;
  return out;
}

std::optional<EffectInstance> effect_in(const Json& object) {
  const model::EffectId id = model::effect_named(word_in(object, "effect"));
  if (!id) return std::nullopt;
  EffectInstance effect;
  effect.id = id;
  if (const std::string axis = word_in(object, "axis"); axis.size() == 1) effect.axis = axis_of(axis[0]);
  effect.sense = sense_named(word_in(object, "sense"));
  effect.code = component_of(word_in(object, "code"));
  effect.approach = model::approach_mode_named(word_in(object, "approach")).value_or(model::ApproachMode::both);
  effect.sensor = word_in(object, "sensor");
  effect.sensor2 = word_in(object, "sensor2");
  if (effect.is_user()) {
    const std::string name = word_in(object, "name");
    effect.name = name.starts_with("user:") ? name.substr(5) : name;
  }
  return effect;
}

Json json_of(const std::optional<model::LackOfFit>& test) {
  if (!test) return nullptr;
  return {{"F", number_or_null(test->F)}, {"p", number_or_null(test->p)}};
}

Json json_of(const ParameterEstimate& parameter) {
  return {{"name", parameter.name},
          {"unit", parameter.unit},
          {"value", number_or_null(parameter.value)},
          {"sigma", number_or_null(parameter.sigma)},
          {"held", parameter.held},
          {"undetermined", parameter.undetermined}};
}

Json json_of(const std::vector<ParameterEstimate>& parameters) {
  Json out = Json::array();
  for (const ParameterEstimate& one : parameters) out.push_back(json_of(one));
  return out;
}

Json json_of(const model::LadderStep& step) {
  return {{"effect", text_or_null(step.effect)},
          {"data", text_or_null(step.data)},
          {"rms_before_um", number_or_null(step.rms_before_um)},
          {"rms_um", number_or_null(step.rms_um)},
          {"peak_um", number_or_null(step.peak_um)},
          {"noise_um", number_or_null(step.noise_um)},
          {"held_out_rms_um", number_or_null(step.held_out_rms_um)}};
}

Json json_of(const std::vector<model::LadderStep>& history) {
  Json out = Json::array();
  for (const model::LadderStep& step : history) out.push_back(json_of(step));
  return out;
}

Json json_of(const model::FittedCurve& curve) {
  return {{"p_mm", numbers_json(curve.p_mm)}, {"value", numbers_json(curve.value)}};
}

Json json_of(const Diagnosis& d) {
  Json candidates = Json::array(), where = Json::array();
  for (const Candidate& one : d.candidates) candidates.push_back(candidate_json(one));
  for (const model::Dependence& one : d.where) where.push_back(dependence_json(one));
  return {{"observations", d.observations},
          {"rms_um", number_or_null(d.rms_um)},
          {"noise_um", number_or_null(d.noise.noise_um)},
          {"noise_from_repeats", d.noise.from_repeats},
          {"lack_of_fit", json_of(d.lack_of_fit)},
          {"verdict", name_of(d.verdict)},
          {"candidates", std::move(candidates)},
          {"where", std::move(where)},
          {"rms_after_um", number_or_null(d.rms_after_um)},
          {"lack_of_fit_after", json_of(d.lack_of_fit_after)},
          {"outliers", d.outliers},
          {"notes", d.notes},
          {"candidates_tried", d.candidates_tried},
          {"blanks", d.noise_replicates}};
}

}  // namespace ecs::commissioning
