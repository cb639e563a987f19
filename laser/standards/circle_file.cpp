#include "laser/standards/circle_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::string_view, 3> kCircleColumns{"angle_deg", "deviation_um", "direction"};
constexpr double kFullTurn_deg = 360.0;

double folded_deg(double angle_deg) {
  const double angle = std::fmod(angle_deg, kFullTurn_deg);
  return angle < 0.0 ? angle + kFullTurn_deg : angle;
}

/// Metadata that the values need.
constexpr double kLargestRadius_mm = 1e6;         ///< a choice
constexpr long long kMostCircleRuns = 1'000'000;  ///< a choice

class CircleHead {
 public:
  CircleHead(CircleTest& test, Findings& findings) : test_(test), findings_(findings) {}

  void take() {
    take_plane();
    const auto radius = number("radius_mm");
    if (!radius)
      findings_.add(0, 0, "expected `# radius_mm: ` with the nominal radius, found none");
    else if (*radius <= 0.0 || *radius > kLargestRadius_mm)
      findings_.add(
          0, 0,
          fmt::format("radius_mm: expected a number above 0, at most {:g}, found {:g}", kLargestRadius_mm, *radius));
    test_.radius_mm = radius.value_or(0.0);
    test_.feed_mm_min = number("feed_mm_min");
    test_.start_angle_deg = number("start_angle_deg");
    for (std::size_t i = 0; i < test_.plane.size(); ++i)
      test_.centre_mm[i] =
          number(fmt::format("centre_{}_mm", static_cast<char>(std::tolower(letter_of(test_.plane[i])))));
  }

 private:
  void take_plane() {
    const std::string text = metadata_value(test_.metadata, "plane").value_or("");
    const auto first = text.size() == 2 ? axis_at(text[0]) : std::nullopt;
    const auto second = text.size() == 2 ? axis_at(text[1]) : std::nullopt;
    if (!first || !second || *first == *second)
      findings_.add(
          0, 0,
          fmt::format("expected `# plane: ` with two of the axes X, Y and Z, such as XY, found {}", in_quotes(text)));
    else
      test_.plane = {*first, *second};
  }

  static std::optional<Axis> axis_at(char letter) {
    for (const Axis axis : kAllAxes)
      if (letter_of(axis) == letter) return axis;
    return std::nullopt;
  }

  std::optional<double> number(const std::string& key) {
    const auto text = metadata_value(test_.metadata, key);
    if (!text) return std::nullopt;
    const auto value = number_in(*text);
    if (!value) findings_.add(0, 0, fmt::format("{}: expected a number, found {}", key, in_quotes(*text)));
    return value;
  }

  CircleTest& test_;
  Findings& findings_;
};

struct CircleColumns {
  std::size_t angle, deviation, direction;
  std::optional<std::size_t> run;
};

CircleReading circle_reading(const CsvRow& row, const CircleColumns& columns, Findings& findings) {
  CircleReading reading;
  reading.line = row.line;
  const auto number = [&](std::size_t column, std::string_view name) {
    const CsvField& field = row.fields[column];
    const auto value = number_in(field.text);
    if (!value)
      findings.add(row.line, field.column, fmt::format("{}: expected a number, found {}", name, in_quotes(field.text)));
    return value.value_or(0.0);
  };
  reading.angle_deg = folded_deg(number(columns.angle, "angle_deg"));
  reading.deviation_um = number(columns.deviation, "deviation_um");
  if (std::abs(reading.deviation_um) >= kUmPerMm)
    findings.add(row.line, row.fields[columns.deviation].column,
                 fmt::format("deviation_um: expected less than a millimetre, found {:g}. Is the column in um?",
                             reading.deviation_um));
  const CsvField& direction = row.fields[columns.direction];
  reading.clockwise = direction.text == "cw";
  if (!reading.clockwise && direction.text != "ccw")
    findings.add(row.line, direction.column,
                 fmt::format("direction: expected cw or ccw, found {}", in_quotes(direction.text)));
  if (columns.run) {
    const CsvField& field = row.fields[*columns.run];
    const auto run = integer_in(field.text);
    if (run && std::abs(*run) <= kMostCircleRuns)
      reading.run = static_cast<int>(*run);
    else
      findings.add(row.line, field.column,
                   fmt::format("run: expected a whole number{}, found {}",
                               run ? fmt::format(" within {}", kMostCircleRuns) : "", in_quotes(field.text)));
  }
  return reading;
}

/// @param angles_deg  of one pass
void check_closed(std::vector<double> angles_deg, bool clockwise, int run, Findings& findings) {
  std::sort(angles_deg.begin(), angles_deg.end());
  double from = angles_deg.back(), widest = angles_deg.front() + kFullTurn_deg - angles_deg.back();
  for (std::size_t k = 1; k < angles_deg.size(); ++k)
    if (angles_deg[k] - angles_deg[k - 1] > widest) {
      from = angles_deg[k - 1];
      widest = angles_deg[k] - from;
    }
  if (widest > kWidestGap_deg)
    findings.add(0, 0,
                 fmt::format("{}, run {}: the circle is open: no reading from {:.6g} to {:.6g} degrees; expected one "
                             "every {:g} degrees at least",
                             contouring_name(clockwise), run, from, folded_deg(from + widest), kWidestGap_deg));
}

}  // namespace

Result<CircleTest> parse_circle_test(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kCircleColumns, findings));
  CircleTest test;
  test.source = file_name;
  test.metadata = table.metadata;
  CircleHead(test, findings).take();
  const CircleColumns columns{*place_of(table, "angle_deg"), *place_of(table, "deviation_um"),
                              *place_of(table, "direction"), place_of(table, "run")};
  std::map<std::pair<bool, int>, std::vector<double>> passes;
  for (const CsvRow& row : table.rows) {
    test.readings.push_back(circle_reading(row, columns, findings));
    const CircleReading& reading = test.readings.back();
    passes[{reading.clockwise, reading.run}].push_back(reading.angle_deg);
  }
  if (findings.empty()) {
    if (passes.empty()) findings.add(table.header_line, 0, "expected readings below the header, found none");
    for (const auto& [pass, angles_deg] : passes) check_closed(angles_deg, pass.first, pass.second, findings);
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return test;
}

}  // namespace ecs::laser
