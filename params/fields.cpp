#include "params/fields.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/words.hpp"

namespace ecs::params {
namespace {

const std::unordered_map<std::string_view, const Field*>& by_key() {
  static const auto index = [] {
    std::unordered_map<std::string_view, const Field*> map;
    for (const Field& field : fields()) map.emplace(field.key, &field);
    return map;
  }();
  return index;
}

std::vector<std::string> keys_ending_in(std::string_view last_part) {
  std::vector<std::string> found;
  const std::string tail = "." + lower(last_part);
  for (const Field& field : fields()) {
    const std::string key = lower(field.key);
    if (key.size() > tail.size() && key.ends_with(tail)) found.push_back(field.key);
  }
  return found;
}

std::string quoted_list(const std::vector<std::string>& words) {
  return fmt::format("\"{}\"", fmt::join(words, "\" or \""));
}

std::string with_unit(std::string text, const Field& field) {
  return field.unit.empty() ? text : text + " " + field.unit;
}

tl::unexpected<Problem> refused(const Field& field, std::string_view expected, std::string_view found) {
  return problem(ProblemKind::usage, "{}: expected {}, found \"{}\"", field.key, expected, found);
}

/// `text` without the field's own unit at its end.
std::string_view without_unit(std::string_view text, const Field& field) {
  text = trimmed(text);
  if (!field.unit.empty() && text.size() > field.unit.size() && text.ends_with(field.unit))
    text.remove_suffix(field.unit.size());
  return trimmed(text);
}

std::optional<double> choice_in(const Field& field, std::string_view text) {
  for (std::size_t i = 0; i < field.choices.size(); ++i)
    if (lower(field.choices[i]) == lower(text)) return static_cast<double>(i);
  return std::nullopt;
}

std::optional<double> value_in(const Field& field, std::string_view text) {
  switch (field.type) {
    case FieldType::choice:
      return choice_in(field, text);
    case FieldType::truth:
      return text == "true" ? std::optional(1.0) : text == "false" ? std::optional(0.0) : std::nullopt;
    case FieldType::integer:
      if (const auto whole = integer_in(text)) return static_cast<double>(*whole);
      return std::nullopt;
    default:
      return number_in(text);
  }
}

}  // namespace

std::string_view name_of(Group group) {
  return WordTable<Group, 3>{{"configuration", "compensation", "datuming"}}.of(group);
}

std::string_view name_of(FieldType type) {
  return WordTable<FieldType, 5>{{"text", "choice", "number", "integer", "true/false"}}.of(type);
}

const std::vector<Field>& fields() {
  static const std::vector<Field> table = field_table();
  return table;
}

const Field* field_named(std::string_view key) {
  const auto found = by_key().find(key);
  return found == by_key().end() ? nullptr : found->second;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_word(word, candidates);
  return nearest.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", nearest);
}

std::string did_you_mean_key(std::string_view key) {
  const auto ending = keys_ending_in(key);
  if (!ending.empty()) return fmt::format(" (did you mean {}?)", quoted_list(ending));
  std::vector<std::string> keys;
  for (const Field& field : fields()) keys.push_back(field.key);
  return did_you_mean(key, keys);
}

Result<const Field*> find_field(std::string_view key) {
  if (const Field* field = field_named(key)) return field;
  return problem(ProblemKind::usage, "\"{}\": there is no such parameter{}; `ecs params show` lists them all", key,
                 did_you_mean_key(key));
}

std::string text_of(const Field& field, const UnitParameters& parameters) {
  if (field.type == FieldType::text) return field.get_text(parameters);
  const double value = field.get(parameters);
  if (field.type == FieldType::truth) return value != 0.0 ? "true" : "false";
  if (field.type != FieldType::choice) return shortest(value);
  if (value >= 0.0 && value <= field.most) return field.choices[static_cast<std::size_t>(value)];
  return fmt::format("invalid ({})", shortest(value));
}

std::optional<double> number_of(const Field& field, const UnitParameters& parameters) {
  if (field.type == FieldType::text) return std::nullopt;
  return field.get(parameters);
}

std::string default_text(const Field& field) { return text_of(field, UnitParameters{}); }

std::string range_text(const Field& field) {
  switch (field.type) {
    case FieldType::text:
      return field.accepts;
    case FieldType::choice:
      return fmt::format("{}", fmt::join(field.choices, " or "));
    case FieldType::truth:
      return "true or false";
    default:
      break;
  }
  const std::string most = shortest(field.most);
  if (field.zero_allowed) return with_unit(shortest(field.least) + " to " + most, field);
  if (field.type == FieldType::integer) return shortest(field.least) + " or " + most;
  if (field.least < 0.0) return with_unit(shortest(field.least) + " to " + most, field) + " except 0";
  return "above 0, up to " + with_unit(most, field);
}

std::string objection_to_number(const Field& field, double value) {
  const bool whole = field.type == FieldType::number || std::trunc(value) == value;
  const bool inside = value >= field.least && value <= field.most && (field.zero_allowed || value != 0.0);
  if (std::isfinite(value) && whole && inside) return {};
  return fmt::format("expected {}, found {}", range_text(field), shortest(value));
}

std::string objection(const Field& field, const UnitParameters& parameters) {
  if (field.type == FieldType::choice && !objection_to_number(field, field.get(parameters)).empty())
    return fmt::format("expected {}, found a code that is none of them", range_text(field));
  if (field.type != FieldType::text) return objection_to_number(field, field.get(parameters));
  UnitParameters copy = parameters;
  const std::string held = field.get_text(parameters);
  if (field.put_text(copy, held)) return {};
  return fmt::format("expected {}, found \"{}\"", range_text(field), held);
}

Result<void> set_text(const Field& field, UnitParameters& parameters, std::string_view text) {
  const std::string_view bare = without_unit(text, field);
  if (field.type == FieldType::text) {
    if (!field.put_text(parameters, bare)) return refused(field, range_text(field), text);
    return {};
  }
  const auto value = value_in(field, bare);
  if (!value) return refused(field, range_text(field) + did_you_mean(bare, field.choices), text);
  return set_number(field, parameters, *value);
}

Result<void> set_number(const Field& field, UnitParameters& parameters, double value) {
  if (field.type == FieldType::text) return refused(field, range_text(field), shortest(value));
  const std::string reason = objection_to_number(field, value);
  if (!reason.empty()) return problem(ProblemKind::usage, "{}: {}", field.key, reason);
  field.put(parameters, value);
  return {};
}

Result<void> set(UnitParameters& parameters, std::string_view key, std::string_view text) {
  ECS_TRY(field, find_field(trimmed(key)));
  return set_text(*field, parameters, text);
}

namespace {

std::string with_unit(const std::string& value, const std::string& unit) {
  return unit.empty() ? value : value + " " + unit;
}

}  // namespace

std::vector<Difference> diff(const UnitParameters& a, const UnitParameters& b) {
  std::vector<Difference> differences;
  for (const Field& field : fields()) {
    Difference found{field.key, field.unit, text_of(field, a), text_of(field, b)};
    if (found.a != found.b) differences.push_back(std::move(found));
  }
  return differences;
}

std::string to_text(const std::vector<Difference>& differences, std::string_view name_a, std::string_view name_b) {
  if (differences.empty()) return {};
  std::size_t key_width = 0;
  std::size_t a_width = name_a.size();
  for (const Difference& d : differences) {
    key_width = std::max(key_width, d.key.size());
    a_width = std::max(a_width, with_unit(d.a, d.unit).size());
  }
  std::string text = fmt::format("{:{}}  {:{}}  {}\n", "", key_width, name_a, a_width, name_b);
  for (const Difference& d : differences)
    text +=
        fmt::format("{:{}}  {:{}}  {}\n", d.key, key_width, with_unit(d.a, d.unit), a_width, with_unit(d.b, d.unit));
  return text;
}

}  // namespace ecs::params
