// The mapping of columns as users type it.
#include "laser/import/columns.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/findings.hpp"

namespace ecs::laser {
namespace {

constexpr std::string_view kForm = "FIELD=COLUMN, FIELD=COLUMN[unit] or FIELD=COLUMN*factor, as in x_mm=1[in]";

/// Cut at commas outside double quotes and brackets.
std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && text[i] == '"') quoted = !quoted;
    if (i < text.size() && (quoted || text[i] != ',')) continue;
    parts.push_back(trimmed(text.substr(start, i - start)));
    start = i + 1;
  }
  return parts;
}

/// Takes "[unit]" from the front of `rest`; what is wrong with it, or nothing.
std::string take_unit(ColumnRule& rule, std::string_view& rest) {
  if (!rest.starts_with('[')) return {};
  const std::size_t end = rest.find(']');
  const std::string_view name = trimmed(rest.substr(1, end == std::string_view::npos ? end : end - 1));
  rule.unit = unit_named(name);
  if (end == std::string_view::npos || !rule.unit)
    return fmt::format("expected a unit in brackets ({}), found {}", unit_names(), in_quotes(name));
  rest = trimmed(rest.substr(end + 1));
  return {};
}

/// Takes "*factor" and "+offset" or "-offset".
std::string take_scale(ColumnRule& rule, std::string_view rest) {
  const std::string found = std::string(rest);
  rule.is_scaled = !rest.empty();
  if (rest.starts_with('*')) {
    rest = trimmed(rest.substr(1));
    std::size_t end = rest.find_first_of("+-", 1);
    while (end != std::string_view::npos && (rest[end - 1] == 'e' || rest[end - 1] == 'E'))
      end = rest.find_first_of("+-", end + 1);
    const auto factor = number_in(rest.substr(0, end));
    if (!factor) return "expected a number after *, found " + in_quotes(rest);
    rule.factor = *factor;
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end);
  }
  if (rest.empty()) return {};
  std::string plain;
  for (const char c : rest)
    if (c != ' ') plain += c;
  const auto offset = plain.front() == '+' || plain.front() == '-' ? number_in(plain) : std::nullopt;
  if (!offset) return "expected *factor, +offset or -offset after the column, found " + in_quotes(found);
  rule.offset = *offset;
  return {};
}

/// A column number from the front of `rest`; 0: there is none.
int take_number(std::string_view& rest) {
  const std::size_t end = std::min(rest.find_first_not_of("0123456789"), rest.size());
  const auto number = integer_in(rest.substr(0, end));
  if (!number || *number < 1 || *number > 10'000) return 0;
  rest.remove_prefix(end);
  return static_cast<int>(*number);
}

/// Takes a column number or a range of them, a quoted heading or a plain one from the front.
std::string take_column(ColumnRule& rule, std::string_view& rest) {
  std::size_t end = 0;
  if (rest.starts_with('"')) {
    end = rest.find('"', 1);
    if (end == std::string_view::npos) return "expected a closing double quote after the heading, found none";
    rule.heading = std::string(rest.substr(1, end - 1));
    ++end;
  } else if (!rest.empty() && std::isdigit(static_cast<unsigned char>(rest.front())) != 0) {
    const std::string_view digits = rest.substr(0, rest.find_first_not_of("0123456789"));
    rule.column = take_number(rest);
    if (rule.column == 0) return "expected a column number of 1 to 10000, found " + in_quotes(digits);
    if (rest.starts_with("..")) {
      rest.remove_prefix(2);
      rule.columns = take_number(rest) - rule.column + 1;
      if (rule.columns < 1 || rule.field != "date_time")
        return "expected one column; only date_time takes several, FIRST..LAST";
    }
  } else {
    end = std::min(rest.find_first_of("[*"), rest.size());
    rule.heading = std::string(trimmed(rest.substr(0, end)));
  }
  if (rule.column == 0 && trimmed(rule.heading).empty()) return "expected a column number or a heading, found nothing";
  rest = trimmed(rest.substr(end));
  return {};
}

std::string rule_fault(ColumnRule& rule, std::string_view part) {
  const std::size_t equals = part.find('=');
  if (equals == std::string_view::npos || equals == 0)
    return fmt::format("expected {}, found {}", kForm, in_quotes(part));
  rule.field = std::string(trimmed(part.substr(0, equals)));
  std::string_view rest = trimmed(part.substr(equals + 1));
  if (std::string fault = take_column(rule, rest); !fault.empty()) return fault;
  if (std::string fault = take_unit(rule, rest); !fault.empty()) return fault;
  return take_scale(rule, rest);
}

bool is_word(const ColumnRule& rule, std::string_view field, std::string_view word) {
  return rule.field == field && rule.column == 0 && rule.heading == word;
}

}  // namespace

Result<std::vector<ColumnRule>> column_rules(std::string_view text) {
  std::vector<ColumnRule> rules;
  std::vector<Problem> problems;
  for (const std::string_view part : parts_of(text)) {
    if (part.empty()) continue;
    ColumnRule rule;
    std::string fault = rule_fault(rule, part);
    const auto same = std::find_if(rules.begin(), rules.end(), [&](const auto& r) { return r.field == rule.field; });
    if (fault.empty() && same != rules.end()) fault = "expected each field once, found it again";
    if (!fault.empty())
      problems.push_back({ProblemKind::usage,
                          fmt::format("columns: {}: {}", rule.field.empty() ? "rule" : rule.field, fault),
                          {},
                          0,
                          0,
                          {}});
    rules.push_back(std::move(rule));
  }
  if (rules.empty()) return problem(ProblemKind::usage, fmt::format("columns: expected {}, found nothing", kForm));
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return rules;
}

Result<ColumnMapping> column_mapping(std::string_view text) {
  ECS_TRY(rules, column_rules(text));
  ColumnMapping mapping;
  for (ColumnRule& rule : rules) {
    if (is_word(rule, "approach", "motion"))
      mapping.motion_approach = true;
    else if (is_word(rule, "approach", "none"))
      mapping.no_approach = true;
    else if (is_word(rule, "run", "motion"))
      mapping.motion_run = true;
    else
      mapping.rules.push_back(std::move(rule));
  }
  return mapping;
}

}  // namespace ecs::laser
