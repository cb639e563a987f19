#include "model/fit/held_out.hpp"

#include <map>

#include "model/diagnosis/structure.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/normal_matrix.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Observations observed_line(int runs, bool both_ways = false, int targets = 10) {
  return observations_of(measured({.targets = targets, .runs = runs, .both_ways = both_ways}, 0.0, nothing), straight(),
                         mill());
}

}  // namespace

TEST_CASE("least squares puts the line through three points on it") {
  const MatrixXd columns{{1.0, 0.0}, {1.0, 1.0}, {1.0, 2.0}};
  const VectorXd sizes = least_squares(columns, VectorXd{{1.0, 3.0, 5.0}});
  CHECK(sizes(0) == Approx(1.0));
  CHECK(sizes(1) == Approx(2.0));
}

TEST_CASE("columns that do the same share the size, a column of zeros gets none") {
  const MatrixXd columns = (MatrixXd(2, 3) << 1.0, 1.0, 0.0, 1.0, 1.0, 0.0).finished();
  const VectorXd sizes = least_squares(columns, VectorXd{{4.0, 4.0}});
  CHECK(sizes(0) == Approx(2.0));
  CHECK(sizes(1) == Approx(2.0));
  CHECK(sizes(2) == 0.0);
  CHECK(least_squares(MatrixXd(2, 0), VectorXd::Ones(2)).size() == 0);
}

TEST_CASE("three runs and more are held out whole") {
  const Observations data = observed_line(4, true);
  const Parts parts = parts_of(data);
  CHECK(parts.by_run);
  CHECK(parts.count == 4);
  for (std::size_t k = 0; k < data.size(); ++k) CHECK(parts.of[k] == static_cast<std::size_t>(data.run[k] - 1));
}

TEST_CASE("of lines with few runs targets are held out, and neighbours if there is one target only") {
  auto set = measured({.targets = 10, .runs = 4}, 0.0, nothing);
  measure(set, {.axis = Axis::Y, .sense = Sense::EY, .targets = 10, .runs = 1, .both_ways = false}, 0.0, nothing);
  for (int k = 0; k < 40; ++k)  // a drift test
    measure(set, {.axis = Axis::Z, .sense = Sense::EZ, .targets = 1, .runs = 1, .both_ways = false}, 0.0, nothing);
  const Observations data = observations_of(set, straight(), mill());
  const Parts parts = parts_of(data);
  std::map<Axis, std::vector<std::size_t>> in_part;
  for (std::size_t k = 0; k < data.size(); ++k)
    in_part.try_emplace(data.axis[k], parts.count).first->second[parts.of[k]] += 1;
  CHECK(parts.count == 4);
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z})
    for (const std::size_t readings : in_part.at(axis)) CHECK(readings >= 2);
}

TEST_CASE("of two runs neighbours are held out together, four at a time in five parts") {
  const Parts parts = parts_of(observed_line(2));
  CHECK_FALSE(parts.by_run);
  CHECK(parts.of == std::vector<std::size_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4});
}

TEST_CASE("a target is in one part in every run and both approaches, its neighbours in others") {
  const Observations data = observed_line(3, true, 11);
  const Parts parts = parts_by_target(data);
  CHECK(parts.count == 5);
  for (std::size_t i = 0; i < data.size(); ++i)
    for (std::size_t j = 0; j < data.size(); ++j) {
      const double apart = std::abs(data.p_mm(i, Axis::X) - data.p_mm(j, Axis::X));
      if (apart < 1e-6) CHECK(parts.of[i] == parts.of[j]);
      if (apart > 1.0 && apart < 40.0) CHECK(parts.of[i] != parts.of[j]);
    }
}

TEST_CASE("the rms of readings predicted from the other runs is that of a hand calculation") {
  Observations data = observed_line(3);
  const auto n = static_cast<Index>(data.size());
  VectorXd target(n);
  for (Index k = 0; k < n; ++k) target(k) = 3.0 * (data.run[static_cast<std::size_t>(k)] - 1);  // 0, 3 and 6
  const std::vector<bool> none(data.size(), false);
  const NoiseModel noise = plain_noise(data, 1.0);
  const Parts parts = parts_of(data);
  // a constant: from the other runs 4.5, 3 and 1.5; left over -4.5, 0 and 4.5
  CHECK(held_out_rms(data, noise, none, parts, MatrixXd::Ones(n, 1), target) == Approx(std::sqrt(13.5)));
  // no column: the rms itself, √((0 + 9 + 36)/3)
  CHECK(held_out_rms(data, noise, none, parts, MatrixXd(n, 0), target) == Approx(std::sqrt(15.0)));
}

TEST_CASE("an outlier takes no part, neither in the fit nor in the rms") {
  const Observations data = observed_line(3);
  const auto n = static_cast<Index>(data.size());
  VectorXd target = VectorXd::Ones(n);
  target(7) = 1000.0;
  std::vector<bool> left_out(data.size(), false);
  left_out[7] = true;
  CHECK(held_out_rms(data, plain_noise(data, 1.0), left_out, parts_of(data), MatrixXd::Ones(n, 1), target) ==
        Approx(0.0));
}

TEST_CASE("a true shape predicts nearly all of what is above noise, at targets it was not fitted to") {
  const Observations data = observed_line(4, true, 40);
  const auto n = static_cast<Index>(data.size());
  VectorXd shape(n);
  for (Index k = 0; k < n; ++k) shape(k) = 5.0 * std::sin(0.01 * data.p_mm(static_cast<std::size_t>(k), Axis::X));
  const VectorXd target = shape + ecs::test::normal_matrix(n, 1, 5).col(0);
  const double share = cross_validated_part(parts_by_target(data), shape, target, target);
  CHECK(share > 0.9);
  CHECK(share < 1.05);
}

TEST_CASE("columns of chance predict nothing, however many there are") {
  const Observations data = observed_line(4, true, 40);
  const auto n = static_cast<Index>(data.size());
  const VectorXd target = 2.0 * ecs::test::normal_matrix(n, 1, 7).col(0);
  CHECK(cross_validated_part(parts_by_target(data), ecs::test::normal_matrix(n, 1, 8), target, target) < 0.05);
  CHECK(cross_validated_part(parts_by_target(data), ecs::test::normal_matrix(n, 60, 9), target, target) < 0.0);
}

TEST_CASE("an effect that is there predicts each of eight runs, with the chance of eight coins that fall alike") {
  const Observations data = observed_line(8);
  const auto n = static_cast<Index>(data.size());
  VectorXd course(n), target(n);
  for (Index k = 0; k < n; ++k) {
    course(k) =
        static_cast<double>(data.run[static_cast<std::size_t>(k)]) * std::sin(0.3 * static_cast<double>(k % 10));
    target(k) = 2.0 * course(k) + 5.0 * data.run[static_cast<std::size_t>(k)];  // and a level of every run
  }
  const NoiseModel noise = plain_noise(data, 1.0);
  const std::vector<bool> none(data.size(), false);
  const auto chance = [&](const VectorXd& effect) {
    return chance_of_predicted_runs(data, noise, none, levels_of_runs(data), effect, target);
  };
  CHECK(chance(course) == Approx(2.0 / 256.0));
  CHECK(chance(VectorXd::Ones(n)) == 1.0);  // no run shows it
}

TEST_CASE("walks that differ from run to run are predicted by another walk as seldom as the chance says") {
  const Observations data = observed_line(8);
  const auto n = static_cast<Index>(data.size());
  const NoiseModel noise = plain_noise(data, 1.0);
  const std::vector<bool> none(data.size(), false);
  constexpr int kDraws = 400;
  constexpr double kChance = 18.0 / 256.0;  // of seven or more of eight, either way
  int reached = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    MatrixXd walks = ecs::test::normal_matrix(n, 2, 500 + static_cast<unsigned>(draw));
    for (Index k = 1; k < n; ++k) walks.row(k) += walks.row(k - 1);
    if (chance_of_predicted_runs(data, noise, none, levels_of_runs(data), walks.col(0), walks.col(1)) <= kChance + 1e-9)
      ++reached;
  }
  CHECK(reached <= kDraws * kChance + 3.0 * std::sqrt(kDraws * kChance));
}
