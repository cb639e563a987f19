#include <numbers>

#include <Eigen/QR>

#include "tests/model/support/searching.hpp"
#include "tests/support/normal_matrix.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double wave(const Reading& r) { return std::sin(2.0 * std::numbers::pi * p(r) / 87.3); }

}  // namespace

TEST_CASE("what is absorbed is orthonormal, and what is left has nothing of it") {
  MatrixXd columns = ecs::test::normal_matrix(30, 4, 1);
  columns.col(3) = columns.col(0) - 2.0 * columns.col(1);  // depends on the others
  Space space;
  space.y = ecs::test::normal_matrix(30, 1, 2).col(0);
  space.q.resize(30, 0);
  const VectorXd y = space.y;
  absorb(space, columns.leftCols(1));
  absorb(space, columns.rightCols(3));
  CHECK(space.q.cols() == 3);
  CHECK((space.q.transpose() * space.q - MatrixXd::Identity(3, 3)).norm() < 1e-12);
  CHECK((columns.transpose() * space.y).norm() < 1e-10);
  const VectorXd left = y - columns * columns.completeOrthogonalDecomposition().solve(y);
  CHECK(space.chi2() == Approx(left.squaredNorm()));
}

TEST_CASE("a period between two that were tried is found, and gains what its size promises") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"cyclic:X:EX"}));
  const std::vector<Choice> found = of.search.expand(of.search.base());
  CHECK(only(found).nonlinear == Approx(87.3).epsilon(0.005));
  const double promised = 0.5 * 246.0 / (kSigma_um * kSigma_um);  // mean square ½ of 246 readings
  CHECK(found.front().gain == Approx(promised).epsilon(0.1));
}

TEST_CASE("of several causes the true one comes first") {
  const auto candidates = candidates_named({"cyclic:X:EX", "backlash:X:EX", "sag:X:EX", "step:X:EX"});
  const Searching of(measured_line([](const Reading& r) { return p(r) > 512.0 ? 1.5 : 0.0; }), kSigma_um, candidates);
  const std::vector<Choice> found = of.search.expand(of.search.base());
  REQUIRE_FALSE(found.empty());
  CHECK(of.name_of(found.front()) == "step:X:EX");
  CHECK(found.front().nonlinear == Approx(512.0).epsilon(0.03));  // between two targets 25 mm apart
  for (std::size_t i = 1; i < found.size(); ++i) CHECK(found[i].score() <= found[i - 1].score());
}

TEST_CASE("an effect that the model has already gains nothing more") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"scale:X:EX", "offset:X:EX", "backlash:X:EX"}));
  for (const Choice& choice : of.search.expand(of.search.base())) CHECK(of.name_of(choice) == "backlash:X:EX");
}

TEST_CASE("the gain of a choice is the fall of the sum of squares of a least squares fit") {
  const Searching of(measured_line([](const Reading& r) { return 0.8 * d(r); }), kSigma_um,
                     candidates_named({"backlash:X:EX"}));
  const Solution solution = of.search.solution({of.search.choice_at(of.search.base(), 0, 0.0)});
  const auto chi2_with = [&](const MatrixXd& columns) {
    return (of.target - columns * columns.completeOrthogonalDecomposition().solve(of.target)).squaredNorm() /
           (kSigma_um * kSigma_um);
  };
  MatrixXd with = of.base;
  with.conservativeResize(Eigen::NoChange, 3);
  for (Index k = 0; k < with.rows(); ++k) with(k, 2) = of.data.approach[static_cast<std::size_t>(k)];
  CHECK(solution.chi2_before == Approx(chi2_with(of.base)));
  CHECK(solution.space.chi2() == Approx(chi2_with(with)));
  CHECK(solution.chosen.front().gain == Approx(chi2_with(of.base) - chi2_with(with)));
}

TEST_CASE("every free coefficient costs the logarithm of the readings that it acts on") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"backlash:X:EX"}));
  CHECK(of.search.choice_at(of.search.base(), 0, 0.0).cost == Approx(std::log(246.0)));
}

TEST_CASE("functions that two curves share are paid for once, whichever comes first") {
  auto set = measured_line([](const Reading& r) { return 4.0 * std::sin(std::numbers::pi * p(r) / 1000.0); });
  for (Reading& r : set.readings) r.position_mm[index_of(Axis::Z)] = 300.0;  // one lever
  const Searching of(set, kSigma_um, candidates_named({"progressive:X:EX", "angular:X:EBX"}));
  REQUIRE(of.search.families().size() == 2);
  const Choice curve = of.search.choice_at(of.search.base(), 0, 0.0);
  const Choice angle = of.search.choice_at(of.search.base(), 1, 0.0);
  for (const Solution& both : {of.search.solution({curve, angle}), of.search.solution({angle, curve})}) {
    const auto functions = both.space.q.cols() - of.search.base().q.cols();
    CHECK(static_cast<Index>(both.chosen[0].parameters + both.chosen[1].parameters) == functions);
    CHECK(both.cost == Approx(std::log(246.0) * static_cast<double>(functions)));
  }
}

TEST_CASE("more candidates never make noise look worse") {
  const auto set = measured_line(nothing);
  const Searching few(set, kSigma_um, candidates_named({"backlash:X:EX"}));
  const Searching many(set, kSigma_um, candidates_named({"backlash:X:EX", "cyclic:X:EX", "step:X:EX"}));
  MatrixXd replicates = ecs::test::normal_matrix(246, 40, 3);
  replicates -= few.search.base().q * (few.search.base().q.transpose() * replicates);
  const auto less = few.search.best_scores(replicates.cast<float>());
  const auto more = many.search.best_scores(replicates.cast<float>());
  REQUIRE(less.size() == 40);
  REQUIRE(more.size() == 40);
  for (std::size_t b = 0; b < less.size(); ++b) CHECK(more[b] >= less[b]);
}

TEST_CASE("the score of noise on one effect is the square of one normal deviate less the price") {
  const Searching of(measured_line(nothing), kSigma_um, candidates_named({"backlash:X:EX"}));
  MatrixXd replicates = ecs::test::normal_matrix(246, 2000, 4);
  replicates -= of.search.base().q * (of.search.base().q.transpose() * replicates);
  double mean = 0.0;
  for (const double score : of.search.best_scores(replicates.cast<float>())) mean += score / 2000.0;
  CHECK(mean == Approx(1.0 - std::log(246.0)).epsilon(0.03));  // the mean of χ² of one degree is 1
}

TEST_CASE("noise gains no more by an angle of which a function with many others makes up the zero of the line") {
  // the lever is the position itself: an angle proportional to its inverse is a constant error
  params::Machine machine = mill();
  machine.configuration = "XYZT";
  const auto set =
      measured({.axis = Axis::Y, .sense = Sense::EX, .from_mm = 90.0, .step_mm = 8.5, .targets = 24, .runs = 4},
               kSigma_um, nothing);
  const Observations data = observations_of(set, Model{}, machine);
  const Regressors regressors(data);
  const Whitener whitener(data, plain_noise(data, kSigma_um), std::vector<bool>(data.size(), false));
  const MatrixXd zero = MatrixXd::Ones(192, 1);
  Eigen::VectorXd bump(192);
  for (Index k = 0; k < 192; ++k) {
    const double y_mm = set.readings[static_cast<std::size_t>(k)].position_mm[1];
    bump(k) = 0.02 * y_mm * std::exp(-std::pow((y_mm - 190.0) / 24.0, 2));
  }
  const Search search(regressors, whitener, zero, bump, candidates_named({"angular:Y:ECY"}));
  REQUIRE(search.candidates() == 1);
  MatrixXd replicates = ecs::test::normal_matrix(192, 200, 5);
  replicates -= search.base().q * (search.base().q.transpose() * replicates);
  for (const double score : search.best_scores(replicates.cast<float>())) CHECK(score < 20.0);
  // and takes all its functions that double precision shows
  CHECK(search.choice_at(search.base(), 0, 0.0).gain > 0.95 * search.base().chi2());
}

TEST_CASE("periods are tried at the pitch of the screw, its parts and its multiples") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"cyclic:X:EX"}));
  const std::vector<double>& facts = only(of.search.families()).facts;
  for (const double period_mm : {10.0, 5.0, 20.0})
    CHECK(std::any_of(facts.begin(), facts.end(), [&](double f) { return std::abs(f - period_mm) < 1e-9; }));
}

TEST_CASE("periods tried are no longer than two thirds of the travel and never a whole turn over it apart") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"cyclic:X:EX"}));
  const std::vector<double>& periods = of.search.families().front().grid;
  REQUIRE(periods.size() > 10);
  const double travel = 1000.0;  // nearly: the targets are a little uneven
  for (std::size_t i = 0; i < periods.size(); ++i) {
    CHECK(periods[i] <= 0.68 * travel);
    if (i > 0) CHECK(1.0 / periods[i] - 1.0 / periods[i - 1] < 0.5 / travel);
  }
}

TEST_CASE("steps are tried between the targets, never on one") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"step:X:EX"}));
  const std::vector<double>& steps = of.search.families().front().grid;
  CHECK(steps.size() == 36);
  for (const double at : steps)
    for (std::size_t k = 0; k < of.data.size(); ++k) CHECK(std::abs(of.data.p_mm(k, Axis::X) - at) > 1.0);
}

TEST_CASE("a search that is cancelled stops") {
  std::atomic<bool> cancelled = false;
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"cyclic:X:EX"}), &cancelled);
  CHECK_FALSE(of.search.expand(of.search.base()).empty());
  cancelled = true;
  CHECK_THROWS_AS(static_cast<void>(of.search.expand(of.search.base())), SearchStopped);
}

TEST_CASE("a free wave of the model is found where six even targets see it as fewer than two turns") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    auto set = measured({.step_mm = 130.0, .targets = 6, .runs = 2}, kSigma_um, nothing, seed);
    for (Reading& r : set.readings) {  // of 130 mm whole turns of the pitch, so that it shows nothing
      r.position_mm[0] = 130.0 * std::round(r.position_mm[0] / 130.0);
      r.error += 9.0 * std::sin(2.0 * std::numbers::pi * p(r) / 202.0);
    }
    const Searching of(set, kSigma_um, {});
    const Search search(of.regressors, of.whitener, of.base.leftCols(1), of.target, {},
                        candidates_named({"cyclic:X:EX"}));
    CHECK(search.alone().space.chi2() < 40.0);  // of 24 readings less six parameters
  }
}

TEST_CASE("a free wave of the model itself keeps its period beside a slope that is missing from it") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Searching of(measured_line([](const Reading& r) { return wave(r) + 12.0 * p(r) / 1000.0; }, seed), kSigma_um,
                       {});
    const MatrixXd offset_alone = of.base.leftCols(1);
    const Search search(of.regressors, of.whitener, offset_alone, of.target,
                        candidates_named({"scale:X:EX", "step:X:EX"}), candidates_named({"cyclic:X:EX"}));
    CHECK(search.candidates() == 2);
    REQUIRE(search.families().size() == 3);
    const Solution solution = search.refined({search.choice_at(search.alone().space, 0, 0.0)});
    CHECK(only(solution.own).nonlinear == Approx(87.3).epsilon(0.005));
    CHECK(solution.space.chi2() == Approx(246.0).epsilon(0.3));  // noise alone is left
    CHECK(search.alone().space.chi2() > 10.0 * solution.space.chi2());
  }
}

TEST_CASE("a model whose own wave has all there is needs nothing more") {
  const Searching of(measured_line(wave), kSigma_um, {});
  const Search search(of.regressors, of.whitener, of.base, of.target, candidates_named({"backlash:X:EX"}),
                      candidates_named({"cyclic:X:EX"}));
  CHECK(only(search.alone().own).nonlinear == Approx(87.3).epsilon(0.005));
  for (const Choice& choice : search.expand(search.alone().space)) CHECK(choice.score() < 8.0);
}

TEST_CASE("an effect pays for the choice of which of its sizes it uses") {
  const Searching of(measured_line([](const Reading& r) { return 40.0 * std::pow(p(r) / 1000.0, 3); }), kSigma_um,
                     candidates_named({"sag:X:EX"}));
  const Choice cube = of.search.choice_at(of.search.base(), 0, 0.0);
  REQUIRE(cube.columns == std::vector<Index>{1});
  CHECK(cube.cost == Approx(std::log(246.0) + 2.0 * std::log(3.0)));  // one of: square, cube, both
}

TEST_CASE("beside a square a formula of square and cube pays for its cube alone") {
  EffectInstance square = effect(effects::user, Axis::X, Sense::EX);
  square.name = "square";
  square.formulas = {{Sense::EX, "k*(x_mm/1000)^2"}};
  square.user = {{"k", "um", {}, {}, {}, {}}};
  EffectInstance both = square;
  both.name = "both";
  both.formulas = {{Sense::EX, "a*(x_mm/1000)^2+b*(x_mm/1000)^3"}};
  both.user = {{"a", "um", {}, {}, {}, {}}, {"b", "um", {}, {}, {}, {}}};
  const Searching of(measured_line([](const Reading& r) { return 40.0 * std::pow(p(r) / 1000.0, 3); }), kSigma_um,
                     {square, both, candidate("step:X:EX")});
  const Search& search = of.search;
  std::vector<Choice> chosen;
  for (std::size_t f = 0; f < 3; ++f) chosen.push_back(search.choice_at(search.base(), f, f < 2 ? 0.0 : 500.0));
  REQUIRE(chosen[1].cost == Approx(2.0 * std::log(246.0)));
  CHECK(search.refined(chosen).chosen[1].cost == Approx(std::log(246.0)));
}

TEST_CASE("a wave started at twice its period, as a second harmonic, is refined to its own period") {
  const Searching of(measured_line(wave), kSigma_um, candidates_named({"cyclic:X:EX"}));
  Choice twice = of.search.choice_at(of.search.base(), 0, 2.0 * 87.3);
  REQUIRE(twice.columns.size() == 4);
  const Search& search = of.search;
  const Choice other = search.choice_at(search.base(), 0, 411.0);
  const Solution found = search.refined({twice, other});
  REQUIRE(found.chosen.size() == 2);
  CHECK(found.chosen.front().nonlinear == Approx(87.3).epsilon(0.005));
  CHECK(found.chosen.front().columns.size() == 2);
}

TEST_CASE("all sizes of an effect are free again for its final fit") {
  const Searching of(measured_line([](const Reading& r) { return 40.0 * std::pow(p(r) / 1000.0, 3); }), kSigma_um,
                     candidates_named({"sag:X:EX"}));
  const Choice cube = of.search.choice_at(of.search.base(), 0, 0.0);
  const EffectInstance held = effect_of(of.search.families()[0].effect, cube);
  CHECK(held.parameters.contains("k2"));
  CHECK_FALSE(with_all_sizes(held, cube).parameters.contains("k2"));
}

TEST_CASE("a time constant far off is searched again beside the effects found with it") {
  const auto set = measured_line(
      [](const Reading& r) { return 12.0 * -std::expm1(-*r.time_s / 150.0) + 10.0 * *r.time_s / 3600.0; });
  const Searching of(set, kSigma_um, candidates_named({"warm_up:X:EX", "time_drift:X:EX"}));
  const Choice slow = of.search.choice_at(of.search.base(), 0, 2500.0);
  const Choice drift = of.search.choice_at(of.search.base(), 1, 0.0);
  const Solution found = of.search.refined({slow, drift});
  REQUIRE(found.chosen.size() == 2);
  const Choice quick = of.search.choice_at(of.search.base(), 0, 150.0);
  CHECK(found.space.chi2() <= of.search.solution({quick, drift}).space.chi2());
  CHECK(found.chosen.front().nonlinear < 300.0);
}

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
  return choice_of(best_gain(family, variants, gram, columns.transpose() * y, gram.diagonal(), kExact, {price, 0.0}),
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
  const Gain gain = best_gain(family_of("scale"), {{0}}, left, VectorXd::Ones(1), VectorXd::Ones(1), kExact, {});
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
