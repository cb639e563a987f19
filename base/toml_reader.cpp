#include "base/toml_reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/plain_text.hpp"
#include "base/text.hpp"

namespace ecs {

Result<toml::table> TomlReader::parsed(std::string_view text) const {
  if (auto why = why_no_text(text, file_)) return tl::unexpected(std::move(*why));
  try {
    return toml::parse(text, std::string_view(file_));
  } catch (const toml::parse_error& error) {
    const auto at = error.source().begin;
    return problem_at(file_, static_cast<int>(at.line), static_cast<int>(at.column),
                      fmt::format("expected TOML: {}", error.description()));
  }
}

void TomlReader::complain(const toml::node& at, std::string message) {
  const auto begin = at.source().begin;
  problems_.push_back({ProblemKind::bad_input,
                       std::move(message),
                       file_,
                       static_cast<int>(begin.line),
                       static_cast<int>(begin.column),
                       {}});
}

void TomlReader::complain(int line, std::string message) {
  problems_.push_back({ProblemKind::bad_input, std::move(message), file_, line, 0, {}});
}

void TomlReader::only(const toml::table& table, const std::vector<std::string>& known, std::string_view what) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string like = nearest_word(name, known);
    complain(node, like.empty() ? fmt::format("{}: expected one of {}, got \"{}\"", what, fmt::join(known, ", "), name)
                                : fmt::format("{}: no such key \"{}\"; did you mean \"{}\"?", what, name, like));
  }
}

std::optional<double> TomlReader::number(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  if (const auto value = node->value<double>(); node->is_number() && value && std::isfinite(*value)) return *value;
  complain(*node, fmt::format("{}: expected a finite number", key));
  return std::nullopt;
}

std::optional<std::string> TomlReader::word(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* text = node->as_string()) return text->get();
  complain(*node, fmt::format("{}: expected a text in quotes", key));
  return std::nullopt;
}

std::vector<const toml::table*> TomlReader::children(const toml::table& table, std::string_view key) {
  std::vector<const toml::table*> found;
  const toml::node* node = table.get(key);
  if (node == nullptr) return found;
  if (!node->is_array_of_tables()) {
    complain(*node, fmt::format("{}: expected [[{}]] tables", key, key));
    return found;
  }
  for (const toml::node& each : *node->as_array()) found.push_back(each.as_table());
  return found;
}

const toml::table* TomlReader::child(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return nullptr;
  if (const auto* inner = node->as_table()) return inner;
  complain(*node, fmt::format("{}: expected a table", key));
  return nullptr;
}

}  // namespace ecs
