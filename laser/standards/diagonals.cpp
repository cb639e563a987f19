// Diagonals by ISO 230-6. Growth over a diagonal of unit vector n is nᵀ·E: with C0Y, B0Z, A0Z and one common scale the
// four body diagonals are four equations for four unknowns. Step diagonals: M. A. V. Chapman, "Limitations of laser
// diagonal measurements", Precision Engineering 27 (2003) 401-406.
#include "laser/standards/diagonals.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "base/units.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {
namespace {

constexpr const char* kChapman =
    "step diagonals: what each axis did is not separated. A beam or mirror a little out of line moves error from one "
    "axis "
    "to another while the sum along the diagonal stays (Chapman 2003); measure the axes one by one";
constexpr const char* kSquarenessAlone =
    "squareness from diagonals holds only if every axis has the same scale error and no angular errors: other errors "
    "give "
    "the same diagonals";

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
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(columns);
  const Eigen::MatrixXd inverse = solver.pseudoInverse();
  const Eigen::VectorXd found = inverse * growth;
  const Eigen::MatrixXd resolution = inverse * columns;
  constexpr const char* kNames[] = {"C0Y", "B0Z", "A0Z"};
  for (Eigen::Index k = 0; k < 3; ++k)
    if (std::abs(resolution(k, k) - 1.0) < 1e-9)
      results.squareness.push_back({kNames[k], found[k], std::sqrt(inverse.row(k).cwiseAbs2().dot(sigma.cwiseAbs2()))});
}

void summarise_body(DiagonalResults& results) {
  double least = 0.0, greatest = 0.0;
  bool any = false;
  for (const DiagonalValues& values : results.diagonals) {
    if (std::count(values.direction.begin(), values.direction.end(), 0) > 0) continue;
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
