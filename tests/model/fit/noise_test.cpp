#include "model/fit/noise.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <rapidcheck.h>

#include "base/linear/decompositions.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kWhite_um = 0.4;

struct Measured {
  Observations data;
  VectorXd residual;
  std::vector<bool> left_out;
};

Measured readings_of(const laser::MeasurementSet& set) {
  Measured m;
  m.data = observations_of(set, straight(), mill());
  m.residual = Eigen::Map<const VectorXd>(m.data.reading.data(), static_cast<Index>(m.data.size()));
  m.left_out.assign(m.data.size(), false);
  return m;
}

/// 41 targets, three runs both ways: 246 readings in 82 nodes.
Measured white(unsigned seed = 1) { return readings_of(measured({}, kWhite_um, nothing, seed)); }

NoiseModel noise_in(const Measured& m) {
  return noise_of(m.data, m.residual, MatrixXd::Ones(m.residual.size(), 1), m.left_out);
}

double share_of_white(const NoiseModel& noise) {
  for (const NoiseShape& shape : noise.shapes)
    if (shape.share == 0.0) return shape.weight;
  return 0.0;
}

}  // namespace

TEST_CASE("noise that values of their own at all targets have absorbed is not seen, whichever way it is estimated") {
  double squares = 0.0;
  constexpr int kSets = 200;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    Measured m = readings_of(measured({.step_mm = 125.0, .targets = 9, .runs = 1}, kWhite_um, nothing, seed));
    MatrixXd targets = MatrixXd::Zero(m.residual.size(), 10);
    for (Index k = 0; k < m.residual.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      targets(k, static_cast<Index>(std::lround(m.data.p_mm(at, Axis::X) / 125.0))) = 1.0;
      targets(k, 9) = m.data.approach[at];
    }
    m.residual -= targets * PivotedQr(targets).solve(m.residual);
    const NoiseModel noise = noise_of(m.data, m.residual, m.left_out, targets);
    CHECK(noise.pure.dof == Approx(8.0).epsilon(0.2));  // 18 readings less 10 columns
    squares += noise.pure.noise_um * noise.pure.noise_um / kSets;
  }
  CHECK(std::sqrt(squares) == Approx(kWhite_um).epsilon(0.08));
}

TEST_CASE("white noise of a known size is found from the repeats, whatever shape is under it") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    Measured m = white(seed);
    for (Index k = 0; k < m.residual.size(); ++k)
      m.residual(k) += 20.0 * std::sin(0.03 * m.data.p_mm(static_cast<std::size_t>(k), Axis::X));
    const NoiseModel noise = noise_in(m);
    CHECK(noise.pure.from_repeats);
    CHECK(noise.pure.noise_um == Approx(kWhite_um).epsilon(0.12));  // 164 degrees of freedom: 5.5 %, two sigmas
    CHECK(share_of_white(noise) > 0.5);
  }
}

TEST_CASE("repeats have as many degrees of freedom as there are readings less places") {
  Measured m = white();
  CHECK(noise_in(m).pure.dof == Approx(246.0 - 82.0));
  m.left_out[3] = true;  // its place keeps two others
  CHECK(noise_in(m).pure.dof == Approx(246.0 - 82.0));
}

TEST_CASE("two runs of seven targets seldom look as if the runs differed, and then half of the repeats are left") {
  constexpr int kSets = 300;
  int differ = 0, too_small = 0;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    const NoiseModel noise =
        noise_in(readings_of(measured({.step_mm = 125.0, .targets = 7, .runs = 2}, kWhite_um, nothing, seed)));
    differ += noise.pure.dof == Approx(7.0) ? 1 : 0;
    too_small += noise.pure.noise_um < 0.5 * kWhite_um ? 1 : 0;
  }
  CHECK(differ <= 12);    // one in a hundred by the F test; twice as many, for outliers count less
  CHECK(too_small <= 6);  // χ² of 14 below 3.5: 0.2 %, and those whose runs differ
}

TEST_CASE("without repeats the noise is what smooth columns leave, and says so") {
  const NoiseModel noise = noise_in(readings_of(measured(
      {.step_mm = 5.0, .targets = 200, .runs = 1, .both_ways = false}, kWhite_um, [](const Reading&) { return 7.0; })));
  CHECK_FALSE(noise.pure.from_repeats);
  CHECK(noise.pure.noise_um == Approx(kWhite_um).epsilon(0.15));
}

TEST_CASE("what a place shows there and back, alike or with its sign turned, is no noise where nothing was repeated") {
  const auto rough = [](const Reading& r) { return 15.0 * std::sin(7.7 * p(r)); };  // no neighbour says it
  const Plan once{.step_mm = 50.0, .targets = 20, .runs = 1};
  const auto noise_um = [&](const Truth& truth) {
    return noise_in(readings_of(measured(once, kWhite_um, truth))).pure;
  };
  const PureError both = noise_um([&](const Reading& r) { return rough(r) + 3.0 * d(r) + 0.004 * p(r) * d(r); });
  CHECK(both.noise_um == Approx(kWhite_um).epsilon(0.35));  // 18 degrees of freedom: 17 %, two sigmas
  CHECK(both.dof == 18.0);
  CHECK_FALSE(both.from_repeats);
  CHECK(noise_um([&](const Reading& r) { return rough(r) * d(r); }).noise_um == Approx(kWhite_um).epsilon(0.35));
  CHECK(noise_um([&](const Reading& r) { return rough(r) * (2.0 + d(r)); }).noise_um > 5.0);
}

TEST_CASE("where targets were repeated only with other feeds or loads, these readings show the noise and are named") {
  Measured m = white();
  const auto noise = [&] {
    for (Index k = 0; k < m.residual.size(); ++k)  // no neighbour says it
      m.residual(k) = m.data.reading[static_cast<std::size_t>(k)] +
                      15.0 * std::sin(7.7 * m.data.p_mm(static_cast<std::size_t>(k), Axis::X));
    return noise_in(m).pure;
  };
  CHECK(noise().differ_in.empty());
  for (std::size_t k = 0; k < m.data.size(); ++k) m.data.feed_mm_min.push_back(1000.0 * m.data.run[k]);
  CHECK(noise().differ_in == "feeds");
  CHECK_FALSE(noise().from_repeats);
  CHECK(noise().noise_um == Approx(kWhite_um).epsilon(0.12));
  for (std::size_t k = 0; k < m.data.size(); ++k) m.data.load_kg.push_back(100.0 * m.data.run[k]);
  CHECK(noise().differ_in == "feeds or loads");
}

TEST_CASE("noise that lasts over several readings is recognised as correlated") {
  std::mt19937_64 random(4);
  NormalDraws normal;
  double state = normal(random), last_s = 0.0;
  const auto turbulence = [&](const Reading& r) {  // correlation time 30 s, readings every 10 s
    const double memory = std::exp(-(*r.time_s - last_s) / 30.0);
    last_s = *r.time_s;
    state = memory * state + std::sqrt(1.0 - memory * memory) * normal(random);
    return state;
  };
  const NoiseModel noise = noise_in(readings_of(measured({.runs = 5}, 0.2, turbulence)));
  CHECK(share_of_white(noise) < 0.01);
  CHECK(only(noise.groups).correlated > 2.0 * noise.groups.front().white);
  CHECK(noise.groups.front().sigma() == Approx(std::hypot(1.0, 0.2)).epsilon(0.3));
}

namespace {

/// One pass of readings that follow each other in `interval_s`: a first order process over a tenth of a second.
Measured scan(int readings, double interval_s, double sigma_um, unsigned seed) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  const double memory = std::exp(-interval_s / 0.1);
  double state = normal(random);
  Measured m = readings_of(
      measured({.step_mm = 0.25, .targets = readings, .runs = 1, .both_ways = false}, 0.0, [&](const Reading&) {
        state = memory * state + std::sqrt(1.0 - memory * memory) * normal(random);
        return sigma_um * state;
      }));
  for (std::size_t k = 0; k < m.data.size(); ++k) m.data.time_s[k] = interval_s * static_cast<double>(k);
  return m;
}

}  // namespace

TEST_CASE("noise that is read at 100 Hz and lasts for a tenth of a second is found in size and time") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const NoiseModel noise = noise_in(scan(4000, 0.01, 0.6, seed));
    // 400 correlation times: the variance is known to 10 % (sqrt(2·2/800)), the size to 5 %; three sigmas
    CHECK(noise.groups.front().sigma() == Approx(0.6).epsilon(0.15));
    CHECK(noise.groups.front().time > 0.05);
    CHECK(noise.groups.front().time < 0.2);
    CHECK(share_of_white(noise) < 0.01);
  }
}

TEST_CASE("of a very long scan a part is judged, and its noise comes out as that of the whole") {
  const NoiseModel noise = noise_in(scan(40'000, 0.01, 0.6, 4));
  CHECK(noise.groups.front().sigma() == Approx(0.6).epsilon(0.1));  // 20,000 readings, 2,000 times: 2 %
}

TEST_CASE("where readings are repeated nobody asks for smooth columns") {
  const Measured m = white();
  int asked = 0;
  const MatrixXd ones = MatrixXd::Ones(m.residual.size(), 1);
  const SmoothColumns smooth = [&]() -> const MatrixXd& {
    ++asked;
    return ones;
  };
  CHECK(noise_of(m.data, m.residual, smooth, m.left_out).pure.from_repeats);
  CHECK(asked == 0);
}

TEST_CASE("a step of the readings stays one where they move by less than its rounding") {
  Measured m = white();
  std::mt19937_64 random(5);
  std::vector<double> floors;
  for (const double moved_um : {0.0, 1e-9}) {
    Measured stepped = m;
    for (double& reading : stepped.data.reading)
      reading = 0.5 * std::round(reading / 0.5) + (random() % 2 == 0 ? moved_um : -moved_um);
    stepped.residual.setZero();
    floors.push_back(noise_in(stepped).pure.noise_um);
  }
  CHECK(floors[0] == Approx(0.25 * 0.5));
  CHECK(floors[1] == Approx(floors[0]).epsilon(1e-6));
}

TEST_CASE("the step of ten readings is seen where no two of them are one step apart, whatever the repeats scatter") {
  const double step_um = 0.822146074;
  const int multiples[] = {99, 92, 71, 49, 29};
  Measured m = readings_of(measured({.step_mm = 100.0, .targets = 5, .runs = 2}, 0.0, nothing));
  for (std::size_t k = 0; k < m.data.size(); ++k) {
    const auto target = static_cast<std::size_t>(std::lround(m.data.p_mm(k, Axis::X) / 100.0));
    m.data.reading[k] = std::round(1e6 * step_um * multiples[target]) * 1e-6;  // six digits in a file
  }
  m.residual.setZero();
  const NoiseModel noise = noise_in(m);
  CHECK(noise.pure.noise_um == Approx(0.25 * step_um));
  CHECK(noise.pure.is_of_step);
  CHECK_FALSE(noise_in(white()).pure.is_of_step);
}

TEST_CASE(
    "where every pass has a single reading, the noise is the scatter of the repeats, not the size of the residual") {
  Measured m = readings_of(measured({.targets = 1, .runs = 60}, kWhite_um, nothing));
  for (std::size_t k = 0; k < m.data.size(); ++k) m.residual(static_cast<Index>(k)) += 7.0 * m.data.approach[k];
  const NoiseModel noise = noise_in(m);
  CHECK(noise.pure.from_repeats);
  CHECK(noise.pure.noise_um == Approx(kWhite_um).epsilon(0.2));  // 118 degrees of freedom: 6.5 %, three sigmas
}

TEST_CASE("angles that were read once have the noise that their neighbours show, not that of repeated positions") {
  for (const double angular_um_per_m : {0.05, 5.0}) {
    laser::MeasurementSet set = measured({.runs = 5}, kWhite_um, nothing);
    measure(set, {.sense = Sense::EA, .runs = 1}, angular_um_per_m, nothing, 2);
    const Measured m = readings_of(set);
    const NoiseModel noise = noise_in(m);
    CHECK(noise.pure.from_repeats);
    CHECK(noise.pure.in_part);
    CHECK(noise.pure.by_unit.um == Approx(kWhite_um).epsilon(0.12));
    CHECK(noise.pure.by_unit.um_per_m == Approx(angular_um_per_m).epsilon(0.25));  // 81 degrees of freedom: 8 %
  }
  CHECK_FALSE(noise_in(white()).pure.in_part);
}

TEST_CASE("a few readings are no multiples of a step") {
  Measured m = readings_of(measured({.targets = 1, .runs = 2}, 0.0, nothing));
  for (double& reading : m.data.reading) reading = 43.46;
  m.residual.setZero();
  const NoiseModel noise = noise_in(m);
  CHECK_FALSE(noise.pure.is_of_step);
  CHECK(noise.pure.noise_um < 1e-6);
}

TEST_CASE("the weights of all shapes of noise add up to one") {
  double sum = 0.0;
  for (const NoiseShape& shape : noise_in(white()).shapes) sum += shape.weight;
  CHECK(sum == Approx(1.0));
}

TEST_CASE("one outlier in a thousand squares leaves their robust mean alone") {
  std::vector<double> squares(999, 1.0);
  squares.push_back(1e6);
  CHECK(robust_mean_square(squares) == Approx(1.0));
  CHECK(robust_mean_square({}) == 0.0);
}

TEST_CASE("readings at one place are repeats under one feed and in one set-up only, and share the place under all") {
  const Measured m = white();
  Observations feeds = m.data, set_ups = m.data;
  feeds.feed_mm_min.assign(m.data.size(), 1000.0);
  set_ups.extras["set_up"].assign(m.data.size(), 1.0);
  for (std::size_t k = 0; k < m.data.size(); ++k)
    if (m.data.run[k] == 3) {
      feeds.feed_mm_min[k] = 4000.0;
      set_ups.extras["set_up"][k] = kNotMeasured;
    }
  for (const Observations& data : {feeds, set_ups}) {
    CHECK(repeats_of(data).nodes == 164);
    CHECK(places_of(data).nodes == 82);
  }
}

TEST_CASE("positions a hundredth of a micrometre apart are one target, a micrometre apart two") {
  Measured m = white();
  m.data.position_mm[5][0] += 1e-5;
  CHECK(places_of(m.data).nodes == 82);
  m.data.position_mm[5][0] += 1e-3;
  CHECK(places_of(m.data).nodes == 83);
}

TEST_CASE("a pass is one run in one direction") {
  const Measured m = white();
  const std::vector<std::size_t> pass = passes_of(m.data);
  CHECK(std::set<std::size_t>(pass.begin(), pass.end()).size() == 6);
  for (std::size_t k = 1; k < pass.size(); ++k)
    CHECK((pass[k] == pass[k - 1]) ==
          (m.data.run[k] == m.data.run[k - 1] && m.data.approach[k] == m.data.approach[k - 1]));
}

TEST_CASE(
    "replicates have the size of the noise, spread by how well it is known, and nothing where rows are left out") {
  Measured m = white();
  m.left_out[10] = true;
  NoiseModel noise = plain_noise(m.data, kWhite_um);
  noise.pure.dof = 164.0;
  const MatrixXd sets = SimulatedNoise(m.data, noise, m.left_out).next(2000);
  CHECK(sets.row(10).squaredNorm() == 0.0);
  const double freedom = 0.7 * 164.0;  // E(freedom/χ²) = freedom/(freedom − 2)
  const double mean_square = sets.squaredNorm() / (2000.0 * 245.0);
  CHECK(mean_square == Approx(kWhite_um * kWhite_um * freedom / (freedom - 2.0)).epsilon(0.02));
  CHECK((sets - SimulatedNoise(m.data, noise, m.left_out).next(2000)).norm() == 0.0);
}

TEST_CASE("whitened noise has size one and no memory") {
  const Measured m = white();
  NoiseModel noise = plain_noise(m.data, kWhite_um);
  noise.groups.front().correlated = 0.8;
  noise.groups.front().time = 30.0;
  noise.shapes = {{0.8, 30.0, 1.0, {0.8}}};  // 0.16 white and 0.64 correlated make 0.8 um²
  noise.pure.dof = 1e9;
  const MatrixXd sets = SimulatedNoise(m.data, noise, m.left_out).next(500);
  const MatrixXd independent = Whitener(m.data, noise, m.left_out)(sets);
  CHECK(independent.squaredNorm() / static_cast<double>(independent.size()) == Approx(1.0).epsilon(0.02));
  const Index n = independent.rows();
  const double lag = (independent.topRows(n - 1).array() * independent.bottomRows(n - 1).array()).mean();
  CHECK(std::abs(lag) < 0.02);
  const double raw = (sets.topRows(n - 1).array() * sets.bottomRows(n - 1).array()).mean();
  CHECK(raw > 0.3);
}

TEST_CASE("where the clock restarts with each run, the noise of the runs is independent") {
  laser::MeasurementSet anew = measured({.runs = 3}, kWhite_um, nothing);
  std::map<int, double> first_s;
  for (const Reading& r : anew.readings) first_s.try_emplace(r.run, *r.time_s);
  for (Reading& r : anew.readings) *r.time_s -= first_s[r.run];
  laser::MeasurementSet one = anew;
  std::erase_if(one.readings, [](const Reading& r) { return r.run > 1; });
  const auto ln_determinant = [](const laser::MeasurementSet& set) {
    const Measured m = readings_of(set);
    NoiseModel noise = plain_noise(m.data, kWhite_um);
    noise.groups.front().correlated = 0.8;
    noise.groups.front().time = 600.0;
    return Whitener(m.data, noise, m.left_out).ln_determinant();
  };
  CHECK(ln_determinant(anew) == Approx(3.0 * ln_determinant(one)).epsilon(1e-12));
  const Measured m = readings_of(anew);
  CHECK(std::ranges::is_sorted(m.data.run));
  const Measured common = readings_of(measured({.runs = 3}, kWhite_um, nothing));
  CHECK(std::ranges::is_sorted(common.data.time_s));
}

namespace {

/// One pass of 200 readings that sums up steps of 0.3 um, on its own or returning to 0 within `memory` readings.
Measured walk(unsigned seed, double memory = 1e9) {
  std::mt19937_64 random(seed + 300);
  NormalDraws normal;
  double state = 0.0;
  return readings_of(
      measured({.step_mm = 5.0, .targets = 200, .runs = 1, .both_ways = false}, 0.0,
               [&](const Reading&) { return state = std::exp(-1.0 / memory) * state + 0.3 * normal(random); }));
}

/// Takes everything for noise of the size that it has.
NoiseModel all_as_noise(const Measured& m, double correlated_share, double time_s) {
  const double sigma = std::sqrt(m.residual.squaredNorm() / static_cast<double>(m.residual.size()));
  NoiseModel noise = plain_noise(m.data, sigma * std::sqrt(1.0 - correlated_share));
  noise.groups.front().correlated = sigma * std::sqrt(correlated_share);
  noise.groups.front().time = time_s;
  return noise;
}

}  // namespace

TEST_CASE("readings at one place under other angles of the rotary axes are no repeats") {
  auto set = measured({}, kWhite_um, nothing);
  const std::size_t places = repeats_of(observations_of(set, straight(), mill())).nodes;
  for (Reading& r : set.readings) r.angle_deg = {0.0, r.run == 2 ? 90.0 : 0.0, 0.0};
  CHECK(repeats_of(observations_of(set, straight(), mill())).nodes == 2 * places);
}

TEST_CASE("white noise does not wander, with repeats or without, nor do rounded readings") {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Measured m = white(seed);
    CHECK_FALSE(wanders(m.data, noise_in(m), m.residual, m.left_out));
    for (double& reading : m.data.reading) reading = std::round(reading);
    for (Index k = 0; k < m.residual.size(); ++k) m.residual(k) = std::round(m.residual(k));
    CHECK_FALSE(wanders(m.data, noise_in(m), m.residual, m.left_out));
  }
}

TEST_CASE("white noise at one target, many readings a run, keeps its size and does not wander") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    laser::MeasurementSet set;
    std::mt19937_64 random(seed);
    NormalDraws normal;
    for (int k = 0; k < 75; ++k) {
      laser::Reading reading;
      reading.position_mm[0] = 100.0;
      reading.run = 1 + k / 15;
      reading.row = k + 1;
      reading.error = kWhite_um * normal(random);
      set.readings.push_back(reading);
    }
    Measured m = readings_of(set);
    m.residual.array() -= m.residual.mean();
    const NoiseModel noise = noise_in(m);
    CHECK(noise.pure.noise_um == Approx(kWhite_um).epsilon(0.3));  // 75 readings know it to 8 %: over three sigmas
    CHECK_FALSE(wanders(m.data, noise, m.residual, m.left_out));
  }
}

TEST_CASE("a random walk that is taken for white noise, or for noise correlated over minutes, wanders") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Measured m = walk(seed);
    m.residual.array() -= m.residual.mean();
    const double rms = std::sqrt(m.residual.squaredNorm() / 200.0);
    if (rms < 0.9) continue;  // neighbours scatter 0.3/√3 by second differences: hardly more than three times that
    CHECK(wanders(m.data, all_as_noise(m, 0.0, 0.0), m.residual, m.left_out));
    CHECK(wanders(m.data, all_as_noise(m, 0.9, 300.0), m.residual, m.left_out));
  }
}

TEST_CASE("turbulence over less than a minute does not wander; without a clock nobody knows that it is turbulence") {
  Measured m = walk(2, 100.0);
  REQUIRE(wanders(m.data, all_as_noise(m, 0.9, 300.0), m.residual, m.left_out));
  CHECK_FALSE(wanders(m.data, all_as_noise(m, 0.9, 30.0), m.residual, m.left_out));
  m.data.time_s.clear();
  CHECK(wanders(m.data, all_as_noise(m, 0.9, 30.0), m.residual, m.left_out));
}

TEST_CASE("a shape of which the noise has taken nothing does not make the noise wander") {
  const Measured m = walk(2);
  CHECK_FALSE(wanders(m.data, plain_noise(m.data, 0.3), m.residual, m.left_out));
}

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
  Plan few{.targets = 11, .runs = 1, .both_ways = false};
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

TEST_CASE("a reading that every pass over its target repeats is no outlier, in one approach or in both") {
  Spoiled forward(4, {.runs = 2});
  for (const std::size_t k : {0U, 82U}) forward.raise(k, 40.0);  // first reading of either forward pass of 41 targets
  CHECK(forward.outliers().empty());
  forward.raise(82, -40.0);  // one run only
  CHECK(forward.outliers() == std::vector<std::size_t>{0});
  Spoiled place(5, {.runs = 1});
  for (const std::size_t k : {10U, 71U}) place.raise(k, 40.0);  // one target, there and back
  CHECK(place.outliers().empty());
  place.raise(71, -40.0);
  CHECK(place.outliers() == std::vector<std::size_t>{10});
}

TEST_CASE("odd readings with which every pass of a line begins are no outliers: a reversal may make them") {
  Spoiled both(6, {.runs = 1});
  both.raise(0, -40.0);  // first readings of the pass there and of that back, two of the latter
  both.raise(41, 40.0);
  both.raise(42, 25.0);
  CHECK(both.outliers().empty());
  both.raise(41, -40.0);  // of one pass only
  CHECK(both.outliers() == std::vector<std::size_t>{0, 42});
}

TEST_CASE("the transposed whitener is the transpose of the whitener, rows left out and all") {
  const auto set = measured({}, 0.3, nothing);
  const Observations data = observations_of(set, straight(), mill());
  NoiseModel noise = plain_noise(data, 0.3);
  for (NoiseGroup& group : noise.groups) {
    group.correlated = 0.4;
    group.time = 25.0;
  }
  std::vector<bool> left_out(data.size(), false);
  left_out[0] = left_out[17] = left_out[18] = left_out[data.size() - 1] = true;
  const Whitener whitener(data, noise, left_out);
  std::mt19937_64 random(3);
  NormalDraws normal;
  const auto n = static_cast<Eigen::Index>(data.size());
  const auto any = [&] { return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, 3, [&] { return normal(random); })); };
  const Eigen::MatrixXd x = any(), y = any();
  const Eigen::MatrixXd one = whitener(x).transpose() * y, other = x.transpose() * whitener.transposed(y);
  CHECK((one - other).norm() < 1e-10 * one.norm());
}
