#include "model/fit/gains.hpp"

#include <doctest/doctest.h>

#include "model/diagnosis/ladder.hpp"

using namespace ecs;
using namespace ecs::model;
using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Family family_of(const char* effect) {
  Family family;
  family.effect.id = parse_add_request(effect)->id;
  return family;
}

/// The best choice among sets of these columns for what is left `y`, at a price a column.
Choice best(const Family& family, const MatrixXd& columns, const VectorXd& y,
            const std::vector<std::vector<Index>>& variants, double price = 0.0) {
  const MatrixXd gram = columns.transpose() * columns;
  return choice_of(best_gain(family, variants, gram, columns.transpose() * y, gram.diagonal(), kAbsorbed, {price, 0.0}),
                   variants);
}

}  // namespace

TEST_CASE("one column gains the square of its product over its own square") {
  const MatrixXd column{{2.0}, {0.0}};
  const Choice choice = best(family_of("scale"), column, VectorXd{{3.0, 5.0}}, {{0}}, 1.5);
  CHECK(choice.gain == Approx(9.0));  // (2·3)²/4
  CHECK(choice.cost == Approx(1.5));
  CHECK(choice.parameters == 1);
}

TEST_CASE("a second column gains only what the first leaves") {
  const MatrixXd columns = (MatrixXd(2, 2) << 1.0, 1.0, 0.0, 1.0).finished();  // (1, 0) and (1, 1)
  const VectorXd y{{1.0, 2.0}};
  CHECK(best(family_of("scale"), columns, y, {{0}}).gain == Approx(1.0));
  CHECK(best(family_of("scale"), columns, y, {{1}}).gain == Approx(4.5));     // (1 + 2)²/2
  CHECK(best(family_of("scale"), columns, y, {{0, 1}}).gain == Approx(5.0));  // all of 1² + 2²
}

TEST_CASE("two columns that are the same count as one") {
  const MatrixXd columns = (MatrixXd(2, 2) << 1.0, 2.0, 1.0, 2.0).finished();
  const Choice choice = best(family_of("scale"), columns, VectorXd{{1.0, 3.0}}, {{0, 1}}, 1.0);
  CHECK(choice.gain == Approx(8.0));  // the mean of 1 and 3, twice
  CHECK(choice.parameters == 1);
  CHECK(choice.cost == Approx(1.0));
}

TEST_CASE("a column of which the model absorbs everything gains nothing") {
  const MatrixXd left = MatrixXd::Constant(1, 1, 1e-10);
  const Gain gain = best_gain(family_of("scale"), {{0}}, left, VectorXd::Ones(1), VectorXd::Ones(1), kAbsorbed, {});
  CHECK(gain.gain < 0.0);
}

TEST_CASE("a single coefficient outside its physical range gains as much as the nearest that is allowed") {
  const MatrixXd column = MatrixXd::Constant(1, 1, 2.0);
  const VectorXd y = VectorXd::Constant(1, 3.0);  // best coefficient 1.5, gain 9
  Family family = family_of("scale");
  family.range = ValueRange{0.0, 1.0};
  CHECK(best(family, column, y, {{0}}).gain == Approx(8.0));  // 3² − (3 − 1·2)²
  family.range = ValueRange{0.0, 2.0};
  CHECK(best(family, column, y, {{0}}).gain == Approx(9.0));
  family.range = ValueRange{2.0, 3.0};
  CHECK(best(family, column, y, {{0}}).gain == Approx(8.0));  // 3² − (3 − 2·2)²
}

TEST_CASE("a single coefficient outside its physical range by more than three standard deviations is another cause") {
  const MatrixXd column = MatrixXd::Constant(1, 1, 2.0);  // standard deviation of the coefficient: 0.5
  Family family = family_of("scale");
  family.range = ValueRange{0.0, 2.0};
  CHECK(best(family, column, VectorXd::Constant(1, 6.9), {{0}}).gain == Approx(39.2));  // 3.45: 6.9² − (6.9 − 2·2)²
  CHECK(best(family, column, VectorXd::Constant(1, 7.1), {{0}}).gain < 0.0);            // 3.55
}

TEST_CASE("of several sets the one whose gain less its price is highest is chosen") {
  const MatrixXd columns = MatrixXd::Identity(2, 2);
  const VectorXd y{{3.0, 1.0}};
  CHECK(best(family_of("scale"), columns, y, {{0}, {0, 1}}, 2.0).columns == std::vector<Index>{0});
  CHECK(best(family_of("scale"), columns, y, {{0}, {0, 1}}, 0.5).columns == std::vector<Index>{0, 1});
}

TEST_CASE("a curve ends where another function does not pay") {
  const MatrixXd columns = MatrixXd::Identity(6, 6);
  const VectorXd y{{5.0, 4.0, 3.0, 0.5, 0.5, 0.5}};
  std::vector<std::vector<Index>> leading(1);
  std::vector<std::vector<Index>> all;
  for (Index j = 0; j < 6; ++j) {
    leading.back().push_back(j);
    all.push_back(leading.back());
  }
  const Choice choice = best(family_of("progressive"), columns, y, all, 1.0);
  CHECK(choice.columns.size() == 3);
  CHECK(choice.gain == Approx(50.0));
  CHECK(choice.score() == Approx(47.0));
}

TEST_CASE("a curve looks past one poor function to the good ones behind it") {
  const MatrixXd columns = MatrixXd::Identity(3, 3);
  const Choice choice =
      best(family_of("progressive"), columns, VectorXd{{2.0, 0.0, 3.0}}, {{0}, {0, 1}, {0, 1, 2}}, 1.0);
  CHECK(choice.columns.size() == 3);
  CHECK(choice.score() == Approx(10.0));  // 4 + 9 − 3, against 4 − 1
}
