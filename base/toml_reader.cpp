#include "base/toml_reader.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"

namespace ecs {

namespace {

constexpr int kMostParts = 32;            ///< of a dotted key
constexpr int kMostNested = 32;           ///< brackets and braces
constexpr std::size_t kMostUnknown = 20;  ///< keys named, the rest is counted

/// Reads over strings and comments and counts what nests outside of them.
class NestingScan {
 public:
  explicit NestingScan(std::string_view text) : text_(text) {}

  /// Line of the first place that nests too deeply; 0: none.
  [[nodiscard]] int line_too_deep() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        take(c);
      if (parts_ > kMostParts || nested_ > kMostNested) return line_;
    }
    return 0;
  }

 private:
  void take(char c) {
    ++at_;
    if (c == '.') ++parts_;
    if (c == '[' || c == '{') ++nested_;
    if (c == ']' || c == '}') --nested_;
    if (c == '\n') ++line_;
    if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) parts_ = 1;
  }
  /// From its first quote on to behind its end, or to the end of a text that does not close it.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool long_string = text_.substr(at_, 3) == three;
    at_ += long_string ? 3 : 1;
    while (at_ < text_.size()) {
      if (long_string ? text_.substr(at_, 3) == three : text_[at_] == quote || text_[at_] == '\n') break;
      if (text_[at_] == '\n') ++line_;
      at_ += quote == '"' && text_[at_] == '\\' ? 2u : 1u;
    }
    if (at_ < text_.size() && text_[at_] == '\n') return;
    at_ = std::min(at_ + (long_string ? 3 : 1), text_.size());
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  int parts_ = 1;
  int nested_ = 0;
};

}  // namespace

Result<toml::table> parse_toml(std::string_view text, const std::string& file) {
  if (auto why = why_no_text(text, file)) return tl::unexpected(std::move(*why));
  if (const int line = NestingScan(text).line_too_deep(); line > 0)
    return problem_at(file, line, 0, "expected keys of at most {} parts and values nested at most {} deep", kMostParts,
                      kMostNested);
  try {
    return toml::parse(text, std::string_view(file));
  } catch (const toml::parse_error& error) {
    const auto at = error.source().begin;
    return problem_at(file, static_cast<int>(at.line), static_cast<int>(at.column), "not valid TOML: {}",
                      error.description());
  } catch (const std::exception& error) {
    return problem_at(file, 0, 0, "not valid TOML: {}", error.what());
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
  std::size_t unknown = 0;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (++unknown > kMostUnknown) continue;
    const std::string like = nearest_word(name, known);
    complain(node, like.empty() ? fmt::format("{}: expected one of {}, got \"{}\"", what, fmt::join(known, ", "), name)
                                : fmt::format("{}: no such key \"{}\"; did you mean \"{}\"?", what, name, like));
  }
  if (unknown > kMostUnknown) complain(table, "{}: {} more unknown keys", what, unknown - kMostUnknown);
}

std::optional<double> TomlReader::number(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  if (const auto value = node->value<double>(); node->is_number() && value && std::isfinite(*value)) return *value;
  complain(*node, "{}: expected a finite number", key);
  return std::nullopt;
}

std::optional<std::string> TomlReader::word(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* text = node->as_string()) return text->get();
  complain(*node, "{}: expected a text in quotes", key);
  return std::nullopt;
}

std::vector<const toml::table*> TomlReader::children(const toml::table& table, std::string_view key) {
  std::vector<const toml::table*> found;
  const toml::node* node = table.get(key);
  if (node == nullptr) return found;
  if (!node->is_array_of_tables()) {
    complain(*node, "{}: expected [[{}]] tables", key, key);
    return found;
  }
  for (const toml::node& each : *node->as_array()) found.push_back(each.as_table());
  return found;
}

const toml::table* TomlReader::child(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return nullptr;
  if (const auto* inner = node->as_table()) return inner;
  complain(*node, "{}: expected a table", key);
  return nullptr;
}

}  // namespace ecs
