// A hidden case as a folder: machine.toml, model.toml, data.csv, map.csv where a map was active, truth.sealed.
// Does not live here: what is in the case (case.hpp).
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "base/result.hpp"
#include "ecs_emulator/hidden_cases/case.hpp"

namespace ecs::emulator {

/// File name → content.
[[nodiscard]] std::map<std::string, std::string> files_of(const HiddenCase& hidden);
/// The truth as JSON (docs/emulator.md).
[[nodiscard]] std::string truth_of(const HiddenCase& hidden);

/// Writes folders of cases, seeds counting up: one case into `folder` itself, several into folder/0001, 0002 …
/// Whole or not at all: everything is made beside the folder and renamed. Refuses a folder that exists and is not
/// empty.
/// @return one line per case that gives nothing of the truth away
[[nodiscard]] Result<std::vector<std::string>> write_hidden_cases(const HiddenCaseRequest& request, int count,
                                                                  const std::filesystem::path& folder);

}  // namespace ecs::emulator
