// What it costs that variances of noise are estimates: against what is known in closed form.

#include "model/fit/statistics.hpp"
#include "modules/lengths/length_solution.hpp"
#include "modules/lengths/shared_noise.hpp"
#include "modules/lengths/tests/support/made_lengths.hpp"

namespace ecs::test {
namespace {

TEST_CASE("the coverage factor is that of tables of Student's t at 95.45 %, and 2 where the noise is known") {
  // GUM table G.2
  const std::pair<double, double> table[] = {{1, 13.97}, {2, 4.53},  {3, 3.31}, {5, 2.65},
                                             {10, 2.28}, {20, 2.13}, {50, 2.05}};
  for (const auto& [freedom, k] : table) CHECK(model::coverage_factor(freedom) == doctest::Approx(k).epsilon(0.0025));
  CHECK(model::coverage_factor(0.2) == model::coverage_factor(1.0));
  CHECK(model::coverage_factor(1e5) == doctest::Approx(2.0).epsilon(1e-4));
  CHECK(model::coverage_factor(std::numeric_limits<double>::infinity()) == 2.0);
}

TEST_CASE("noise of one variance has the degrees of freedom that the readings leave, and adds nothing") {
  MadeLengths lengths("XYTZ");
  lengths.test.tools = {{"A", {0, 0, 0}}};
  lengths.test.set_ups = {{"X", model::LengthInstrument::interferometer, {1, 0, 0}, 0}};
  lengths.line(0, 0, {0, 0, 0}, {500, 0, 0}, 11);
  model::CurveSettings settings;
  for (double& knots : settings.knots_mm) knots = 500.0;
  const auto machine = model::length_machine(lengths.machine);
  REQUIRE(machine.has_value());
  const model::MachineCurves curves(*machine, settings);
  const Eigen::Index n = 22, p = 3;
  Eigen::MatrixXd direction = Eigen::MatrixXd::Zero(n, 3);
  direction.col(0).setOnes();
  const model::SharedNoise shared(lengths.test, curves, direction);
  std::mt19937 generator(5);
  NormalDraws normal;
  Eigen::MatrixXd columns(n, p);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < p; ++j) columns(i, j) = normal(generator);
  const double variance = 0.3;
  const model::LengthSolution solution = model::solution_of(columns / std::sqrt(variance), Eigen::VectorXd::Zero(n));
  const model::NoiseCertainty sure(shared, solution.basis, solution.back, {variance, 0.0, 0.0, 0.0, 0.0},
                                   {true, false, false, false, false});
  CHECK((sure.covariance() - solution.covariance).norm() < 1e-9 * solution.covariance.norm());
  CHECK(sure.degrees_of_freedom(Eigen::VectorXd(Eigen::VectorXd::Ones(p)), 0) ==
        doctest::Approx(static_cast<double>(n - p)));
  CHECK(sure.spread()(0, 0) == doctest::Approx(2.0 * variance * variance / static_cast<double>(n - p)));
}

TEST_CASE("where several variances are estimated the covariance grows and the degrees of freedom are fewer") {
  MadeLengths lengths("XYTZ");
  lengths.stations(7);
  lengths.stop_um = 0.6, lengths.stop_um_per_m = 1.0;
  lengths.measure(MadeComponents(3), 0.2, 3);
  const model::Identification found = identified(lengths, {});
  REQUIRE(found.whole());
  for (const auto& square : found.squareness) {
    CHECK(square.degrees_of_freedom > 5.0);
    CHECK(square.degrees_of_freedom < found.degrees_of_freedom);
    CHECK(square.U_um_per_m > 2.0 * square.u_um_per_m);
    CHECK(square.U_um_per_m < 2.7 * square.u_um_per_m);
  }
  CHECK(*found.volume_U_um > 2.0 * *found.volume_um);
}

}  // namespace
}  // namespace ecs::test
