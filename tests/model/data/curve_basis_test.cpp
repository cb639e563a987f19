// Smooth curves between their targets.
#include "model/data/curve_basis.hpp"

#include <Eigen/Dense>

#include "tests/support/test.hpp"

namespace ecs::model {
namespace {

/// Fifteen targets 50 mm apart.
std::vector<double> targets() {
  std::vector<double> all;
  for (int i = 0; i < 15; ++i) all.push_back(50.0 * i);
  return all;
}

/// Mean, slope and every function of the basis.
Eigen::RowVectorXd row(const CurveBasis& basis, double position_mm) {
  Eigen::RowVectorXd all(static_cast<Eigen::Index>(basis.size()) + 2);
  all(0) = 1.0;
  all(1) = (position_mm - basis.centre_mm()) / basis.half_width_mm();
  for (std::size_t k = 0; k < basis.size(); ++k) all(static_cast<Eigen::Index>(k) + 2) = basis.value(k, position_mm);
  return all;
}

TEST_CASE("a curve that is free at every target does not swing between the outer ones") {
  const auto at = targets();
  const CurveBasis basis(at, 20, true);
  REQUIRE(basis.size() == at.size() - 2);
  Eigen::MatrixXd columns(15, 15);
  Eigen::VectorXd value(15);
  for (int i = 0; i < 15; ++i) {
    columns.row(i) = row(basis, at[static_cast<std::size_t>(i)]);
    value(i) = i % 2 == 0 ? 1.0 : -1.0;
  }
  const Eigen::VectorXd sizes = columns.colPivHouseholderQr().solve(value);
  for (int i = 0; i < 15; ++i) CHECK(row(basis, at[static_cast<std::size_t>(i)]).dot(sizes) == Approx(value(i)));
  for (double p = 0.0; p <= 700.0; p += 1.0) CHECK(std::abs(row(basis, p).dot(sizes)) < 1.2);
}

TEST_CASE("at the targets the functions are Legendre polynomials, between many of them nearly so") {
  std::vector<double> at;
  for (int i = 0; i <= 200; ++i) at.push_back(5.0 * i);
  const CurveBasis basis(at, 6);
  for (std::size_t k = 0; k < 6; ++k) {
    double mean = 0.0;
    for (const double p : at) mean += smooth_shape(k + 1, p / 1000.0) / 201.0;
    double sum = 0.0, squares = 0.0;
    for (const double p : at) {
      sum += (p - 500.0) * smooth_shape(k + 1, p / 1000.0);
      squares += (p - 500.0) * (p - 500.0);
    }
    for (const double p : {0.0, 15.0, 500.0, 517.3, 998.0})
      CHECK(basis.value(k, p) == Approx(smooth_shape(k + 1, p / 1000.0) - mean - sum / squares * (p - 500.0))
                                     .epsilon(3e-3));  // the ends are natural
  }
}

}  // namespace
}  // namespace ecs::model
