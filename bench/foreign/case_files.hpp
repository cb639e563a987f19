// A case as files: data.csv, machine.toml, model.toml, map.csv where there is a map, truth.json.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "bench/foreign/case.hpp"

namespace foreign {

[[nodiscard]] ecs::Result<void> write_case(const std::filesystem::path& folder, const Case& drawn);

}  // namespace foreign
