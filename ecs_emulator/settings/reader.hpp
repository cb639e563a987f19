// The tables of `[emulator]` in a machine file, each value checked where it stands; what is wrong stays in the reader.
// Does not live here: what the values mean and the file (emulator.hpp).
#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include "base/toml_reader.hpp"
#include "ecs_emulator/settings/emulator.hpp"

namespace ecs::emulator {

enum class Sign { any, not_negative, positive, not_zero };

/// Leaves `value` as it is where the key is absent or wrong.
void number_into(TomlReader& reader, const toml::table& table, std::string_view key, Sign sign, double& value);
/// As number_into(), and complains where the key is absent.
void required_into(TomlReader& reader, const toml::table& table, std::string_view key, Sign sign, double& value);

/// A number of a table, where it goes and what it may be.
struct NumberField {
  const char* key;
  double* value;
  Sign sign = Sign::any;
  double most = std::numeric_limits<double>::infinity();
  bool required = false;
};

[[nodiscard]] inline NumberField required(const char* key, double& value, Sign sign) {
  return {key, &value, sign, std::numeric_limits<double>::infinity(), true};
}

/// Reads every field; complains about each key of `table` that is neither a field nor one of `others`.
void numbers_into(TomlReader& reader, const toml::table& table, std::string_view what,
                  const std::vector<NumberField>& fields, std::vector<std::string> others = {});

/// +1 or −1.
void sign_into(TomlReader& reader, const toml::table& table, std::string_view key, int& value);

/// `[emulator.axis.X]`
[[nodiscard]] AxisSettings read_axis_settings(TomlReader& reader, const toml::table& table);
/// `[emulator.laser]`
[[nodiscard]] LaserSettings read_laser_settings(TomlReader& reader, const toml::table& table);

}  // namespace ecs::emulator
