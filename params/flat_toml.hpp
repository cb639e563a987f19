// A TOML document as a flat list of dotted keys with their places, so that readers can judge every entry in one pass.
// The TOML library stops here. What the keys mean lives in parameters_toml and machine.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.hpp"

namespace ecs::params {

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
