// SINUMERIK 840D, reading: assignments first, then whole tables.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

constexpr double kLeastStep_mm = 1e-6;
constexpr long long kMostIndex = 100'000;

/// `$AN_CEC_STEP[3]=10` taken apart. Lower case, without blanks.
struct SiemensAssignment {
  bool encoder = false;            ///< $AA_ENC_COMP, else $AN_CEC
  std::string field;               ///< "" a value; "step", "min", "max", "is_modulo", "input_axis" …
  std::vector<std::string> index;  ///< what stands between the brackets
  std::string value;
  int column = 0;  ///< of the value
};

/// A table as far as the file tells.
struct Draft {
  std::map<long long, double> value;  ///< mm, by point
  std::optional<double> step, min, max;
  std::string input, output;  ///< axis names of a cross table
  int direction = 0;
  bool modulo = false;
  bool multiplied = false;
  int line = 0;  ///< where it is first named
};
using Drafts = std::map<std::pair<bool, std::string>, Draft>;  ///< by kind and "encoder,axis" or table number

std::string without_blanks(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '\t') out += c;
  return lower(out);
}

/// Numbers with a point; the exponent of the control is written EX.
std::optional<double> value_of(std::string text) {
  if (const std::size_t at = text.find("ex"); at != std::string::npos) text.replace(at, 2, "e");
  return number_in(text);
}

bool is_frame(const std::string& line) {
  if (line.starts_with("%") || line.starts_with("chandata(") || line == "ret") return true;
  for (const std::string_view data : {"$ma_", "$mn_", "$mc_", "$sn_", "$sa_", "$sc_", "$md_"})
    if (line.starts_with(data)) return true;
  for (const std::string_view word : {"m0", "m00", "m1", "m01", "m2", "m02", "m17", "m30", "newconf", "stopre", "g4f1"})
    if (line == word) return true;
  return false;
}

/// `N120 ` in front of a line.
std::string_view after_number(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos || (line[first] != 'N' && line[first] != 'n')) return line;
  std::size_t at = first + 1;
  while (at < line.size() && line[at] >= '0' && line[at] <= '9') ++at;
  return at > first + 1 ? line.substr(at) : line;
}

std::vector<std::string> index_in(const std::string& text) {
  const char part = text.find(',') == std::string::npos ? '.' : ',';
  std::vector<std::string> words;
  for (const std::string_view word : split(text, part)) words.emplace_back(word);
  return words;
}

/// Nothing if the line is no assignment of these two variables.
std::optional<SiemensAssignment> siemens_assignment_in(std::string_view line) {
  const std::size_t open = line.find('['), close = line.find(']');
  if (open == std::string_view::npos || close == std::string_view::npos || close < open) return std::nullopt;
  std::string name = without_blanks(line.substr(0, open));
  SiemensAssignment made;
  for (const std::string_view variable : {"$aa_enc_comp", "$an_cec"}) {
    if (!name.starts_with(variable)) continue;
    made.encoder = variable == "$aa_enc_comp";
    made.field = name.substr(variable.size());
    if (!made.field.empty() && made.field.front() != '_') return std::nullopt;
    if (!made.field.empty()) made.field.erase(0, 1);
    made.index = index_in(without_blanks(line.substr(open + 1, close - open - 1)));
    std::size_t from = close + 1;
    while (from < line.size() && (line[from] == ' ' || line[from] == '\t' || line[from] == '=')) ++from;
    made.value = without_blanks(line.substr(from));
    made.column = static_cast<int>(from) + 1;
    return made;
  }
  return std::nullopt;
}

class SiemensReader {
 public:
  SiemensReader(const std::string& file, const SiemensOptions& options) : findings(file), options_(options) {
    if (options.cec_adds) cec_sign_ = 1.0;
  }

  void take(std::string_view line, int number) {
    line = line.substr(0, line.find(';'));
    const std::string_view content = after_number(line);
    const int shift = static_cast<int>(line.size() - content.size());
    const std::string plain = without_blanks(content);
    if (plain.starts_with("%")) ended_ = 0;  // another program in the same file
    if (plain == "m17" || plain == "m30" || plain == "m02" || plain == "m2") ended_ = ended_ == 0 ? number : ended_;
    if (plain.empty() || is_frame(plain)) return;
    auto assignment = siemens_assignment_in(content);
    if (assignment && ended_ != 0)
      return findings.add(
          number, 1,
          "it follows the end of the program in line {}: a control does not read it; remove it, or remove that end",
          ended_);
    if (!assignment) {
      const std::size_t first = line.find_first_not_of(" \t");
      findings.add(number, static_cast<int>(first) + 1,
                   "expected $AA_ENC_COMP…[…]=…, $AN_CEC…[…]=…, CHANDATA or M17, found {}",
                   laser::in_quotes(trimmed(line)));
      return;
    }
    assignment->column += shift;
    if (assignment->encoder)
      take_encoder(*assignment, number);
    else
      take_cross(*assignment, number);
  }

  ControllerTables tables() {
    ControllerTables read;
    for (const auto& [key, draft] : drafts_) finish(key.first, key.second, draft, read);
    return read;
  }

  laser::Findings findings;

 private:
  void wrong(const SiemensAssignment& a, int line, std::string_view expected) {
    findings.add(line, a.column, "expected {}, found {}", expected, laser::in_quotes(a.value));
  }

  Draft& draft_of(const SiemensAssignment& a, const std::string& key, int line) {
    Draft& draft = drafts_[{a.encoder, key}];
    if (draft.line == 0) draft.line = line;
    return draft;
  }

  void take_encoder(const SiemensAssignment& a, int line) {
    const std::size_t wanted = a.field.empty() ? 3 : 2;
    if (a.index.size() != wanted)
      return findings.add(line, 1, "expected {} in the brackets, found {} entries",
                          wanted == 3 ? "[encoder,point,axis]" : "[encoder,axis]", a.index.size());
    Draft& draft = draft_of(a, a.index.front() + "," + a.index.back(), line);
    draft.input = draft.output = a.index.back();
    take_field(a, draft, wanted == 3 ? a.index[1] : "", line);
  }

  void take_cross(const SiemensAssignment& a, int line) {
    const std::size_t wanted = a.field.empty() ? 2 : 1;
    if (a.index.size() != wanted || !integer_in(a.index.front()))
      return findings.add(line, 1, "expected {} in the brackets", wanted == 2 ? "[table,point]" : "[table]");
    Draft& draft = draft_of(a, a.index.front(), line);
    take_field(a, draft, wanted == 2 ? a.index[1] : "", line);
  }

  void take_field(const SiemensAssignment& a, Draft& draft, const std::string& point, int line) {
    if (a.field == "input_axis" || a.field == "output_axis") {
      std::string& name = a.field == "input_axis" ? draft.input : draft.output;
      name = a.value;
      std::erase_if(name, [](char c) { return c == '(' || c == ')' || c == '"'; });
      if (name.empty()) wrong(a, line, "an axis in parentheses, as in (AX1)");
      return;
    }
    const auto value = value_of(a.value);
    if (!value) return wrong(a, line, "a number with a point");
    if (a.field.empty()) {
      const auto k = integer_in(point);
      if (!k || *k < 0 || *k > kMostIndex)
        return findings.add(line, 1, "expected a point from 0, found {}", laser::in_quotes(point));
      if (std::abs(*value) * kUmPerMm > kLargestValue_um) return wrong(a, line, "a value in mm within ±32");
      const auto [before, first] = draft.value.emplace(*k, *value);
      if (!first && before->second != *value)
        return findings.add(line, 1, "point {} has two values in this file: keep only one", *k);
    } else if (a.field == "step") {
      draft.step = *value;
    } else if (a.field == "min") {
      draft.min = *value;
    } else if (a.field == "max") {
      draft.max = *value;
    } else if (a.field == "is_modulo") {
      draft.modulo = *value != 0.0;
    } else if (a.field == "mult_by_table") {
      draft.multiplied = *value != 0.0;
    } else if (a.field == "direction") {
      if (*value != 0.0 && *value != 1.0 && *value != -1.0) return wrong(a, line, "a direction 0, 1 or -1");
      draft.direction = static_cast<int>(*value);
    } else if (a.field != "input_ncu" && a.field != "output_ncu") {
      findings.add(line, 1, "unknown variable: …_{}", a.field);
    }
  }

  [[nodiscard]] std::optional<Axis> axis_of_name(const std::string& name) const {
    for (const Axis axis : kAllAxes)
      if (lower(options_.axis_name[index_of(axis)]) == name) return axis;
    for (const Axis axis : kAllAxes) {
      const std::string letter(1, small_letter_of(axis));
      if (name == letter || name == letter + "1" || name == fmt::format("ax{}", index_of(axis) + 1)) return axis;
    }
    return std::nullopt;
  }

  static bool all_zero(const Draft& draft) {
    return std::ranges::all_of(draft.value, [](const auto& v) { return v.second == 0.0; });
  }

  void finish(bool encoder, const std::string& key, const Draft& draft, ControllerTables& read) {
    const std::string name = encoder ? fmt::format("$AA_ENC_COMP[{}]", key) : fmt::format("$AN_CEC[{}]", key);
    if (draft.value.empty() || (all_zero(draft) && draft.step.value_or(0.0) == 0.0)) {
      read.notes.push_back(name + ": no points, ignored");
      return;
    }
    const auto input = axis_of_name(draft.input), output = axis_of_name(draft.output);
    if ((draft.modulo || !input || !output) && all_zero(draft)) {
      read.notes.push_back(name + ": all zero, ignored");
      return;
    }
    if (encoder && key.substr(0, key.find(',')) != std::to_string(options_.encoder)) {
      read.notes.push_back(fmt::format("{}: belongs to the other measuring system, ignored (--encoder)", name));
      return;
    }
    if (draft.modulo) return findings.add(draft.line, 1, name + ": a modulo table: a map covers linear axes only");
    if (draft.multiplied)
      return findings.add(draft.line, 1, name + ": multiplied by another table: a map cannot represent the product");
    if (!input || !output)
      return findings.add(draft.line, 1, "{}: the axes {} and {} are unknown; give --axes X=NAME,Y=NAME,Z=NAME", name,
                          laser::in_quotes(draft.input), laser::in_quotes(draft.output));
    add_table(name, draft, *input, *output, encoder ? -1.0 : cec_sign_, read);
  }

  void add_table(const std::string& name, const Draft& draft, Axis input, Axis output, double sign,
                 ControllerTables& read) {
    const auto place = [](const std::optional<double>& mm) { return mm && std::abs(*mm) <= kLargestPosition_mm; };
    if (!draft.step || *draft.step < kLeastStep_mm || !place(draft.min) || !place(draft.max) || *draft.max < *draft.min)
      return findings.add(draft.line, 1, name + ": expected STEP above 0, MIN, and MAX not below it");
    const double count = std::ceil((*draft.max - *draft.min) / *draft.step - 1e-6) + 1.0;
    if (count > static_cast<double>(kMostIndex))
      return findings.add(draft.line, 1, name + ": MIN, MAX and STEP make more points than a table can have");
    const auto points = static_cast<long long>(count);
    laser::MapTable table{curve_of(static_cast<Sense>(output), input), static_cast<Approach>(draft.direction), {}, {}};
    for (long long k = 0; k < points; ++k) {
      const auto value = draft.value.find(k);
      if (value == draft.value.end())
        return findings.add(draft.line, 1, "{}: point {} of {} is missing: was the file truncated?", name, k, points);
      table.position_mm.push_back(std::min(*draft.min + *draft.step * static_cast<double>(k), *draft.max));
      table.compensation.push_back(sign * value->second * kUmPerMm + 0.0);
    }
    if (draft.value.rbegin()->first >= points)
      read.notes.push_back(fmt::format("{}: points beyond MAX are ignored, as in the control", name));
    read.tables.push_back(std::move(table));
  }

  const SiemensOptions& options_;
  double cec_sign_ = -1.0;
  Drafts drafts_;
  int ended_ = 0;  ///< line of M17 or M30; 0: not there yet
};

}  // namespace

Result<ControllerTables> parse_siemens(std::string_view text, const std::string& file_name,
                                       const SiemensOptions& options) {
  SiemensReader reader(file_name, options);
  for (const NumberedLine& line : numbered_lines_of(text)) reader.take(line.text, line.number);
  ControllerTables read;
  if (reader.findings.empty()) read = reader.tables();
  read.lines_are_squareness = true;
  if (reader.findings.empty() && read.tables.empty())
    reader.findings.add(0, 0, "no compensation table with values: expected $AA_ENC_COMP or $AN_CEC");
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  for (const laser::MapTable& table : read.tables) {
    const laser::SourceFile source{std::string(name_of(table.component)), file_name, sha256_hex(text)};
    if (std::ranges::find(read.sources, source) == read.sources.end()) read.sources.push_back(source);
  }
  return read;
}

}  // namespace ecs::controllers
