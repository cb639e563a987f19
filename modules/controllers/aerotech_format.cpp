// Aerotech calibration files, reading: tables of one axis (:START) and of two (:START2D). The layout is that of public
// writers of such files and of two real tables; no manual was at hand.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::controllers {
namespace {

constexpr int kMostColumns = 10'000, kLargestAxisNumber = 1000;

std::optional<int> axis_number_in(double value) {
  const bool is_one = value >= 0.0 && value <= kLargestAxisNumber && value == std::floor(value);
  return is_one ? std::optional(static_cast<int>(value)) : std::nullopt;
}

struct AerotechValue {
  double value = 0.0;
  int line = 0;
};

/// One table with its head.
struct AerotechTable {
  int line = 0;  ///< of its first head line
  bool two_axes = false;
  std::vector<int> words;       ///< axis numbers: axis; or row, column, and outputs
  double step[2] = {0.0, 0.0};  ///< rows (or the only axis), columns
  int columns = 1;
  std::map<std::string, std::string, std::less<>> keys;  ///< in capitals
  std::vector<std::vector<AerotechValue>> rows;          ///< lines of numbers

  [[nodiscard]] std::size_t outputs() const { return two_axes ? (keys.contains("OUTAXIS3") ? 3 : 2) : 1; }
};

class AerotechReader {
 public:
  explicit AerotechReader(const std::string& file) : findings(file) {}

  void take(std::string_view line, int number) {
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == ';' || text.front() == '\'') return;
    const std::string capitals = upper(text);
    if (capitals.starts_with(":START")) {
      take_head(line, number, capitals.starts_with(":START2D"));
    } else if (capitals.starts_with(":END")) {
      open_ = false;
    } else if (!open_) {
      findings.add(number, 1, "expected :START or :START2D before the corrections, found " + laser::in_quotes(text));
    } else {
      take_row(line, number);
    }
  }

  laser::Findings findings;
  std::vector<AerotechTable> tables;

 private:
  void take_head(std::string_view line, int number, bool two_axes) {
    const bool goes_on = open_ && tables.back().rows.empty() && tables.back().two_axes == two_axes;
    if (!goes_on) {
      tables.emplace_back();
      tables.back().line = number;
      tables.back().two_axes = two_axes;
    }
    open_ = true;
    AerotechTable& table = tables.back();
    std::vector<double> numbers;
    for (const std::string_view word : blank_words(line)) {
      if (word.front() == ':') continue;
      if (const std::size_t equals = word.find('='); equals != std::string_view::npos)
        table.keys[upper(word.substr(0, equals))] = upper(word.substr(equals + 1));
      else if (const auto value = number_in(word))
        numbers.push_back(*value);
      else
        table.keys[upper(word)] = "1";
    }
    if (!numbers.empty()) take_numbers(table, numbers, number);
  }

  void take_numbers(AerotechTable& table, const std::vector<double>& numbers, int line) {
    const std::size_t wanted = table.two_axes ? 7 : 1;
    if (numbers.size() != wanted)
      return findings.add(line, 1,
                          table.two_axes ? "expected :START2D ROWAXIS COLUMNAXIS OUT1 OUT2 ROWSTEP COLUMNSTEP COLUMNS"
                                         : "expected :START AXIS SAMPLEDIST=STEP");
    for (std::size_t i = 0; i < (table.two_axes ? 4U : 1U); ++i) {
      const auto axis = axis_number_in(numbers[i]);
      if (!axis)
        return findings.add(line, 1, "expected an axis number from 0 to {}, found {}", kLargestAxisNumber, numbers[i]);
      table.words.push_back(*axis);
    }
    if (!table.two_axes) return;
    table.step[0] = numbers[4];
    table.step[1] = numbers[5];
    if (!(numbers[6] >= 1.0 && numbers[6] <= kMostColumns))
      return findings.add(line, 1, "expected 1 to {} columns, found {}", kMostColumns, numbers[6]);
    table.columns = static_cast<int>(numbers[6]);
  }

  void take_row(std::string_view line, int number) {
    AerotechTable& table = tables.back();
    std::vector<AerotechValue> row;
    for (const std::string_view word : blank_words(line)) {
      const auto value = number_in(word);
      if (!value)
        return findings.add(number, laser::column_of(line, word),
                            "expected a correction, found " + laser::in_quotes(word));
      row.push_back({*value, number});
    }
    const std::size_t expected = static_cast<std::size_t>(table.columns) * table.outputs();
    if (table.two_axes && row.size() != expected)
      return findings.add(number, 1, "expected {} numbers in a row ({} columns of {} outputs), found {}", expected,
                          table.columns, table.outputs(), row.size());
    table.rows.push_back(std::move(row));
  }

  bool open_ = false;
};

/// Factor to mm of "METRIC", "ENGLISH", "PRIMARY/1000"; 0 for other words.
double unit_mm(const AerotechTable& table, std::string_view key) {
  const auto found = table.keys.find(key);
  const std::string_view word = found == table.keys.end() ? std::string_view("METRIC") : found->second;
  const std::size_t slash = word.find('/');
  const double divisor = slash == std::string_view::npos ? 1.0 : number_in(word.substr(slash + 1)).value_or(0.0);
  const std::string_view unit = word.substr(0, slash);
  if (!(divisor > 0.0)) return 0.0;
  if (unit == "METRIC" || unit == "PRIMARY") return 1.0 / divisor;
  return unit == "ENGLISH" ? kMmPerInch / divisor : 0.0;
}

double number_of(const AerotechTable& table, std::string_view key) {
  const auto found = table.keys.find(key);
  return found == table.keys.end() ? 0.0 : number_in(found->second).value_or(0.0);
}

/// Positions of one axis with the values there, put in ascending order.
laser::MapTable curve_at(Component component, const std::vector<double>& places_mm, const std::vector<double>& values) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < places_mm.size(); ++i) order.push_back(i);
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return places_mm[a] < places_mm[b]; });
  laser::MapTable table{component, Approach::unknown, {}, {}};
  for (const std::size_t i : order) {
    table.position_mm.push_back(places_mm[i]);
    table.compensation.push_back(values[i] + 0.0);
  }
  return table;
}

/// What the tables of a file mean for a machine of three axes.
class AerotechMeaning {
 public:
  AerotechMeaning(AerotechReader& reader, std::map<int, Axis> axes) : reader_(reader), axes_(std::move(axes)) {}

  void take(const AerotechTable& table) {
    const double position = unit_mm(table, "POSUNIT"), correction = unit_mm(table, "CORUNIT");
    if (position == 0.0 || correction == 0.0)
      return wrong(table,
                   "expected the units METRIC, ENGLISH or PRIMARY, with a divisor such as /1000 if there is one");
    if (table.words.empty() || table.rows.empty())
      return wrong(table, "expected axis numbers and corrections, found none");
    to_um_ = correction * kUmPerMm * (table.keys.contains("NEGCOR") ? -1.0 : 1.0);
    to_mm_ = position;
    table.two_axes ? take_plane(table) : take_line(table);
  }

  ControllerTables read;

 private:
  void wrong(const AerotechTable& table, std::string message) {
    reader_.findings.add(table.line, 1, std::move(message));
  }

  std::optional<Axis> axis_of_number(int number) const {
    const auto found = axes_.find(number);
    return found == axes_.end() ? std::nullopt : std::optional(found->second);
  }

  std::optional<Axis> moving_axis_of(const AerotechTable& table, int number) {
    const auto axis = axis_of_number(number);
    if (!axis)
      wrong(table,
            fmt::format("axis number {} is not an axis of the machine: assign the numbers, as in --axes X={},Y=2,Z=3",
                        number, number));
    return axis;
  }

  void take_line(const AerotechTable& table) {
    const auto axis = moving_axis_of(table, table.words.front());
    const double step = number_of(table, "SAMPLEDIST") * to_mm_;
    if (!axis) return;
    if (step == 0.0) return wrong(table, "expected SAMPLEDIST=STEP, found none");
    std::vector<double> places, values;
    for (const auto& row : table.rows)
      for (const AerotechValue& value : row) {
        places.push_back(static_cast<double>(places.size()) * step);
        values.push_back(value.value * to_um_);
      }
    add(table, curve_at(positioning_curve(*axis), places, values));
    if (table.keys.contains("HOMEOFFSET") || table.keys.contains("HOMEDIRECTION"))
      read.notes.push_back(
          fmt::format("line {}: positions count from home as set by HOMEOFFSET and HOMEDIRECTION: they are assumed to "
                      "be machine coordinates",
                      table.line));
  }

  void take_plane(const AerotechTable& table) {
    const auto along_rows = moving_axis_of(table, table.words[0]),
               along_columns = moving_axis_of(table, table.words[1]);
    if (!along_rows || !along_columns) return;
    if (along_rows == along_columns || table.step[0] == 0.0 || table.step[1] == 0.0)
      return wrong(table, "expected two different axes and steps that are not 0");
    for (std::size_t out = 0; out < table.outputs(); ++out) {
      const auto number = out < 2 ? table.words[2 + out] : axis_number_in(number_of(table, "OUTAXIS3"));
      if (!number)
        return wrong(table, fmt::format("OUTAXIS3: expected an axis number from 0 to {}", kLargestAxisNumber));
      if (const auto output = axis_of_number(*number))
        take_output(table, out, *output, *along_rows, *along_columns);
      else
        read.notes.push_back(fmt::format("line {}: the corrections of axis number {} are ignored: it is not in --axes",
                                         table.line, *number));
    }
  }

  /// A correction c(row, column) as the sum of a curve of each axis: means of columns and of rows (least squares where
  /// every place counts the same).
  void take_output(const AerotechTable& table, std::size_t out, Axis output, Axis along_rows, Axis along_columns) {
    const auto at = [&](std::size_t r, std::size_t c) {
      return table.rows[r][c * table.outputs() + out].value * to_um_;
    };
    std::vector<std::size_t> rows, columns;  // those that hold a value
    for (std::size_t r = 0; r < table.rows.size(); ++r)
      for (std::size_t c = 0; c < static_cast<std::size_t>(table.columns); ++c) {
        if (at(r, c) == 0.0) continue;
        if (rows.empty() || rows.back() != r) rows.push_back(r);
        columns.push_back(c);
      }
    std::ranges::sort(columns);
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    const std::string name = fmt::format("line {}: {} by {} and {}", table.line, letter_of(output),
                                         letter_of(along_rows), letter_of(along_columns));
    if (rows.size() < 2 || columns.size() < 2) {
      read.notes.push_back(name + ": zero, or one row or column: ignored");
      return;
    }
    std::vector<double> by_row(rows.size(), 0.0), by_column(columns.size(), 0.0);
    double mean = 0.0;
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const double value = at(rows[r], columns[c]);
        by_row[r] += value / static_cast<double>(columns.size());
        by_column[c] += value / static_cast<double>(rows.size());
        mean += value / static_cast<double>(rows.size() * columns.size());
      }
    double squares = 0.0, largest = 0.0;
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const double left = at(rows[r], columns[c]) - by_row[r] - by_column[c] + mean;
        squares += left * left;
        largest = std::max(largest, std::abs(left));
      }
    for (double& value : by_row) value -= mean;
    add(table, curve_at(ecs::curve_of(static_cast<Sense>(output), along_columns),
                        places_of(columns, number_of(table, "OFFSETCOL"), table.step[1]), by_column));
    add(table, curve_at(ecs::curve_of(static_cast<Sense>(output), along_rows),
                        places_of(rows, number_of(table, "OFFSETROW"), table.step[0]), by_row));
    read.notes.push_back(
        fmt::format("{}: separated into a curve along each axis; the part that needs a two-axis table is ignored: rms "
                    "{:.3g} um, {:.3g} um at most; rows and columns of zeros at the border are treated as unmeasured",
                    name, std::sqrt(squares / static_cast<double>(rows.size() * columns.size())), largest));
  }

  std::vector<double> places_of(const std::vector<std::size_t>& indices, double offset, double step) const {
    std::vector<double> places;
    for (const std::size_t i : indices) places.push_back((offset + static_cast<double>(i) * step) * to_mm_);
    return places;
  }

  void add(const AerotechTable& table, laser::MapTable curve) {
    for (std::size_t i = 0; i < curve.position_mm.size(); ++i)
      if (!(std::abs(curve.position_mm[i]) <= kLargestPosition_mm) ||
          !(std::abs(curve.compensation[i]) <= kLargestValue_um))
        return wrong(table, fmt::format("a correction of {:.6g} um at {:.6g} mm is implausible: check the units",
                                        curve.compensation[i], curve.position_mm[i]));
    read.tables.push_back(std::move(curve));
  }

  AerotechReader& reader_;
  std::map<int, Axis> axes_;
  double to_um_ = 1.0;
  double to_mm_ = 1.0;
};

Result<std::map<int, Axis>> axes_of(const OptionValues& options) {
  std::map<int, Axis> axes{{1, Axis::X}, {2, Axis::Y}, {3, Axis::Z}};
  const auto pairs = axis_pairs(options.text("axes"));
  if (!pairs.empty()) axes.clear();
  for (const auto& [axis, word] : pairs) {
    const auto number = integer_in(word);
    if (!axis || !number || *number < 0 || *number > kLargestAxisNumber)
      return problem(ProblemKind::usage, "--axes: expected axis numbers, as in X=1,Y=2,Z=4, got \"{}\"",
                     options.text("axes"));
    axes[static_cast<int>(*number)] = *axis;
  }
  return axes;
}

Result<ControllerTables> read_aerotech(const ReadRequest& request) {
  ECS_TRY(axes, axes_of(request.options));
  AerotechReader reader(request.file_name);
  for (const NumberedLine& line : numbered_lines_of(request.text)) reader.take(line.text, line.number);
  if (reader.findings.empty() && reader.tables.empty())
    reader.findings.add(0, 0, "expected :START or :START2D, found none");
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  AerotechMeaning meaning(reader, axes);
  for (const AerotechTable& table : reader.tables) meaning.take(table);
  if (reader.findings.empty() && meaning.read.tables.empty())
    reader.findings.add(
        reader.tables.front().line, 1,
        "it contains no correction of an axis of the machine: assign the axis numbers, as in --axes X=1,Y=2,Z=4");
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  for (const laser::MapTable& table : meaning.read.tables)
    meaning.read.sources.push_back(
        {std::string(name_of(table.component)), request.file_name, sha256_hex(std::string(request.bytes))});
  return std::move(meaning.read);
}

}  // namespace

extern const ControllerFormat aerotech_format{
    .id = "aerotech",
    .title = "Aerotech calibration file",
    .name = "Aerotech",
    .marks = ":START or :START2D",
    .place = 60,
    .holds = {"read", "–", "read", "–", "–", "any, even steps"},
    .tables_add_up = true,
    .read_options = {{.name = "axes", .help = "axis numbers; default X=1,Y=2,Z=3"}},
    .recognises = [](std::string_view text) { return upper(text).find(":START") != std::string::npos; },
    .read = read_aerotech,
};

}  // namespace ecs::controllers
