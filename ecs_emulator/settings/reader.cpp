#include "ecs_emulator/settings/reader.hpp"

#include <array>

#include <fmt/format.h>

namespace ecs::emulator {

void number_into(TomlReader& reader, const toml::table& table, std::string_view key, Bounds may, double& value) {
  const auto found = reader.number(table, key);
  if (!found) return;
  const auto* range = std::get_if<Within>(&may);
  const Sign sign = range != nullptr ? Sign::any : std::get<Sign>(may);
  const bool right = range != nullptr
                         ? *found >= range->low && *found <= range->high
                         : sign == Sign::any || (sign == Sign::not_negative && *found >= 0.0) ||
                               (sign == Sign::positive && *found > 0.0) || (sign == Sign::not_zero && *found != 0.0);
  if (right) {
    value = *found;
    return;
  }
  constexpr std::array<std::string_view, 4> kWanted{"a number", "0 or more", "a number above 0", "anything but 0"};
  const std::string wanted = range != nullptr ? fmt::format("{} to {}", range->low, range->high)
                                              : std::string(kWanted[static_cast<std::size_t>(sign)]);
  reader.complain(*table.get(key), "{}: expected {}, got {}", key, wanted, *found);
}

void required_into(TomlReader& reader, const toml::table& table, std::string_view key, Bounds may, double& value) {
  if (table.contains(key))
    number_into(reader, table, key, may, value);
  else
    reader.complain(table, "{}: expected a number, it is missing", key);
}

void numbers_into(TomlReader& reader, const toml::table& table, std::string_view what,
                  const std::vector<NumberField>& fields, std::vector<std::string> others) {
  for (const NumberField& field : fields) others.emplace_back(field.key);
  reader.only(table, others, what);
  for (const NumberField& field : fields) {
    (field.required ? required_into : number_into)(reader, table, field.key, field.may, *field.value);
    if (*field.value > field.most)
      reader.complain(*table.get(field.key), "{}: expected at most {}, got {}", field.key, field.most, *field.value);
  }
}

void sign_into(TomlReader& reader, const toml::table& table, std::string_view key, int& value) {
  const auto found = reader.number(table, key);
  if (!found) return;
  if (*found == 1.0 || *found == -1.0)
    value = *found > 0.0 ? 1 : -1;
  else
    reader.complain(*table.get(key), "{}: expected 1 or -1, got {}", key, *found);
}

}  // namespace ecs::emulator
