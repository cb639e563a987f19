// Lack of fit by adding functions: the F test of columns added to a regression (Fisher 1922; Draper and Smith
// 1998, 6.1), one test a variable, its largest judged by the largest of replicates of noise (Westfall and Young
// 1993, 2.3).
#include "model/diagnosis/structure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "model/data/curve_basis.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/candidates.hpp"

namespace ecs::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

double minus_log_p(double gain, double freedom, double noise_freedom) {
  if (freedom <= 0.0) return 0.0;
  return -ln_f_tail(gain / freedom, freedom, noise_freedom) / std::numbers::ln10;
}

Structure::Structure(const Observations& data, const Whitener& whitener, double noise_freedom)
    : variables_(variables_of(data)), noise_freedom_(noise_freedom) {
  for (const Variable& variable : variables_) white_.push_back(whitener(variable.columns));
}

StructureTest Structure::test_of(const Space& space, std::size_t variable) const {
  Space more = space;
  const double before = more.chi2();
  absorb(more, white_[variable]);
  StructureTest test;
  test.variable = variables_[variable].name;
  test.gain = before - more.chi2();
  test.freedom = static_cast<double>(more.q.cols() - space.q.cols());
  test.excess = (test.gain - test.freedom) / static_cast<double>(space.y.size());
  test.minus_log_p = minus_log_p(test.gain, test.freedom, noise_freedom_);
  return test;
}

std::vector<StructureTest> tests_beyond_position(const Observations& data, const Whitener& whitener,
                                                 const Structure& structure, const Space& space,
                                                 std::vector<StructureTest> tests) {
  constexpr double kShown = 3.0;  // digits of the chance: a thousandth, as what is ranked in an answer
  for (std::size_t v = 0; v < tests.size(); ++v) {
    if (tests[v].minus_log_p < kShown) continue;
    Space with_position = space;
    absorb(with_position, whitener(position_beside(data, tests[v].variable)));
    tests[v] = structure.test_of(with_position, v);
  }
  return tests;
}

std::vector<StructureTest> Structure::tests(const Space& space) const {
  std::vector<StructureTest> tests;
  for (std::size_t v = 0; v < variables_.size(); ++v) tests.push_back(test_of(space, v));
  return tests;
}

double largest_of(const std::vector<StructureTest>& tests) {
  double largest = 0.0;
  for (const StructureTest& test : tests) largest = std::max(largest, test.minus_log_p);
  return largest;
}

std::vector<double> Structure::largest_of(const Space& space, const MatrixXf& noise_replicates) const {
  std::vector<double> largest(static_cast<std::size_t>(noise_replicates.cols()), 0.0);
  for (std::size_t v = 0; v < variables_.size(); ++v) {
    Space more = space;
    absorb(more, white_[v]);
    const Index fresh = more.q.cols() - space.q.cols();
    if (fresh == 0) continue;
    const MatrixXf products = more.q.rightCols(fresh).cast<float>().transpose() * noise_replicates;
    for (Index b = 0; b < noise_replicates.cols(); ++b) {
      double& top = largest[static_cast<std::size_t>(b)];
      top = std::max(top, minus_log_p(static_cast<double>(products.col(b).squaredNorm()), static_cast<double>(fresh),
                                      noise_freedom_));
    }
  }
  return largest;
}

}  // namespace ecs::model
