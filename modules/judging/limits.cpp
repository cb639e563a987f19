// The limits by which a model will be accepted, from TOML.
#include <cmath>
#include <set>

#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "laser/csv_columns.hpp"
#include "modules/judging/judging.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kMostReadings = 1e6;

/// A number within its bounds, `least` allowed only where it is not above 0.
std::optional<double> bounded(TomlReader& reader, const toml::table& table, const char* key, double least,
                              double greatest, const char* expected) {
  const auto value = reader.number(table, key);
  if (!value) return value;
  if (*value >= least && *value <= greatest && *value > 0.0) return value;
  reader.complain(*table.get(key), "{}: expected {}, got {}", key, expected, shortest(*value));
  return std::nullopt;
}

std::optional<AcceptanceLimit> limit_in(TomlReader& reader, const toml::table& group, const char* kind) {
  const toml::table* table = reader.child(group, kind);
  if (table == nullptr) return std::nullopt;
  constexpr double kMost = 1e9;
  constexpr const char* kExpected = "a limit above 0 and at most 1e9";
  reader.only(*table, {"rms_um", "max_um"}, kind);
  if (!table->contains("rms_um")) reader.complain(*table, "{}: expected rms_um", kind);
  AcceptanceLimit limit;
  limit.rms_um = bounded(reader, *table, "rms_um", 0.0, kMost, kExpected).value_or(0.0);
  limit.max_um = bounded(reader, *table, "max_um", 0.0, kMost, kExpected);
  return limit;
}

/// The nodes of a list that must be there.
const toml::array* list_in(TomlReader& reader, const toml::table& table, const char* key, const char* expected) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return nullptr;
  if (node->is_array() && !node->as_array()->empty()) return node->as_array();
  reader.complain(*node, "{}: expected {}", key, expected);
  return nullptr;
}

std::vector<std::string> values_in(TomlReader& reader, const toml::table& table, const std::string& by,
                                   std::set<std::pair<std::string, std::string>>& taken) {
  std::vector<std::string> values;
  const toml::array* list = list_in(reader, table, "values", "a list of numbers or texts");
  if (list == nullptr) return values;
  for (const toml::node& node : *list) {
    const auto number = node.is_number() ? node.value<double>() : std::nullopt;
    if ((number && !std::isfinite(*number)) || (!number && !node.is_string())) {
      reader.complain(node, "values: expected numbers or texts");
      continue;
    }
    values.push_back(number ? shortest(*number) : *node.value<std::string>());
    if (!taken.emplace(by, values.back()).second)
      reader.complain(node, "values: {} {} is given twice", by, values.back());
  }
  return values;
}

HeldOutGroups groups_in(TomlReader& reader, const toml::table& table,
                        std::set<std::pair<std::string, std::string>>& taken) {
  reader.only(table, {"by", "values", "axis", "sector_deg", "share", "readings", "inside", "beyond"}, "group");
  HeldOutGroups groups;
  groups.line = static_cast<int>(table.source().begin.line);
  groups.by = reader.word(table, "by").value_or("");
  if (!table.contains("by") || (table.get("by")->is_string() && groups.by.empty()))
    reader.complain(table, "by: expected a column, or all, day, half, magnitude, sector, sense, sign");
  groups.values = values_in(reader, table, groups.by, taken);
  if (const auto letter = reader.word(table, "axis")) {
    const auto named = laser::axis_named(*letter);
    if (!named || !named->rotary)
      reader.complain(*table.get("axis"), "axis: expected A, B or C, got \"{}\"", *letter);
    else
      groups.axis = named->axis;
    if (groups.by != "sector" && groups.by != "sign" && groups.by != "magnitude")
      reader.complain(*table.get("axis"), "axis: only with by = \"magnitude\", \"sector\" or \"sign\"");
  }
  if (const auto width = bounded(reader, table, "sector_deg", 1.0, 360.0, "degrees from 1 to 360")) {
    groups.sector_deg = *width;
    if (groups.by != "sector") reader.complain(*table.get("sector_deg"), "sector_deg: only with by = \"sector\"");
    const double parts = 360.0 / *width;
    if (std::abs(parts - std::round(parts)) > 1e-9)
      reader.complain(*table.get("sector_deg"), "sector_deg: expected a part of 360, got {}", *width);
  }
  groups.share = bounded(reader, table, "share", 0.0, 0.9, "a share above 0 and at most 0.9").value_or(0.0);
  if (const auto least = bounded(reader, table, "readings", 4.0, kMostReadings, "a whole number from 4")) {
    groups.readings = static_cast<std::size_t>(*least);
    if (static_cast<double>(groups.readings) != *least)
      reader.complain(*table.get("readings"), "readings: expected a whole number");
  }
  groups.inside = limit_in(reader, table, "inside");
  groups.beyond = limit_in(reader, table, "beyond");
  if (!table.contains("inside") && !table.contains("beyond"))
    reader.complain(table, "group: expected a limit: inside = { rms_um = … }, beyond = { rms_um = … }, or both");
  return groups;
}

void ranges_in(TomlReader& reader, const toml::table& top, JudgingLimits& limits) {
  const toml::table* table = reader.child(top, "inside");
  if (table == nullptr) return;
  for (const auto& [key, node] : *table) {
    const toml::array* pair = node.as_array();
    const auto end = [&](std::size_t k) {
      return pair->get(k)->is_number() ? pair->get(k)->value<double>() : std::nullopt;
    };
    const auto least = pair != nullptr && pair->size() == 2 ? end(0) : std::nullopt;
    const auto greatest = least ? end(1) : std::nullopt;
    if (greatest && std::isfinite(*least) && std::isfinite(*greatest) && *least <= *greatest)
      limits.inside[std::string(key.str())] = {*least, *greatest};
    else
      reader.complain(node, "{}: expected [least, greatest]", key.str());
  }
}

}  // namespace

Result<JudgingLimits> parse_judging_limits(std::string_view text, const std::string& file) {
  TomlReader reader(file);
  ECS_TRY(top, reader.parsed(text));
  reader.only(top, {"zero", "known", "inside", "group"}, "limits");
  JudgingLimits limits;
  if (const auto zero = reader.word(top, "zero")) {
    limits.zero_of_each_run = *zero == "run";
    if (*zero != "run" && *zero != "model")
      reader.complain(*top.get("zero"), "zero: expected \"model\" or \"run\", got \"{}\"", *zero);
  }
  if (const toml::array* known = list_in(reader, top, "known", "a list of effects, such as \"cyclic:X:EX\""))
    for (const toml::node& node : *known) {
      if (const auto effect = node.value<std::string>(); effect && node.is_string())
        limits.known.push_back({*effect, static_cast<int>(node.source().begin.line)});
      else
        reader.complain(node, "known: expected a text, such as \"cyclic:X:EX\"");
    }
  ranges_in(reader, top, limits);
  std::set<std::pair<std::string, std::string>> taken;
  std::map<std::string, bool> whole;
  for (const toml::table* table : reader.children(top, "group")) {
    const HeldOutGroups& groups = limits.groups.emplace_back(groups_in(reader, *table, taken));
    const auto [before, first] = whole.try_emplace(groups.by, groups.values.empty());
    if (!first && (before->second || groups.values.empty()))
      reader.complain(*table, "by: {} is given twice; give each its values", groups.by);
  }
  if (!top.contains("group")) reader.complain(1, "expected at least one [[group]]");
  if (!reader.clean()) return tl::unexpected(reader.all());
  return limits;
}

}  // namespace ecs::commissioning
