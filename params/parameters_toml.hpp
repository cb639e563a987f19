// A unit's parameters as a TOML file: read with every problem at once, written with unit, range and help per field; a
// TOML document as a flat list of dotted keys with their places, so that readers judge every entry in one pass. The
// TOML library stops here. Ranges and names live in fields.hpp, cross-checks in check.hpp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
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
    "the file does not end with the line \"# end of parameters\": perhaps its end is missing; compare its values with "
    "those of the unit, then add the line";

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

struct TomlTable {};  ///< a table; its entries follow
struct TomlOther {};  ///< anything that no parameter is: a date, an array of tables or of mixed values

struct TomlEntry {
  std::string key;  ///< "axis.X.travel_mm"; a part that holds a dot itself stands in quotes
  std::variant<bool, long long, double, std::string, std::vector<double>, TomlTable, TomlOther> value;
  int line = 0;    ///< of the value, or of the head of a table; 1-based
  int column = 0;  ///< 1-based
};

/// Every entry, a table before what is in it, else in no order that means anything. The library stops at the first
/// error of syntax, so that one comes alone.
[[nodiscard]] Result<std::vector<TomlEntry>> flat_toml(std::string_view text, const std::string& name);

/// Longest name of a machine or of whom it belongs to, bytes: as in the header of a map.
inline constexpr std::size_t kLongestName = 200;

/// Problems in the order of the file.
void sort_by_place(std::vector<Problem>& problems);

/// What was found, in words: `"abc"`, `3.5`, `a table`.
[[nodiscard]] std::string shown(const TomlEntry& entry);

/// `text` as a quoted TOML string.
[[nodiscard]] std::string toml_string(std::string_view text);
/// A double as a TOML float that reads back to the same bits. @pre finite
[[nodiscard]] std::string toml_float(double value);

}  // namespace ecs::params
