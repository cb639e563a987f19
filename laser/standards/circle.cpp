// Least squares centre and minimum zone of deviations that are small against the radius: r − a cos θ − b sin θ.
#include "laser/standards/circle.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/standards/zone.hpp"

namespace ecs::laser {
namespace {

constexpr double kRad_per_deg = std::numbers::pi / 180.0;
constexpr double kFullTurn_deg = 360.0;

std::vector<ZonePoint> zone_points(const CirclePass& pass) {
  std::vector<ZonePoint> points;
  for (const CircleReading& reading : pass.readings) {
    const double angle = reading.angle_deg * kRad_per_deg;
    points.push_back({std::cos(angle), std::sin(angle), reading.deviation_um});
  }
  return points;
}

/// The constant of the least squares circle: residuals about it have no mean.
double mean_about(const std::vector<ZonePoint>& points, const Zone& zone) {
  double sum = 0.0;
  for (const ZonePoint& point : points) sum += point.value - zone.per_u * point.u - zone.per_v * point.v;
  return sum / static_cast<double>(points.size());
}

/// What a part shows at an angle; nothing where it has no readings around it.
std::optional<double> shown_by(const CirclePass& part, double angle_deg) {
  const auto& readings = part.readings;
  const auto is_below = [](const CircleReading& reading, double at) { return reading.angle_deg < at; };
  const auto above = std::lower_bound(readings.begin(), readings.end(), angle_deg, is_below);
  const CircleReading& high = above == readings.end() ? readings.front() : *above;
  const CircleReading& low = above == readings.begin() ? readings.back() : *std::prev(above);
  if (high.angle_deg == angle_deg) return high.deviation_um;
  if (folded_deg(high.angle_deg - low.angle_deg) > kWidestGap_deg) return std::nullopt;
  return deviation_at(part, angle_deg, {});
}

/// Takes the zeros off, so that all readings have that of the first part.
class PartJoiner {
 public:
  explicit PartJoiner(CirclePass& pass) : pass_(pass) {
    for (const CircleReading& reading : pass.readings) parts_[reading.part].readings.push_back(reading);
  }

  void join() {
    if (parts_.size() < 2) return;
    for (const auto& [number, part] : parts_) pass_.parts.push_back({number});
    if (!from_common_angles()) from_circle();
    for (CircleReading& reading : pass_.readings) {
      const auto same = [&](const CirclePart& part) { return part.part == reading.part; };
      reading.deviation_um -= std::ranges::find_if(pass_.parts, same)->zero_um;
    }
  }

 private:
  [[nodiscard]] Eigen::Index unknowns() const { return static_cast<Eigen::Index>(parts_.size()) - 1; }

  bool from_common_angles() {
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> differences;
    Eigen::Index j = 0;
    for (auto a = parts_.begin(); a != parts_.end(); ++a, ++j) {
      Eigen::Index k = 0;
      for (auto b = parts_.begin(); b != parts_.end(); ++b, ++k) {
        if (a == b) continue;
        for (const CircleReading& reading : a->second.readings) {
          const auto other = shown_by(b->second, reading.angle_deg);
          const bool counted = k < j && other && at_reading(b->second, reading.angle_deg);
          if (!other || counted) continue;  // the same angle is met from both parts
          Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns());
          if (j > 0) row[j - 1] += 1.0;
          if (k > 0) row[k - 1] -= 1.0;
          rows.push_back(row);
          differences.push_back(reading.deviation_um - *other);
        }
      }
    }
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(rows.size()), unknowns());
    for (Eigen::Index i = 0; i < columns.rows(); ++i) columns.row(i) = rows[static_cast<std::size_t>(i)].transpose();
    if (columns.rows() < unknowns()) return false;
    const PivotedQr qr(columns);
    if (qr.rank() < unknowns()) return false;
    pass_.common = rows.size();
    const Eigen::Map<const Eigen::VectorXd> y(differences.data(), columns.rows());
    const LeastSquares zeros = least_squares(columns, y);
    const Eigen::MatrixXd gram = inverse_gram(columns);
    const auto freedom = static_cast<double>(columns.rows() - unknowns());
    for (Eigen::Index i = 0; i < unknowns(); ++i) {
      CirclePart& part = pass_.parts[static_cast<std::size_t>(i) + 1];
      part.zero_um = zeros.sizes[i];
      if (freedom > 0.0) part.sigma_um = std::sqrt(zeros.squares_left / freedom * gram(i, i));
    }
    return true;
  }

  static bool at_reading(const CirclePass& part, double angle_deg) {
    return std::ranges::any_of(part.readings, [&](const CircleReading& one) { return one.angle_deg == angle_deg; });
  }

  /// Zeros and one centre together.
  void from_circle() {
    const auto rows = static_cast<Eigen::Index>(pass_.readings.size());
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, unknowns() + 3);
    Eigen::VectorXd deviation(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const CircleReading& reading = pass_.readings[static_cast<std::size_t>(i)];
      const double angle = reading.angle_deg * kRad_per_deg;
      columns(i, std::distance(parts_.begin(), parts_.find(reading.part))) = 1.0;
      columns(i, unknowns() + 1) = std::cos(angle);
      columns(i, unknowns() + 2) = std::sin(angle);
      deviation[i] = reading.deviation_um;
    }
    const Eigen::VectorXd sizes = least_squares(columns, deviation).sizes;
    for (Eigen::Index i = 0; i < unknowns(); ++i)
      pass_.parts[static_cast<std::size_t>(i) + 1].zero_um = sizes[i + 1] - sizes[0];
  }

  CirclePass& pass_;
  std::map<int, CirclePass> parts_;  ///< by number, readings by rising angle
};

void evaluate(CirclePass& pass) {
  std::ranges::stable_sort(pass.readings,
                           [](const CircleReading& a, const CircleReading& b) { return a.angle_deg < b.angle_deg; });
  PartJoiner(pass).join();
  const auto points = zone_points(pass);
  const Zone zone = least_squares_zone(points);
  pass.centre_um = {zone.per_u, zone.per_v};
  pass.F_max_um = zone.greatest;
  pass.F_min_um = zone.least;
  pass.mean_um = mean_about(points, zone);
  pass.G_um = minimum_zone(points).width();
}

std::set<int> numbers_of_parts(const CirclePass& pass) {
  std::set<int> numbers;
  for (const CircleReading& reading : pass.readings) numbers.insert(reading.part);
  return numbers;
}

CirclePair pair_of(const CirclePass& ccw, const CirclePass& cw) {
  CirclePair pair;
  pair.clockwise_run = cw.run;
  pair.counter_clockwise_run = ccw.run;
  auto both = zone_points(ccw);
  const auto others = zone_points(cw);
  both.insert(both.end(), others.begin(), others.end());
  pair.G_um = minimum_zone(both).width();
  const Zone common = least_squares_zone(both);
  pair.D_um = mean_about(both, common);
  pair.centre_um = {common.per_u, common.per_v};
  for (const CircleReading& reading : ccw.readings) {
    const double own = deviation_at(ccw, reading.angle_deg, pair.centre_um),
                 other = deviation_at(cw, reading.angle_deg, pair.centre_um);
    if (std::abs(own - other) <= pair.H_um) continue;
    pair.H_um = std::abs(own - other);
    pair.H_at_deg = reading.angle_deg;
  }
  return pair;
}

}  // namespace

double folded_deg(double angle_deg) {
  const double angle = std::fmod(angle_deg, kFullTurn_deg);
  return angle < 0.0 ? angle + kFullTurn_deg : angle;
}

double deviation_at(const CirclePass& pass, double angle_deg, const std::array<double, 2>& centre_um) {
  const auto& readings = pass.readings;
  const auto above = std::lower_bound(readings.begin(), readings.end(), angle_deg,
                                      [](const CircleReading& reading, double at) { return reading.angle_deg < at; });
  const CircleReading& high = above == readings.end() ? readings.front() : *above;
  const CircleReading& low = above == readings.begin() ? readings.back() : *std::prev(above);
  const auto ahead = [](double from, double to) { return to < from ? to - from + 360.0 : to - from; };
  const double gap = ahead(low.angle_deg, high.angle_deg);
  const double share = gap > 0.0 ? ahead(low.angle_deg, angle_deg) / gap : 1.0;
  const auto about_centre = [&](const CircleReading& reading) {
    const double angle = reading.angle_deg * kRad_per_deg;
    return reading.deviation_um - centre_um[0] * std::cos(angle) - centre_um[1] * std::sin(angle);
  };
  return std::lerp(about_centre(low), about_centre(high), share);
}

CircleValues circle_values_of(const CircleTest& test) {
  std::map<std::pair<bool, int>, CirclePass> passes;
  for (const CircleReading& reading : test.readings) {
    CirclePass& pass = passes[{reading.clockwise, reading.run}];
    pass.clockwise = reading.clockwise;
    pass.run = reading.run;
    pass.readings.push_back(reading);
  }
  CircleValues values;
  for (auto& [key, pass] : passes) {
    evaluate(pass);
    values.passes.push_back(std::move(pass));
  }
  const auto first_cw = std::ranges::find_if(values.passes, [](const CirclePass& pass) { return pass.clockwise; });
  for (auto ccw = values.passes.begin(), cw = first_cw; ccw != first_cw && cw != values.passes.end(); ++ccw, ++cw)
    if (numbers_of_parts(*ccw) == numbers_of_parts(*cw))
      values.pairs.push_back(pair_of(*ccw, *cw));
    else
      values.with_other_zeros = true;
  return values;
}

namespace {

constexpr std::array<std::string_view, 3> kCircleColumns{"angle_deg", "deviation_um", "direction"};

constexpr double kLargestRadius_mm = 1e6;   ///< a choice
constexpr int kMostCircleRuns = 1'000'000;  ///< a choice

void take_plane(TableReader& table, CircleTest& test, Findings& findings) {
  const auto axis_at = [](const std::string& text, std::size_t place) -> std::optional<Axis> {
    for (const Axis axis : kAllAxes)
      if (text.size() == 2 && letter_of(axis) == text[place]) return axis;
    return std::nullopt;
  };
  const std::string text = table.stated("plane").value_or("");
  const auto first = axis_at(text, 0), second = axis_at(text, 1);
  if (first && second && *first != *second)
    test.plane = {*first, *second};
  else
    findings.add(0, 0, "expected `# plane: ` with two of the axes X, Y and Z, such as XY, found {}", in_quotes(text));
}

/// Metadata that the values need.
void take_circle_head(TableReader& table, CircleTest& test, Findings& findings) {
  take_plane(table, test, findings);
  const auto radius = table.stated_number("radius_mm");
  if (!radius)
    findings.add(0, 0, "expected `# radius_mm: ` with the nominal radius, found none");
  else if (*radius <= 0.0 || *radius > kLargestRadius_mm)
    findings.add(0, 0, "radius_mm: expected a number above 0, at most {:g}, found {:g}", kLargestRadius_mm, *radius);
  test.radius_mm = radius.value_or(0.0);
  test.feed_mm_min = table.stated_number("feed_mm_min");
  test.start_angle_deg = table.stated_number("start_angle_deg");
  for (std::size_t i = 0; i < test.plane.size(); ++i)
    test.centre_mm[i] = table.stated_number(fmt::format("centre_{}_mm", small_letter_of(test.plane[i])));
}

CircleReading circle_reading(TableReader& row) {
  CircleReading reading;
  reading.line = row.line();
  reading.angle_deg = folded_deg(row.number("angle_deg").value_or(0.0));
  reading.deviation_um = row.number("deviation_um").value_or(0.0);
  if (std::abs(reading.deviation_um) >= kUmPerMm)
    row.refuse("deviation_um",
               fmt::format("deviation_um: expected less than a millimetre, found {:g}. Is the column in um?",
                           reading.deviation_um));
  reading.clockwise = row.text("direction") == "cw";
  if (!reading.clockwise && row.text("direction") != "ccw") row.wrong("direction", "cw or ccw");
  const auto number = [&](std::string_view column) {
    if (!row.has(column)) return 1;
    const auto value = number_in(row.text(column));
    const bool is_whole = value && *value == std::round(*value);
    if (is_whole && std::abs(*value) <= kMostCircleRuns) return static_cast<int>(*value);
    row.wrong(column, is_whole ? fmt::format("a whole number within {}", kMostCircleRuns) : "a whole number");
    return 1;
  };
  reading.run = number("run");
  reading.part = number("part");
  return reading;
}

/// @param angles_deg  of one pass
void check_closed(std::vector<double> angles_deg, bool clockwise, int run, Findings& findings) {
  std::ranges::sort(angles_deg);
  double from = angles_deg.back(), widest = angles_deg.front() + kFullTurn_deg - angles_deg.back();
  for (std::size_t k = 1; k < angles_deg.size(); ++k)
    if (angles_deg[k] - angles_deg[k - 1] > widest) {
      from = angles_deg[k - 1];
      widest = angles_deg[k] - from;
    }
  if (angles_deg.size() == 1)
    findings.add(0, 0, "{}, run {}: the circle has one reading only", contouring_name(clockwise), run);
  else if (widest > kWidestGap_deg)
    findings.add(
        0, 0,
        "{}, run {}: the circle is open: no reading between {:.6g} and {:.6g} degrees, a gap of {:.6g} degrees; "
        "expected a gap of {:g} degrees at most",
        contouring_name(clockwise), run, from, folded_deg(from + widest), widest, kWidestGap_deg);
}

}  // namespace

Result<CircleTest> parse_circle_test(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kCircleColumns, findings));
  CircleTest test;
  test.source = file_name;
  test.metadata = table.metadata;
  TableReader reader(table, findings);
  take_circle_head(reader, test, findings);
  std::map<std::pair<bool, int>, std::vector<double>> passes;
  for (const CsvRow& row : table.rows) {
    reader.take(row);
    test.readings.push_back(circle_reading(reader));
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
