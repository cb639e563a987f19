// HEIDENHAIN, reading.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "controllers/heidenhain.hpp"
#include "laser/findings.hpp"

namespace ecs::controllers {
namespace {

constexpr double kUmPerMPerDeg = 1e6 * std::numbers::pi / 180.0;

struct ComHeading {
  std::string name;
  std::size_t begin = 0;
  std::optional<Component> component;  ///< none: NR, AXISPOS, BACKLASH, or nothing of ours
};

/// The axis that the name of a table ends in: "X.COM", "AXIS_X.COM", "axis-y.com".
std::optional<Axis> axis_of_table(const std::string& name) {
  const std::string stem = std::filesystem::path(name).stem().string();
  if (stem.empty()) return std::nullopt;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (stem.size() > 1 && is_letter(stem[stem.size() - 2])) return std::nullopt;
  return axis_of(static_cast<char>(stem.back() & ~0x20));
}

class ComReader {
 public:
  ComReader(const std::string& file, const HeidenhainOptions& options)
      : findings(file), file_(file), options_(options) {}

  void take(std::string_view line, int number) {
    if (ended_ || trimmed(line).empty()) return;
    if (!begun_) return begin(trimmed(line), number);
    if (headings_.empty() && !is_list_) return heading(line, number);
    if (trimmed(line) == "[END]") {
      ended_ = true;
      return;
    }
    if (!is_list_) row(line, number);
  }

  [[nodiscard]] bool is_list() const { return is_list_; }

  ControllerTables finish(std::string_view text) {
    ControllerTables read;
    if (!begun_) findings.add(1, 1, "expected a first line such as BEGIN X.COM MM");
    if (begun_ && !is_list_ && findings.empty()) {
      if (!ended_) findings.add(0, 0, "expected [END] behind the last row, found the end of the file: is it cut?");
      if (position_mm_.size() < 2) findings.add(0, 0, "expected two rows at least");
    }
    if (!findings.empty()) return read;
    if (is_list_) {
      read.notes.push_back(file_ + " is the list of the tables and holds no values: read the .com files themselves");
      return read;
    }
    for (std::size_t h = 0; h < headings_.size(); ++h) add_tables(read, h);
    if (read.tables.empty()) findings.add(0, 0, "no column of X, Y, Z or C1 to C6 has values");
    const std::string what = read.tables.empty() ? "" : std::string(name_of(read.tables.front().component));
    read.sources.push_back({what, file_, sha256_hex(text)});
    return read;
  }

  laser::Findings findings;

 private:
  void begin(std::string_view line, int number) {
    const std::string plain = lower(line);
    begun_ = true;
    if (!plain.starts_with("begin ") ||
        (plain.find(".com") == std::string::npos && plain.find(".cma") == std::string::npos))
      return findings.add(number, 1, fmt::format("expected BEGIN NAME.COM MM, found {}", laser::in_quotes(line)));
    is_list_ = plain.find(".cma") != std::string::npos;
    if (is_list_) return;
    if (plain.find("datum:") != std::string::npos || plain.find("distance:") != std::string::npos)
      return findings.add(number, 1,
                          "tables with DATUM and DISTANCE are not read: the layout of their rows is not known");
    if (plain.ends_with(" inch")) return findings.add(number, 1, "expected MM, found INCH");
    const std::string_view rest = trimmed(line.substr(6));
    const auto by_name = axis_of_table(std::string(rest.substr(0, rest.find(' '))));
    axis_ = options_.axis ? options_.axis : by_name ? by_name : axis_of_table(file_);
    if (!axis_) findings.add(number, 7, "the name of the table does not end in X, Y or Z: give --axis");
  }

  void heading(std::string_view line, int number) {
    for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
      headings_.push_back({std::string(line.substr(at, end - at)), at, std::nullopt});
      at = line.find_first_not_of(" \t\r", end);
    }
    values_.resize(headings_.size());
    for (std::size_t h = 0; h < headings_.size(); ++h) {
      ComHeading& one = headings_[h];
      const std::string name = lower(one.name);
      if (name == "axispos") place_ = h;
      if (name == "backlash") backlash_ = h;
      if (!axis_) continue;
      if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z')
        one.component = curve_of(static_cast<Sense>(name[0] - 'x'), *axis_);
      if (name.size() == 2 && name[0] == 'c' && name[1] >= '1' && name[1] <= '6')
        one.component = curve_of(static_cast<Sense>(name[1] - '1'), *axis_);
    }
    if (!place_) findings.add(number, 1, "expected a column AXISPOS");
  }

  /// The cells of a line, each under its heading.
  void row(std::string_view line, int number) {
    std::optional<double> place, backlash;
    std::vector<std::optional<double>> cells(headings_.size());
    for (std::size_t h = 0; h < headings_.size(); ++h) {
      const std::size_t from = h == 0 ? 0 : headings_[h].begin;
      const std::size_t to = h + 1 < headings_.size() ? headings_[h + 1].begin : line.size();
      const std::string_view cell = from < line.size() ? trimmed(line.substr(from, to - std::min(from, to))) : "";
      if (cell.empty() || (!headings_[h].component && h != place_ && h != backlash_)) continue;
      const auto value = number_in(cell);
      if (!value) {
        findings.add(number, laser::column_of(line, cell),
                     fmt::format("{}: expected a number under its heading, found {}", headings_[h].name,
                                 laser::in_quotes(cell)));
        continue;
      }
      (h == place_ ? place : h == backlash_ ? backlash : cells[h]) = *value;
    }
    if (!place) return findings.add(number, 1, "expected a position in the column AXISPOS");
    if (std::abs(*place) > kLargestPosition_mm)
      return findings.add(number, 1, fmt::format("{} mm is no position of a machine", *place));
    if (!position_mm_.empty() && *place <= position_mm_.back())
      return findings.add(number, 1,
                          fmt::format("expected a position above {}, found {}", position_mm_.back(), *place));
    position_mm_.push_back(*place);
    lines_.push_back(number);
    backlashes_.push_back(backlash);
    for (std::size_t h = 0; h < headings_.size(); ++h) values_[h].push_back(cells[h]);
  }

  [[nodiscard]] double compensation(double value, Component component, int line) {
    const double sign = options_.holds_errors ? -1.0 : 1.0;
    const double out = sign * value * (is_angular(component) ? kUmPerMPerDeg : kUmPerMm);
    if (!(std::abs(out) <= kLargestValue_um))
      findings.add(line, 1,
                   fmt::format("a compensation of {:.6g} is implausibly large: is the file in mm and degrees?", out));
    return out;
  }

  /// Those of one column; an empty cell between others is a gap in the table.
  void add_tables(ControllerTables& read, std::size_t h) {
    if (!headings_[h].component) return;
    const Component component = *headings_[h].component;
    const std::vector<std::optional<double>>& cells = values_[h];
    if (std::none_of(cells.begin(), cells.end(), [](const auto& cell) { return cell.has_value(); })) {
      if (is_positioning(component) && headings_[h].name.size() == 1 && any_backlash())
        findings.add(lines_.front(), 1, "BACKLASH has values, the column of the axis has none");
      return;
    }
    const bool own = is_positioning(component) && any_backlash();
    laser::MapTable forward{component, own ? Approach::forward : Approach::unknown, {}, {}};
    laser::MapTable reverse{component, Approach::reverse, {}, {}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (!cells[i]) continue;
      forward.position_mm.push_back(position_mm_[i]);
      forward.compensation.push_back(compensation(*cells[i], component, lines_[i]));
      reverse.compensation.push_back(compensation(backlashes_[i].value_or(*cells[i]), component, lines_[i]));
    }
    reverse.position_mm = forward.position_mm;
    for (const laser::MapTable& other : read.tables)
      if (other.component == component)
        return findings.add(
            0, 0, fmt::format("{} is in an axis column and in a column of KinematicsComp", name_of(component)));
    if (forward.position_mm.size() < 2)
      return findings.add(lines_.front(), 1, fmt::format("{}: expected two values at least", headings_[h].name));
    read.tables.push_back(std::move(forward));
    if (own) read.tables.push_back(std::move(reverse));
  }

  [[nodiscard]] bool any_backlash() const {
    return std::any_of(backlashes_.begin(), backlashes_.end(), [](const auto& one) { return one.has_value(); });
  }

  std::string file_;
  HeidenhainOptions options_;
  bool begun_ = false, ended_ = false, is_list_ = false;
  std::optional<Axis> axis_;
  std::vector<ComHeading> headings_;
  std::optional<std::size_t> place_, backlash_;
  std::vector<double> position_mm_;
  std::vector<int> lines_;
  std::vector<std::optional<double>> backlashes_;
  std::vector<std::vector<std::optional<double>>> values_;  ///< by column
};

}  // namespace

Result<ControllerTables> parse_heidenhain(std::string_view text, const std::string& file_name,
                                          const HeidenhainOptions& options) {
  ComReader reader(file_name, options);
  int number = 0;
  for (const std::string_view line : lines_of(text)) reader.take(line, ++number);
  ControllerTables read = reader.finish(text);
  if (!reader.findings.empty()) return tl::unexpected(reader.findings.as_problem());
  return read;
}

}  // namespace ecs::controllers
