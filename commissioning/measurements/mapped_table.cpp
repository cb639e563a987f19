#include "commissioning/measurements/mapped_table.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "commissioning/measurements/fields.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/format.hpp"
#include "laser/import/import.hpp"
#include "laser/import/time.hpp"
#include "laser/units.hpp"

namespace ecs::commissioning {
namespace {

using laser::ColumnRule;
using laser::Role;
using laser::UnitKind;

/// A meaning of a column, as the user chooses it.
struct RoleWords {
  std::string_view field;  ///< of `--columns`; of several fields what they begin with
  std::string_view name;
  std::string_view help;
};

constexpr std::string_view kForward = "forward", kReverse = "reverse", kSensor = "t_", kKept = "kept";

constexpr std::array<RoleWords, 39> kRoles{{
    {"", "-", "not read"},
    {"x_mm", "X position", "target, or parked position of X"},
    {"y_mm", "Y position", "target, or parked position of Y"},
    {"z_mm", "Z position", "target, or parked position of Z"},
    {"a_deg", "A angle", "target of the rotary axis A"},
    {"b_deg", "B angle", "target of the rotary axis B"},
    {"c_deg", "C angle", "target of the rotary axis C"},
    {"reading", "reading", "an error, a position reached or a compensation: see values below"},
    {kForward, "forward", "readings of one forward pass; each such column is a run"},
    {kReverse, "reverse", "readings of one reverse pass; each such column is a run"},
    {"run", "run", "number of the run, a whole number"},
    {"approach", "approach", "1, -1, 0, or words such as forward, reverse, + and -"},
    {"time_s", "time", "time since the beginning"},
    {"date_time", "date and time", "2024-05-06 09:10:11 or 06.05.2024 09:10:11, in one column or in two"},
    {"t_air_degC", "air temp.", "temperature of the air"},
    {"t_material_degC", "material temp.", "temperature of the machine or of the scale"},
    {kSensor, "temperature", "temperature of another sensor, named after the heading"},
    {"pressure_hPa", "pressure", "pressure of the air"},
    {"humidity_pct", "humidity", "humidity of the air in percent"},
    {"feed_mm_min", "feed", "feed in mm/min"},
    {"load_kg", "load", "load on the axis in kg"},
    {"compensated", "compensated", "1: measured with compensation active, 0: without"},
    {"EX", "EX error", "error in the direction X"},
    {"EY", "EY error", "error in the direction Y"},
    {"EZ", "EZ error", "error in the direction Z"},
    {"EA", "EA error", "rotation about X"},
    {"EB", "EB error", "rotation about Y"},
    {"EC", "EC error", "rotation about Z"},
    {"axis", "axis", "letter of the moving axis"},
    {"target", "target", "target of the axis in the column axis"},
    {"sense", "sense", "EX, EY, EZ, EA, EB or EC"},
    {"measured_x_mm", "measured X", "measured position, in addition to the nominal one or the number of the point"},
    {"measured_y_mm", "measured Y", "measured position, in addition to the nominal one or the number of the point"},
    {"measured_z_mm", "measured Z", "measured position, in addition to the nominal one or the number of the point"},
    {"tip_x_mm", "tip X", "tool centre point at a ball, with the angles of the rotary axes"},
    {"tip_y_mm", "tip Y", "tool centre point at a ball, with the angles of the rotary axes"},
    {"tip_z_mm", "tip Z", "tool centre point at a ball, with the angles of the rotary axes"},
    {laser::kPointColumn, "point", "number of the point, with measured positions and no nominal ones"},
    {kKept, "kept", "kept as a further column, under its heading"},
}};

/// Of a field; of one that is no role of its own those of its family.
const RoleWords& words_of(std::string_view field) {
  const auto exact = std::ranges::find(kRoles, field, &RoleWords::field);
  if (exact != kRoles.end()) return *exact;
  std::string_view family = kKept;
  if (laser::is_sensor_column(field)) family = kSensor;
  if (const auto pass = laser::pass_named(field)) family = pass->approach == Approach::forward ? kForward : kReverse;
  return *std::ranges::find(kRoles, family, &RoleWords::field);
}

/// Of another name than those that mean something.
std::string kept_field(const std::string& heading, std::size_t number) {
  std::string name;
  for (const char c : lower(heading))
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  while (name.ends_with('_')) name.pop_back();
  const bool is_plain = !name.empty() && name != laser::kPointColumn && laser::role_of(name) == Role::other &&
                        !laser::is_known_column(name) && !laser::is_sensor_column(name);
  return is_plain ? name : fmt::format("column_{}", number);
}

constexpr std::string_view kAxisLetters = "XYZABC";
bool is_rotary(std::string_view letter) { return !letter.empty() && kAxisLetters.find(letter) >= kAxes; }

bool reads_value_in_units(Role role) { return role == Role::error || role == Role::pass; }

/// To two digits.
long rounded(double count) {
  const double digit = std::pow(10.0, std::floor(std::log10(std::max(count, 1.0))) - 1.0);
  return std::lround(std::round(count / digit) * digit);
}

/// The next of some words; `now` may be none of them.
std::string next_of(const std::vector<std::string>& words, const std::string& now, int by) {
  const auto count = static_cast<int>(words.size());
  const auto found = std::ranges::find(words, now);
  const int place = found == words.end() ? (by > 0 ? -1 : 0) : static_cast<int>(found - words.begin());
  return words[static_cast<std::size_t>((place + by + count) % count)];
}

std::vector<std::string> units_of(UnitKind kind) {
  std::vector<std::string> names;
  const std::string all = laser::unit_names();
  for (const std::string_view name : blank_words(all))
    if (const auto unit = laser::unit_named(name); unit->kind == kind && unit->name == name) names.emplace_back(name);
  return names;
}

/// "line 7: reading: expected a finite number, found "x" (and 11 more)".
std::string first_fault(const Problem& problem) {
  return (problem.line > 0 ? fmt::format("line {}: ", problem.line) : "") + problem.message +
         (problem.also.empty() ? "" : fmt::format(" (and {} more)", problem.also.size()));
}

std::string summary_text(const LineSummary& line) {
  const char* const approaches = line.forward && line.reverse ? "forward and reverse"
                                 : line.forward               ? "forward"
                                 : line.reverse               ? "reverse"
                                                              : "approach unknown";
  const std::string extent =
      line.targets < 2
          ? fmt::format("at {:.6g} {}", line.first_mm, laser::target_unit(line.group.rotary))
          : fmt::format("{:.6g} to {:.6g} {}", line.first_mm, line.last_mm, laser::target_unit(line.group.rotary));
  return fmt::format("{}: {} reading{}, {} run{}, {}; {}",
                     laser::curve_name(line.group.sense, line.group.axis, line.group.rotary), line.readings,
                     line.readings == 1 ? "" : "s", line.runs, line.runs == 1 ? "" : "s", approaches, extent);
}

}  // namespace

std::optional<MappedTable> MappedTable::of_file(const std::string& path, const ImportArguments& given) {
  if (!given.matrix.empty() || !given.channels.empty() || !given.profile.empty()) return std::nullopt;
  const auto head = beginning_of_text(path, given.encoding);
  if (!head) return std::nullopt;
  const auto rules = laser::column_rules(given.columns);
  const bool is_mapped =
      rules && std::ranges::any_of(*rules, [](const auto& rule) { return !laser::is_word_rule(rule); });
  if (!is_mapped) {
    const FileKind kind = kind_of_content(head->text);
    const bool is_described = (kind != FileKind::other && kind != FileKind::measurements) ||
                              laser::recognised_format(head->text, path) != nullptr ||
                              !with_found_profile(head->text, path, given).profile.empty();
    if (is_described) return std::nullopt;
  }
  auto found = laser::found_table(head->text);
  if (!found) return std::nullopt;
  MappedTable table;
  table.path_ = path;
  table.part_read_ = head->part;
  table.found_ = std::move(*found);
  table.given_ = given;
  const laser::TableShape& shape = table.found_.shape;
  // the stretch may go on behind the beginning of the file
  if (table.found_.suggestion && head->part < 1.0 &&
      shape.stretch_line + static_cast<int>(shape.stretch_rows) > shape.last_row_line)
    table.found_.suggestion->rows.count = 0;
  table.head_ = head->text;
  constexpr std::size_t kRowsShown = 5;
  const auto lines = lines_of(table.head_);
  for (std::size_t i = static_cast<std::size_t>(laser::rows_of(shape).skip);
       i < lines.size() && table.first_rows_.size() < kRowsShown; ++i) {
    const auto cells = laser::cells_of(lines[i], shape.delimiter);
    if (laser::is_comment(lines[i]) || cells.size() != shape.columns) continue;
    table.first_rows_.emplace_back(cells.begin(), cells.end());
  }
  if (table.first_rows_.empty()) return std::nullopt;
  table.remembered_ = remembered_mapping(shape);
  table.begin_with(is_mapped                 ? Source::given
                   : table.remembered_       ? Source::remembered
                   : table.found_.suggestion ? Source::guessed
                                             : Source::none);
  return table;
}

void MappedTable::begin_with(Source source) {
  source_ = source;
  ImportArguments options = given_;
  if (source == Source::remembered) {
    options = remembered_->options;
    options.takes_rotary = given_.takes_rotary;
    options.environment = given_.environment;
    if (!given_.parked.empty()) options.parked = given_.parked;
  } else if (source != Source::given) {
    const laser::SuggestedRows rows = found_.suggestion ? found_.suggestion->rows : laser::rows_of(found_.shape);
    options.columns.clear();
    options.values.clear();
    options.skip = rows.skip;
    options.rows = static_cast<int>(rows.count);
  }
  if (source == Source::guessed) {
    options.columns = found_.suggestion->columns;
    options.values = laser::option_word(found_.suggestion->values);
    if (options.sense.empty()) options.sense = found_.suggestion->sense;
    if (options.axis.empty()) options.axis = found_.suggestion->axis;
    if (options.parked.empty()) options.parked = found_.suggestion->parked;
  }
  take(options);
}

void MappedTable::take(const ImportArguments& options) {
  options_ = options;
  options_.columns.clear();
  auto rules = laser::column_rules(options.columns);
  const bool by_heading = rules && std::ranges::any_of(*rules, [](const ColumnRule& rule) {
                            return rule.column == 0 && !laser::is_word_rule(rule);
                          });
  if (by_heading) options_.skip = laser::rows_of(found_.shape).skip;
  rules_.clear();
  if (auto numbered = rules ? laser::by_number(std::move(*rules), found_.shape.headings) : std::nullopt)
    rules_ = std::move(*numbered);
  look_again();
}

std::string MappedTable::heading(std::size_t column) const {
  return column < found_.shape.headings.size() ? found_.shape.headings[column] : std::string();
}

std::size_t MappedTable::place_of_rule(std::size_t column) const {
  const auto number = static_cast<int>(column) + 1;
  const auto found = std::ranges::find_if(rules_, [&](const ColumnRule& rule) {
    return rule.column > 0 && rule.column <= number && number < rule.column + rule.columns;
  });
  return static_cast<std::size_t>(found - rules_.begin());
}

const ColumnRule* MappedTable::rule_of(std::size_t column) const {
  const std::size_t place = place_of_rule(column);
  return place == rules_.size() ? nullptr : &rules_[place];
}

ColumnRule* MappedTable::rule_of(std::size_t column) {
  const std::size_t place = place_of_rule(column);
  return place == rules_.size() ? nullptr : &rules_[place];
}

std::string MappedTable::role(std::size_t column) const {
  const ColumnRule* const rule = rule_of(column);
  if (rule == nullptr) return "-";
  const auto pass = laser::pass_named(rule->field);
  return std::string(words_of(rule->field).name) + (pass && pass->run > 0 ? fmt::format(" {}", pass->run) : "");
}

std::string MappedTable::role_help(std::size_t column) const {
  const ColumnRule* const rule = rule_of(column);
  const RoleWords& words = words_of(rule == nullptr ? std::string_view() : rule->field);
  const bool named = rule != nullptr && (words.field == kSensor || words.field == kKept);
  return fmt::format("{}: {}{}", words.name, words.help, named ? fmt::format(": {}", rule->field) : "");
}

std::string MappedTable::unit(std::size_t column) const {
  const ColumnRule* const rule = rule_of(column);
  if (rule == nullptr) return {};
  std::string text = rule->unit ? std::string(rule->unit->name) : "";
  if (rule->is_scaled) text += "*" + shortest(rule->factor);
  if (rule->offset != 0.0) text += (rule->offset > 0.0 ? "+" : "") + shortest(rule->offset);
  return text;
}

std::string MappedTable::origin() const {
  std::string text;
  if (source_ == Source::given) text = "as accepted before";
  if (source_ == Source::remembered)
    text = fmt::format("as {} was read, which has the same headings", remembered_->file);
  if (source_ == Source::guessed) text = "guessed from headings and values";
  if (source_ == Source::none) text = "no guess";
  if (source_ == Source::none && found_.suggestion) text = "empty";
  return text;
}

void MappedTable::clear_role(std::size_t column) {
  const std::size_t place = place_of_rule(column);
  if (place == rules_.size()) return;
  ColumnRule& rule = rules_[place];
  if (const int number = static_cast<int>(column) + 1; number > rule.column)
    rule.columns = number - rule.column;  // of a date and a time the date stays
  else
    rules_.erase(rules_.begin() + static_cast<std::ptrdiff_t>(place));
  look_again();
}

/// @param field  of the list of roles
void MappedTable::set_field(std::size_t column, const std::string& field) {
  const auto number = static_cast<int>(column) + 1;
  clear_role(column);
  if (field.empty()) return;
  ColumnRule rule;
  rule.field = field;
  rule.column = number;
  const auto used = [&](const std::string& name) {
    return std::ranges::any_of(rules_, [&](const ColumnRule& one) { return one.field == name; });
  };
  if (field == kForward || field == kReverse)
    for (int run = 1; rule.field == field || used(rule.field); ++run) rule.field = fmt::format("{}{}", field, run);
  if (field == kSensor) rule.field = laser::sensor_named(heading(column), column + 1);
  if (field == kSensor && used(rule.field)) rule.field = fmt::format("t_{}_degC", number);
  if (field == kKept) rule.field = kept_field(heading(column), column + 1);
  if (field == "date_time" && !first_rows_.empty() && column + 1 < columns() && rule_of(column + 1) == nullptr) {
    const std::string& cell = first_rows_.front()[column];
    if (!laser::seconds_in(cell) && laser::seconds_in(cell + " " + first_rows_.front()[column + 1])) rule.columns = 2;
  }
  const bool is_pass = field == kForward || field == kReverse;
  if (field == "approach" || is_pass) set_word("approach", "");
  if (field == "run" || is_pass) set_word("run", "");
  rule.unit = laser::unit_in_heading(heading(column));
  if (units_for(rule).empty()) rule.unit.reset();
  rules_.push_back(std::move(rule));
}

void MappedTable::assign(std::size_t column, int place) {
  const auto count = static_cast<int>(kRoles.size());
  set_field(column, std::string(kRoles[static_cast<std::size_t>((place % count + count) % count)].field));
  fit_units();
  look_again();
}

void MappedTable::next_role(std::size_t column, int by) {
  const ColumnRule* const rule = rule_of(column);
  const RoleWords& words = words_of(rule == nullptr ? std::string_view() : rule->field);
  assign(column, static_cast<int>(&words - kRoles.data()) + by);
}

void MappedTable::next_role_with(std::size_t column, char letter) {
  const ColumnRule* const rule = rule_of(column);
  const RoleWords& words = words_of(rule == nullptr ? std::string_view() : rule->field);
  const auto count = static_cast<int>(kRoles.size());
  for (int k = 1; k <= count; ++k) {
    const int place = (static_cast<int>(&words - kRoles.data()) + k) % count;
    if (lower(kRoles[static_cast<std::size_t>(place)].name).front() == lower(std::string(1, letter)).front())
      return assign(column, place);
  }
}

/// The units that a field may have; the usual one first. Empty: it has none.
std::vector<std::string> MappedTable::units_for(const ColumnRule& rule) const {
  const Role role = laser::role_of(rule.field);
  const auto with = [](UnitKind kind, std::string usual) {
    std::vector<std::string> units = units_of(kind);
    std::erase(units, usual);
    units.insert(units.begin(), std::move(usual));
    return units;
  };
  if (role == Role::position || role == Role::measured || role == Role::target) return with(UnitKind::length, "mm");
  if (role == Role::angle) return with(UnitKind::angle, "deg");
  if (role == Role::own_sense)
    return is_rotation(*sense_named(rule.field)) ? with(UnitKind::angle, "um/m") : with(UnitKind::length, "um");
  if (reads_value_in_units(role)) {
    const auto sense = sense_named(options_.sense);
    const bool angle = sense ? is_rotation(*sense) : is_rotary(axis_letter());
    if (options_.values == "actual")
      return is_rotary(axis_letter()) ? with(UnitKind::angle, "deg") : with(UnitKind::length, "mm");
    return angle ? with(UnitKind::angle, "um/m") : with(UnitKind::length, "um");
  }
  if (laser::is_sensor_column(rule.field)) return with(UnitKind::temperature, "degC");
  if (rule.field == "pressure_hPa") return with(UnitKind::pressure, "hPa");
  if (rule.field == "time_s") return with(UnitKind::time, "s");
  return {};
}

void MappedTable::next_unit(std::size_t column, int by) {
  ColumnRule* const rule = rule_of(column);
  if (rule == nullptr) return;
  const auto units = units_for(*rule);
  if (units.empty()) return;
  rule->unit = laser::unit_named(next_of(units, rule->unit ? std::string(rule->unit->name) : "", by));
  look_again();
}

void MappedTable::toggle_forced_unit(std::size_t column) {
  ColumnRule* const rule = rule_of(column);
  if (rule == nullptr || rule->factor != 1.0 || rule->offset != 0.0) return;
  rule->is_scaled = !rule->is_scaled;
  look_again();
}

/// A unit of another kind than the field has gives way to that of the heading, or to the usual one.
void MappedTable::fit_units() {
  for (ColumnRule& rule : rules_) {
    const auto units = units_for(rule);
    if (rule.column == 0 || units.empty()) continue;
    const UnitKind kind = laser::unit_named(units.front())->kind;
    const auto stated = laser::unit_in_heading(heading(static_cast<std::size_t>(rule.column - 1)));
    if (rule.unit && rule.unit->kind == kind) continue;
    if (!rule.unit && rule.is_scaled) continue;
    rule.unit = stated && stated->kind == kind ? stated : laser::unit_named(units.front());
  }
}

std::optional<std::size_t> MappedTable::only_position() const {
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < rules_.size(); ++k) {
    const Role role = laser::role_of(rules_[k].field);
    if (role != Role::position && role != Role::angle) continue;
    if (found) return std::nullopt;
    found = k;
  }
  return found;
}

std::string MappedTable::axis_letter() const {
  if (!options_.axis.empty()) return options_.axis;
  const auto position = only_position();
  return position ? std::string(1, static_cast<char>(rules_[*position].field[0] - 'a' + 'A')) : std::string();
}

/// The one column of positions is that of the axis.
void MappedTable::change_axis(int by) {
  std::vector<std::string> letters;
  for (const char letter : kAxisLetters) letters.emplace_back(1, letter);
  const std::string letter = next_of(letters, axis_letter(), by);
  options_.axis = letter;
  const auto position = only_position();
  if (!position) return;
  options_.axis.clear();
  rules_[*position].field = lower(letter) + (is_rotary(letter) ? "_deg" : "_mm");
}

std::string MappedTable::word_of(const std::string& field) const {
  for (const ColumnRule& rule : rules_)
    if (rule.field == field) return rule.column == 0 ? rule.heading : fmt::format("column {}", rule.column);
  return {};
}

void MappedTable::set_word(const std::string& field, const std::string& word) {
  std::erase_if(rules_, [&](const ColumnRule& rule) { return rule.field == field; });
  if (word.empty()) return;
  ColumnRule rule;
  rule.field = field;
  rule.heading = word;
  rules_.push_back(std::move(rule));
}

namespace {

/// What is chosen, and its words.
struct Choice {
  std::string_view value, shown;
};
constexpr std::array<Choice, 7> kSenses{
    {{"", "along the axis"}, {"EX", "EX"}, {"EY", "EY"}, {"EZ", "EZ"}, {"EA", "EA"}, {"EB", "EB"}, {"EC", "EC"}}};
constexpr std::array<Choice, 3> kValues{
    {{"", "errors"}, {"actual", "positions reached"}, {"compensation", "compensation"}}};
constexpr std::array<Choice, 2> kApproaches{{{"", "unknown"}, {"motion", "from the motion"}}};
constexpr std::array<Choice, 2> kRuns{{{"", "by repetition"}, {"motion", "there and back"}}};
constexpr std::array<Choice, 2> kRows{{{"", "all"}, {"in_motion", "in motion"}}};

template <std::size_t N>
std::string shown(const std::array<Choice, N>& choices, std::string_view value) {
  const auto found = std::ranges::find(choices, value, &Choice::value);
  return std::string(found == choices.end() ? value : found->shown);
}

template <std::size_t N>
std::string next_of(const std::array<Choice, N>& choices, const std::string& now, int by) {
  std::vector<std::string> values;
  for (const Choice& one : choices) values.emplace_back(one.value);
  return next_of(values, now, by);
}

}  // namespace

std::array<SettingWords, kMappingSettings> MappedTable::settings() const {
  const std::string letter = axis_letter();
  const char* const names[] = {"as accepted", "remembered", "guessed", "empty"};
  const std::string approach = word_of("approach");
  const bool passes =
      std::ranges::any_of(rules_, [](const ColumnRule& rule) { return laser::role_of(rule.field) == Role::pass; });
  return {
      {{"columns", names[static_cast<std::size_t>(source_)], origin()},
       {"axis", letter.empty() ? "?" : letter, "the axis that moved"},
       {"sense", shown(kSenses, options_.sense),
        "direction of the readings: EX EY EZ in length, EA EB EC rotations about X Y Z"},
       {"values", shown(kValues, options_.values),
        "meaning of the readings: error = actual - target; if they are positions reached, the target is subtracted"},
       {"approach",
        passes && approach.empty() ? "from the columns" : shown(kApproaches, approach == "none" ? "" : approach),
        approach == "motion" ? "from the motion: rising positions are forward, falling ones reverse"
                             : "unknown: no approach is assigned. Other choice: from the motion"},
       {"runs", passes && word_of("run").empty() ? "from the columns" : shown(kRuns, word_of("run")),
        word_of("run") == "motion" ? "there and back: one run goes there and back"
                                   : "by repetition: each repeat at a target is a run. Other choice: there and back"},
       {"rows", shown(kRows, word_of("rows")),
        word_of("rows").empty() ? "all: every row is read. Other choice: in motion"
                                : "in motion: only rows at more than half the usual speed"},
       {"parked", options_.parked,
        "position of the other axes, as in y=-1400,z=0 [mm]; of this axis too, if it did not move. Empty: not known"}}};
}

void MappedTable::next_value(MappingSetting setting, int by) {
  switch (setting) {
    case MappingSetting::columns: {
      std::vector<Source> sources;
      if (!given_.columns.empty()) sources.push_back(Source::given);
      if (remembered_) sources.push_back(Source::remembered);
      if (found_.suggestion) sources.push_back(Source::guessed);
      sources.push_back(Source::none);
      const auto now = std::ranges::find(sources, source_) - sources.begin();
      const auto count = std::ssize(sources);
      return begin_with(sources[static_cast<std::size_t>((now + by + count) % count)]);
    }
    case MappingSetting::axis:
      change_axis(by);
      break;
    case MappingSetting::sense:
      options_.sense = next_of(kSenses, options_.sense, by);
      break;
    case MappingSetting::values:
      options_.values = next_of(kValues, options_.values, by);
      for (ColumnRule& rule : rules_)  // errors are in um, positions in mm, where no heading says more
        if (reads_value_in_units(laser::role_of(rule.field)) && !rule.is_scaled &&
            !laser::unit_in_heading(heading(static_cast<std::size_t>(rule.column - 1))))
          rule.unit = laser::unit_named(units_for(rule).front());
      break;
    case MappingSetting::approach:
      set_word("approach", next_of(kApproaches, word_of("approach"), by));
      break;
    case MappingSetting::runs:
      set_word("run", next_of(kRuns, word_of("run"), by));
      break;
    case MappingSetting::rows:
      set_word("rows", next_of(kRows, word_of("rows"), by));
      break;
    case MappingSetting::parked:
      return;
  }
  fit_units();
  look_again();
}

void MappedTable::set_parked(const std::string& text) {
  options_.parked = text;
  look_again();
}

ImportArguments MappedTable::answers() const {
  ImportArguments answers = options_;
  answers.columns = laser::rules_text(rules_);
  return answers;
}

/// What is wrong before anything is read; empty: nothing.
std::string MappedTable::doubled() const {
  const bool any = std::ranges::any_of(rules_, [](const ColumnRule& rule) { return rule.column > 0; });
  if (!any)
    return fmt::format(
        "{}No column has a role yet. Give one column the role of a position and another that of a reading.",
        found_.seems_to_be.empty() ? "" : fmt::format("This seems to be {}. ", found_.seems_to_be));
  for (std::size_t i = 0; i < rules_.size(); ++i)
    for (std::size_t k = i + 1; k < rules_.size(); ++k)
      if (rules_[i].field == rules_[k].field)
        return fmt::format("Columns {} and {} both have the role \"{}\". Give one of them another role.",
                           rules_[i].column, rules_[k].column, words_of(rules_[i].field).name);
  const bool gives_readings =
      std::ranges::any_of(rules_, [](const ColumnRule& rule) { return laser::is_value(laser::role_of(rule.field)); });
  return gives_readings ? ""
                        : "No column gives readings. Give one the role \"reading\", or an error such as \"EX error\".";
}

std::string MappedTable::read_text(const laser::MeasurementSet& set) const {
  constexpr std::size_t kShown = 4;
  std::vector<std::string> first;
  for (const laser::Reading& reading : set.readings) {
    if (first.size() == kShown) break;
    first.push_back(
        fmt::format("{:.4g} {} at {:.6g}", reading.error, laser::unit_of(reading.sense), laser::target_of(reading)));
  }
  return fmt::format("first readings: {}", fmt::join(first, ", "));
}

void MappedTable::look_again() {
  preview_ = {};
  preview_.wrong = doubled();
  if (!preview_.wrong.empty()) return;
  auto options = import_options(answers());
  if (!options) {
    preview_.wrong = to_text(options.error());
    return;
  }
  if (options->mapping && options->mapping->delimiter == '\0') options->mapping->delimiter = found_.shape.delimiter;
  options->encoding = laser::Encoding::automatic;
  auto imported = laser::imported_from(head_, "", *options);
  if (!imported) preview_.wrong = first_fault(imported.error());
  if (!imported && !options->takes_rotary) {  // what is read is shown, though it is of no use here
    options->takes_rotary = true;
    imported = laser::imported_from(head_, "", *options);
  }
  if (!imported) return;
  const laser::MeasurementSet& set = imported->set;
  constexpr std::size_t kMostLines = 2;
  const auto lines = lines_in(set);
  for (std::size_t k = 0; k < std::min(lines.size(), kMostLines); ++k) preview_.lines.push_back(summary_text(lines[k]));
  if (lines.size() > kMostLines) preview_.lines.back() += fmt::format("; {} more lines", lines.size() - kMostLines);
  preview_.lines.push_back(read_text(set));
  if (part_read_ < 1.0)
    preview_.lines.push_back(fmt::format("These are from the beginning of the file; all of it has about {} readings.",
                                         rounded(static_cast<double>(set.readings.size()) / part_read_)));
  for (const std::string& note : set.notes) preview_.lines.push_back("note: " + note);
  if (source_ == Source::guessed)
    for (const std::string& sentence : found_.suggestion->assumed)
      preview_.lines.push_back(fmt::format("assumed by the guess: {}.", sentence));
}

}  // namespace ecs::commissioning
