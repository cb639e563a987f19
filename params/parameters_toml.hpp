// A unit's parameters as a TOML file: read with every problem at once, written with unit, range and help per field.
// Ranges and names live in fields.hpp, cross-checks in check.hpp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/parameters.hpp"

namespace ecs::params {

/// `[identity]`: whose parameters these are. Empty: not stated.
struct Identity {
  std::string machine;
  std::string serial_number;
  friend bool operator==(const Identity&, const Identity&) = default;
};

/// The last line of a parameter file that is whole; every file that is written has it.
inline constexpr std::string_view kParametersEnd = "# end of parameters";
inline constexpr std::string_view kNoParametersEnd =
    "the file does not end with the line \"# end of parameters\": it may have lost its end; compare its values, then "
    "add "
    "the line";

struct ParametersFile {
  UnitParameters parameters{};
  Identity identity{};
  std::vector<std::string> defaulted;   ///< keys that the file does not give; those of absent axes are not listed
  std::vector<Axis> axes_without_keys;  ///< present, but the file gives nothing of theirs
  bool has_end = false;                 ///< its last line is kParametersEnd
};

/// Parameters out of TOML text. Unknown keys, wrong types, values out of range, NaN and inf are problems, all reported
/// in one pass with line and column. @param name  the file as problems name it
[[nodiscard]] Result<ParametersFile> parse_parameters(std::string_view text, const std::string& name);
[[nodiscard]] Result<ParametersFile> read_parameters(const std::filesystem::path& path);
/// The same for values that go into another file: refused without the closing line, which the other file would have.
[[nodiscard]] Result<ParametersFile> read_whole_parameters(const std::filesystem::path& path);

/// Commented TOML that parse_parameters() reads back to the same bits. The table of an absent axis is written only
/// where it differs from the defaults.
[[nodiscard]] std::string parameters_toml(const UnitParameters& parameters, const Identity& identity = {});
[[nodiscard]] Result<void> write_parameters(const std::filesystem::path& path, const UnitParameters& parameters,
                                            const Identity& identity = {});

}  // namespace ecs::params
