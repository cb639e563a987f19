// The file of a union jack, and its heights by the worksheets of Moody (1955), with the corrections of B. Allen,
// "Comments on Moody's method for surface plate calibration" (2019): the lowest height is taken off, not added.
#include "modules/standards/plate.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/standards/zone.hpp"

namespace ecs::laser {
namespace {

enum PlateLineIndex : std::size_t { kNwSe, kNeSw, kNeNw, kNeSe, kSeSw, kNwSw, kEW, kNS };

struct Spot {
  double x = 0.0, y = 0.0;  ///< of width and depth
};
/// Ends of the lines, first and last.
constexpr std::array<std::array<Spot, 2>, kPlateLines> kEnds{{{{{0, 1}, {1, 0}}},
                                                              {{{1, 1}, {0, 0}}},
                                                              {{{1, 1}, {0, 1}}},
                                                              {{{1, 1}, {1, 0}}},
                                                              {{{1, 0}, {0, 0}}},
                                                              {{{0, 1}, {0, 0}}},
                                                              {{{1, 0.5}, {0, 0.5}}},
                                                              {{{0.5, 1}, {0.5, 0}}}}};

using Heights = std::vector<double>;

/// Sums of the slopes, first station 0 [um].
Heights raw_heights(const PlateReadings& plate, std::size_t line) {
  Heights heights{0.0};
  for (const double slope : plate.slopes_um_per_m[line])
    heights.push_back(heights.back() + slope * plate.step_mm / kMmPerM);
  return heights;
}

/// Turned and shifted so that it begins and ends there.
Heights between(Heights heights, double first, double last) {
  const double n = static_cast<double>(heights.size() - 1);
  const double begin = heights.front(), turn = (last - first) - (heights.back() - begin);
  for (std::size_t k = 0; k < heights.size(); ++k) heights[k] += first - begin + turn * static_cast<double>(k) / n;
  return heights;
}

double middle_of(const Heights& heights) { return heights[heights.size() / 2]; }

Heights shifted(Heights heights, double by) {
  for (double& height : heights) height += by;
  return heights;
}

/// 0 at the middle, both ends of one height.
Heights diagonal(Heights heights) {
  heights = between(std::move(heights), 0.0, 0.0);
  return shifted(heights, -middle_of(heights));
}

}  // namespace

Flatness flatness_of(const PlateReadings& plate) {
  std::array<Heights, kPlateLines> lines;
  for (std::size_t i = 0; i < kPlateLines; ++i) lines[i] = raw_heights(plate, i);
  lines[kNwSe] = diagonal(std::move(lines[kNwSe]));
  lines[kNeSw] = diagonal(std::move(lines[kNeSw]));
  const double nw = lines[kNwSe].front(), se = lines[kNwSe].back();
  const double ne = lines[kNeSw].front(), sw = lines[kNeSw].back();
  lines[kNeNw] = between(std::move(lines[kNeNw]), ne, nw);
  lines[kNeSe] = between(std::move(lines[kNeSe]), ne, se);
  lines[kSeSw] = between(std::move(lines[kSeSw]), se, sw);
  lines[kNwSw] = between(std::move(lines[kNwSw]), nw, sw);
  lines[kEW] = between(std::move(lines[kEW]), middle_of(lines[kNeSe]), middle_of(lines[kNwSw]));
  lines[kNS] = between(std::move(lines[kNS]), middle_of(lines[kNeNw]), middle_of(lines[kSeSw]));
  Flatness flatness;
  flatness.closure_um = {middle_of(lines[kEW]), middle_of(lines[kNS])};
  lines[kEW] = shifted(std::move(lines[kEW]), -flatness.closure_um[0]);
  lines[kNS] = shifted(std::move(lines[kNS]), -flatness.closure_um[1]);

  flatness.width_mm = plate.step_mm * static_cast<double>(plate.slopes_um_per_m[kNeNw].size());
  flatness.depth_mm = plate.step_mm * static_cast<double>(plate.slopes_um_per_m[kNeSe].size());
  double lowest = 0.0;
  for (const Heights& line : lines) lowest = std::min(lowest, *std::ranges::min_element(line));
  std::vector<ZonePoint> points;
  for (std::size_t i = 0; i < kPlateLines; ++i)
    for (std::size_t k = 0; k < lines[i].size(); ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(lines[i].size() - 1);
      const auto& [first, last] = kEnds[i];
      PlateStation station{i, k, flatness.width_mm * std::lerp(first.x, last.x, share),
                           flatness.depth_mm * std::lerp(first.y, last.y, share), lines[i][k] - lowest};
      flatness.moody_um = std::max(flatness.moody_um, station.height_um);
      points.push_back({station.x_mm, station.y_mm, station.height_um});
      flatness.stations.push_back(station);
    }
  flatness.least_squares_um = least_squares_zone(points).width();
  flatness.minimum_zone_um = minimum_zone(points).width();
  return flatness;
}

namespace {

constexpr std::array<std::string_view, 3> kPlateColumns{"line", "station_mm", "reading"};
constexpr double kUm_per_m_arcsec = 4.84813681;
/// A foot is put to a mark within this share of its length.
constexpr double kUnequal = 0.01;
/// Diagonals are laid out a little beyond or within the corners (Moody: 80 inches over 64 by 40).
constexpr double kOblique = 0.10;

std::string reversed_name(std::string_view name) {
  const std::size_t dash = name.find('-');
  return dash == name.npos ? std::string() : fmt::format("{}-{}", name.substr(dash + 1), name.substr(0, dash));
}

std::string order_text() { return fmt::format("the order is {}", fmt::join(kPlateLineNames, ", ")); }

/// What `# key:` of the file gives.
struct PlateHead {
  double step_mm = 0.0;
  double um_per_m = 1.0;  ///< of a reading of 1
};

PlateHead plate_head(TableReader& table, Findings& findings) {
  PlateHead head;
  const std::string step = table.stated("step_mm").value_or("");
  head.step_mm = number_in(step).value_or(0.0);
  if (head.step_mm <= 0.0)
    findings.add(0, 0, "expected `# step_mm: ` with the distance of the feet, found {}", in_quotes(step));
  if (table.stated_word("unit", "arcsec", "um/m", "um/m") == "arcsec") head.um_per_m = kUm_per_m_arcsec;
  if (table.stated_word("positive", "rises", "falls", "rises") == "falls") head.um_per_m = -head.um_per_m;
  return head;
}

/// Rows become the lines of a plate, one after the other.
class PlateLines {
 public:
  PlateLines(TableReader& row, const PlateHead& head) : row_(row), head_(head) {}

  void take() {
    const std::string& name = row_.text("line");
    if (name != last_name_ && !begins(name)) return;
    last_name_ = name;
    const auto station_mm = row_.number("station_mm"), reading = row_.number("reading");
    if (!station_mm || !reading) return;
    std::vector<double>& slopes = lines[at_];
    if (!slopes.empty() && std::abs(*station_mm - last_mm_ - head_.step_mm) > kUnequal * head_.step_mm)
      row_.refuse("station_mm",
                  fmt::format("station_mm: expected {:.6g}, a step of {:.6g} mm from {:.6g}, found {:.6g}: the steps "
                              "must be equal",
                              last_mm_ + head_.step_mm, head_.step_mm, last_mm_, *station_mm));
    last_mm_ = *station_mm;
    slopes.push_back(head_.um_per_m * *reading);
  }

  std::array<std::vector<double>, kPlateLines> lines;

 private:
  /// A line begins. @return whether it is the one expected here
  bool begins(const std::string& name) {
    const std::size_t expected = begun_ ? at_ + 1 : 0;
    const auto known = [](std::string_view one) {
      return std::ranges::find(kPlateLineNames, one) != kPlateLineNames.end();
    };
    if (expected < kPlateLines && name == kPlateLineNames[expected]) {
      at_ = expected;
      begun_ = true;
      return true;
    }
    if (std::exchange(faulty_, name) == name) return false;  // said once for each line
    const auto refuse = [&](std::string_view wanted, std::string_view why) {
      row_.refuse("line", fmt::format("line: expected {}, found {}: {}", wanted, name, why));
    };
    if (const std::string turned = reversed_name(name); !known(name) && known(turned))
      refuse(turned + " from its first station", "reverse the order of its readings and change their sign");
    else if (!known(name))
      row_.wrong("line", fmt::format("{}", fmt::join(kPlateLineNames, ", ")));
    else if (expected < kPlateLines)
      refuse(fmt::format("{} here", kPlateLineNames[expected]), order_text());
    else
      refuse(fmt::format("no line after {}", kPlateLineNames.back()), order_text());
    return false;
  }

  TableReader& row_;
  const PlateHead& head_;
  std::size_t at_ = 0;
  bool begun_ = false;
  std::string last_name_, faulty_;
  double last_mm_ = 0.0;
};

void check_plate(const PlateReadings& plate, Findings& findings) {
  const auto& lines = plate.slopes_um_per_m;
  for (std::size_t i = 0; i < kPlateLines; ++i) {
    if (lines[i].empty())
      findings.add(0, 0, "the line {} is missing; {}", kPlateLineNames[i], order_text());
    else if (lines[i].size() % 2 != 0)
      findings.add(0, 0, "line {}: expected an even number of steps, so that a station is at its middle, found {}",
                   kPlateLineNames[i], lines[i].size());
  }
  if (!findings.empty()) return;
  constexpr std::array<std::array<std::size_t, 2>, 5> kEqual{{{0, 1}, {2, 4}, {2, 6}, {3, 5}, {3, 7}}};
  for (const auto& [a, b] : kEqual)
    if (lines[a].size() != lines[b].size())
      findings.add(0, 0, "expected as many steps along {} as along {}, found {} and {}", kPlateLineNames[b],
                   kPlateLineNames[a], lines[b].size(), lines[a].size());
  const double sides = std::hypot(static_cast<double>(lines[2].size()), static_cast<double>(lines[3].size()));
  const double diagonal = static_cast<double>(lines[0].size());
  if (std::abs(diagonal / sides - 1.0) > kOblique)
    findings.add(0, 0, "expected diagonals of about {:.1f} steps, as the sides make them, found {}", sides,
                 lines[0].size());
}

}  // namespace

Result<PlateReadings> parse_plate_readings(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kPlateColumns, findings));
  PlateReadings plate{file_name, table.metadata, 0.0, {}};
  TableReader reader(table, findings);
  const PlateHead head = plate_head(reader, findings);
  plate.step_mm = head.step_mm;
  PlateLines lines(reader, head);
  if (findings.empty())
    for (const CsvRow& row : table.rows) {
      reader.take(row);
      lines.take();
    }
  plate.slopes_um_per_m = std::move(lines.lines);
  if (findings.empty()) check_plate(plate, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return plate;
}

}  // namespace ecs::laser
