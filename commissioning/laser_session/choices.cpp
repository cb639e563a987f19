#include "commissioning/laser_session/choices.hpp"

#include <utility>

#include "base/json.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::commissioning {
namespace {

Json json_of(const LaserLineChoice& line) {
  Json runs = Json::array(), readings = Json::array();
  for (const auto& [run, reason] : line.runs) runs.push_back({run, reason});
  for (const auto& [place, reason] : line.readings) readings.push_back({place, reason});
  return {{"runs", runs}, {"readings", readings}};
}

Json json_of(const LaserComponentChoice& component) {
  Json object{{"smoothing_mm", component.smoothing_mm}, {"zero_reason", component.zero_reason}};
  if (component.slope) object["slope"] = laser::name_of(*component.slope);
  if (component.increment_mm) object["increment_mm"] = *component.increment_mm;
  return object;
}

Json json_of(const LaserHeaderChoice& h) {
  return {{"customer", h.customer}, {"machine", h.machine}, {"serial_number", h.serial_number},
          {"engineer", h.engineer}, {"date", h.date},       {"remarks", h.remarks}};
}

LaserLineChoice line_in(const Json& object) {
  LaserLineChoice line;
  for (const Json& one : object.at("runs")) line.runs.emplace(one.at(0).get<int>(), one.at(1).get<std::string>());
  for (const Json& one : object.at("readings"))
    line.readings.emplace(one.at(0).get<std::size_t>(), one.at(1).get<std::string>());
  return line;
}

LaserComponentChoice component_in(const Json& object) {
  LaserComponentChoice component;
  component.smoothing_mm = object.at("smoothing_mm").get<double>();
  component.zero_reason = object.at("zero_reason").get<std::string>();
  if (object.contains("slope")) component.slope = laser::slope_method_named(object["slope"].get<std::string>());
  if (object.contains("increment_mm")) component.increment_mm = object["increment_mm"].get<double>();
  return component;
}

LaserHeaderChoice header_in(const Json& h) {
  return {h.at("customer").get<std::string>(),      h.at("machine").get<std::string>(),
          h.at("serial_number").get<std::string>(), h.at("engineer").get<std::string>(),
          h.at("date").get<std::string>(),          h.at("remarks").get<std::string>()};
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
  for (const auto& [code, component] : object.at("components").items())
    choices.components[code] = component_in(component);
  choices.params_file = object.at("params").get<std::string>();
  choices.scope = object.at("scope").get<std::string>();
  choices.header = header_in(object.at("header"));
  choices.map_file = object.at("map").get<std::string>();
  choices.opened_map = object.value("opened_map", "");
  return choices;
}

}  // namespace

std::string choices_text(const LaserChoices& choices) {
  Json object{{"files", Json::array()},        {"lines", Json::object()},         {"components", Json::object()},
              {"params", choices.params_file}, {"scope", choices.scope},          {"header", json_of(choices.header)},
              {"map", choices.map_file},       {"opened_map", choices.opened_map}};
  for (const LaserFileChoice& file : choices.files)
    object["files"].push_back({{"path", file.path}, {"answers", given_answers(file.answers)}, {"places", file.places}});
  for (const auto& [key, line] : choices.lines)
    if (!(line == LaserLineChoice{})) object["lines"][key] = json_of(line);
  for (const auto& [code, component] : choices.components)
    if (!(component == LaserComponentChoice{})) object["components"][code] = json_of(component);
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
