// Parameters as TOML, and docs/parameters.md out of the field table.
#include "params/parameters_toml.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "base/toml_reader.hpp"
#include "params/fields.hpp"

namespace ecs::params {
namespace {

constexpr std::string_view kMachineKey = "identity.machine";
constexpr std::string_view kSerialKey = "identity.serial_number";

/// Every table that the file may have: "axis", "axis.X", "axis.X.datum", …
const std::set<std::string>& known_tables() {
  static const auto tables = [] {
    std::set<std::string> found{"identity"};
    for (const Field& field : fields())
      for (auto dot = field.key.find('.'); dot != std::string::npos; dot = field.key.find('.', dot + 1))
        found.insert(field.key.substr(0, dot));
    return found;
  }();
  return tables;
}

/// One pass over the entries of a file; keeps every problem.
class ParametersReader {
 public:
  explicit ParametersReader(std::string name) : name_(std::move(name)) {}

  void take(const TomlEntry& entry) {
    if (std::holds_alternative<TomlTable>(entry.value) && known_tables().contains(entry.key)) return;
    if (inside_refused_table(entry.key)) return;
    if (entry.key == kMachineKey) return take_text(entry, file_.identity.machine);
    if (entry.key == kSerialKey) return take_text(entry, file_.identity.serial_number);
    const Field* field = field_named(entry.key);
    if (field == nullptr) return refuse_unknown(entry);
    given_.insert(entry.key);
    take_field(*field, entry);
  }

  [[nodiscard]] Result<ParametersFile> result(bool has_end) {
    if (!problems_.empty()) {
      sort_by_place(problems_);
      return tl::unexpected(folded(std::move(problems_)));
    }
    file_.has_end = has_end;
    PerAxis<bool> named{};
    for (const Field& field : fields()) {
      const bool given = given_.contains(field.key);
      if (field.axis && given) named[index_of(*field.axis)] = true;
      const bool absent = field.axis && !file_.parameters.axis_present[index_of(*field.axis)];
      if (!absent && !given && !field.may_be_absent) file_.defaulted.push_back(field.key);
    }
    for (const Axis axis : kAllAxes)
      if (file_.parameters.axis_present[index_of(axis)] && !named[index_of(axis)])
        file_.axes_without_keys.push_back(axis);
    return std::move(file_);
  }

 private:
  void refuse(const TomlEntry& entry, std::string message) {
    problems_.push_back(
        {ProblemKind::bad_input, fmt::format("{}: {}", entry.key, message), name_, entry.line, entry.column, {}});
  }

  void refuse_unknown(const TomlEntry& entry) {
    const bool table = std::holds_alternative<TomlTable>(entry.value);
    if (table) refused_tables_.push_back(entry.key + ".");
    if (known_tables().contains(entry.key)) return refuse(entry, "expected a table, found " + shown(entry));
    const std::vector<std::string> tables(known_tables().begin(), known_tables().end());
    refuse(entry, fmt::format("there is no such {}{}; correct the name or remove it", table ? "table" : "parameter",
                              table ? did_you_mean(entry.key, tables) : hint(entry.key)));
  }

  static std::string hint(const std::string& key) {
    const std::string of_identity = did_you_mean(key, {std::string(kMachineKey), std::string(kSerialKey)});
    return key.starts_with("identity.") ? of_identity : did_you_mean_key(key);
  }

  /// The entries of a table that is refused as a whole need no words of their own.
  [[nodiscard]] bool inside_refused_table(const std::string& key) const {
    for (const std::string& table : refused_tables_)
      if (key.starts_with(table)) return true;
    return false;
  }

  void take_text(const TomlEntry& entry, std::string& text) {
    const auto* found = std::get_if<std::string>(&entry.value);
    if (found == nullptr)
      refuse(entry, fmt::format("expected a text in quotes, found {}", shown(entry)));
    else if (found->size() > kLongestName)
      refuse(entry, fmt::format("expected at most {} bytes, found {}", kLongestName, found->size()));
    else
      text = ecs::shown(*found);
  }

  void take_field(const Field& field, const TomlEntry& entry) {
    const auto expected = [&] { return fmt::format("expected {}, found {}", range_text(field), shown(entry)); };
    if (field.type == FieldType::text || field.type == FieldType::choice) return take_word(field, entry, expected());
    const std::optional<double> value = number_for(field, entry);
    if (!value || !set_number(field, file_.parameters, *value)) refuse(entry, expected());
  }

  void take_word(const Field& field, const TomlEntry& entry, const std::string& expected) {
    const auto* word = std::get_if<std::string>(&entry.value);
    if (word == nullptr) return refuse(entry, expected + "; write the word in quotes");
    if (!set_text(field, file_.parameters, *word)) refuse(entry, expected + did_you_mean(*word, field.choices));
  }

  static std::optional<double> number_for(const Field& field, const TomlEntry& entry) {
    if (field.type == FieldType::truth) {
      const auto* truth = std::get_if<bool>(&entry.value);
      return truth != nullptr ? std::optional(*truth ? 1.0 : 0.0) : std::nullopt;
    }
    if (const auto* whole = std::get_if<long long>(&entry.value)) return static_cast<double>(*whole);
    const auto* real = std::get_if<double>(&entry.value);
    return real != nullptr && field.type == FieldType::number ? std::optional(*real) : std::nullopt;
  }

  std::string name_;
  ParametersFile file_{};
  std::set<std::string> given_;
  std::vector<std::string> refused_tables_;
  std::vector<Problem> problems_;
};

// --- writing

/// "axis.X.measurement_line_mm.y" → table "axis.X", name "measurement_line_mm", part "y" (a lower-case axis letter).
struct Place {
  std::string table;
  std::string name;
  std::string part;  ///< empty: a plain entry
};

Place place_of(const Field& field) {
  std::string path = field.key;
  Place place;
  if (path.size() > 2 && path[path.size() - 2] == '.') {
    place.part = path.substr(path.size() - 1);
    path.resize(path.size() - 2);
  }
  const auto dot = path.rfind('.');
  place.table = path.substr(0, dot);
  place.name = path.substr(dot + 1);
  return place;
}

std::string toml_value(const Field& field, const UnitParameters& parameters) {
  if (field.type == FieldType::text || field.type == FieldType::choice) return toml_string(text_of(field, parameters));
  if (field.type == FieldType::number) return toml_float(field.get(parameters));
  return text_of(field, parameters);
}

bool axis_worth_writing(Axis axis, const UnitParameters& parameters) {
  if (parameters.axis_present[index_of(axis)]) return true;
  const UnitParameters fresh;
  for (const Field& field : fields())
    if (field.axis == axis && text_of(field, parameters) != text_of(field, fresh)) return true;
  return false;
}

/// Writes fields one after the other, opening tables and joining the parts of a vector into one entry.
class ParametersWriter {
 public:
  void put(const Field& field, const UnitParameters& parameters) {
    const Place place = place_of(field);
    const bool continued = !vector_.empty() && vector_ == place.table + "." + place.name;
    if (!continued) {
      close_vector();
      open(place.table);
      text_ += fmt::format("# {}\n", field.help);
      text_ += fmt::format("# {}; default {}\n", range_text(field), default_text(field));
    }
    const std::string value = toml_value(field, parameters);
    if (place.part.empty()) {
      text_ += fmt::format("{} = {}\n", place.name, value);
      return;
    }
    text_ += continued ? ", " : place.name + " = { ";
    text_ += fmt::format("{} = {}", place.part, value);
    vector_ = place.table + "." + place.name;
  }

  void open(const std::string& table) {
    if (table == table_) return;
    text_ += fmt::format("\n[{}]\n", table);
    table_ = table;
  }

  void put_identity(const Identity& identity) {
    if (identity == Identity{}) return;
    open("identity");
    if (!identity.machine.empty()) text_ += fmt::format("machine = {}\n", toml_string(identity.machine));
    if (!identity.serial_number.empty())
      text_ += fmt::format("serial_number = {}\n", toml_string(identity.serial_number));
  }

  [[nodiscard]] std::string finished() {
    close_vector();
    return fmt::format("# Parameters of a compensation unit; docs/parameters.md explains each.\n{}\n{}\n", text_,
                       kParametersEnd);
  }

 private:
  void close_vector() {
    if (!vector_.empty()) text_ += " }\n";
    vector_.clear();
  }

  std::string text_;
  std::string table_;   ///< the table that is open
  std::string vector_;  ///< the vector that is open
};

}  // namespace

Result<ParametersFile> parse_parameters(std::string_view text, const std::string& name) {
  ECS_TRY(entries, flat_toml(text, name));
  ParametersReader reader(name);
  for (const TomlEntry& entry : entries) reader.take(entry);
  return reader.result(trimmed(text.substr(text.find_last_of('\n', text.find_last_not_of(" \t\r\n")) + 1)) ==
                       kParametersEnd);
}

Result<ParametersFile> read_parameters(const std::filesystem::path& path) {
  ECS_TRY(text, read_file_of(FileKind::parameters, path));
  return parse_parameters(text, path.string());
}

Result<ParametersFile> read_whole_parameters(const std::filesystem::path& path) {
  auto file = read_parameters(path);
  if (file && !file->has_end)
    return tl::unexpected(Problem{ProblemKind::refused, std::string(kNoParametersEnd), path.string(), 0, 0, {}});
  return file;
}

std::string parameters_toml(const UnitParameters& parameters, const Identity& identity) {
  ParametersWriter writer;
  writer.put_identity(identity);
  for (const Field& field : fields())
    if (!field.axis || axis_worth_writing(*field.axis, parameters)) writer.put(field, parameters);
  return writer.finished();
}

Result<void> write_parameters(const std::filesystem::path& path, const UnitParameters& parameters,
                              const Identity& identity) {
  return write_file(path, parameters_toml(parameters, identity));
}

namespace {

constexpr std::string_view kHead = R"(# Parameters of the unit

The parameters that adapt a unit to its machine: the three groups of thesis section 5.3, with our additions (a dash in the last column).
Keys are paths in the TOML file and the names for `ecs params set`. Keys of an axis are shown for X; Y and Z have the same.
This page is generated from the program.

A file may begin with `[identity]`: `machine` and `serial_number`, texts that identify the machine and unit.
Missing keys have their default; `params check` lists them. `params set`, `params send` and `map send` list up to five, otherwise only their number. The last line is
`# end of parameters`: without it, or without any key of a present axis, the end of the file may be missing, and it is not sent. Squareness
is given as *error*; maps contain compensation.

With `configuration.measurement_system = "imperial"`, positions and speeds of the axes are in inches (0.00001 in) and in/min on the on-line monitor (`ecs monitor`
and its screen), on SET AXIS POSITION (also the position that is typed there) and the other screens with a table of the axes, and in `ecs report --params`: travels, positions of measured lines,
ranges of maps and the axes of the graphs. Errors, compensation and resolutions remain in µm. Files, CSV, JSON, arguments of commands, recorded datum sequences and
`utility status` remain in mm, whichever system is set.
)";

std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, 1, '\\');
  return text;
}

/// Keys that differ only in the axis are one line: that of X.
bool shown(const Field& field) { return !field.axis || *field.axis == Axis::X; }

std::string line(const Field& field) {
  return fmt::format("| `{}` | {} | {} | `{}` | {} | {} |\n", field.key, name_of(field.type), cell(range_text(field)),
                     default_text(field), cell(field.help), field.thesis_name.empty() ? "–" : cell(field.thesis_name));
}

}  // namespace

std::string parameters_markdown() {
  std::string page(kHead);
  for (const Group group : {Group::configuration, Group::compensation, Group::datuming}) {
    page += fmt::format("\n## {} parameters\n\n", name_of(group));
    page += "| key | type | accepts | default | meaning, how to find the value | thesis name |\n";
    page += "|---|---|---|---|---|---|\n";
    for (const Field& field : fields())
      if (field.group == group && shown(field)) page += line(field);
  }
  return page;
}

namespace {

std::string joined(const std::string& path, std::string_view part) {
  const bool plain = part.find_first_of(". \t\"'") == std::string_view::npos && !part.empty();
  const std::string shown_part = plain ? std::string(part) : toml_string(part);
  return path.empty() ? shown_part : path + "." + shown_part;
}

std::optional<std::vector<double>> numbers_in(const toml::array& array) {
  std::vector<double> numbers;
  for (const toml::node& node : array) {
    if (!node.is_number()) return std::nullopt;
    numbers.push_back(*node.value<double>());
  }
  return numbers;
}

decltype(TomlEntry::value) value_of(const toml::node& node) {
  if (node.is_table()) return TomlTable{};
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* truth = node.as_boolean()) return truth->get();
  if (const auto* whole = node.as_integer()) return static_cast<long long>(whole->get());
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* array = node.as_array())
    if (auto numbers = numbers_in(*array)) return std::move(*numbers);
  return TomlOther{};
}

/// Tables deeper than any of ours are named, not entered.
constexpr int kDeepest = 16;

void flatten(const toml::table& table, const std::string& path, int depth, std::vector<TomlEntry>& entries) {
  for (const auto& [key, node] : table) {
    const std::string full = joined(path, key.str());
    const auto place = node.source().begin;
    entries.push_back({full, value_of(node), static_cast<int>(place.line), static_cast<int>(place.column)});
    if (const auto* inner = node.as_table(); inner != nullptr && depth < kDeepest)
      flatten(*inner, full, depth + 1, entries);
  }
}

}  // namespace

Result<std::vector<TomlEntry>> flat_toml(std::string_view text, const std::string& name) {
  ECS_TRY(document, parse_toml(text, name));
  std::vector<TomlEntry> entries;
  flatten(document, "", 1, entries);
  return entries;
}

void sort_by_place(std::vector<Problem>& problems) {
  std::ranges::stable_sort(problems, [](const Problem& a, const Problem& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

std::string shown(const TomlEntry& entry) {
  struct Show {
    std::string operator()(bool truth) const { return truth ? "true" : "false"; }
    std::string operator()(long long whole) const { return fmt::format("{}", whole); }
    std::string operator()(double real) const { return shortest(real); }
    std::string operator()(const std::string& text) const { return toml_string(text); }
    std::string operator()(const std::vector<double>& list) const { return fmt::format("[{}]", fmt::join(list, ", ")); }
    std::string operator()(TomlTable) const { return "a table"; }
    std::string operator()(TomlOther) const { return "a value of another kind"; }
  };
  return std::visit(Show{}, entry.value);
}

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (code < 0x20 || code == 0x7f) {
      quoted += fmt::format("\\u{:04X}", code);
    } else {
      quoted += c;
    }
  }
  return shown_json(quoted) + "\"";  // escapes of TOML are those of JSON
}

std::string toml_float(double value) {
  std::string text = shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

}  // namespace ecs::params
