// The tables of `[emulator]` in a machine file, each value checked where it stands; what is wrong stays in the reader.
// Does not live here: what the values mean and the file (emulator.hpp).
#pragma once

#include <limits>
#include <string_view>
#include <variant>
#include <vector>

#include "base/toml_reader.hpp"

namespace ecs::emulator {

enum class Sign { any, not_negative, positive, not_zero };
struct Within {
  double low = 0.0;
  double high = 0.0;
};
/// What a number may be.
using Bounds = std::variant<Sign, Within>;

/// Where a complaint about a key points: what stands under it, else its table.
[[nodiscard]] inline const toml::node& place_of(const toml::table& table, std::string_view key) {
  const toml::node* node = table.get(key);
  return node != nullptr ? *node : table;
}

/// Leaves `value` as it is where the key is absent or wrong.
void number_into(TomlReader& reader, const toml::table& table, std::string_view key, Bounds may, double& value);
/// As number_into(), and complains where the key is absent.
void required_into(TomlReader& reader, const toml::table& table, std::string_view key, Bounds may, double& value);

/// A number of a table, where it goes and what it may be.
struct NumberField {
  const char* key;
  double* value;
  Bounds may = Sign::any;
  double most = std::numeric_limits<double>::infinity();
  bool required = false;
};

[[nodiscard]] inline NumberField required(const char* key, double& value, Bounds may) {
  return {key, &value, may, std::numeric_limits<double>::infinity(), true};
}

/// Reads every field; complains about each key of `table` that is neither a field nor one of `others`.
void numbers_into(TomlReader& reader, const toml::table& table, std::string_view what,
                  const std::vector<NumberField>& fields, std::vector<std::string> others = {});

/// +1 or −1.
void sign_into(TomlReader& reader, const toml::table& table, std::string_view key, int& value);

}  // namespace ecs::emulator
