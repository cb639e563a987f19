// Named answers to what a kind of file does not say: the import options, kept in a TOML file.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "commissioning/measurements/files.hpp"

namespace ecs::commissioning {

/// `NAME` → import/NAME.toml beside the configuration file, else the profile of that name that comes with the program
/// (samples/profiles); a name with a slash or ending in .toml is a path.
[[nodiscard]] std::filesystem::path profile_file(const std::string& name);

/// Fills what `arguments` leave open from its profile. A `usage` problem lists the profiles there are if it is none of
/// them; unknown keys and wrong values are refused with their line.
[[nodiscard]] Result<ImportArguments> with_profile(ImportArguments arguments);

/// With neither a profile nor a mapping given: the profile that comes with the program for files that contain its
/// `recognised_by` or, where it has none, two lines that begin as its `row_begins`, if there is one.
[[nodiscard]] ImportArguments with_found_profile(const std::string& file, ImportArguments given);

/// Writes what was given as a profile; the file that was written. A profile of that name is replaced with `force` only.
[[nodiscard]] Result<std::filesystem::path> save_profile(const std::string& name, const ImportArguments& arguments,
                                                         bool force);

}  // namespace ecs::commissioning
