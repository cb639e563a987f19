#include "base/settings.hpp"

#include <cstdlib>

#include "base/file.hpp"
#include "base/toml_reader.hpp"

namespace ecs {
namespace {

std::string variable_or_empty(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

}  // namespace

std::filesystem::path settings_file() {
  const std::string config_home = variable_or_empty("XDG_CONFIG_HOME");
  const std::filesystem::path folder = config_home.empty()
                                           ? std::filesystem::path(variable_or_empty("HOME")) / ".config"
                                           : std::filesystem::path(config_home);
  return folder / "ecs" / "config.toml";
}

Result<std::optional<std::string>> setting(std::string_view key) {
  const std::filesystem::path path = settings_file();
  if (!disc::exists(path)) return std::optional<std::string>();
  ECS_TRY(text, read_file(path));
  ECS_TRY(table, parse_toml(text, path.string()));
  const auto* node = table.get(key);
  if (node == nullptr) return std::optional<std::string>();
  const auto value = node->value<std::string>();
  if (!node->is_string() || !value)
    return problem_at(path.string(), static_cast<int>(node->source().begin.line),
                      static_cast<int>(node->source().begin.column), "{}: expected a text in quotes", key);
  return value;
}

std::string setting_or_empty(const char* variable, std::string_view key) {
  if (std::string value = variable_or_empty(variable); !value.empty()) return value;
  const auto set = setting(key);
  return set ? set->value_or("") : "";
}

}  // namespace ecs
