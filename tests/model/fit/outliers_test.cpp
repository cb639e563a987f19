#include "model/fit/outliers.hpp"

#include <algorithm>

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "tests/model/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// 41 targets, three runs both ways: 246 readings of unit noise, some off.
struct Spoiled {
  Observations data;
  VectorXd residual;

  explicit Spoiled(unsigned seed, const Plan& plan = {})
      : data(observations_of(measured(plan, 1.0, nothing, seed), straight(), mill())),
        residual(Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()))) {}
  void raise(std::size_t k, double by_um) { residual(static_cast<Index>(k)) += by_um; }
  [[nodiscard]] std::vector<std::size_t> outliers() const {
    std::vector<std::size_t> rows;
    const std::vector<bool> out = isolated_outliers(data, residual);
    for (std::size_t k = 0; k < out.size(); ++k)
      if (out[k]) rows.push_back(k);
    return rows;
  }
};

}  // namespace

TEST_CASE("a reading far off its neighbours and its repeats is an outlier, wherever it is and up or down") {
  CHECK(rc::check([] {
    Spoiled set(static_cast<unsigned>(*rc::gen::inRange(1, 1000)));
    const auto at = *rc::gen::inRange<std::size_t>(0, 246);
    set.raise(at, *rc::gen::element(-1e4, -30.0, 30.0, 1e4));
    const std::vector<std::size_t> found = set.outliers();
    RC_ASSERT(std::find(found.begin(), found.end(), at) != found.end());
    RC_ASSERT(found.size() <= 2U);
  }));
}

TEST_CASE("noise has an outlier in at most two of a hundred sets") {
  unsigned sets = 0;
  for (unsigned seed = 1; seed <= 500; ++seed)
    if (!Spoiled(seed).outliers().empty()) ++sets;
  CHECK(sets <= 10);
}

TEST_CASE("two odd readings in a row are outliers, three are something that happened") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Spoiled two(seed), three(seed);
    for (const std::size_t k : {50U, 51U}) two.raise(k, 40.0);
    for (const std::size_t k : {50U, 51U, 52U}) three.raise(k, 40.0);
    CHECK(two.outliers() == std::vector<std::size_t>{50, 51});
    CHECK(three.outliers().empty());
  }
}

TEST_CASE("three odd readings of four in a row are a burst that crosses zero, not outliers") {
  Spoiled set(7);
  for (const std::size_t k : {50U, 51U, 53U}) set.raise(k, 40.0);
  CHECK(set.outliers().empty());
}

TEST_CASE("where one reading in nine is odd alike, none is isolated") {
  Spoiled set(1);
  for (std::size_t k = 4; k < 246; k += 9) set.raise(k, 20.0);
  CHECK(set.outliers().empty());
}

TEST_CASE("of many odd readings the few that stand apart are outliers") {
  Spoiled set(1);
  std::vector<std::size_t> apart;
  for (std::size_t i = 0, k = 4; k < 246; ++i, k += 9) {
    set.raise(k, i % 5 == 0 ? 1000.0 : 20.0);
    if (i % 5 == 0) apart.push_back(k);
  }
  CHECK(set.outliers() == apart);
}

TEST_CASE("outliers that do not stand apart from the next are kept to five percent of the readings") {
  CHECK(rc::check([] {
    Spoiled set(static_cast<unsigned>(*rc::gen::inRange(1, 1000)));
    const auto every = *rc::gen::inRange<std::size_t>(5, 60);
    for (std::size_t k = 4; k < 246; k += every) set.raise(k, 10.0 * *rc::gen::inRange(1, 1000));
    RC_ASSERT(set.outliers().size() <= 12U);
  }));
}

TEST_CASE("eleven readings know no scale to judge one of them by") {
  Plan few;
  few.targets = 11;
  few.runs = 1;
  few.both_ways = false;
  Spoiled set(1, few);
  set.raise(5, 1e6);
  CHECK(set.outliers().empty());
  few.targets = 12;
  Spoiled enough(1, few);
  enough.raise(5, 1e6);
  CHECK(enough.outliers() == std::vector<std::size_t>{5});
}

TEST_CASE("two neighbours far off, one to each side, are a jump that the model has smoothed, no outliers") {
  Spoiled set(3, {.runs = 1, .both_ways = false});
  set.raise(20, 40.0);
  set.raise(21, -40.0);
  CHECK(set.outliers().empty());
  Spoiled alone(3, {.runs = 1, .both_ways = false});
  alone.raise(20, 40.0);
  CHECK(alone.outliers() == std::vector<std::size_t>{20});
}

TEST_CASE("the first reading after a reversal is no outlier where every run is off there") {
  Spoiled set(4, {.runs = 2});
  const std::vector<std::size_t> first{0, 82};  // of either forward pass of 41 targets
  for (const std::size_t k : first) set.raise(k, 40.0);
  CHECK(set.outliers() == first);  // as long as nobody says how far the axis has moved since its reversal
  for (std::size_t k = 0; k < set.data.size(); ++k) {
    const double p_mm = set.data.p_mm(k, Axis::X);
    set.data.travel_since_reversal_mm.push_back(set.data.approach[k] > 0 ? 10.0 + p_mm : 1010.0 - p_mm);
  }
  CHECK(set.outliers().empty());
  set.raise(82, -40.0);  // one run only
  CHECK(set.outliers() == std::vector<std::size_t>{0});
}
