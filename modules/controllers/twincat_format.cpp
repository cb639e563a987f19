// TwinCAT CNC and ISG kernels: writing and reading the leadscrew part of a compensation value list.
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/curve.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

constexpr double kTenthsPerUm = 10.0;
constexpr double kTenthsPerMm = 10'000.0;

/// End of the first comment of a list of ours. @param adds  written for a control that adds the values
constexpr std::string_view list_sign(bool adds) {
  return adds ? "nominal minus actual, in 0.1 um; pos and neg: direction of motion"
              : "actual minus nominal, in 0.1 um; pos and neg: direction of motion";
}

constexpr double kMostOfTwinCat2_um = 3276.7;  // 16 bit of tenths

std::string file_of(int axis_number) { return fmt::format("achskw{}.lis", axis_number); }

/// What stands in a list is this times the compensation.
double sign_of(const TwinCatOptions& options) { return options.adds.value_or(false) ? 1.0 : -1.0; }

/// The list travels alone: what is not certain stands in it.
std::string_view sign_warning(bool adds) {
  return adds ? "sign against the example of the TF5200 manual, not tried on a control: check one axis with the laser "
                "before use (the option --ssfk-sign subtracts reverses it)"
              : "sign as in the example of the TF5200 manual, not tried on a control: check one axis with the laser "
                "before use (the option --ssfk-sign adds reverses it)";
}

/// The curve in whole tenths of a micrometre, positions and values.
ControlCurve in_tenths(const ControlCurve& curve) {
  const auto rounded = [](double tenths) {
    return [tenths](double value) { return std::round(value * tenths) / tenths; };
  };
  return as_in_file(curve, rounded(kTenthsPerMm), rounded(kTenthsPerUm));
}

std::string list_text(const ControlCurve& curve, Axis axis, const TwinCatOptions& options) {
  const int number = options.axis_number[index_of(axis)];
  const double sign = sign_of(options);
  const bool adds = options.adds.value_or(false);
  const auto tenths = [](double value, double per_unit) { return std::llround(value * per_unit); };
  std::string text = fmt::format(
      "# {} error of {}, {}\n# {}\nkopf.achs_nr {}\nkopf.log_achs_name {}\nkw.ssfk.unit 1\nkw.ssfk.interval "
      "0\nkw.ssfk.kw_startpos {}\nkw.ssfk.kw_nr_max {}\nkw.ssfk.bilateral 1\nkw.ssfk.modulo 0\n",
      name_of(positioning_curve(axis)), letter_of(axis), list_sign(adds), sign_warning(adds), number, letter_of(axis),
      tenths(curve.position_mm.front(), kTenthsPerMm), curve.position_mm.size());
  for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
    text += fmt::format("kw.ssfk.table[{0}].setpoint {1}\nkw.ssfk.table[{0}].pos {2}\nkw.ssfk.table[{0}].neg {3}\n", i,
                        tenths(curve.position_mm[i], kTenthsPerMm), tenths(sign * curve.forward[i], kTenthsPerUm),
                        tenths(sign * curve.reverse[i], kTenthsPerUm));
  return text;
}

/// The list is switched on and off where the axis stands; at the reference position as a rule.
void note_step(const ControlCurve& kept, Axis axis, double reference_mm, double sign, ControllerExport& made) {
  const auto held = [&](Approach approach) {
    return std::round(sign * value_at(kept, approach, reference_mm) * kTenthsPerUm) / kTenthsPerUm + 0.0;
  };
  const double pos_um = held(Approach::forward), neg_um = held(Approach::reverse);
  if (pos_um == 0.0 && neg_um == 0.0) return;
  made.notes.push_back(fmt::format(
      "at the reference position of {} ({} mm) the list has {}: the axis steps by {} when the "
      "compensation becomes active",
      letter_of(axis), reference_mm + 0.0,
      pos_um == neg_um
          ? fmt::format("{:.1f} um", pos_um)
          : fmt::format("{:.1f} um in its column pos (forward) and {:.1f} um in neg (reverse)", pos_um, neg_um),
      pos_um == neg_um ? "this amount" : "one of these amounts"));
}

void note_what_is_too_large(const std::string& name, double largest_um, ControllerExport& made) {
  if (largest_um <= kMostOfTwinCat2_um) return;
  made.notes.push_back(fmt::format("{} has values up to {:.1f} um: values beyond {} um do not fit TwinCAT 2 (16 bit)",
                                   name, largest_um, kMostOfTwinCat2_um));
}

/// One axis into files, tables, notes and `applied`; false: the map or the machine has none.
Result<bool> add_axis(const ExportSource& source, const TwinCatOptions& options, Axis axis, ControllerExport& made) {
  const Component component = positioning_curve(axis);
  const auto curve = curve_of(source.map, component);
  if (!curve || !has_axis(source, axis)) return false;
  const ControlCurve kept = in_tenths(thinned(*curve, options.most_points));
  const std::string name = file_of(options.axis_number[index_of(axis)]);
  made.files.push_back({name, list_text(kept, axis, options)});
  auto again = parse_twincat(made.files.back().content, name, options);
  if (!again) return unwritable(again.error());
  ECS_DO(append(made.applied, std::move(*again), true));
  made.tables.push_back({std::string(name_of(component)), name, curve->position_mm.size(), kept.position_mm.size(),
                         largest_in(kept),
                         deviation_from_unit(kept, source.map, component, source.parameters.interpolation), 0.0});
  note_step(kept, axis, source.parameters.axes[index_of(axis)].datum.reference_position_mm, sign_of(options), made);
  note_what_is_too_large(name, largest_in(kept), made);
  return true;
}

void add_settings(const TwinCatOptions& options, const std::vector<Component>& carried, ControllerExport& made) {
  made.settings.push_back(fmt::format("start-up list: zahl_kw {}", carried.size()));
  for (std::size_t i = 0; i < carried.size(); ++i) {
    const int number = options.axis_number[index_of(moving_axis(carried[i]))];
    made.settings.push_back(
        fmt::format("start-up list: achs_kw_log_ax_nr[{0}] {1}, achs_kw[{0}] {2}", i, number, file_of(number)));
    made.settings.push_back(fmt::format("list of axis {}: lr_param.ssfk 1", number));
  }
}

constexpr long long kMostAxes = 65'534;  ///< logical axis numbers of the control

Result<TwinCatOptions> options_in(const OptionValues& values) {
  TwinCatOptions options;
  const std::string_view axes = values.text("axes"), sign = values.text("ssfk-sign");
  if (!sign.empty()) options.adds = sign == "adds";
  for (const auto& [axis, name] : axis_pairs(axes)) {
    const auto number = integer_in(name);
    if (!axis || !number || *number < 1 || *number > kMostAxes)
      return problem(ProblemKind::usage,
                     "--axes: expected X=NUMBER,Y=NUMBER,Z=NUMBER with numbers from 1 to {}, as in X=1, found \"{}\"",
                     kMostAxes, axes);
    options.axis_number[index_of(*axis)] = static_cast<int>(*number);
  }
  for (const Axis a : kAllAxes)
    for (const Axis b : kAllAxes)
      if (a < b && options.axis_number[index_of(a)] == options.axis_number[index_of(b)])
        return problem(ProblemKind::usage, "--axes: {} and {} have the same number {} (default: X=1,Y=2,Z=3)",
                       letter_of(a), letter_of(b), options.axis_number[index_of(a)]);
  return options;
}

Result<ControllerExport> write_twincat(const ExportSource& source, const OptionValues& values) {
  ECS_TRY(options, options_in(values));
  options.most_points = static_cast<std::size_t>(values.integer("points"));
  return twincat_export(source, options);
}

Result<ControllerTables> read_twincat(const ReadRequest& request) {
  ECS_TRY(options, options_in(request.options));
  ECS_TRY(axis, axis_option(request));
  return parse_twincat(request.text, request.file_name, options, axis);
}

const FormatOption kSignToRead{.name = "ssfk-sign",
                               .help =
                                   "whether TwinCAT subtracts or adds a value; default: as stated in the list if ecs "
                                   "wrote it, else subtracts, as in its manual",
                               .words = {"subtracts", "adds"}};
const FormatOption kSignToWrite{
    .name = "ssfk-sign",
    .help = "whether TwinCAT subtracts or adds a value; default: subtracts, as in its manual",
    .words = {"subtracts", "adds"}};

}  // namespace

Result<ControllerExport> twincat_export(const ExportSource& source, const TwinCatOptions& options) {
  ECS_DO(check_exportable(source.map));
  ControllerExport made;
  std::vector<Component> carried;
  for (const Axis axis : kAllAxes) {
    ECS_TRY(added, add_axis(source, options, axis, made));
    if (added) carried.push_back(positioning_curve(axis));
  }
  if (carried.empty())
    return problem(ProblemKind::refused,
                   "the map has no positioning table (EXX, EYY, EZZ) of an axis that the machine has: leadscrew "
                   "compensation contains nothing else");
  add_settings(options, carried, made);
  leave_behind(made, source, carried, "cannot be corrected by a table of one axis, which has no lever arm",
               "leadscrew compensation acts along its own axis only");
  made.notes.insert(
      made.notes.begin(),
      {"switch off the backlash compensation of these axes (P-AXIS-00021 lr_param.anwahl_losekomp 0): the "
       "lists contain their reversal error",
       "beyond the ends of a list the control uses the end values, as the unit does",
       "values are whole tenths of a micrometre",
       fmt::format("the sign is {} the manual's worked example and was not tested on a control: measure "
                   "one axis again first (modules/controllers/README.md)",
                   options.adds.value_or(false) ? "against" : "that of")});
  return made;
}

bool is_twincat_file(std::string_view name) {
  const auto number = name.starts_with("achskw") && name.ends_with(".lis") && name.size() > 10
                          ? integer_in(name.substr(6, name.size() - 10))
                          : std::nullopt;
  return number && *number > 0 && *number <= kMostAxes && name == file_of(static_cast<int>(*number));
}

extern const ControllerFormat twincat_format{
    .id = "twincat",
    .title = "TwinCAT CNC, leadscrew compensation",
    .name = "TwinCAT",
    .summary = "TwinCAT CNC and ISG kernels: a leadscrew compensation list for each axis, both directions",
    .example = "ecs export twincat map.csv --params mill.toml -o twincat/",
    .output_help = "folder for achskw1.lis, achskw2.lis, achskw3.lis",
    .marks = "kw.ssfk",
    .place = 40,
    .holds = {"yes", "yes, by position", "–", "–", "–", "1,499 an axis, anywhere"},
    .resolution_um = 0.1,
    .write_options = {kSignToWrite,
                      {.name = "axes", .help = "logical axis numbers of the control; default X=1,Y=2,Z=3"},
                      {.name = "points",
                       .help = "maximum number of points of a list; default 1499",
                       .fallback = "1499",
                       .range = IntegerRange{2, static_cast<int>(kTwinCatMostPoints)}}},
    .read_options = {{.name = "axis", .help = "axis; default: as stated in the list"},
                     {.name = "axes", .help = "logical axis numbers; default X=1,Y=2,Z=3"},
                     kSignToRead},
    .is_file = is_twincat_file,
    .recognises = [](std::string_view text) { return lower(text).find("kw.ssfk.") != std::string::npos; },
    .write = write_twincat,
    .read = read_twincat,
};

namespace {

constexpr long long kMostPoints = 1'000'000;

struct Entry {
  double value = 0.0;
  int line = 0;
};

/// Its first word and what stands behind it, with their columns.
struct TwinCatAssignment {
  std::string key;
  std::string_view rest;
  std::string_view value;  ///< the first word of the rest
  int column = 0;
};

TwinCatAssignment twincat_assignment_in(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  const std::string_view content = trimmed(line);
  const std::size_t end = std::min(content.find_first_of(kBlanks), content.size());
  TwinCatAssignment out;
  out.key = lower(content.substr(0, end));
  out.rest = trimmed(content.substr(end));
  out.value = out.rest.substr(0, out.rest.find_first_of(kBlanks));
  out.column = static_cast<int>((out.rest.empty() ? content : out.rest).data() - line.data()) + 1;
  return out;
}

/// The axis that a name begins with, as a capital: "Y", "y-achse", "X1", "B-ACHSE", but not "ACHSE1".
std::optional<char> letter_in(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (name.empty() || !is_letter(name[0]) || (name.size() > 1 && is_letter(name[1]))) return std::nullopt;
  return static_cast<char>(name[0] & ~0x20);
}

class TwinCatReader {
 public:
  TwinCatReader(const std::string& file, const TwinCatOptions& options) : findings(file), options_(options) {}

  void take(std::string_view line, int number) {
    line_ = number;
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.starts_with("/*")) return comment(content);
    const TwinCatAssignment a = twincat_assignment_in(line);
    if (a.key == "kopf.log_achs_name") {
      name_ = std::string(trimmed(a.rest.substr(0, a.rest.find('('))));
      name_line_ = number;
    } else if (a.key == "kopf.achs_nr" || a.key == "kopf.log_achs_nr") {
      keep("kopf.achs_nr", a);
    } else if (a.key.starts_with("kw.ssfk.table[")) {
      table(a);
    } else if (a.key.starts_with("kw.ssfk.")) {
      general(a);
    } else if (a.key.starts_with("kw.")) {
      other_.insert(a.key.substr(0, a.key.find('.', 3)));
    } else {
      findings.add(number, 1, "expected an entry such as kw.ssfk.unit 1 or kopf.achs_nr 1, found {}",
                   laser::in_quotes(trimmed(line)));
    }
  }

  /// Both tables on the points of the list, as compensation. @pre no findings
  [[nodiscard]] std::vector<laser::MapTable> tables(Axis axis) {
    const Component component = positioning_curve(axis);
    laser::MapTable forward{component, Approach::forward, {}, {}}, reverse{component, Approach::reverse, {}, {}};
    check_general();
    if (!findings.empty()) return {};
    const bool two = value_of("bilateral") == 1.0;
    const auto points = static_cast<long long>(value_of("kw_nr_max"));
    if (!table_.empty() && table_.rbegin()->first >= points)
      findings.add(first_line(table_.rbegin()->second), 1,
                   "table[{}] lies beyond the {} points that kw_nr_max announces", table_.rbegin()->first, points);
    for (long long i = 0; i < points; ++i) {
      point(i, two, forward, reverse);
      if (table_.count(i) == 0) break;
    }
    reverse.position_mm = forward.position_mm;
    return {std::move(forward), std::move(reverse)};
  }

  [[nodiscard]] std::optional<Axis> axis() {
    const auto letter = letter_in(name_);
    const auto by_name = letter ? axis_of(*letter) : std::nullopt;
    if (letter && !by_name) {
      findings.add(name_line_, 1,
                   "the list belongs to axis {}: a map covers X, Y and Z; give --axis if it is one of them",
                   laser::in_quotes(name_));
      return std::nullopt;
    }
    std::optional<Axis> by_number;
    const auto number = general_.find("kopf.achs_nr");
    if (number != general_.end())
      for (const Axis one : kAllAxes)
        if (number->second.value == options_.axis_number[index_of(one)]) by_number = one;
    if (by_name && by_number && *by_name != *by_number) {
      findings.add(number->second.line, 1,
                   "the name of the axis is {}, but its number {} is that of {}: give --axes with the numbers of the "
                   "control, or --axis",
                   letter_of(*by_name), number->second.value, letter_of(*by_number));
      return std::nullopt;
    }
    if (!by_name && !by_number)
      findings.add(
          0, 0, "the axis is unknown: neither kopf.log_achs_name nor kopf.achs_nr states it; give --axis, or --axes");
    return by_name ? by_name : by_number;
  }

  [[nodiscard]] std::vector<std::string> notes(const std::string& file) const {
    std::vector<std::string> out;
    for (const std::string& other : other_)
      out.push_back(fmt::format("{}: {} is not a leadscrew compensation, ignored", file, other));
    return out;
  }

  laser::Findings findings;

 private:
  struct Row {
    std::optional<Entry> setpoint, pos, neg;
  };

  static int first_line(const Row& row) {
    for (const auto* entry : {&row.setpoint, &row.pos, &row.neg})
      if (*entry) return (*entry)->line;
    return 0;
  }

  /// A list of ours says its sign.
  void comment(std::string_view content) {
    for (const bool adds : {false, true}) {
      if (!content.ends_with(list_sign(adds))) continue;
      if (says_adds_.value_or(adds) != adds)
        findings.add(line_, 1, "this comment states a different sign from the previous one: read one list at a time");
      else if (options_.adds.value_or(adds) != adds)
        findings.add(line_, 1,
                     "the list was written with --ssfk-sign {}, but --ssfk-sign {} was given: omit the option",
                     sign_name(adds), sign_name(!adds));
      says_adds_ = adds;
    }
  }
  static const char* sign_name(bool adds) { return adds ? "adds" : "subtracts"; }
  [[nodiscard]] double sign() const { return options_.adds.value_or(says_adds_.value_or(false)) ? 1.0 : -1.0; }

  std::optional<Entry> number(const TwinCatAssignment& a) {
    const auto value = number_in(a.value);
    if (value) return Entry{*value, line_};
    findings.add(line_, a.column, "expected a number, found {}", laser::in_quotes(a.value));
    return std::nullopt;
  }

  void keep(const std::string& key, const TwinCatAssignment& a) {
    const auto value = number(a);
    if (!value) return;
    if (!general_.emplace(key, *value).second)
      findings.add(line_, 1, "{} occurs twice (also in line {})", key, general_[key].line);
  }

  void general(const TwinCatAssignment& a) {
    static const std::set<std::string> kKnown{"unit",      "interval", "kw_startpos",       "kw_nr_max",
                                              "bilateral", "modulo",   "manual_activation", "set_pos_without_comp",
                                              "max_points"};
    const std::string key = a.key.substr(8);
    if (kKnown.count(key) == 0)
      return findings.add(line_, 1, "expected an entry of kw.ssfk, found {}", laser::in_quotes(a.key));
    keep(key, a);
  }

  /// "kw.ssfk.table[12].pos"
  void table(const TwinCatAssignment& a) {
    constexpr std::size_t kOpen = 13;
    const std::size_t close = a.key.find(']', kOpen);
    const auto index =
        close == std::string::npos ? std::nullopt : integer_in(a.key.substr(kOpen + 1, close - kOpen - 1));
    const std::string what = close == std::string::npos ? "" : a.key.substr(close + 1);
    if (!index || *index < 0 || *index >= kMostPoints || (what != ".setpoint" && what != ".pos" && what != ".neg"))
      return findings.add(line_, 1, "expected kw.ssfk.table[0] and so on with .setpoint, .pos or .neg, found {}",
                          laser::in_quotes(a.key));
    const auto value = number(a);
    if (!value) return;
    Row& row = table_[*index];
    auto& entry = what == ".setpoint" ? row.setpoint : what == ".pos" ? row.pos : row.neg;
    if (entry) findings.add(line_, 1, "{} occurs twice (also in line {})", a.key, entry->line);
    entry = value;
  }

  [[nodiscard]] double value_of(const std::string& key) const {
    const auto found = general_.find(key);
    return found == general_.end() ? 0.0 : found->second.value;
  }
  [[nodiscard]] int line_of(const std::string& key) const {
    const auto found = general_.find(key);
    return found == general_.end() ? 0 : found->second.line;
  }

  void check_general() {
    if (table_.empty() && general_.count("kw_nr_max") == 0)
      return findings.add(0, 0, "no leadscrew compensation: expected entries such as kw.ssfk.table[0].pos 24");
    for (const char* flag : {"unit", "bilateral", "modulo"})
      if (const double value = value_of(flag); value != 0.0 && value != 1.0)
        findings.add(line_of(flag), 1, "kw.ssfk.{}: expected 0 or 1, found {}", flag, value);
    if (value_of("unit") == 0.0)
      findings.add(line_of("unit"), line_of("unit") > 0 ? 1 : 0,
                   "kw.ssfk.unit is not 1: the list is in encoder increments, whose length it does not state");
    if (value_of("modulo") == 1.0)
      findings.add(line_of("modulo"), 1, "kw.ssfk.modulo 1: a rotary axis; a map covers linear axes only");
    if (const double interval = value_of("interval");
        interval < 0.0 || std::abs(interval) > kLargestPosition_mm * kTenthsPerMm)
      findings.add(line_of("interval"), 1, "kw.ssfk.interval: expected the step between points, or 0");
    const double points = value_of("kw_nr_max");
    if (points < 1.0 || points > static_cast<double>(kMostPoints) || points != std::floor(points))
      findings.add(line_of("kw_nr_max"), line_of("kw_nr_max") > 0 ? 1 : 0,
                   "kw.ssfk.kw_nr_max: expected the number of points, a whole number from 1 to {}", kMostPoints);
  }

  void point(long long i, bool two, laser::MapTable& forward, laser::MapTable& reverse) {
    const Row row = table_.count(i) > 0 ? table_[i] : Row();
    const auto missing = [&](const char* what) {
      findings.add(first_line(row), 0, "kw.ssfk.table[{}].{} is missing: the control would use 0", i, what);
    };
    const double interval = value_of("interval");
    if (interval == 0.0 && !row.setpoint) return missing("setpoint");
    if (!row.pos) return missing("pos");
    if (two && !row.neg) return missing("neg");
    if (!two && row.neg && row.neg->value != row.pos->value && row.neg->value != 0.0)
      return findings.add(row.neg->line, 1,
                          "neg differs from pos in a list for one direction (kw.ssfk.bilateral is not 1): it is not "
                          "known which of them the control uses");
    const double place =
        interval == 0.0 ? row.setpoint->value : value_of("kw_startpos") + interval * static_cast<double>(i);
    const double place_mm = place / kTenthsPerMm;
    const double forward_um = sign() * row.pos->value / kTenthsPerUm;
    const double reverse_um = two ? sign() * row.neg->value / kTenthsPerUm : forward_um;
    if (std::abs(place_mm) > kLargestPosition_mm)
      return findings.add(first_line(row), 1, "{} mm is not a plausible position", place_mm);
    if (!forward.position_mm.empty() && place_mm <= forward.position_mm.back())
      return findings.add(first_line(row), 1, "position {} mm does not rise", place_mm);
    for (const double value : {forward_um, reverse_um})
      if (std::abs(value) > kLargestValue_um)
        findings.add(row.pos->line, 1, "an error of {:.6g} mm is implausibly large", value / 1000.0);
    forward.position_mm.push_back(place_mm);
    forward.compensation.push_back(forward_um + 0.0);
    reverse.compensation.push_back(reverse_um + 0.0);
  }

  const TwinCatOptions& options_;
  int line_ = 0;
  std::string name_;
  int name_line_ = 0;
  std::optional<bool> says_adds_;
  std::map<std::string, Entry> general_;
  std::map<long long, Row> table_;
  std::set<std::string> other_;
};

}  // namespace

Result<ControllerTables> parse_twincat(std::string_view text, const std::string& file_name,
                                       const TwinCatOptions& options, std::optional<Axis> axis) {
  const std::string whole(text);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  TwinCatReader reader(file_name, options);
  for (const NumberedLine& line : numbered_lines_of(text)) reader.take(line.text, line.number);
  if (!axis && reader.findings.empty()) axis = reader.axis();
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  ControllerTables read;
  read.tables = reader.tables(*axis);
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  read.notes = reader.notes(file_name);
  read.sources.push_back({std::string(name_of(read.tables.front().component)), file_name, sha256_hex(whole)});
  return read;
}

}  // namespace ecs::controllers
