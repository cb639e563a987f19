// Decompositions where there is nothing to decompose.
#include "model/linear/decompositions.hpp"

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

TEST_CASE("columns of zeros have rank 0 and a solution of zeros") {
  const Eigen::MatrixXd zeros = Eigen::MatrixXd::Zero(5, 2);
  const PivotedQr qr(zeros);
  CHECK(qr.rank() == 0);
  CHECK(qr.solve(Eigen::VectorXd::Ones(5)) == Eigen::VectorXd::Zero(2));
  CHECK(qr.basis().cols() == 0);
}

}  // namespace
}  // namespace ecs::model
