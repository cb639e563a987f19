// Decompositions where there is nothing to decompose.
#include "model/linear/decompositions.hpp"

#include <cmath>

#include <doctest/doctest.h>

namespace ecs::model {
namespace {

TEST_CASE("a matrix without columns has rank 0 and answers without entries") {
  const Eigen::MatrixXd none(5, 0);
  const Eigen::VectorXd y = Eigen::VectorXd::Ones(5);
  for (const PivotedQr& qr : {PivotedQr(none), PivotedQr(none, 1e-9)}) {
    CHECK(qr.rank() == 0);
    CHECK(qr.solve(y).size() == 0);
    CHECK(qr.independent_sizes(y).size() == 0);
    CHECK(qr.inverse_gram().size() == 0);
    CHECK(qr.basis().rows() == 5);
    CHECK(qr.basis().cols() == 0);
    CHECK(qr.condition() == 1.0);
  }
  CHECK(least_norm_solution(none, y).size() == 0);
  CHECK(least_norm_solution(none, y, 1e-9).size() == 0);
}

TEST_CASE("a basis takes no more room than its columns, however many rows there are") {
  constexpr Eigen::Index kRows = 300'000;  // the square matrix would be 720 GB
  Eigen::MatrixXd columns(kRows, 3);
  for (Eigen::Index k = 0; k < kRows; ++k) {
    const double p = static_cast<double>(k) / kRows;
    columns.row(k) << 1.0, p, p * p;
  }
  const Eigen::MatrixXd basis = PivotedQr(columns).basis();
  REQUIRE(basis.rows() == kRows);
  REQUIRE(basis.cols() == 3);
  CHECK((basis.transpose() * basis - Eigen::MatrixXd::Identity(3, 3)).norm() < 1e-9);
  CHECK((columns - basis * (basis.transpose() * columns)).norm() < 1e-9 * columns.norm());
}

TEST_CASE("of columns that are alike the first is the one that counts, whatever the last digits say") {
  Eigen::VectorXd column = Eigen::VectorXd::LinSpaced(7, 1.0, 2.0).normalized();
  for (const double rounding : {-1e-12, 0.0, 1e-12}) {
    Eigen::MatrixXd columns(7, 2);
    columns << size_in_order(0) * column, size_in_order(1) * (1.0 + rounding) * column;
    const PivotedQr qr(columns, 1e-9);
    CHECK(qr.rank() == 1);
    CHECK(qr.place(0) == 0);
  }
}

TEST_CASE("a solution leaves the least where columns depend on each other") {
  constexpr Eigen::Index kRows = 40;
  Eigen::MatrixXd columns(kRows, 9);
  Eigen::VectorXd y(kRows);
  for (Eigen::Index k = 0; k < kRows; ++k) {
    const double p = static_cast<double>(k) / kRows;
    for (Eigen::Index j = 0; j < 5; ++j) columns(k, j) = std::cos(static_cast<double>(j) * 3.0 * p);
    for (Eigen::Index j = 5; j < 9; ++j) columns(k, j) = columns(k, j - 5) / 3.0 - 0.1 * columns(k, j - 4);
    y(k) = std::sin(50.0 * p);
  }
  const PivotedQr qr(columns);
  CHECK(qr.rank() == 5);
  const Eigen::VectorXd left = y - columns * qr.solve(y);
  CHECK((columns.transpose() * left).norm() < 1e-9);
}

TEST_CASE("columns of zeros have rank 0 and a solution of zeros") {
  const Eigen::MatrixXd zeros = Eigen::MatrixXd::Zero(5, 2);
  const PivotedQr qr(zeros);
  CHECK(qr.rank() == 0);
  CHECK(qr.solve(Eigen::VectorXd::Ones(5)) == Eigen::VectorXd::Zero(2));
  CHECK(qr.basis().cols() == 0);
}

}  // namespace
}  // namespace ecs::model
