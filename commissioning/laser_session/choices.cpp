#include "commissioning/laser_session/choices.hpp"

#include <array>
#include <utility>

#include "base/json.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::array<std::pair<const char*, std::string laser::MapRecipe::*>, 6> kHeaderKeys{
    {{"customer", &laser::MapRecipe::customer},
     {"machine", &laser::MapRecipe::machine},
     {"serial_number", &laser::MapRecipe::serial_number},
     {"engineer", &laser::MapRecipe::engineer},
     {"date", &laser::MapRecipe::date},
     {"remarks", &laser::MapRecipe::remark}}};

Json json_of(const LaserLineChoice& line) {
  Json runs = Json::array(), readings = Json::array();
  for (const auto& [run, reason] : line.runs) runs.push_back({run, reason});
  for (const auto& [place, reason] : line.readings) readings.push_back({place, reason});
  return {{"runs", runs}, {"readings", readings}};
}

LaserLineChoice line_in(const Json& object) {
  LaserLineChoice line;
  for (const Json& one : object.at("runs")) line.runs.emplace(one.at(0).get<int>(), one.at(1).get<std::string>());
  for (const Json& one : object.at("readings"))
    line.readings.emplace(one.at(0).get<std::size_t>(), one.at(1).get<std::string>());
  return line;
}

/// By code: what is done to it, or why it is declared zero.
std::map<std::string, Json> components_of(const laser::MapRecipe& recipe) {
  std::map<std::string, Json> components;
  for (std::size_t k = 0; k < kComponents; ++k) {
    const auto component = static_cast<Component>(k);
    const laser::ComponentRecipe one = laser::settings_of(recipe, component);
    const std::string reason = laser::zero_reason(recipe, component);
    if (one == laser::settings_of({}, component) && reason.empty()) continue;
    Json& object = components[std::string(name_of(component))];
    object = {{"smoothing_mm", one.smoothing_mm}, {"zero_reason", reason}};
    if (one.slope) object["slope"] = laser::name_of(*one.slope);
    if (one.increment_mm) object["increment_mm"] = *one.increment_mm;
  }
  return components;
}

void take_component(laser::MapRecipe& recipe, Component component, const Json& object) {
  laser::ComponentRecipe& one = laser::settings_in(recipe, component);
  one.smoothing_mm = object.at("smoothing_mm").get<double>();
  laser::declare_zero(recipe, component, object.at("zero_reason").get<std::string>());
  if (object.contains("slope")) one.slope = laser::slope_method_named(object["slope"].get<std::string>());
  if (object.contains("increment_mm")) one.increment_mm = object["increment_mm"].get<double>();
}

LaserChoices choices_of(const Json& object) {
  LaserChoices choices;
  for (const Json& one : object.at("files")) {
    LaserFileChoice file{one.at("path").get<std::string>(), {}};
    for (const auto& [name, value] : one.at("answers").items()) (void)set_answer(file.answers, name, value);
    file.places = one.value("places", file.places);
    choices.files.push_back(std::move(file));
  }
  for (const auto& [key, line] : object.at("lines").items()) choices.lines[key] = line_in(line);
  for (const auto& [code, one] : object.at("components").items())
    if (const auto component = component_of(code)) take_component(choices.recipe, *component, one);
  choices.params_file = object.at("params").get<std::string>();
  choices.scope = object.at("scope").get<std::string>();
  for (const auto& [key, member] : kHeaderKeys) choices.recipe.*member = object.at("header").at(key).get<std::string>();
  choices.map_file = object.at("map").get<std::string>();
  choices.opened_map = object.value("opened_map", "");
  return choices;
}

}  // namespace

std::string choices_text(const LaserChoices& choices) {
  Json header;
  for (const auto& [key, member] : kHeaderKeys) header[key] = choices.recipe.*member;
  Json object{
      {"files", Json::array()},        {"lines", Json::object()},         {"components", components_of(choices.recipe)},
      {"params", choices.params_file}, {"scope", choices.scope},          {"header", header},
      {"map", choices.map_file},       {"opened_map", choices.opened_map}};
  for (const LaserFileChoice& file : choices.files)
    object["files"].push_back({{"path", file.path}, {"answers", given_answers(file.answers)}, {"places", file.places}});
  for (const auto& [key, line] : choices.lines)
    if (!(line == LaserLineChoice{})) object["lines"][key] = json_of(line);
  return one_line(object);
}

std::optional<LaserChoices> choices_in(const std::string& text) {
  try {
    return choices_of(Json::parse(text));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace ecs::commissioning
