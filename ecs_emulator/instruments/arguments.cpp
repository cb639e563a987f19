#include "ecs_emulator/instruments/arguments.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::emulator {

const nlohmann::json* Arguments::find(const char* key) {
  known_.emplace_back(key);
  const auto at = request_.find(key);
  return at == request_.end() ? nullptr : &*at;
}

void Arguments::complain(std::string message) {
  problems_.push_back({ProblemKind::usage, std::move(message), {}, 0, 0, {}});
}

std::optional<double> Arguments::number(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number()) return value->get<double>();
  complain(fmt::format("{}: expected a number, got {}", key, value->dump()));
  return std::nullopt;
}

std::optional<long long> Arguments::integer(const char* key, long long low, long long high) {
  const auto* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number_integer() && value->get<long long>() >= low && value->get<long long>() <= high)
    return value->get<long long>();
  complain(fmt::format("{}: expected a whole number from {} to {}, got {}", key, low, high, value->dump()));
  return std::nullopt;
}

std::string Arguments::word(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return {};
  if (value->is_string()) return value->get<std::string>();
  complain(fmt::format("{}: expected a text, got {}", key, value->dump()));
  return {};
}

bool Arguments::flag(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return false;
  if (value->is_boolean()) return value->get<bool>();
  complain(fmt::format("{}: expected true or false, got {}", key, value->dump()));
  return false;
}

std::optional<bool> Arguments::zero_or_one(const char* key) {
  const auto value = integer(key, 0, 1);
  return value ? std::optional(*value == 1) : std::nullopt;
}

std::vector<double> Arguments::numbers(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return {};
  if (value->is_array() && std::all_of(value->begin(), value->end(), [](const auto& e) { return e.is_number(); }))
    return value->get<std::vector<double>>();
  complain(fmt::format("{}: expected a list of numbers, got {}", key, value->dump()));
  return {};
}

std::vector<std::string> Arguments::words(const char* key) {
  const auto* value = find(key);
  if (value == nullptr) return {};
  if (value->is_string()) return {value->get<std::string>()};
  if (value->is_array() && std::all_of(value->begin(), value->end(), [](const auto& e) { return e.is_string(); }))
    return value->get<std::vector<std::string>>();
  complain(fmt::format("{}: expected texts, got {}", key, value->dump()));
  return {};
}

std::optional<Axis> Arguments::axis(const char* key) {
  const std::string name = word(key);
  if (name.empty()) return std::nullopt;
  if (name.size() == 1)
    if (const auto axis = axis_of(name.front())) return axis;
  complain(fmt::format("{}: expected X, Y or Z, got \"{}\"", key, name));
  return std::nullopt;
}

PerAxis<std::optional<double>> Arguments::coordinates(const char* object) {
  PerAxis<std::optional<double>> place{};
  if (object == nullptr) {
    place[0] = number("X");
    place[1] = number("Y");
    place[2] = number("Z");
    return place;
  }
  const auto* value = find(object);
  if (value == nullptr) return place;
  if (!value->is_object()) {
    complain(fmt::format("{}: expected {{\"Y\": mm, …}}, got {}", object, value->dump()));
    return place;
  }
  for (const auto& [name, coordinate] : value->items()) {
    const auto axis = name.size() == 1 ? axis_of(name.front()) : std::nullopt;
    if (axis && coordinate.is_number())
      place[index_of(*axis)] = coordinate.get<double>();
    else
      complain(fmt::format("{}: expected X, Y or Z with a number, got \"{}\": {}", object, name, coordinate.dump()));
  }
  return place;
}

Result<void> Arguments::checked() {
  for (const auto& [key, value] : request_.items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string like = nearest_word(key, known_);
    complain(
        fmt::format("no such argument \"{}\"{}", key, like.empty() ? "" : fmt::format("; did you mean \"{}\"?", like)));
  }
  if (problems_.empty()) return {};
  return tl::unexpected(folded(std::move(problems_)));
}

}  // namespace ecs::emulator
