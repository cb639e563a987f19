// The file of a diagonal test, and its results by ISO 230-6.
// Growth over a diagonal of unit vector n is nᵀ·E: with C0Y, B0Z, A0Z and one common scale the
// four body diagonals are four equations for four unknowns. Step diagonals: M. A. V. Chapman, "Limitations of laser
// diagonal measurements", Precision Engineering 27 (2003) 401-406.
#include "laser/standards/diagonals.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {
namespace {

/// More is a wrong unit or no measurement; choices.
constexpr double kLongestEdge_mm = 1e6, kLargestDeviation_um = 1e6, kMostDiagonalRuns = 1e6;
constexpr std::array<std::string_view, 3> kDiagonalColumns{"diagonal", "position_mm", "deviation_um"};
/// Of the length: a target may lie a little beyond the corner.
constexpr double kBeyondCorner = 1.001;

std::optional<DiagonalDirection> diagonal_named(std::string_view name) {
  DiagonalDirection direction{};
  if (name.size() != kAxes) return std::nullopt;
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (name[i] != 'P' && name[i] != 'N' && name[i] != '0') return std::nullopt;
    direction[i] = name[i] == 'P' ? 1 : name[i] == 'N' ? -1 : 0;
  }
  return std::ranges::count(direction, 0) > 1 ? std::nullopt : std::optional(direction);
}

/// The same line from its other end.
DiagonalDirection turned(DiagonalDirection direction) {
  for (int& sign : direction) sign = -sign;
  return direction;
}

/// Of the two ends' directions the one that runs with its first axis: it comes after (0, 0, 0) in the order of arrays.
DiagonalDirection as_line(const DiagonalDirection& direction) {
  return direction < DiagonalDirection{} ? turned(direction) : direction;
}

std::string diagonal_name(const DiagonalDirection& direction) {
  std::string name;
  for (const int sign : direction) name += sign > 0 ? 'P' : sign < 0 ? 'N' : '0';
  return name;
}

/// The diagonals that belong to a body or a face with these axes.
std::vector<DiagonalDirection> family_of(const DiagonalDirection& direction) {
  std::vector<DiagonalDirection> family;
  for (const int x : {1, -1})
    for (const int y : {1, -1})
      for (const int z : {1, -1}) {
        const DiagonalDirection one =
            as_line({direction[0] == 0 ? 0 : x, direction[1] == 0 ? 0 : y, direction[2] == 0 ? 0 : z});
        if (std::ranges::find(family, one) == family.end()) family.push_back(one);
      }
  return family;
}

double length_of(const DiagonalDirection& direction, const std::array<double, kAxes>& span_mm) {
  double squares = 0.0;
  for (std::size_t i = 0; i < kAxes; ++i) squares += direction[i] == 0 ? 0.0 : span_mm[i] * span_mm[i];
  return std::sqrt(squares);
}

class DiagonalReader {
 public:
  DiagonalReader(const CsvTable& table, Findings& findings, DiagonalTest& test)
      : table_(table), findings_(findings), test_(test), row_(table, findings) {}

  void read() {
    read_head();
    for (const CsvRow& row : table_.rows) {
      row_.take(row);
      take();
    }
    if (findings_.empty()) check();
  }

 private:
  void read_head() {
    test_.steps = row_.stated_word("kind", "diagonal", "step", "diagonal") == "step";
    if (test_.steps && !row_.has("moved"))
      findings_.add(table_.header_line, 1, "header: expected a column moved, the axis that moved last, found none");
    for (const Axis axis : kAllAxes) {
      const std::string key = fmt::format("{}_mm", small_letter_of(axis));
      const auto text = row_.stated(key);
      if (!text) continue;
      const auto span_mm = number_in(*text);
      if (!span_mm || *span_mm <= 0.0 || *span_mm > kLongestEdge_mm)
        findings_.add(0, 0, "{}: expected a length above 0, at most {:g}, found {}", key, kLongestEdge_mm,
                      in_quotes(*text));
      test_.span_mm[index_of(axis)] = span_mm.value_or(0.0);
    }
  }

  /// Of a column that may be missing.
  std::optional<double> number(std::string_view column, double most) {
    return row_.has(column) ? row_.number(column, most) : std::nullopt;
  }

  DiagonalReadings* diagonal_of_row() {
    const std::string& name = row_.text("diagonal");
    const auto direction = diagonal_named(name);
    if (!direction) {
      row_.wrong("diagonal", "P, N or 0 for each of X, Y and Z, such as PPN or PN0");
      return nullptr;
    }
    for (DiagonalReadings& diagonal : test_.diagonals) {
      if (diagonal.name == name) return &diagonal;
      if (diagonal.direction != turned(*direction)) continue;
      row_.refuse("diagonal", fmt::format("diagonal: {} is {} from its other end; expected each diagonal from one end",
                                          name, diagonal.name));
      return nullptr;
    }
    test_.diagonals.push_back({name, *direction, {}, {}});
    test_.diagonals.back().readings.source = test_.source;
    return &test_.diagonals.back();
  }

  void take() {
    DiagonalReadings* const diagonal = diagonal_of_row();
    const auto position_mm = number("position_mm", kLongestEdge_mm),
               deviation_um = number("deviation_um", kLargestDeviation_um);
    const double approach = number("approach", 1.0).value_or(0.0), run = number("run", kMostDiagonalRuns).value_or(1.0);
    if (diagonal == nullptr || !position_mm || !deviation_um) return;
    Reading reading;
    reading.line = row_.line();
    reading.position_mm[0] = *position_mm;
    reading.error = *deviation_um;
    reading.approach = approach > 0.0 ? Approach::forward : approach < 0.0 ? Approach::reverse : Approach::unknown;
    reading.run = static_cast<int>(run);
    if (test_.steps)
      take_step(*diagonal, reading);
    else
      diagonal->readings.readings.push_back(reading);
  }

  /// Of a step diagonal the readings at the end of each step, when every axis has moved, are those of the diagonal.
  void take_step(DiagonalReadings& diagonal, const Reading& reading) {
    if (!row_.has("moved")) return;
    const std::string& moved = row_.text("moved");
    const auto axis =
        std::ranges::find_if(kAllAxes, [&](Axis a) { return moved.size() == 1 && letter_of(a) == moved.front(); });
    if (axis == kAllAxes.end() || diagonal.direction[index_of(*axis)] == 0)
      return row_.wrong("moved", fmt::format("an axis of the diagonal {}", diagonal.name));
    StepState& state = steps_[diagonal.name];
    const double along = reading.approach == Approach::reverse ? -1.0 : 1.0;
    if (state.run != reading.run || state.approach != reading.approach || state.passes == 0)
      state = {reading.run, reading.approach, reading.error, 0, state.passes + 1, state.moving_um};
    else
      state.moving_um[index_of(*axis)] += along * (reading.error - state.last_um);
    for (std::size_t i = 0; i < kAxes; ++i)
      if (diagonal.direction[i] != 0) diagonal.while_moving_um[i] = state.moving_um[i] / state.passes;
    state.last_um = reading.error;
    const auto still = static_cast<int>(std::ranges::count(diagonal.direction, 0));
    const int axes = std::max(1, static_cast<int>(kAxes) - still);
    if (state.count++ % axes == 0) diagonal.readings.readings.push_back(reading);
  }

  void check() {
    if (test_.diagonals.empty()) findings_.add(table_.header_line, 0, "expected readings below the header, found none");
    for (const DiagonalReadings& diagonal : test_.diagonals) {
      check_edges(diagonal);
      check_family(diagonal);
    }
  }

  void check_edges(const DiagonalReadings& diagonal) {
    for (const Axis axis : kAllAxes)
      if (diagonal.direction[index_of(axis)] != 0 && test_.span_mm[index_of(axis)] <= 0.0)
        findings_.add(0, 0, "diagonal {}: expected `# {}_mm: ` with the length of the volume along {} [mm], found none",
                      diagonal.name, small_letter_of(axis), letter_of(axis));
    const double length_mm = length_of(diagonal.direction, test_.span_mm);
    for (const Reading& reading : diagonal.readings.readings)
      if (length_mm > 0.0 && (reading.position_mm[0] < length_mm - kBeyondCorner * length_mm ||
                              reading.position_mm[0] > kBeyondCorner * length_mm))
        findings_.add(reading.line, 0, "position_mm: expected 0 to {:.6g}, the length of {}, found {:g}", length_mm,
                      diagonal.name, reading.position_mm[0]);
  }

  void check_family(const DiagonalReadings& diagonal) {
    const auto family = family_of(diagonal.direction);
    std::vector<std::string> missing;
    for (const DiagonalDirection& one : family)
      if (std::ranges::none_of(test_.diagonals,
                               [&](const DiagonalReadings& other) { return as_line(other.direction) == one; }))
        missing.push_back(diagonal_name(one));
    const bool first = std::ranges::none_of(test_.diagonals, [&](const DiagonalReadings& other) {
      return &other < &diagonal && family_of(other.direction) == family;
    });
    if (missing.empty() || !first) return;
    findings_.add(0, 0, "expected the {} diagonals of the {}, found {}; missing: {}", family.size(),
                  family.size() == 4 ? "body" : "face", family.size() - missing.size(), fmt::join(missing, ", "));
  }

  struct StepState {
    int run = 0;
    Approach approach = Approach::unknown;
    double last_um = 0.0;
    int count = 0;
    int passes = 0;
    std::array<double, kAxes> moving_um{};  ///< sums over the passes
  };

  const CsvTable& table_;
  Findings& findings_;
  DiagonalTest& test_;
  TableReader row_;
  std::map<std::string, StepState> steps_;
};

}  // namespace

Result<DiagonalTest> parse_diagonals(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kDiagonalColumns, findings));
  DiagonalTest test;
  test.source = file_name;
  test.metadata = table.metadata;
  DiagonalReader(table, findings, test).read();
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return test;
}

namespace {

constexpr const char* kChapman =
    "step diagonals: the errors of the axes are not separated. A slightly misaligned beam or mirror moves error from "
    "one axis to another while the sum along the diagonal is unchanged (Chapman 2003); measure the axes one by one";
constexpr const char* kSquarenessAlone =
    "squareness from diagonals is valid only if every axis has the same scale error and no angular errors: such "
    "errors can give the same diagonals";

/// Slope of the means over the position, with its standard error.
void fit_growth(DiagonalValues& values) {
  double n = 0.0, sum_p = 0.0, sum_e = 0.0;
  const auto each = [&](const auto& take) {
    for (const Iso230Target& target : values.iso.targets)
      if (target.mean) take(target.position_mm / kMmPerM, *target.mean);
  };
  each([&](double p, double e) {
    n += 1.0;
    sum_p += p;
    sum_e += e;
  });
  double pp = 0.0, pe = 0.0, left = 0.0;
  each([&](double p, double e) {
    pp += (p - sum_p / n) * (p - sum_p / n);
    pe += (p - sum_p / n) * (e - sum_e / n);
  });
  if (pp <= 0.0) return;
  values.growth_um_per_m = pe / pp;
  each([&](double p, double e) {
    const double r = e - sum_e / n - values.growth_um_per_m * (p - sum_p / n);
    left += r * r;
  });
  values.growth_sigma = n > 2.0 ? std::sqrt(left / (n - 2.0) / pp) : 0.0;
}

/// What C0Y, B0Z, A0Z of 1 um/m add to the growth of a diagonal [um/m].
Eigen::RowVector4d growth_of_squareness(const DiagonalValues& values, const std::array<double, kAxes>& span_mm) {
  std::array<double, kAxes> n{};
  for (std::size_t i = 0; i < kAxes; ++i) n[i] = values.direction[i] * span_mm[i] / values.length_mm;
  return {-n[0] * n[1], n[0] * n[2], -n[1] * n[2], 1.0};
}

void solve_squareness(const DiagonalTest& test, DiagonalResults& results) {
  const auto rows = static_cast<Eigen::Index>(results.diagonals.size());
  Eigen::MatrixXd columns(rows, 4);
  Eigen::VectorXd growth(rows), sigma(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const DiagonalValues& values = results.diagonals[static_cast<std::size_t>(i)];
    columns.row(i) = growth_of_squareness(values, test.span_mm);
    growth[i] = values.growth_um_per_m;
    sigma[i] = values.growth_sigma;
  }
  const Eigen::MatrixXd inverse = pseudo_inverse(columns);
  const Eigen::VectorXd found = product(inverse, growth);
  const Eigen::MatrixXd resolution = product(inverse, columns);
  constexpr const char* kNames[] = {"C0Y", "B0Z", "A0Z"};
  for (Eigen::Index k = 0; k < 3; ++k)
    if (std::abs(resolution(k, k) - 1.0) < 1e-9)
      results.squareness.push_back({kNames[k], found[k], std::sqrt(inverse.row(k).cwiseAbs2().dot(sigma.cwiseAbs2()))});
}

void summarise_body(DiagonalResults& results) {
  double least = 0.0, greatest = 0.0;
  bool any = false;
  for (const DiagonalValues& values : results.diagonals) {
    if (std::ranges::count(values.direction, 0) > 0) continue;
    const double growth_um = values.growth_um_per_m * values.length_mm / kMmPerM;
    least = any ? std::min(least, growth_um) : growth_um;
    greatest = any ? std::max(greatest, growth_um) : growth_um;
    any = true;
    if (values.iso.E) results.E_body_um = std::max(results.E_body_um.value_or(0.0), *values.iso.E);
    if (values.iso.B) results.B_body_um = std::max(results.B_body_um.value_or(0.0), *values.iso.B);
  }
  if (any) results.body_difference_um = greatest - least;
}

}  // namespace

Result<DiagonalResults> diagonal_results_of(const DiagonalTest& test) {
  DiagonalResults results;
  for (const DiagonalReadings& diagonal : test.diagonals) {
    DiagonalValues values{diagonal.name, diagonal.direction, 0.0, {}, 0.0, 0.0};
    for (std::size_t i = 0; i < kAxes; ++i)
      if (diagonal.direction[i] != 0) values.length_mm = std::hypot(values.length_mm, test.span_mm[i]);
    ECS_TRY(iso, iso230_of(diagonal.readings, groups_of(diagonal.readings).front()));
    values.iso = iso;
    fit_growth(values);
    results.diagonals.push_back(std::move(values));
  }
  summarise_body(results);
  solve_squareness(test, results);
  if (!results.squareness.empty()) results.notes.emplace_back(kSquarenessAlone);
  if (test.steps) results.notes.emplace_back(kChapman);
  return results;
}

}  // namespace ecs::laser
