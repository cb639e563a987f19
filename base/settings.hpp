// What a user has set once for all runs: keys of ~/.config/ecs/config.toml, each of which an environment variable
// overrides.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// $XDG_CONFIG_HOME/ecs/config.toml, else ~/.config/ecs/config.toml. It need not exist.
[[nodiscard]] std::filesystem::path settings_file();

/// The text under `key`; nothing where file or key is absent. A value that is no text is a problem with its place.
[[nodiscard]] Result<std::optional<std::string>> setting(std::string_view key);

/// The environment variable, where it is set and not empty; else setting(). A file that cannot be read sets nothing.
[[nodiscard]] std::string setting_or_empty(const char* variable, std::string_view key);

}  // namespace ecs
