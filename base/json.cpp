#include "base/json.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs {

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json number_or_null(const std::optional<double>& value) { return value ? number_or_null(*value) : Json(nullptr); }
Json text_or_null(std::string_view text) { return text.empty() ? Json(nullptr) : Json(std::string(text)); }

Json json_in(std::string_view text) {
  constexpr int kDeepest = 100;
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size() && depth <= kDeepest; ++i) {
    const char c = text[i];
    if (in_text && c == '\\') ++i;
    if (c == '"') in_text = !in_text;
    if (!in_text && (c == '[' || c == '{')) ++depth;
    if (!in_text && (c == ']' || c == '}')) --depth;
  }
  return depth > kDeepest ? Json(Json::value_t::discarded) : Json::parse(text, nullptr, false);
}

std::string one_line(const Json& value) {
  return shown_json(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json problem_json(const Problem& problem) {
  Json out;
  out["message"] = problem.message;
  out["file"] = text_or_null(problem.file);
  out["line"] = problem.line > 0 ? Json(problem.line) : Json(nullptr);
  out["column"] = problem.column > 0 ? Json(problem.column) : Json(nullptr);
  for (const Problem& other : problem.also) out["also"].push_back(problem_json(other));
  return out;
}

std::string hex_address(std::uint32_t address) { return fmt::format("0x{:06X}", address); }

}  // namespace ecs
