#include "params/flat_toml.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/toml_reader.hpp"

namespace ecs::params {
namespace {

std::string joined(const std::string& path, std::string_view part) {
  const bool plain = part.find_first_of(". \t\"'") == std::string_view::npos && !part.empty();
  const std::string shown_part = plain ? std::string(part) : toml_string(part);
  return path.empty() ? shown_part : path + "." + shown_part;
}

std::optional<std::vector<double>> numbers_in(const toml::array& array) {
  std::vector<double> numbers;
  for (const toml::node& node : array) {
    if (!node.is_number()) return std::nullopt;
    numbers.push_back(*node.value<double>());
  }
  return numbers;
}

decltype(TomlEntry::value) value_of(const toml::node& node) {
  if (node.is_table()) return TomlTable{};
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  if (const auto* whole = node.as_integer()) return static_cast<long long>(whole->get());
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* array = node.as_array())
    if (auto numbers = numbers_in(*array)) return std::move(*numbers);
  return TomlOther{};
}

/// Tables deeper than any of ours are named, not entered.
constexpr int kDeepest = 16;

void flatten(const toml::table& table, const std::string& path, int depth, std::vector<TomlEntry>& entries) {
  for (const auto& [key, node] : table) {
    const std::string full = joined(path, key.str());
    const auto place = node.source().begin;
    entries.push_back({full, value_of(node), static_cast<int>(place.line), static_cast<int>(place.column)});
    if (const auto* inner = node.as_table(); inner != nullptr && depth < kDeepest)
      flatten(*inner, full, depth + 1, entries);
  }
}

}  // namespace

Result<std::vector<TomlEntry>> flat_toml(std::string_view text, const std::string& name) {
  ECS_TRY(document, parse_toml(text, name));
  std::vector<TomlEntry> entries;
  flatten(document, "", 1, entries);
  return entries;
}

void sort_by_place(std::vector<Problem>& problems) {
  std::ranges::stable_sort(problems, [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

std::string shown(const TomlEntry& entry) {
  struct Show {
    std::string operator()(bool truth) const { return truth ? "true" : "false"; }
    std::string operator()(long long whole) const { return fmt::format("{}", whole); }
    std::string operator()(double real) const { return shortest(real); }
    std::string operator()(const std::string& text) const { return toml_string(text); }
    std::string operator()(const std::vector<double>& list) const { return fmt::format("[{}]", fmt::join(list, ", ")); }
    std::string operator()(TomlTable) const { return "a table"; }
    std::string operator()(TomlOther) const { return "a value of another kind"; }
  };
  return std::visit(Show{}, entry.value);
}

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (code < 0x20 || code == 0x7f) {
      quoted += fmt::format("\\u{:04X}", code);
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string toml_float(double value) {
  std::string text = shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

}  // namespace ecs::params
