// The Etalon exchange format, reading.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "controllers/etalon.hpp"
#include "laser/findings.hpp"

namespace ecs::controllers {
namespace {

/// E or a letter of a constant, then two of X Y Z A B C 0: the shape that all names have, rotary axes among them.
bool is_a_name(std::string_view name) {
  if (name.size() != 3) return false;
  const auto among = [](char c, std::string_view set) { return set.find(c) != std::string_view::npos; };
  if (name[0] == 'E') return among(name[1], "XYZABC0") && among(name[2], "XYZABCUVW0");
  return among(name[0], "XYZABC") && name[1] == '0' && among(name[2], "XYZABCUVW");
}

class EtalonReader {
 public:
  explicit EtalonReader(const std::string& file) : findings(file) {}

  void take(std::string_view raw, int number) {
    line_ = number;
    raw_ = raw;
    const std::size_t comment = raw.find("//");
    if (comment != std::string_view::npos) head(trimmed(raw.substr(comment + 2)));
    std::string_view rest = trimmed(raw.substr(0, comment));
    while (!rest.empty()) rest = trimmed(in_grid_ ? grid(rest) : outside(rest));
    if (half_row_) findings.add(number, static_cast<int>(raw.size()) + 1, "expected a value behind the position");
    half_row_.reset();
  }

  void finish() {
    if (in_grid_) findings.add(line_, 0, fmt::format("the grid points of {} do not end with }}", name_));
    close();
    if (findings.empty() && read.tables.empty() && !any_square_)
      findings.add(0, 0,
                   "no errors of linear axes: expected sections such as [EXX] with Gridpoints, or [C0Y] with VALUE");
  }

  laser::Findings findings;
  ControllerTables read;

 private:
  [[nodiscard]] int column(std::string_view at) const { return static_cast<int>(at.data() - raw_.data()) + 1; }
  /// Where lever arms count from, as our own files say it.
  void head(std::string_view comment) {
    const bool lines = comment == kLeversFromLines;
    if (!lines && comment != kLeversFromZero) return;
    if (read.levers_from_lines && *read.levers_from_lines != lines)
      findings.add(line_, 1, "the file says both of its lever arms: from the machine zero, and from measurement lines");
    read.levers_from_lines = lines;
  }
  void wrong(std::string_view at, std::string_view expected) {
    findings.add(line_, column(at), fmt::format("expected {}, found {}", expected, laser::in_quotes(at)));
  }

  /// A section, VALUE or the beginning of a grid; what is left of the line.
  std::string_view outside(std::string_view text) {
    if (text.front() == '[') {
      const std::size_t end = text.find(']');
      if (end == std::string_view::npos) {
        wrong(text, "a name in brackets, as in [EXX]");
        return {};
      }
      open(text.substr(0, end + 1));
      return text.substr(end + 1);
    }
    if (text.front() == '{' && grid_announced_) {
      grid_announced_ = false;
      in_grid_ = true;
      return text.substr(1);
    }
    const std::string plain = lower(text.substr(0, 10));
    if (plain.starts_with("gridpoints")) {
      grid_announced_ = true;
      return after_equals(text.substr(10));
    }
    if (plain.starts_with("value")) {
      value(after_equals(text.substr(5)));
      return {};
    }
    wrong(text, "[NAME], VALUE = or Gridpoints = {");
    return {};
  }

  static std::string_view after_equals(std::string_view text) {
    text = trimmed(text);
    return text.starts_with('=') ? trimmed(text.substr(1)) : text;
  }

  void open(std::string_view bracketed) {
    close();
    std::string_view inside = trimmed(bracketed.substr(1, bracketed.size() - 2));
    name_.clear();
    for (const char c : inside) name_ += static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
    if (!is_a_name(name_)) wrong(bracketed, "a name such as EXX, EAY or C0Y");
    opened_line_ = line_;
    component_ = component_of(name_);
    if (!component_ && is_a_name(name_)) read.notes.push_back(name_ + ": no error of three linear axes, left out");
    if (component_ && !named_.insert(*component_).second)
      findings.add(line_, column(bracketed), fmt::format("{} occurs twice", name_));
  }

  void value(std::string_view text) {
    const auto number = number_in(text);
    if (!number || std::abs(*number) / kRadPerUmPerM > kLargestValue_um * kUmPerMm) return wrong_value(text);
    if (!component_) return;
    if (is_squareness(*component_)) {
      if (std::abs(*number) / kRadPerUmPerM > kLargestValue_um) return wrong_value(text);
      read.squareness[index_of(*component_)] = *number / kRadPerUmPerM;
      any_square_ = true;
    } else if (*number != 0.0) {
      findings.add(line_, 1, fmt::format("{} varies along its axis: expected Gridpoints", name_));
    }
  }
  void wrong_value(std::string_view text) {
    findings.add(line_, text.empty() ? 0 : column(text),
                 fmt::format("expected a number, found {}", laser::in_quotes(text)));
  }

  /// A word of a row `position value`; what is left of the line. The grid ends at the brace.
  std::string_view grid(std::string_view text) {
    if (text.front() == '}') {
      in_grid_ = false;
      return text.substr(1);
    }
    const std::size_t end = text.find_first_of(" \t,;}");
    if (end == 0) return text.substr(1);
    const std::string_view word = text.substr(0, end);
    const auto number = number_in(word);
    if (!number) {
      wrong(word, "a position and a value with points");
      half_row_.reset();
      return {};
    }
    if (half_row_) {
      points_.push_back({*half_row_, *number, line_});
      half_row_.reset();
    } else {
      half_row_ = *number;
    }
    return end == std::string_view::npos ? std::string_view() : text.substr(end);
  }

  struct Point {
    double position_mm = 0.0, value = 0.0;
    int line = 0;
  };

  /// The section that ends here becomes a table.
  void close() {
    std::vector<Point> points = std::move(points_);
    points_.clear();
    in_grid_ = grid_announced_ = false;
    if (points.empty() || !component_) return;
    if (is_squareness(*component_))
      return findings.add(opened_line_, 1, fmt::format("{} is one VALUE, not grid points", name_));
    if (points.size() > 1 && points.back().position_mm < points.front().position_mm)
      std::reverse(points.begin(), points.end());
    const double scale = is_angular(*component_) ? 1.0 / kRadPerUmPerM : kUmPerMm;
    laser::MapTable table{*component_, Approach::unknown, {}, {}};
    for (const Point& point : points) {
      if (!table.position_mm.empty() && point.position_mm <= table.position_mm.back())
        findings.add(point.line, 0, fmt::format("{}: the positions do not rise throughout", name_));
      if (std::abs(point.value) * scale > kLargestValue_um || std::abs(point.position_mm) > kLargestPosition_mm)
        findings.add(
            point.line, 0,
            fmt::format("{}: {} at {} is no error of a machine (mm, rad)", name_, point.value, point.position_mm));
      table.position_mm.push_back(point.position_mm);
      table.compensation.push_back(-point.value * scale + 0.0);
    }
    read.tables.push_back(std::move(table));
  }

  int line_ = 0;
  int opened_line_ = 0;
  std::string_view raw_;
  std::string name_;
  std::optional<Component> component_;
  std::set<Component> named_;
  bool in_grid_ = false;
  bool grid_announced_ = false;
  bool any_square_ = false;
  std::optional<double> half_row_;
  std::vector<Point> points_;
};

}  // namespace

Result<ControllerTables> parse_etalon(std::string_view text, const std::string& file_name) {
  EtalonReader reader(file_name);
  int number = 0;
  for (const std::string_view line : lines_of(text)) reader.take(line, ++number);
  reader.finish();
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  const auto add_source = [&](Component component) {
    reader.read.sources.push_back({std::string(name_of(component)), file_name, sha256_hex(text)});
  };
  for (const laser::MapTable& table : reader.read.tables) add_source(table.component);
  return std::move(reader.read);
}

}  // namespace ecs::controllers
