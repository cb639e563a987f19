// Decompositions: what they promise, and where there is nothing to decompose.
#include "base/linear/decompositions.hpp"

#include "tests/support/normal_matrix.hpp"
#include "tests/support/test.hpp"

namespace ecs {
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

TEST_CASE(
    "what the rows of a matrix span makes its columns orthonormal, and what they do not span makes them nothing") {
  for (const Eigen::Index dependent : {0, 1, 2}) {
    CAPTURE(dependent);
    Eigen::MatrixXd columns = ecs::test::normal_matrix(30, 7, 5);
    for (Eigen::Index j = 0; j < dependent; ++j) columns.col(3 * j) = columns.col(5) * (1.0 + static_cast<double>(j));
    const RowSpace space = row_space_of(columns, 1e-9);
    REQUIRE(space.back.cols() == 7 - dependent);
    REQUIRE(space.free.cols() == dependent);
    const Eigen::MatrixXd basis = columns * space.back;
    CHECK((basis.transpose() * basis).isIdentity(1e-12));
    CHECK((columns * space.free).norm() < 1e-12);
    CHECK((space.free.transpose() * space.free).isIdentity(1e-12));
    const Eigen::VectorXd y = columns.rowwise().sum() + Eigen::VectorXd::LinSpaced(30, -1.0, 1.0);
    CHECK((space.back * (basis.transpose() * y)).isApprox(least_norm_solution(columns, y), 1e-10));
  }
}

TEST_CASE("a Cholesky factor solves, inverts and whitens what it was made of; a matrix that is not positive has none") {
  const Eigen::MatrixXd columns = ecs::test::normal_matrix(20, 4, 3);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(4, 4);
  add_gram(gram, columns);
  CHECK(gram.isApprox(columns.transpose() * columns, 1e-13));
  const Cholesky factor(gram);
  REQUIRE(factor.is_positive());
  CHECK((gram * factor.inverse()).isIdentity(1e-12));
  CHECK((gram * factor.solve(Eigen::VectorXd::Ones(4))).isApprox(Eigen::VectorXd::Ones(4), 1e-12));
  CHECK(factor.by_l_transposed(factor.by_l(gram)).isIdentity(1e-12));
  CHECK(factor.half_ln_determinant() == Approx(0.5 * std::log(gram.determinant())));
  add_gram(gram, columns, -2.0);
  CHECK(!Cholesky(gram).is_positive());
}

}  // namespace
}  // namespace ecs
