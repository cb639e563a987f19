// LinuxCNC, reading: what the file means, and where LinuxCNC itself would not follow.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "controllers/linuxcnc.hpp"
#include "laser/findings.hpp"

namespace ecs::controllers {
namespace {

struct Row {
  double nominal = 0.0, forward = 0.0, reverse = 0.0;
  int line = 0;
};

struct Word {
  std::string_view text;
  int column = 0;
};

std::vector<Word> words_of(std::string_view line) {
  std::vector<Word> words;
  std::size_t at = 0;
  while (true) {
    at = line.find_first_not_of(" \t\r\v\f", at);
    if (at == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(" \t\r\v\f", at), line.size());
    words.push_back({line.substr(at, end - at), static_cast<int>(at) + 1});
    at = end;
  }
}

/// Reading one file: rows, and what is to be said about them.
class LinuxCncReader {
 public:
  LinuxCncReader(const std::string& file, bool as_loaded) : file_(file), findings_(file), as_loaded_(as_loaded) {}

  void take(std::string_view line, int number) {
    const std::vector<Word> words = words_of(line);
    if (words.empty()) return stops(number, 1, "an empty line");
    if (words[0].text.front() == '#' || words[0].text.front() == ';')
      return stops(number, words[0].column, "a comment");
    announce_stop();
    if (stopped_ && as_loaded_) return;
    Row row;
    row.line = number;
    double* const columns[] = {&row.nominal, &row.forward, &row.reverse};
    for (std::size_t i = 0; i < 3; ++i) {
      if (i >= words.size())
        return findings_.add(number, static_cast<int>(line.size()) + 1,
                             fmt::format("expected three numbers, found {}", i));
      const auto value = number_in(words[i].text);
      if (!value) return wrong_number(words[i], number);
      *columns[i] = *value;
    }
    if (words.size() > 3) warn(number, words[3].column, "LinuxCNC does not read what follows the third number");
    keep(row, words[0].column);
  }

  /// CR alone ends a line here, not in LinuxCNC.
  void look_at_line_ends(std::string_view text) {
    int line = 1;
    for (std::size_t i = 0; i + 1 < text.size(); ++i) {
      if (text[i] == '\r' && text[i + 1] != '\n')
        return warn(line, 0,
                    "the line ends with CR alone: LinuxCNC parts lines at LF only and would take what follows for the "
                    "same line; save the file with LF");
      if (text[i] == '\n') ++line;
    }
  }

  void stops(int line, int column, std::string_view at) {
    if (!stopped_) pending_ = {line, column, std::string(at)};
    stopped_ = true;
  }

  /// After the last line.
  void finish() {
    if (rows_.empty()) findings_.add(0, 0, "no rows: expected three numbers a line, as in \"50.0 0.004 0.007\"");
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] laser::Findings& findings() { return findings_; }
  [[nodiscard]] std::vector<Problem> warnings() { return std::move(warnings_); }

 private:
  struct Stop {
    int line = 0, column = 0;
    std::string at;
  };

  void warn(int line, int column, std::string message) {
    constexpr std::size_t kMost = 20;
    if (warnings_.size() < kMost)
      warnings_.push_back({ProblemKind::bad_input, std::move(message), file_, line, column, {}});
  }

  void wrong_number(const Word& word, int line) {
    const bool comma = word.text.find(',') != std::string_view::npos;
    findings_.add(
        line, word.column,
        fmt::format("expected a number, found {}{}; LinuxCNC would stop here without a message",
                    laser::in_quotes(word.text), comma ? " (decimals take a point, blanks part the numbers)" : ""));
  }

  /// A row below a stop that LinuxCNC makes in silence: said once, when it costs something.
  void announce_stop() {
    if (pending_.at.empty()) return;
    warn(pending_.line, pending_.column,
         fmt::format("LinuxCNC stops reading at {} without a message: it uses nothing below this line", pending_.at));
    pending_.at.clear();
  }

  void keep(const Row& row, int column) {
    if (!rows_.empty() && row.nominal <= rows_.back().nominal)
      return warn(row.line, column,
                  fmt::format("nominal {} does not increase (line {} has {}): LinuxCNC drops this row, and so it is "
                              "left out here",
                              row.nominal, rows_.back().line, rows_.back().nominal));
    if (rows_.size() == kLinuxCncMostPoints) {
      if (!full_) warn(row.line, column, "LinuxCNC takes 256 points: it uses none from this line on");
      full_ = true;
    }
    if (full_ && as_loaded_) return;
    rows_.push_back(row);
  }

  std::string file_;
  laser::Findings findings_;
  bool as_loaded_ = false;
  bool stopped_ = false;
  bool full_ = false;
  Stop pending_;
  std::vector<Row> rows_;
  std::vector<Problem> warnings_;
};

/// Type 0 holds positions, type 1 small differences: told apart where one of the two is out of the question.
std::optional<int> type_by_numbers(const std::vector<Row>& rows) {
  double as_trim = 0.0, as_position = 0.0;
  for (const Row& row : rows)
    for (const double value : {row.forward, row.reverse}) {
      as_trim = std::max(as_trim, std::abs(value));
      as_position = std::max(as_position, std::abs(row.nominal - value));
    }
  constexpr double kClearly = 10.0;
  if (as_position * kClearly < as_trim) return 0;
  if (as_trim * kClearly < as_position) return 1;
  return std::nullopt;
}

}  // namespace

Result<ControllerTables> parse_linuxcnc(std::string_view text, const std::string& file_name,
                                        const LinuxCncReadOptions& options) {
  LinuxCncReader reader(file_name, options.as_loaded);
  const std::string source_text(text);
  if (text.starts_with("\xEF\xBB\xBF")) {
    text.remove_prefix(3);
    reader.stops(1, 1, "the byte order mark");
  }
  reader.look_at_line_ends(text);
  int number = 0;
  for (const std::string_view line : lines_of(text)) reader.take(line, ++number);
  if (reader.findings().empty()) reader.finish();
  if (!reader.findings().empty()) return tl::unexpected(reader.findings().as_problem());

  ControllerTables read;
  const auto type = options.type ? options.type : type_by_numbers(reader.rows());
  if (!type)
    return problem_at(file_name, 0, 0,
                      "the numbers may be positions (COMP_FILE_TYPE 0) or trims (1): say --type, as the INI file does");
  if (!options.type)
    read.notes.push_back(fmt::format("{}: taken as COMP_FILE_TYPE {} by its numbers", file_name, *type));
  const double to_mm = options.units == MachineUnits::inch ? kMmPerInch : 1.0;
  const Component component = curve_of(static_cast<Sense>(options.axis), options.axis);
  laser::MapTable forward{component, Approach::forward, {}, {}}, reverse{component, Approach::reverse, {}, {}};
  for (const Row& row : reader.rows()) {
    if (std::abs(row.nominal * to_mm) > kLargestPosition_mm)
      reader.findings().add(row.line, 1, fmt::format("{} is no position of a machine", row.nominal));
    const auto trim_um = [&](double value) { return (*type == 0 ? row.nominal - value : value) * to_mm * kUmPerMm; };
    for (const double value : {row.forward, row.reverse})
      if (std::abs(trim_um(value)) > kLargestValue_um)
        reader.findings().add(row.line, 1,
                              fmt::format("a compensation of {:.6g} mm is implausibly large: is the file of "
                                          "type {}, in these units?",
                                          trim_um(value) / kUmPerMm, *type));
    forward.position_mm.push_back(row.nominal * to_mm);
    forward.compensation.push_back(trim_um(row.forward));
    reverse.compensation.push_back(trim_um(row.reverse));
  }
  if (!reader.findings().empty()) return tl::unexpected(reader.findings().as_problem());
  reverse.position_mm = forward.position_mm;
  read.tables = {std::move(forward), std::move(reverse)};
  read.warnings = reader.warnings();
  read.sources.push_back({std::string(name_of(component)), file_name, sha256_hex(source_text)});
  return read;
}

}  // namespace ecs::controllers
