// The one table of a unit's parameters: key, unit, range, help, and how to read and set each in UnitParameters; what
// differs between two parameter sets. TOML, `params show/set/check/diff`, the documentation and the screens are driven
// by it. Files live in parameters_toml.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/parameters.hpp"

namespace ecs::params {

/// The three groups of thesis 5.3.
enum class Group { configuration, compensation, datuming };
[[nodiscard]] std::string_view name_of(Group group);

enum class FieldType {
  text,     ///< letters: the chain, the axes
  choice,   ///< one word of `choices`; its number is the place in that list
  number,   ///< a finite double
  integer,  ///< a whole number
  truth,    ///< true or false
};
[[nodiscard]] std::string_view name_of(FieldType type);

/// One parameter. Numbers may lie in least … most, ends included, without 0 where `zero_allowed` is false.
struct Field {
  std::string key;  ///< path as in TOML: "axis.X.datum.approach_speed_mm_min"
  Group group = Group::configuration;
  FieldType type = FieldType::number;
  std::optional<Axis> axis;  ///< the axis it belongs to, if any
  std::string unit;          ///< "um", "mm/min", …; empty: none
  double least = 0.0;
  double most = 0.0;
  bool zero_allowed = true;
  bool may_be_absent = false;  ///< a file without it is complete: its default is as if the parameter did not exist
  std::vector<std::string> choices;                  ///< of a choice
  std::string accepts;                               ///< of a text: what may stand there, in words
  std::string help;                                  ///< what it does and how to find the value, plain words, one line
  std::string thesis_name;                           ///< its name in thesis 5.3; empty: our addition
  std::function<double(const UnitParameters&)> get;  ///< empty for text
  std::function<void(UnitParameters&, double)> put;  ///< empty for text; no check: use set_number()
  std::function<std::string(const UnitParameters&)> get_text;       ///< only for text
  std::function<bool(UnitParameters&, std::string_view)> put_text;  ///< only for text; false: refused, unchanged
};

/// Every parameter, in the order of the file: configuration, compensation, then each axis with its datum.
[[nodiscard]] const std::vector<Field>& fields();

/// The field of that exact key; nullptr if there is none.
[[nodiscard]] const Field* field_named(std::string_view key);

/// The field of that key, or a usage problem that names the nearest keys.
[[nodiscard]] Result<const Field*> find_field(std::string_view key);

/// ` (did you mean "…"?)` for a misspelt word; empty if none of `candidates` is like it.
[[nodiscard]] std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);
/// The same over the keys of all fields; a last part alone ("deadband_um") finds its full keys.
[[nodiscard]] std::string did_you_mean_key(std::string_view key);

/// The value as text, at full precision, without unit: "TXYZ", "encoder", "0.1", "true".
[[nodiscard]] std::string text_of(const Field& field, const UnitParameters& parameters);
/// The value as a number: integer, truth as 0/1, choice as its place in `choices`; nothing for text.
[[nodiscard]] std::optional<double> number_of(const Field& field, const UnitParameters& parameters);
/// The value of a UnitParameters{}.
[[nodiscard]] std::string default_text(const Field& field);

/// What the field accepts, in words: "100 to 20000 us", "encoder or resolver", "-1 or 1".
[[nodiscard]] std::string range_text(const Field& field);

/// Why a value cannot stand in the field; empty if it can.
[[nodiscard]] std::string objection_to_number(const Field& field, double value);
/// Why the value it holds now cannot stand; empty if it can.
[[nodiscard]] std::string objection(const Field& field, const UnitParameters& parameters);

/// Sets one field; a usage problem with the reason (range, unit, choices) leaves the parameters as they were.
/// The text may carry the field's own unit: "2.5 um".
[[nodiscard]] Result<void> set_text(const Field& field, UnitParameters& parameters, std::string_view text);
/// The same from a number (choice: place in `choices`, truth: 0 or 1).
[[nodiscard]] Result<void> set_number(const Field& field, UnitParameters& parameters, double value);
/// find_field() and set_text() in one: `set(p, "axis.X.deadband_um", "2.5")`.
[[nodiscard]] Result<void> set(UnitParameters& parameters, std::string_view key, std::string_view text);

/// docs/parameters.md: the table of all fields for readers.
[[nodiscard]] std::string parameters_markdown();

/// All rows, in the order of the file.
[[nodiscard]] std::vector<Field> field_table();

struct Difference {
  std::string key;
  std::string unit;  ///< empty: none
  std::string a;     ///< value in the first set, full precision
  std::string b;     ///< value in the second
  friend bool operator==(const Difference&, const Difference&) = default;
};

/// Every field whose values, written in full, differ; in the order of the field table.
[[nodiscard]] std::vector<Difference> diff(const UnitParameters& a, const UnitParameters& b);

/// A table with one line per difference, headed by the names of the two sets; empty without differences.
[[nodiscard]] std::string to_text(const std::vector<Difference>& differences, std::string_view name_a,
                                  std::string_view name_b);

}  // namespace ecs::params
