#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "commissioning/models/view.hpp"
#include "laser/csv_columns.hpp"
#include "model/effects/definition.hpp"

namespace ecs::commissioning {
namespace {

using model::EffectInstance;
using model::ParameterEstimate;

}  // namespace

std::string axis_json(Axis axis, bool rotary) { return std::string(1, laser::letter_of(axis, rotary)); }

Cell position_cell(double position_mm) { return {number_or_null(position_mm), position_text(position_mm)}; }

std::string position_layout(bool rotary) {
  std::vector<std::string> columns;
  for (const Axis a : kAllAxes) columns.push_back(fmt::format("{{{}:>10}}", laser::target_column(a, rotary)));
  return fmt::format("{}", fmt::join(columns, " "));
}

void add_position(AnswerFields& fields, const Vector3& position_mm, bool rotary) {
  for (const Axis a : kAllAxes)
    fields.push_back(FieldKey(laser::target_column(a, rotary))(position_cell(position_mm[index_of(a)])));
}

Json position_json(const Vector3& position_mm, bool rotary) {
  Json out = Json::object();
  for (const Axis a : kAllAxes)
    out[std::string(laser::target_column(a, rotary))] = number_or_null(position_mm[index_of(a)]);
  return out;
}

Json numbers_json(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number_or_null(value));
  return out;
}

Json effect_json(const EffectInstance& effect) {
  Json out = object_of("effect"_is(name_of(effect.id)),
                       "axis"_is(effect.axis ? Json(axis_json(*effect.axis, effect.rotary)) : Json(nullptr)),
                       "sense"_is(text_or_null(sense_text(effect))), "approach"_is(name_of(effect.approach)),
                       "code"_is(text_or_null(code_text(effect))), "sensor"_is(text_or_null(effect.sensor)),
                       "name"_is(to_text(effect)));
  if (!effect.sensor2.empty()) out["sensor2"] = effect.sensor2;
  if (effect.ball > 1) out["ball"] = effect.ball;
  if (effect.line > 0) out["line"] = effect.line;
  if (effect.from_run > 0) out["run"] = effect.from_run;
  return out;
}

std::optional<EffectInstance> effect_in(const Json& object) {
  const model::EffectId id = model::effect_named(text_at(object, "effect"));
  if (!id) return std::nullopt;
  EffectInstance effect;
  effect.id = id;
  if (const auto named = laser::axis_named(text_at(object, "axis"))) {
    effect.axis = named->axis;
    effect.rotary = named->rotary;
  }
  effect.sense = sense_named(text_at(object, "sense"));
  static_cast<void>(set_code(effect, text_at(object, "code")));
  if (id->place == model::Place::artefact) effect.rotary = true;
  effect.approach = model::approach_mode_named(text_at(object, "approach")).value_or(model::ApproachMode::both);
  effect.sensor = text_at(object, "sensor");
  effect.sensor2 = text_at(object, "sensor2");
  const auto number = [&](const char* name, int otherwise) {
    const auto found = object.find(name);
    return found != object.end() && found->is_number_integer() ? std::max(otherwise, found->get<int>()) : otherwise;
  };
  effect.ball = number("ball", 1);
  effect.line = number("line", 0);
  effect.from_run = number("run", 0);
  if (effect.is_user()) {
    const std::string name = text_at(object, "name");
    effect.name = name.starts_with("user:") ? name.substr(5) : name;
  }
  return effect;
}

Cell lack_of_fit_cell(const std::optional<model::LackOfFit>& test) {
  if (!test) return null_cell("too few repeats to judge");
  // A p that fails does not measure the misfit: a better model leaves less scatter between the runs, and p falls
  // further.
  const std::string p =
      test->fails() ? "p < 0.0001" : fmt::format("p = {:.1g}{}", test->p, test->is_in_doubt() ? ", below 0.01" : "");
  return record_cell("{word} ({p})", "F"_is(test->F), "p"_is(test->p, p),
                     "word"_shown(test->fails()         ? "the model does not fit"
                                  : test->is_in_doubt() ? "it is doubtful whether the model fits"
                                                        : "the model is not rejected at 1 %"));
}

AnswerFields fields_of(const ParameterEstimate& p) {
  std::string sigma = p.sigma ? few_digits(*p.sigma, 2) : "-";
  if (p.held) sigma = "fixed";
  if (p.undetermined) sigma = "undetermined";
  int digits = 5;
  if (!p.held && !p.undetermined && p.sigma && *p.sigma >= 1e-9)
    digits =
        2 + std::max(0, static_cast<int>(std::floor(std::log10(std::max(std::abs(p.value), *p.sigma) / *p.sigma))));
  return described("name"_is(shown_name(p)), "unit"_is(p.unit),
                   "value"_is(p.value, p.undetermined ? "-" : few_digits(p.value, digits)), "sigma"_is(p.sigma, sigma),
                   "held"_is(p.held), "undetermined"_is(p.undetermined));
}

namespace {

/// "period" of "period_mm"; where the name is its unit alone, the title of the effect, or of one of several parameters
/// its meaning.
std::string label_text(const ParameterEstimate& parameter, const model::EffectInstance& effect) {
  std::string words = model::spoken_name(shown_name(parameter), parameter.unit);
  const auto& all = effect.definition().parameters;
  const auto found = std::ranges::find(all, parameter.name, &model::ParameterDefinition::name);
  if (!words.empty() || found == all.end()) return words;
  words = all.size() == 1 ? title_of(effect) : std::string(found->meaning);
  words.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(words.front())));
  return words;
}

}  // namespace

Cell parameters_cell(const model::EffectFit& effect, std::string_view layout) {
  Cell list{Json::array(), {}};
  for (const ParameterEstimate& one : effect.parameters) {
    AnswerFields fields = fields_of(one);
    fields.push_back("label"_shown(label_text(one, effect.effect)));
    list.add(record_cell(layout, fields));
  }
  return list;
}

Json curve_json(const model::FittedCurve& curve) {
  return object_of("p_mm"_is(numbers_json(curve.p_mm)), "value"_is(numbers_json(curve.value)));
}

}  // namespace ecs::commissioning
