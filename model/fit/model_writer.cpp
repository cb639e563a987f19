// Model files written: the same keys that model_file.cpp reads.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/model_file.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::model {
namespace {

std::string list_of(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double v : values) words.push_back(shortest(v));
  return fmt::format("[{}]", fmt::join(words, ", "));
}

/// `key = { … }`, nothing where there is no value to write.
std::string table_of(std::string_view key, const EffectInstance& effect, const std::map<std::string, double>& values) {
  std::vector<std::string> words;
  for (const auto& [name, value] : values)
    if (!is_left_out(effect, name, value))
      words.push_back(fmt::format("{} = {}", effect.is_user() ? name : shown_name(name, effect), shortest(value)));
  return words.empty() ? std::string() : fmt::format("{} = {{ {} }}\n", key, fmt::join(words, ", "));
}

std::string user_text(const EffectInstance& effect) {
  std::string text = fmt::format("name = {}\n", params::toml_string(effect.name));
  std::vector<std::string> formulas, parameters;
  for (const UserFormula& formula : effect.formulas)
    formulas.push_back(fmt::format("{} = {}", name_of(formula.sense), params::toml_string(formula.text)));
  text += fmt::format("formula = {{ {} }}\n", fmt::join(formulas, ", "));
  for (const UserParameter& p : effect.user) {
    std::vector<std::string> facts;
    if (!p.unit.empty()) facts.push_back(fmt::format("unit = {}", params::toml_string(p.unit)));
    const auto number = [&](const char* key, const std::optional<double>& value) {
      if (value) facts.push_back(fmt::format("{} = {}", key, shortest(*value)));
    };
    number("value", p.value);
    number("start", p.start);
    number("least", p.least);
    number("greatest", p.greatest);
    parameters.push_back(fmt::format("{} = {{ {} }}", p.name, fmt::join(facts, ", ")));
  }
  return text + fmt::format("parameters = {{ {} }}\n", fmt::join(parameters, ", "));
}

/// A comment, so that programs that know no alternatives read the file as well; model_file.cpp reads it.
constexpr std::string_view kAlternatives = "# or";

std::string effect_text(const EffectInstance& effect, std::string_view table) {
  std::string text = fmt::format("\n[[{}]]\n", table);
  if (!effect.tied_with.empty()) text += fmt::format("{} {}\n", kAlternatives, effect.tied_with);
  text += fmt::format("id = \"{}\"\n", name_of(effect.id));
  if (effect.axis) text += fmt::format("axis = \"{}\"\n", axis_letter(effect));
  const auto word = [&](std::string_view key, std::string_view value) {
    if (!value.empty()) text += fmt::format("{} = \"{}\"\n", key, value);
  };
  if (!effect.is_user()) word("sense", sense_text(effect));
  word("code", code_text(effect));
  if (effect.ball > 1) text += fmt::format("ball = {}\n", effect.ball);
  if (effect.line > 0) text += fmt::format("line = {}\n", effect.line);
  if (effect.from_run > 0) text += fmt::format("run = {}\n", effect.from_run);
  if (effect.approach != ApproachMode::both) text += fmt::format("approach = \"{}\"\n", name_of(effect.approach));
  if (!effect.sensor.empty()) text += fmt::format("sensor = {}\n", params::toml_string(effect.sensor));
  if (!effect.sensor2.empty()) text += fmt::format("sensor2 = {}\n", params::toml_string(effect.sensor2));
  if (effect.is_user())
    text += user_text(effect);
  else
    text += table_of("parameters", effect, effect.parameters);
  text += table_of("fitted", effect, effect.fitted);
  if (effect.undetermined) {
    std::vector<std::string> names;
    for (const std::string& name : *effect.undetermined) names.push_back(params::toml_string(name));
    text += fmt::format("undetermined = [{}]\n", fmt::join(names, ", "));
  }
  if (!effect.curve.empty())
    text += fmt::format("curve = {{ {} = {}, value = {} }}\n", shown_name("p_mm", effect), list_of(effect.curve.p_mm),
                        list_of(effect.curve.value));
  return text;
}

/// In quotes where TOML wants them: "t_bed.front_degC".
std::string key_text(const std::string& name) {
  const bool bare = std::ranges::all_of(
      name, [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '-'); });
  return bare ? name : params::toml_string(name);
}

std::string origin_text(const Origin& origin) {
  std::string text = "\n[origin]\n";
  if (origin.time_s) text += fmt::format("time_s = {}\n", shortest(*origin.time_s));
  if (!origin.date.empty()) text += fmt::format("date = {}\n", params::toml_string(origin.date));
  std::vector<std::string> sensors;
  for (const auto& [name, degC] : origin.sensors_degC)
    sensors.push_back(fmt::format("{} = {}", key_text(name), shortest(degC)));
  if (!sensors.empty()) text += fmt::format("temperatures = {{ {} }}\n", fmt::join(sensors, ", "));
  if (origin.air)
    text +=
        fmt::format("air = {{ t_air_degC = {}, pressure_hPa = {}, humidity_pct = {} }}\n", shortest(origin.air->degC),
                    shortest(origin.air->pressure_hPa), shortest(origin.air->humidity_pct));
  return text;
}

}  // namespace

std::string to_toml(const Model& model) {
  std::string text;
  if (!model.name.empty()) text += fmt::format("name = {}\n", params::toml_string(model.name));
  if (model.compensated_readings > 0) text += fmt::format("compensated_readings = {}\n", model.compensated_readings);
  if (!model.map_file.empty())
    text += fmt::format("[map]\nfile = {}\n{}", params::toml_string(model.map_file),
                        model.map_taken_out ? "taken_out = true\n" : "");
  if (model.origin) text += origin_text(*model.origin);
  for (const EffectInstance& effect : model.effects) text += effect_text(effect, "effect");
  for (const EffectInstance& effect : model.candidates) text += effect_text(effect, "candidate");
  for (const KnownComponent& known : model.known)
    text += fmt::format("\n[[known]]\ncode = \"{}\"\np_mm = {}\nvalue = {}\n", name_of(known.code), list_of(known.p_mm),
                        list_of(known.value));
  for (const LadderStep& step : model.history) {
    text += fmt::format(
        "\n[[history]]\neffect = {}\ndata = {}\nrms_before_um = {}\nrms_um = {}\npeak_um = {}\nnoise_um = {}\n",
        params::toml_string(step.effect), params::toml_string(step.data), shortest(step.rms_before_um),
        shortest(step.rms_um), shortest(step.peak_um), shortest(step.noise_um));
    if (step.outliers > 0) text += fmt::format("outliers = {}\n", step.outliers);
    if (step.held_out_rms_um) text += fmt::format("held_out_rms_um = {}\n", shortest(*step.held_out_rms_um));
  }
  return text;
}

Result<void> write_model(const std::filesystem::path& path, const Model& model,
                         const std::filesystem::path& read_from) {
  Model moved = model;
  const std::filesystem::path map(model.map_file);
  if (!model.map_file.empty() && !read_from.empty() && map.is_relative()) {
    std::error_code failed;
    const auto from = std::filesystem::absolute(read_from, failed).parent_path();
    const auto to = std::filesystem::absolute(path, failed).parent_path();
    if (from != to) moved.map_file = (from / map).lexically_relative(to).string();
  }
  return write_file(path, to_toml(moved));
}

}  // namespace ecs::model
