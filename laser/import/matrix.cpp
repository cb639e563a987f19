#include "laser/import/matrix.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kMostAlong = 10'000;  ///< points along an axis

/// A row of cells with its place in the file.
struct MatrixRow {
  std::vector<std::string_view> cells;
  int text_line = 0;
  std::string_view whole;
};

/// What a file states besides its cells.
struct MatrixContents {
  std::map<std::string, double, std::less<>> named;  ///< names in lower case
  std::vector<MatrixRow> rows;
  std::vector<MetadataEntry> comments;
  std::vector<std::string> notes;
};

std::vector<std::string_view> matrix_cells(std::string_view line, char delimiter) {
  std::vector<std::string_view> cells;
  for (const std::string_view part : split(line, delimiter)) cells.push_back(trimmed(part));
  if (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

/// Sorts the lines of a file into names with values, headings with values below them, rows of cells, and comments.
class MatrixLines {
 public:
  explicit MatrixLines(const MatrixLayout& layout) : layout_(layout) {}

  MatrixContents contents(std::string_view text) {
    const auto lines = lines_of(text);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::string_view line = trimmed(lines[i]);
      if (!layout_.line_prefix.empty() && line.starts_with(layout_.line_prefix))
        line = trimmed(line.substr(layout_.line_prefix.size()));
      if (!line.empty() && is_inside(line)) take(line, lines[i], static_cast<int>(i) + 1);
    }
    keep_as_comment();
    return std::move(contents_);
  }

 private:
  bool is_inside(std::string_view line) {
    if (layout_.section.empty()) return true;
    if (!line.starts_with('[')) return inside_;
    const bool fits = line.starts_with(layout_.section);
    if (fits && found_) contents_.notes.push_back(fmt::format("{} is not used", line));
    inside_ = fits && !found_;
    found_ = found_ || fits;
    return false;
  }

  void take(std::string_view line, std::string_view whole, int text_line) {
    if (const std::size_t equals = line.find('='); equals != std::string_view::npos) {
      if (const auto value = number_in(line.substr(equals + 1)))
        contents_.named[lower(trimmed(line.substr(0, equals)))] = *value;
      return;
    }
    const auto cells = matrix_cells(line, layout_.delimiter);
    const bool has_number = std::ranges::any_of(cells, [](auto cell) { return number_in(cell).has_value(); });
    if (!has_number && contents_.rows.empty()) {
      keep_as_comment();
      heading_ = line;
    } else if (const auto names = matrix_cells(heading_, layout_.delimiter);
               contents_.rows.empty() && names.size() > 1 && names.size() == cells.size()) {
      for (std::size_t k = 0; k < names.size(); ++k)
        if (const auto value = number_in(cells[k])) contents_.named[lower(names[k])] = *value;
      heading_ = {};
    } else {
      contents_.rows.push_back({cells, text_line, whole});
    }
  }

  void keep_as_comment() {
    if (!heading_.empty()) contents_.comments.push_back({"", std::string(heading_)});
    heading_ = {};
  }

  const MatrixLayout& layout_;
  MatrixContents contents_;
  std::string_view heading_;
  bool inside_ = false, found_ = false;
};

/// A number, or what the file states under one of the names.
std::optional<double> stated(const MatrixContents& contents, std::string_view text) {
  if (const auto number = number_in(text)) return number;
  for (const std::string_view name : split(text, '|'))
    if (const auto at = contents.named.find(lower(trimmed(name))); at != contents.named.end()) return at->second;
  return std::nullopt;
}

struct Places {
  double first_mm = 0.0, step_mm = 0.0;
  std::size_t count = 0;
  [[nodiscard]] double at(std::size_t i) const { return first_mm + static_cast<double>(i) * step_mm; }
};

/// @param present  cells of a row, or rows
std::optional<Places> places_of(const MatrixContents& contents, const MatrixAxis& axis, std::size_t present,
                                Findings& findings) {
  const auto wanted = [&](std::string_view what, const std::string& name) {
    findings.add(0, 0, "{}: expected {} ({}), found none", letter_of(axis.axis), what, name);
    return std::nullopt;
  };
  const auto first_mm = stated(contents, axis.first_mm);
  if (!first_mm) return wanted("the first position", axis.first_mm);
  Places places{*first_mm, 0.0, present};
  if (!axis.count.empty()) {
    const auto count = stated(contents, axis.count);
    if (count && (*count < 1.0 || *count > static_cast<double>(kMostAlong)))
      return wanted("a plausible count", axis.count);
    if (count) places.count = static_cast<std::size_t>(*count);
  }
  if (axis.last_mm.empty()) {
    const auto step_mm = stated(contents, axis.step_mm);
    if (!step_mm || *step_mm <= 0.0) return wanted("a step above 0", axis.step_mm);
    places.step_mm = *step_mm;
  } else {
    const auto last_mm = stated(contents, axis.last_mm);
    if (!last_mm) return wanted("the last position", axis.last_mm);
    if (places.count < 2) return wanted("two points at least", axis.last_mm);
    places.step_mm = (*last_mm - *first_mm) / static_cast<double>(places.count - 1);
  }
  return places;
}

/// Readings of the moving axis along the cells of a row, at the place of each row along the other.
Result<MeasurementSet> read_matrix(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  const MatrixLayout& layout = *options.matrix;
  const auto& [along_cells, along_rows] = layout.axes;
  MatrixContents contents = MatrixLines(layout).contents(text);
  MeasurementSet set;
  set.source = file_name;
  set.metadata = std::move(contents.comments);
  set.notes = std::move(contents.notes);
  Findings findings(file_name);
  if (contents.rows.empty()) return problem_at(file_name, 0, 0, "expected rows of values, found none");
  const auto cells = places_of(contents, along_cells, contents.rows.front().cells.size(), findings);
  const auto rows = places_of(contents, along_rows, contents.rows.size(), findings);
  if (!cells || !rows) return tl::unexpected(findings.as_problem());
  if (contents.rows.size() < rows->count)
    findings.add(0, 0, "expected {} rows ({}), found {}: the file is truncated", rows->count, along_rows.count,
                 contents.rows.size());
  std::size_t absent = 0;
  const double factor = options.reading_unit ? options.reading_unit->factor * kUmPerMm : 1.0;
  for (std::size_t r = 0; r < std::min(rows->count, contents.rows.size()); ++r) {
    const MatrixRow& row = contents.rows[r];
    if (row.cells.size() != cells->count) {
      findings.add(row.text_line, 1, "expected {} values in the row, found {}", cells->count, row.cells.size());
      continue;
    }
    for (std::size_t c = 0; c < cells->count; ++c) {
      if (row.cells[c] == layout.absent) {
        ++absent;
        continue;
      }
      const auto value = number_in(row.cells[c]);
      if (!value) {
        findings.add(row.text_line, column_of(row.whole, row.cells[c]),
                     "expected a number, found " + in_quotes(row.cells[c]));
        continue;
      }
      Reading reading;
      reading.line = row.text_line;
      reading.axis = options.axis.value_or(along_cells.axis);
      reading.sense = options.sense.value_or(static_cast<Sense>(index_of(reading.axis)));
      reading.position_mm = options.parked_mm;
      reading.position_mm[index_of(along_cells.axis)] = cells->at(c);
      reading.position_mm[index_of(along_rows.axis)] = rows->at(r);
      reading.error = *value * factor;
      set.readings.push_back(std::move(reading));
    }
  }
  if (findings.empty() && set.readings.empty()) findings.add(0, 0, "expected values, found none");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (absent > 0)
    set.notes.push_back(
        fmt::format("{} cell{} \"{}\" left out: the file writes it for a position without a value (a "
                    "reading of zero has decimals, as in 0.000)",
                    absent, absent == 1 ? "" : "s", layout.absent));
  number_rows(set);
  return set;
}

}  // namespace

Result<std::array<MatrixAxis, 2>> matrix_axes(std::string_view text) {
  std::array<MatrixAxis, 2> axes{};
  const auto rules = split(text, ',');
  const auto wrong = problem(ProblemKind::usage,
                             "matrix: expected AXIS=FIRST..LAST*COUNT or AXIS=FIRST+STEP*COUNT, twice, as in "
                             "x=xmin..xmax,y=ymin+20, found \"{}\"",
                             text);
  if (rules.size() != axes.size()) return wrong;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::string_view rule = trimmed(rules[k]);
    const auto axis = rule.size() > 3 && rule[1] == '=' ? axis_of(static_cast<char>(rule[0] & ~0x20)) : std::nullopt;
    if (!axis) return wrong;
    std::string_view places = rule.substr(2);
    axes[k].axis = *axis;
    if (const std::size_t star = places.find('*'); star != std::string_view::npos) {
      axes[k].count = std::string(trimmed(places.substr(star + 1)));
      places = places.substr(0, star);
    }
    const std::size_t dots = places.find("..");
    const std::size_t plus = places.find('+', 1);
    if (dots == std::string_view::npos && plus == std::string_view::npos) return wrong;
    const bool has_last = dots != std::string_view::npos;
    axes[k].first_mm = std::string(trimmed(places.substr(0, has_last ? dots : plus)));
    (has_last ? axes[k].last_mm : axes[k].step_mm) =
        std::string(trimmed(places.substr(has_last ? dots + 2 : plus + 1)));
  }
  if (axes[0].axis == axes[1].axis) return wrong;
  return axes;
}

extern const FileFormat kMappedMatrix{
    .id = "mapped_matrix",
    .title = "matrix of values",
    .sample = "bed_mesh.cfg",
    .read = read_matrix,
    .units = ErrorUnits::fixed,
    .states_place = {true, true, true},
};

}  // namespace ecs::laser
