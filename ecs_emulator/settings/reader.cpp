#include "ecs_emulator/settings/reader.hpp"

#include <array>

#include <fmt/format.h>

namespace ecs::emulator {

void number_into(TomlReader& reader, const toml::table& table, std::string_view key, Sign sign, double& value) {
  const auto found = reader.number(table, key);
  if (!found) return;
  const bool right = sign == Sign::any || (sign == Sign::not_negative && *found >= 0.0) ||
                     (sign == Sign::positive && *found > 0.0) || (sign == Sign::not_zero && *found != 0.0);
  if (right) {
    value = *found;
    return;
  }
  constexpr std::array<std::string_view, 4> kWanted{"a number", "0 or more", "a number above 0", "anything but 0"};
  reader.complain(*table.get(key),
                  fmt::format("{}: expected {}, got {}", key, kWanted[static_cast<std::size_t>(sign)], *found));
}

/// +1 or −1.
void sign_into(TomlReader& reader, const toml::table& table, std::string_view key, int& value) {
  const auto found = reader.number(table, key);
  if (!found) return;
  if (*found == 1.0 || *found == -1.0)
    value = *found > 0.0 ? 1 : -1;
  else
    reader.complain(*table.get(key), fmt::format("{}: expected 1 or -1, got {}", key, *found));
}

}  // namespace ecs::emulator
