// One parameter set as the screen edits it: the unit's parameters with the identity of their owner, each under a key;
// unsaved ones as the text of a draft.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/parameters.hpp"
#include "params/fields.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

struct ParameterSet {
  UnitParameters parameters{};
  params::Identity identity{};
  friend bool operator==(const ParameterSet&, const ParameterSet&) = default;
};

/// Keys that are no fields of the unit: texts that say whose parameters these are.
inline constexpr std::string_view kMachineKey = "identity.machine";
inline constexpr std::string_view kSerialKey = "identity.serial_number";

/// A line of a group: a heading (no key), an identity text (no field), or a field.
struct ParameterRow {
  std::string key;
  std::string label;                     ///< "approach speed": the key in words, without group, axis and unit
  const params::Field* field = nullptr;  ///< of the field table
};

/// The rows of a group of thesis 5.3, absent axes left out, the fields of an axis below its heading.
[[nodiscard]] std::vector<ParameterRow> rows_of(params::Group group, const UnitParameters& parameters);
/// The same for one key wherever it stands: "X approach speed", "tool offset X".
[[nodiscard]] std::string full_label_of(std::string_view key);

/// The value of a key, without unit; empty for an unknown one.
[[nodiscard]] std::string value_of(std::string_view key, const ParameterSet& set);
/// With the unit of the field: "5 um".
[[nodiscard]] std::string value_with_unit(std::string_view key, const std::string& value);
/// Refused with the reason; the set is then as it was.
[[nodiscard]] Result<void> set_value(std::string_view key, ParameterSet& set, std::string_view text);
/// Help, range, default, thesis name in words, for the panel below the list.
struct KeyWords {
  std::string help;
  std::string accepts;        ///< "0 to 10000 um"
  std::string default_value;  ///< "5 um"
  std::string thesis_name;    ///< empty: ours
};
[[nodiscard]] KeyWords words_of(std::string_view key);
/// Words that the value cycles through: choices, true and false, the two values of a sign; empty: typed.
[[nodiscard]] std::vector<std::string> choices_of(std::string_view key);

struct ParametersDraft {
  std::string file;     ///< they were opened from; empty: none
  std::string machine;  ///< file they were checked against; empty: none
  ParameterSet set;
  ParameterSet base;  ///< as last loaded, saved or sent
};
/// Two parameter files one after the other, so that people can read it too.
[[nodiscard]] std::string draft_text(const ParametersDraft& draft);
[[nodiscard]] Result<ParametersDraft> parsed_draft(const std::string& text);

}  // namespace ecs::commissioning
