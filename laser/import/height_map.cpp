// Probed surfaces: Klipper bed mesh, RepRapFirmware height map, LinuxCNC probe points, as EZ along X for each Y.
// Does not live here: what a control does with them.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/renishaw_file.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kMostAlong = 10'000;  ///< points along an axis

/// What stands between commas.
std::vector<std::string_view> cells_in(std::string_view line) {
  std::vector<std::string_view> cells;
  for (const std::string_view part : split(line, ',')) cells.push_back(trimmed(part));
  if (!cells.empty() && cells.back().empty()) cells.pop_back();
  return cells;
}

struct Height {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double z_mm = 0.0;
  int line = 0;
};

/// One direction of the grid.
struct Along {
  double first_mm = 0.0;
  double step_mm = 0.0;
  std::size_t count = 0;
  [[nodiscard]] double at(std::size_t i) const { return first_mm + static_cast<double>(i) * step_mm; }
};

/// A row of the grid as heights; "0" without a point is a place that was not probed.
void take_row(std::vector<Height>& heights, std::string_view row, const Along& x, double y_mm, int line,
              Findings& findings) {
  const auto cells = cells_in(row);
  if (cells.size() != x.count) {
    findings.add(line, 1, fmt::format("expected {} heights in the row, found {}", x.count, cells.size()));
    return;
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == "0") continue;
    const auto z_mm = number_in(cells[i]);
    if (z_mm)
      heights.push_back({x.at(i), y_mm, *z_mm, line});
    else
      findings.add(line, static_cast<int>(cells[i].data() - row.data()) + 1,
                   "expected a height in mm, found " + in_quotes(cells[i]));
  }
}

// --- RepRapFirmware

using Named = std::map<std::string, double, std::less<>>;

std::optional<double> first_of(const Named& values, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    if (const auto found = values.find(name); found != values.end()) return found->second;
  return std::nullopt;
}

std::optional<Along> along(const Named& grid, std::string_view letter, std::string_view digit) {
  const auto first_mm = first_of(grid, {fmt::format("{}min", letter), fmt::format("min{}", digit)});
  const auto count = first_of(grid, {fmt::format("{}num", letter), fmt::format("num{}", digit)});
  const auto step_mm = first_of(grid, {fmt::format("{}spacing", letter), fmt::format("spacing{}", digit), "spacing"});
  if (!first_mm || !count || !step_mm || *count < 1.0 || *count > static_cast<double>(kMostAlong) || *step_mm <= 0.0)
    return std::nullopt;
  return Along{*first_mm, *step_mm, static_cast<std::size_t>(*count)};
}

void reprap_heights(std::vector<Height>& heights, const std::vector<std::string_view>& lines, Findings& findings) {
  if (lines.size() < 4) {
    findings.add(0, 0, "expected a title, a heading, a grid line and rows of heights, found fewer lines");
    return;
  }
  const auto names = cells_in(lines[1]);
  const auto values = cells_in(lines[2]);
  Named grid;
  for (std::size_t i = 0; i < names.size() && i < values.size(); ++i)
    if (const auto value = number_in(values[i])) grid[lower(names[i])] = *value;
  const auto x = along(grid, "x", "0");
  const auto y = along(grid, "y", "1");
  if (!x || !y) {
    findings.add(3, 1,
                 "expected the grid (xmin, xmax, ymin, ymax, radius, spacing, xnum, ynum), found " +
                     in_quotes(trimmed(lines[2])));
    return;
  }
  std::size_t row = 0;
  for (std::size_t i = 3; i < lines.size(); ++i)
    if (!trimmed(lines[i]).empty() && row < y->count) {
      take_row(heights, lines[i], *x, y->at(row), static_cast<int>(i) + 1, findings);
      ++row;
    }
  if (row < y->count)
    findings.add(0, 0, fmt::format("expected {} rows (ynum), found {}: the file is cut short", y->count, row));
}

// --- Klipper

/// The first bed mesh: its keys, and its rows with their lines.
struct KlipperMesh {
  Named values;
  std::vector<std::pair<std::string_view, int>> rows;
  std::vector<std::string> others;  ///< names of further meshes
};

KlipperMesh klipper_mesh_in(const std::vector<std::string_view>& lines) {
  KlipperMesh mesh;
  bool inside = false;
  bool found = false;
  bool in_points = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string_view line = trimmed(lines[i]);
    if (line.starts_with("#*#")) line = trimmed(line.substr(3));
    if (line.starts_with('[')) {
      const bool is_mesh = line.starts_with("[bed_mesh ");
      if (is_mesh && found) mesh.others.emplace_back(line);
      inside = is_mesh && !found;
      found = found || is_mesh;
      in_points = false;
    } else if (inside && line.find('=') != std::string_view::npos) {
      const std::size_t equals = line.find('=');
      const std::string key = lower(trimmed(line.substr(0, equals)));
      in_points = key == "points";
      if (const auto value = number_in(line.substr(equals + 1))) mesh.values[key] = *value;
    } else if (inside && in_points && !line.empty()) {
      mesh.rows.emplace_back(line, static_cast<int>(i) + 1);
    }
  }
  return mesh;
}

std::optional<Along> between(const Named& values, const std::string& axis, std::size_t count) {
  const auto first = first_of(values, {"min_" + axis});
  const auto last = first_of(values, {"max_" + axis});
  if (!first || !last || count < 2 || count > kMostAlong) return std::nullopt;
  return Along{*first, (*last - *first) / static_cast<double>(count - 1), count};
}

void klipper_heights(std::vector<Height>& heights, const std::vector<std::string_view>& lines,
                     std::vector<std::string>& notes, Findings& findings) {
  const KlipperMesh mesh = klipper_mesh_in(lines);
  if (mesh.rows.empty()) {
    findings.add(0, 0, "bed_mesh: expected rows below points, found none");
    return;
  }
  const auto x = between(mesh.values, "x", cells_in(mesh.rows.front().first).size());
  const auto y = between(mesh.values, "y", mesh.rows.size());
  if (!x || !y) {
    findings.add(mesh.rows.front().second, 1,
                 "bed_mesh: expected min_x, max_x, min_y, max_y and two points each way at least");
    return;
  }
  for (const auto& [key, count] :
       {std::pair<std::string_view, std::size_t>{"x_count", x->count}, {"y_count", y->count}})
    if (const auto said = first_of(mesh.values, {key}); said && *said != static_cast<double>(count))
      findings.add(0, 0, fmt::format("bed_mesh: expected {} {}, found {} points", key, *said, count));
  for (std::size_t row = 0; row < mesh.rows.size(); ++row)
    take_row(heights, mesh.rows[row].first, *x, y->at(row), mesh.rows[row].second, findings);
  for (const std::string& other : mesh.others) notes.push_back(fmt::format("{} is not used", other));
}

// --- LinuxCNC

void probe_points(std::vector<Height>& heights, const std::vector<std::string_view>& lines, Findings& findings) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const auto numbers = numbers_of(lines[i]);
    if (numbers.size() < 3 || numbers.size() != words_of(lines[i]).size())
      findings.add(static_cast<int>(i) + 1, 1, "expected X, Y and Z, found " + in_quotes(trimmed(lines[i])));
    else
      heights.push_back({numbers[0], numbers[1], numbers[2], static_cast<int>(i) + 1});
  }
}

/// The first bed mesh of a Klipper configuration, a RepRapFirmware height map, or LinuxCNC probe points, as EZ along X
/// at each Y. Places that were not probed are left out.
Result<MeasurementSet> read_height_map(std::string_view text, const std::string& file_name, const ImportOptions&) {
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  std::vector<Height> heights;
  const auto lines = lines_of(text);
  if (text.find("[bed_mesh ") != std::string_view::npos) {
    klipper_heights(heights, lines, set.notes, findings);
  } else if (!lines.empty() && lines.front().find("height map file") != std::string_view::npos) {
    set.metadata.push_back({"", std::string(trimmed(lines.front()))});
    reprap_heights(heights, lines, findings);
  } else {
    probe_points(heights, lines, findings);
  }
  if (findings.empty() && heights.empty()) findings.add(0, 0, "expected probed heights, found none");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  for (const Height& height : heights) {
    Reading reading;
    reading.line = height.line;
    reading.axis = Axis::X;
    reading.sense = Sense::EZ;
    reading.position_mm = {height.x_mm, height.y_mm, 0.0};
    reading.error = height.z_mm * kUmPerMm;
    set.readings.push_back(std::move(reading));
  }
  set.notes.push_back("heights of a probed surface as EZ along X at each Y: the form of the surface is in them too");
  number_rows(set);
  return set;
}

Recognition recognises_height_map(const FileStart& file) {
  const auto numbers = numbers_alone(file.first_line);
  const bool is_probe_point =  // X, Y, Z and six zeros
      numbers.size() == 9 && std::all_of(numbers.begin() + 3, numbers.end(), [](double n) { return n == 0.0; });
  const bool is_mesh =
      file.text.find("[bed_mesh ") != std::string_view::npos || file.head.starts_with("reprapfirmware height map file");
  return is_mesh || is_probe_point ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kHeightMap{
    .id = "height_map",
    .title = "probed surface (bed mesh, height map)",
    .sample = "bed_mesh.cfg",
    .recognises = recognises_height_map,
    .read = read_height_map,
    .states_place = {true, true, true},
};

}  // namespace ecs::laser
