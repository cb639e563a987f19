#include "model/diagnosis/p_value.hpp"

#include <cmath>

#include <doctest/doctest.h>

#include "model/diagnosis/diagnose.hpp"
#include "tests/model/normal_matrix.hpp"
#include "tests/model/support/searching.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Readings against offset and scale; a backlash is tested beside them.
struct Tested {
  Observations data = observations_of(measured_line(nothing), straight(), mill());
  Regressors regressors{data};
  NoiseModel noise = plain_noise(data, kSigma_um);
  std::vector<bool> left_out = std::vector<bool>(data.size(), false);
  MatrixXd columns{static_cast<Index>(data.size()), 2};
  MatrixXd effect = regressors.columns(candidate("backlash:X:EX"), 0.0).of;

  Tested() {
    for (std::size_t k = 0; k < data.size(); ++k)
      columns.row(static_cast<Index>(k)) << 1.0, data.p_mm(k, Axis::X) / 1000.0;
  }
  [[nodiscard]] double p_value(const VectorXd& y, double tests = 1.0) const {
    return p_value_of({regressors, noise, left_out}, columns, y, effect, tests);
  }
  [[nodiscard]] VectorXd of_noise(double size_um, unsigned seed) const {
    return size_um * normal_matrix(columns.rows(), 1, seed).col(0);
  }
};

}  // namespace

TEST_CASE("in noise of any size a p-value is below a chance as often as that chance says") {
  const Tested of;
  constexpr unsigned kSets = 2000;
  for (const double size_um : {0.01, 30.0}) {
    CAPTURE(size_um);
    unsigned below_tenth = 0, below_hundredth = 0;
    for (unsigned seed = 1; seed <= kSets; ++seed) {
      const double p = of.p_value(of.of_noise(size_um, seed));
      below_tenth += p <= 0.1 ? 1U : 0U;
      below_hundredth += p <= 0.01 ? 1U : 0U;
    }
    CHECK(below_tenth / static_cast<double>(kSets) == Approx(0.1).epsilon(0.2));
    CHECK(below_hundredth <= 35);  // of 20 on average: three standard deviations
  }
}

TEST_CASE("a p-value pays for every test, and is at most one") {
  const Tested of;
  const VectorXd y = of.of_noise(kSigma_um, 3) + 0.1 * of.effect.col(0);
  const double p = of.p_value(y);
  CHECK(of.p_value(y, 7.0) == Approx(std::min(1.0, 7.0 * p)));
  CHECK(of.p_value(of.of_noise(kSigma_um, 3), 1e9) == 1.0);
}

TEST_CASE("a p-value depends neither on the unit nor on what the model itself can take") {
  const Tested of;
  const VectorXd y = of.of_noise(kSigma_um, 5) + 0.1 * of.effect.col(0);
  const double p = of.p_value(y);
  REQUIRE(p < 0.5);
  CHECK(of.p_value(1e3 * y + of.columns * Eigen::Vector2d(40.0, -7.0)) == Approx(p).epsilon(1e-6));
}

TEST_CASE("of the shapes of noise that the readings leave possible the one that speaks least for an effect counts") {
  Tested of;
  const VectorXd y = of.of_noise(kSigma_um, 3) + of.effect.col(0);
  const double in_white = of.p_value(y);
  const NoiseShape white = of.noise.shapes.front(), slow{0.9, 60.0, 1e-3, white.variance};
  of.noise.shapes = {slow};
  const double in_slow = of.p_value(y);
  REQUIRE(in_slow > 10.0 * in_white);
  of.noise.shapes = {white, slow};
  CHECK(of.p_value(y) == in_slow);
  of.noise.shapes[1].weight = 1e-12;  // ruled out
  CHECK(of.p_value(y) == in_white);
}

TEST_CASE("an effect that the model takes wholly has no evidence") {
  Tested of;
  of.effect = of.columns.col(1);
  CHECK(of.p_value(of.of_noise(kSigma_um, 3)) == 1.0);
}

TEST_CASE("the causes named for a fleet are those of a whole diagnosis, with p-values that hold among many machines") {
  DiagnoseOptions options;
  options.noise_replicates = 60;
  options.p_values = true;
  for (const double backlash_um : {0.0, 2.0}) {
    CAPTURE(backlash_um);
    const Observations data =
        observations_of(measured_line([&](const laser::Reading& r) { return backlash_um * d(r); }), straight(), mill());
    const Diagnosis whole = diagnose(straight(), data, options).value();
    const NamedCauses names = named_causes(straight(), data, options).value();
    CHECK(names.verdict == whole.verdict);
    std::size_t named = 0;
    for (const Candidate& candidate : whole.candidates) {
      if (!candidate.named) continue;
      REQUIRE(named < names.causes.size());
      CHECK(names.causes[named].name == to_text(candidate.effect));
      CHECK(names.causes[named].probability == candidate.probability);
      CHECK(names.causes[named].e_value == candidate.e_value);
      CHECK(names.causes[named].false_naming == candidate.false_naming);
      ++named;
    }
    CHECK(names.causes.size() == named);
    CHECK(named == (backlash_um > 0.0 ? 1 : 0));
    CHECK((names.p_value < 1e-20) == (backlash_um > 0.0));
  }
}
