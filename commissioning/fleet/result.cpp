#include "commissioning/fleet/result.hpp"

#include "base/json.hpp"

namespace ecs::commissioning {
namespace {

std::string word_or_none(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<double> number_or_none(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

}  // namespace

std::string to_line(const FleetResult& result) {
  if (!result.error.empty()) {
    Json error{{"id", text_or_null(result.id)}, {"error", result.error}};
    if (result.doubled) error["doubled"] = true;
    return one_line(error);
  }
  Json causes = Json::array();
  for (const FleetCause& cause : result.causes)
    causes.push_back({{"name", cause.name},
                      {"probability", number_or_null(cause.probability)},
                      {"e_value", number_or_null(cause.e_value)},
                      {"false_naming", number_or_null(cause.false_naming)},
                      {"p_value", number_or_null(cause.p_value)},
                      {"standing", cause.standing}});
  return one_line({{"id", result.id},
                   {"hash", result.hash},
                   {"verdict", result.verdict},
                   {"p_value", number_or_null(result.p_value)},
                   {"causes", std::move(causes)},
                   {"type", text_or_null(result.type)},
                   {"batch", text_or_null(result.batch)},
                   {"processor_s", number_or_null(result.processor_s)}});
}

std::optional<FleetResult> result_in(std::string_view line) {
  const Json object = Json::parse(line, nullptr, false);
  if (!object.is_object() || !object.contains("id")) return std::nullopt;
  FleetResult result;
  result.id = word_or_none(object, "id");
  result.error = word_or_none(object, "error");
  result.doubled = !result.error.empty() && object.contains("doubled");
  if (!result.error.empty()) return result;
  result.hash = word_or_none(object, "hash");
  result.verdict = word_or_none(object, "verdict");
  if (result.id.empty() || result.hash.empty() || result.verdict.empty()) return std::nullopt;
  result.type = word_or_none(object, "type");
  result.batch = word_or_none(object, "batch");
  result.processor_s = number_or_none(object, "processor_s").value_or(0.0);
  result.p_value = number_or_none(object, "p_value");
  const auto causes = object.find("causes");
  if (causes == object.end() || !causes->is_array()) return std::nullopt;
  for (const Json& one : *causes) {
    FleetCause cause;
    cause.name = one.is_object() ? word_or_none(one, "name") : std::string();
    if (cause.name.empty()) return std::nullopt;
    cause.probability = number_or_none(one, "probability").value_or(0.0);
    cause.e_value = number_or_none(one, "e_value");
    cause.false_naming = number_or_none(one, "false_naming").value_or(1.0);
    cause.p_value = number_or_none(one, "p_value");
    if (const std::string standing = word_or_none(one, "standing"); !standing.empty()) cause.standing = standing;
    result.causes.push_back(std::move(cause));
  }
  return result;
}

}  // namespace ecs::commissioning
