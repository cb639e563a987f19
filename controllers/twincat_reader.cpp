// TwinCAT CNC and ISG kernels, reading: the leadscrew part of a compensation value list.
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "controllers/twincat.hpp"
#include "controllers/twincat_list.hpp"
#include "laser/findings.hpp"

namespace ecs::controllers {
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
      findings.add(number, 1,
                   fmt::format("expected an entry such as kw.ssfk.unit 1 or kopf.achs_nr 1, found {}",
                               laser::in_quotes(trimmed(line))));
    }
  }

  /// Both tables on the points of the list, as compensation. @pre no findings
  [[nodiscard]] std::vector<laser::MapTable> tables(Axis axis) {
    const Component component = curve_of(static_cast<Sense>(axis), axis);
    laser::MapTable forward{component, Approach::forward, {}, {}}, reverse{component, Approach::reverse, {}, {}};
    check_general();
    if (!findings.empty()) return {};
    const bool two = value_of("bilateral") == 1.0;
    const auto points = static_cast<long long>(value_of("kw_nr_max"));
    if (!table_.empty() && table_.rbegin()->first >= points)
      findings.add(
          first_line(table_.rbegin()->second), 1,
          fmt::format("table[{}] lies beyond the {} points that kw_nr_max announces", table_.rbegin()->first, points));
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
                   fmt::format("the list is of axis {}: a map holds X, Y and Z; give --axis if it is one of them",
                               laser::in_quotes(name_)));
      return std::nullopt;
    }
    std::optional<Axis> by_number;
    const auto number = general_.find("kopf.achs_nr");
    if (number != general_.end())
      for (const Axis one : kAllAxes)
        if (number->second.value == options_.axis_number[index_of(one)]) by_number = one;
    if (by_name && by_number && *by_name != *by_number) {
      findings.add(
          number->second.line, 1,
          fmt::format("the name of the axis says {}, its number {} is that of {}: give --axes with the numbers "
                      "of the control, or --axis",
                      letter_of(*by_name), number->second.value, letter_of(*by_number)));
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
      out.push_back(fmt::format("{}: {} is no leadscrew compensation, left out", file, other));
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
        findings.add(line_, 1, "this comment says another sign than the one before it: read one list at a time");
      else if (options_.adds.value_or(adds) != adds)
        findings.add(
            line_, 1,
            fmt::format("the list was written with --ssfk-sign {}, which --ssfk-sign {} contradicts: leave the option "
                        "away",
                        sign_name(adds), sign_name(!adds)));
      says_adds_ = adds;
    }
  }
  static const char* sign_name(bool adds) { return adds ? "adds" : "subtracts"; }
  [[nodiscard]] double sign() const { return options_.adds.value_or(says_adds_.value_or(false)) ? 1.0 : -1.0; }

  std::optional<Entry> number(const TwinCatAssignment& a) {
    const auto value = number_in(a.value);
    if (value) return Entry{*value, line_};
    findings.add(line_, a.column, fmt::format("expected a number, found {}", laser::in_quotes(a.value)));
    return std::nullopt;
  }

  void keep(const std::string& key, const TwinCatAssignment& a) {
    const auto value = number(a);
    if (!value) return;
    if (!general_.emplace(key, *value).second)
      findings.add(line_, 1, fmt::format("{} occurs twice (also in line {})", key, general_[key].line));
  }

  void general(const TwinCatAssignment& a) {
    static const std::set<std::string> kKnown{"unit",      "interval", "kw_startpos",       "kw_nr_max",
                                              "bilateral", "modulo",   "manual_activation", "set_pos_without_comp",
                                              "max_points"};
    const std::string key = a.key.substr(8);
    if (kKnown.count(key) == 0)
      return findings.add(line_, 1, fmt::format("expected an entry of kw.ssfk, found {}", laser::in_quotes(a.key)));
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
      return findings.add(line_, 1,
                          fmt::format("expected kw.ssfk.table[0] and so on with .setpoint, .pos or .neg, found {}",
                                      laser::in_quotes(a.key)));
    const auto value = number(a);
    if (!value) return;
    Row& row = table_[*index];
    auto& entry = what == ".setpoint" ? row.setpoint : what == ".pos" ? row.pos : row.neg;
    if (entry) findings.add(line_, 1, fmt::format("{} occurs twice (also in line {})", a.key, entry->line));
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
        findings.add(line_of(flag), 1, fmt::format("kw.ssfk.{}: expected 0 or 1, found {}", flag, value));
    if (value_of("unit") == 0.0)
      findings.add(line_of("unit"), line_of("unit") > 0 ? 1 : 0,
                   "kw.ssfk.unit is not 1: the list is in increments of an encoder, whose length it does not say");
    if (value_of("modulo") == 1.0)
      findings.add(line_of("modulo"), 1, "kw.ssfk.modulo 1: a rotary axis, a map holds linear ones");
    if (const double interval = value_of("interval");
        interval < 0.0 || std::abs(interval) > kLargestPosition_mm * kTenthsPerMm)
      findings.add(line_of("interval"), 1, "kw.ssfk.interval: expected the step between points, or 0");
    const double points = value_of("kw_nr_max");
    if (points < 1.0 || points > static_cast<double>(kMostPoints) || points != std::floor(points))
      findings.add(
          line_of("kw_nr_max"), line_of("kw_nr_max") > 0 ? 1 : 0,
          fmt::format("kw.ssfk.kw_nr_max: expected the number of points, a whole number from 1 to {}", kMostPoints));
  }

  void point(long long i, bool two, laser::MapTable& forward, laser::MapTable& reverse) {
    const Row row = table_.count(i) > 0 ? table_[i] : Row();
    const auto missing = [&](const char* what) {
      findings.add(first_line(row), 0,
                   fmt::format("kw.ssfk.table[{}].{} is missing: the control would take 0", i, what));
    };
    const double interval = value_of("interval");
    if (interval == 0.0 && !row.setpoint) return missing("setpoint");
    if (!row.pos) return missing("pos");
    if (two && !row.neg) return missing("neg");
    if (!two && row.neg && row.neg->value != row.pos->value && row.neg->value != 0.0)
      return findings.add(
          row.neg->line, 1,
          "neg differs from pos in a list for one direction (kw.ssfk.bilateral is not 1): which of them "
          "the control takes is not known");
    const double place =
        interval == 0.0 ? row.setpoint->value : value_of("kw_startpos") + interval * static_cast<double>(i);
    const double place_mm = place / kTenthsPerMm;
    const double forward_um = sign() * row.pos->value / kTenthsPerUm;
    const double reverse_um = two ? sign() * row.neg->value / kTenthsPerUm : forward_um;
    if (std::abs(place_mm) > kLargestPosition_mm)
      return findings.add(first_line(row), 1, fmt::format("{} mm is no position of a machine", place_mm));
    if (!forward.position_mm.empty() && place_mm <= forward.position_mm.back())
      return findings.add(first_line(row), 1, fmt::format("position {} mm does not rise", place_mm));
    for (const double value : {forward_um, reverse_um})
      if (std::abs(value) > kLargestValue_um)
        findings.add(row.pos->line, 1, fmt::format("an error of {:.6g} mm is implausibly large", value / 1000.0));
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
  int number = 0;
  for (const std::string_view line : lines_of(text)) reader.take(line, ++number);
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
