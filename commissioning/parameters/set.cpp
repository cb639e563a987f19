#include "commissioning/parameters/set.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::size_t kLongestIdentity = 64;

/// "axis.X.datum.kind" → "datum.kind"; also without group.
std::string_view own_part(std::string_view key, bool of_axis) {
  const auto skip = [&](std::string_view begin) {
    if (key.starts_with(begin)) key.remove_prefix(begin.size());
  };
  if (of_axis) key.remove_prefix(std::string_view("axis.X.").size());
  skip("configuration.");
  skip("compensation.");
  skip("identity.");
  skip("datum.");
  return key;
}

/// The unit as keys spell it: "um/count" → "_um_per_count", "mm/min" → "_mm_min".
std::vector<std::string> suffixes_of(std::string unit) {
  if (unit.empty()) return {};
  const std::size_t slash = unit.find('/');
  if (slash == std::string::npos) return {"_" + unit};
  const std::string over = unit.substr(0, slash), under = unit.substr(slash + 1);
  return {"_" + over + "_per_" + under, "_per_" + under, "_" + over + "_" + under};
}

/// Each part without the unit; a last part of one letter is an axis.
std::string in_words(std::string_view own, const std::string& unit) {
  std::string label;
  std::size_t at = 0;
  while (at <= own.size()) {
    const std::size_t dot = std::min(own.find('.', at), own.size());
    std::string part(own.substr(at, dot - at));
    for (const std::string& suffix : suffixes_of(unit))
      if (part.size() > suffix.size() && part.ends_with(suffix)) {
        part.resize(part.size() - suffix.size());
        break;
      }
    if (part.size() == 1) part.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(part.front())));
    std::replace(part.begin(), part.end(), '_', ' ');
    label += (label.empty() ? "" : " ") + part;
    at = dot + 1;
  }
  return label;
}

std::string label_of(const params::Field& field) {
  if (field.key.ends_with(".datum.kind")) return "datum type";
  return in_words(own_part(field.key, field.axis.has_value()), field.unit);
}

const std::string* identity_text(std::string_view key, const ParameterSet& set) {
  if (key == kMachineKey) return &set.identity.machine;
  if (key == kSerialKey) return &set.identity.serial_number;
  return nullptr;
}

}  // namespace

std::vector<ParameterRow> rows_of(params::Group group, const UnitParameters& parameters) {
  std::vector<ParameterRow> rows;
  if (group == params::Group::configuration) {
    rows.push_back({std::string(kMachineKey), "machine", nullptr});
    rows.push_back({std::string(kSerialKey), "serial number of the unit", nullptr});
  }
  std::optional<Axis> under;
  for (const params::Field& field : params::fields()) {
    if (field.group != group) continue;
    if (field.axis && !parameters.axis_present[index_of(*field.axis)]) continue;
    if (field.axis && field.axis != under)
      rows.push_back({"", fmt::format("axis {}", letter_of(*field.axis)), nullptr});
    under = field.axis;
    rows.push_back({field.key, label_of(field), &field});
  }
  return rows;
}

std::string full_label_of(std::string_view key) {
  const params::Field* field = params::field_named(key);
  if (field == nullptr) return in_words(own_part(key, false), "");
  return field->axis ? fmt::format("{} {}", letter_of(*field->axis), label_of(*field)) : label_of(*field);
}

std::string value_of(std::string_view key, const ParameterSet& set) {
  if (const std::string* text = identity_text(key, set)) return *text;
  const params::Field* field = params::field_named(key);
  return field == nullptr ? "" : params::text_of(*field, set.parameters);
}

std::string value_with_unit(std::string_view key, const std::string& value) {
  const params::Field* field = params::field_named(key);
  return field == nullptr || field->unit.empty() || value.empty() ? value : value + " " + field->unit;
}

Result<void> set_value(std::string_view key, ParameterSet& set, std::string_view text) {
  const std::string bare(trimmed(text));
  if (identity_text(key, set) == nullptr) return params::set(set.parameters, key, bare);
  const bool printable =
      std::none_of(bare.begin(), bare.end(), [](char c) { return static_cast<unsigned char>(c) < 32; });
  if (bare.size() > kLongestIdentity || !printable)
    return problem(ProblemKind::usage, "{}: expected a text of at most {} characters", key, kLongestIdentity);
  (key == kMachineKey ? set.identity.machine : set.identity.serial_number) = bare;
  return {};
}

KeyWords words_of(std::string_view key) {
  if (key == kMachineKey)
    return {
        "The machine to which these parameters belong. If the unit contains a map for another machine, it is not kept "
        "when these parameters are sent.",
        "any text; empty: not stated", "", ""};
  if (key == kSerialKey)
    return {
        "The unit for which these parameters are intended. Sending them to a unit with another serial number needs a "
        "confirmation.",
        "the serial number that the unit reports; empty: any unit", "", ""};
  const params::Field* field = params::field_named(key);
  if (field == nullptr) return {};
  return {field->help, params::range_text(*field), value_with_unit(key, params::default_text(*field)),
          field->thesis_name};
}

std::vector<std::string> choices_of(std::string_view key) {
  const params::Field* field = params::field_named(key);
  if (field == nullptr) return {};
  switch (field->type) {
    case params::FieldType::choice:
      return field->choices;
    case params::FieldType::truth:
      return {"false", "true"};
    case params::FieldType::integer:
      if (!field->zero_allowed && field->least == -1.0 && field->most == 1.0) return {"-1", "1"};
      return {};
    default:
      return {};
  }
}

namespace {

constexpr std::string_view kFile = "#@ file ";
constexpr std::string_view kMachine = "#@ machine ";
constexpr std::string_view kBase = "#@ as loaded";
constexpr const char* kName = "draft of the parameters screen";

Result<ParameterSet> set_in(const std::string& text) {
  ECS_TRY(parsed, params::parse_parameters(text, kName));
  return ParameterSet{parsed.parameters, parsed.identity};
}

}  // namespace

std::string draft_text(const ParametersDraft& draft) {
  return fmt::format("{}{}\n{}{}\n{}\n{}\n{}", kFile, draft.file, kMachine, draft.machine,
                     params::parameters_toml(draft.set.parameters, draft.set.identity), kBase,
                     params::parameters_toml(draft.base.parameters, draft.base.identity));
}

Result<ParametersDraft> parsed_draft(const std::string& text) {
  ParametersDraft draft;
  std::string set, base;
  std::string* part = &set;
  for (const std::string_view line : lines_of(text)) {
    if (line.starts_with(kFile)) draft.file = line.substr(kFile.size());
    if (line.starts_with(kMachine)) draft.machine = line.substr(kMachine.size());
    if (line == kBase) part = &base;
    part->append(line).push_back('\n');
  }
  auto edited = set_in(set);
  auto loaded = set_in(base);
  if (!edited) return tl::unexpected(edited.error());
  if (!loaded) return tl::unexpected(loaded.error());
  draft.set = std::move(*edited);
  draft.base = std::move(*loaded);
  return draft;
}

}  // namespace ecs::commissioning
