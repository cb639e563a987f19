#include "params/diff.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "params/fields.hpp"

namespace ecs::params {
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
