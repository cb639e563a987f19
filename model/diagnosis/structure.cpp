// Lack of fit by adding functions: the F test of columns added to a regression (Fisher 1922; Draper and Smith
// 1998, 6.1), one test a variable, its largest judged by the largest of replicates of noise (Westfall and Young
// 1993, 2.3). Wander: Gaussian likelihood by the innovations of a Kalman filter (Schweppe 1965) under first order
// Gauss-Markov processes (Uhlenbeck and Ornstein 1930) of long memory, or a level of its own for every pass (random
// effects: Laird and Ware 1982); compared with an effect by Schwarz's criterion (1978). Restricted likelihood:
// Patterson and Thompson (1971).
#include "model/diagnosis/structure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "base/linear/decompositions.hpp"
#include "base/random.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/statistics.hpp"

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

Structure::Beyond Structure::beyond(const Space& space, std::size_t variable) const {
  Space added = added_by(space, white_[variable]);
  return {std::move(added.q), added.chi2()};
}

const std::vector<Structure::Beyond>& Structure::all_beyond(const Space& space) const {
  if (beyond_.size() == variables_.size() && same_matrix(latest_.y, space.y) && same_matrix(latest_.q, space.q))
    return beyond_;
  latest_ = space;
  beyond_.clear();
  for (std::size_t v = 0; v < variables_.size(); ++v) beyond_.push_back(beyond(space, v));
  return beyond_;
}

StructureTest Structure::test_of(const Space& space, std::size_t variable, const Beyond& beyond) const {
  StructureTest test;
  test.variable = variables_[variable].name;
  test.gain = space.chi2() - beyond.chi2;
  test.freedom = static_cast<double>(beyond.q.cols());
  test.excess = (test.gain - test.freedom) / static_cast<double>(space.y.size());
  test.minus_log_p = minus_log_p(test.gain, test.freedom, noise_freedom_);
  return test;
}

StructureTest Structure::test_of(const Space& space, std::size_t variable) const {
  return test_of(space, variable, beyond(space, variable));
}

std::vector<StructureTest> tests_beyond_position(const Observations& data, const Whitener& whitener,
                                                 const Structure& structure, const Space& space,
                                                 std::vector<StructureTest> tests) {
  constexpr double kShown = 3.0;  // digits of the chance: a thousandth, as what is ranked in an answer
  BesidePosition beside(data, space, [&](const MatrixXd& columns) { return whitener(columns); });
  for (std::size_t v = 0; v < tests.size(); ++v)
    if (tests[v].minus_log_p >= kShown) tests[v] = structure.test_of(beside.of(tests[v].variable), v);
  return tests;
}

std::vector<StructureTest> Structure::tests(const Space& space) const {
  std::vector<StructureTest> tests;
  for (std::size_t v = 0; v < variables_.size(); ++v) tests.push_back(test_of(space, v, all_beyond(space)[v]));
  return tests;
}

double largest_of(const std::vector<StructureTest>& tests) {
  double largest = 0.0;
  for (const StructureTest& test : tests) largest = std::max(largest, test.minus_log_p);
  return largest;
}

std::vector<double> Structure::largest_of(const Space& space, const MatrixXf& noise_replicates) const {
  std::vector<double> largest(static_cast<std::size_t>(noise_replicates.cols()), 0.0);
  for (const Beyond& beyond : all_beyond(space)) {
    const Index fresh = beyond.q.cols();
    if (fresh == 0) continue;
    const MatrixXf products = beyond.q.cast<float>().transpose() * noise_replicates;
    for (Index b = 0; b < noise_replicates.cols(); ++b) {
      double& top = largest[static_cast<std::size_t>(b)];
      top = std::max(top, minus_log_p(static_cast<double>(products.col(b).squaredNorm()), static_cast<double>(fresh),
                                      noise_freedom_));
    }
  }
  return largest;
}

namespace {

/// Memories tried, as shares of the session: steps of three cost little likelihood between them.
constexpr std::array kMemories{3.0, 1.0, 0.3, 0.1, 0.03, 0.01};
/// Shares of the wander in the variance tried: closer to 1, where most is wander.
constexpr std::array kShares{0.3, 0.7, 0.9, 0.97, 0.99, 0.997};
/// Memories of turbulence tried, up to a minute [s]: steps of three, as of wanders.
constexpr std::array kTurbulences_s{60.0, 20.0, 6.0, 2.0};
/// Standard deviations of the level of a run tried, in those of a reading.
constexpr std::array kLevels{0.3, 1.0, 3.0, 10.0};
/// A level that is kept over a pass: longer than any.
constexpr double kForever = 1e9;
/// Something wanders where that is this many times likelier than the noise as it is.
constexpr double kEvident = 100.0;
/// Least size of a column beyond the others: no ln of 0.
constexpr double kLeastSize = 1e-150;

}  // namespace

NoiseModel wandering(NoiseModel noise, double share, double memory) {
  NoiseShape shape{share, memory, 1.0, {}};
  for (NoiseGroup& group : noise.groups) {
    const double sigma = group.sigma();
    group.white = sigma * std::sqrt(1.0 - share);
    group.correlated = sigma * std::sqrt(share);
    group.time = memory;
    shape.variance.push_back(sigma * sigma);
  }
  noise.shapes = {std::move(shape)};
  return noise;
}

namespace {

/// The same with a level of its own for every pass.
NoiseModel by_pass(const NoiseModel& noise, double share) {
  NoiseModel levels = wandering(noise, share, kForever);
  levels.has_time = false;
  return levels;
}

/// Time from the first reading to the last [s], any where all have the same; without times their number.
double session_of(const Observations& data, const NoiseModel& noise) {
  if (!noise.has_time) return static_cast<double>(data.size());
  double session = 0.0;
  for (const double t : data.time_s)
    if (!std::isnan(t)) session = std::max(session, t);
  return session > 0.0 ? session : 1.0;
}

double counted(const std::vector<bool>& left_out) { return static_cast<double>(std::ranges::count(left_out, false)); }

double ln_square(double size) { return 2.0 * std::log(std::max(size, kLeastSize)); }

}  // namespace

Eigen::MatrixXd levels_of_runs(const Observations& data) {
  std::map<std::pair<int, Channel>, Eigen::Index> level;
  for (std::size_t k = 0; k < data.size(); ++k)
    level.try_emplace({data.run[k], data.channel(k)}, static_cast<Eigen::Index>(level.size()));
  Eigen::MatrixXd levels =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), static_cast<Eigen::Index>(level.size()));
  for (std::size_t k = 0; k < data.size(); ++k)
    levels(static_cast<Eigen::Index>(k), level.at({data.run[k], data.channel(k)})) = 1.0;
  return levels;
}

Eigen::MatrixXd independent_columns(const Eigen::MatrixXd& columns, const std::vector<bool>& left_out) {
  Eigen::MatrixXd seen = columns;
  for (std::size_t k = 0; k < left_out.size(); ++k)
    if (left_out[k]) seen.row(static_cast<Eigen::Index>(k)).setZero();
  const PivotedQr qr(seen);
  Eigen::MatrixXd independent(columns.rows(), qr.rank());
  for (Eigen::Index i = 0; i < qr.rank(); ++i) independent.col(i) = columns.col(qr.place(i));
  return independent;
}

double deviance_of(const Observations& data, const Wander& law, const std::vector<bool>& left_out,
                   const Eigen::MatrixXd& columns, const Eigen::MatrixXd& effect, const Eigen::VectorXd& target) {
  const double freedom = counted(left_out) - static_cast<double>(columns.cols());
  if (freedom < 1.0) return 0.0;  // nothing is left that could tell of a law
  const Whitener whitener(data, law.noise, left_out);
  const Eigen::MatrixXd levels =
      law.level_um > 0.0 ? Eigen::MatrixXd(law.level_um * levels_of_runs(data)) : Eigen::MatrixXd(columns.rows(), 0);
  const Eigen::Index n = target.size(), drawn = levels.cols(), taken = drawn + columns.cols(),
                     all = taken + effect.cols();
  // readings, then a row for each level: how far it is from 0 in its standard deviations
  Eigen::MatrixXd white = Eigen::MatrixXd::Zero(n + all + 1, all + 1);
  white.topLeftCorner(n, drawn) = whitener(levels);
  white.block(n, 0, drawn, drawn).setIdentity();
  white.block(0, drawn, n, columns.cols()) = whitener(columns);
  white.block(0, taken, n, effect.cols()) = whitener(effect);
  white.col(all).head(n) = whitener(target);
  const Eigen::VectorXd own = beyond_those_before(white);
  double ln_determinants = whitener.ln_determinant();
  for (Eigen::Index j = 0; j < taken; ++j) ln_determinants += ln_square(own(j));
  return freedom * (std::log(std::numbers::pi) + ln_square(own(all))) - 2.0 * ln_gamma(0.5 * freedom) + ln_determinants;
}

namespace {

std::vector<Wander> wanders_tried(const Observations& data, const NoiseModel& noise) {
  const double session = session_of(data, noise);
  std::vector<Wander> laws;
  for (const double share : kShares) {
    for (const double memory : kMemories) laws.push_back({wandering(noise, share, memory * session)});
    laws.push_back({by_pass(noise, share)});
  }
  for (const double level : kLevels) laws.push_back({noise, level * noise.pure.noise_um});
  return laws;
}

}  // namespace

double least_deviance(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                      const Eigen::MatrixXd& columns, const Eigen::MatrixXd& effect, const Eigen::VectorXd& target,
                      bool or_wander) {
  std::vector<Wander> laws;
  if (or_wander) laws = wanders_tried(data, noise);
  laws.push_back({noise});
  laws.push_back({wandering(noise, 0.0, kForever)});
  if (noise.has_time)
    for (const double share : kShares)
      for (const double memory_s : kTurbulences_s) laws.push_back({wandering(noise, share, memory_s)});
  double least = kBeyondAll;
  for (const Wander& law : laws) least = std::min(least, deviance_of(data, law, left_out, columns, effect, target));
  return least;
}

std::vector<LikelyWander> likely_wanders(const Observations& data, const NoiseModel& noise,
                                         const std::vector<bool>& left_out, const Eigen::MatrixXd& columns,
                                         const Eigen::VectorXd& target) {
  const Eigen::MatrixXd independent = independent_columns(columns, left_out), none(columns.rows(), 0);
  std::vector<LikelyWander> tried;
  for (Wander& law : wanders_tried(data, noise)) {
    const double deviance = deviance_of(data, law, left_out, independent, none, target);
    tried.push_back({std::move(law), deviance});
  }
  sort_greatest_first(tried, [](const LikelyWander& likely) { return -likely.deviance; });
  return tried;
}

WanderingNoise wandering_noise(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                               const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, std::size_t count) {
  constexpr std::uint64_t kSeed = 11;  // any number: the same data always give the same replicates
  const std::vector<LikelyWander> likely = likely_wanders(data, noise, left_out, columns, target);
  const double steady = deviance_of(data, {noise}, left_out, independent_columns(columns, left_out),
                                    Eigen::MatrixXd(columns.rows(), 0), target);
  const double least = std::min(steady, likely.front().deviance);
  const auto weight = [&](double deviance) { return std::exp(-0.5 * (deviance - least)); };
  double sum = 0.0;
  for (const LikelyWander& one : likely) sum += weight(one.deviance);
  WanderingNoise wandering;
  wandering.probability = sum / (sum + static_cast<double>(likely.size()) * weight(steady));
  if (!(wandering.probability > 0.5)) return wandering;  // nor where no law can be compared
  const Eigen::MatrixXd levels = levels_of_runs(data);
  std::mt19937_64 random(kSeed);
  NormalDraws normal;
  wandering.replicates.resize(static_cast<Index>(data.size()), static_cast<Index>(count));
  Index had = 0;
  double share = 0.0;
  for (std::size_t i = 0; i < likely.size(); ++i) {
    share += weight(likely[i].deviance) / sum;
    const Index fresh = std::lround(share * static_cast<double>(count)) - had;
    if (fresh == 0) continue;
    const Wander& law = likely[i].law;
    NoiseModel of_law = law.noise;
    of_law.pure.dof = static_cast<double>(data.size());  // of one size: that of the readings is known
    Eigen::MatrixXd drawn = SimulatedNoise(data, of_law, left_out, kSeed + 1 + i).next(static_cast<std::size_t>(fresh));
    if (law.level_um > 0.0) {
      const MatrixXd sizes = MatrixXd::NullaryExpr(levels.cols(), fresh, [&] { return normal(random); });
      drawn += law.level_um * levels * sizes;
    }
    wandering.replicates.middleCols(had, fresh) = drawn;
    had += fresh;
  }
  return wandering;
}

bool is_wandering(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                  const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  constexpr double kShare = kShares.front();  // a greater wander is likelier than the noise at this share too
  const Eigen::MatrixXd independent = independent_columns(columns, left_out), none(columns.rows(), 0);
  const auto deviance = [&](const Wander& law) { return deviance_of(data, law, left_out, independent, none, target); };
  const double session = session_of(data, noise);
  const double most = deviance({noise, 0.0}) - 2.0 * std::log(kEvident);
  return deviance({by_pass(noise, kShare)}) < most || deviance({noise, noise.pure.noise_um}) < most ||
         std::ranges::any_of(
             kMemories, [&](double memory) { return deviance({wandering(noise, kShare, memory * session)}) < most; });
}

bool wanders_by_pass(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                     const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  constexpr double kOfPasses = 0.1;  // of the session, as a pass is of five runs both ways
  if (!is_wandering(data, noise, left_out, columns, target)) return false;
  const Wander likeliest = likely_wanders(data, noise, left_out, columns, target).front().law;
  const double memory = likeliest.noise.groups.front().time;
  return likeliest.level_um == 0.0 && (memory == kForever || memory <= kOfPasses * session_of(data, noise));
}

bool is_like_wander(const EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  return effect.traits().is_drift || effect.traits().of_condition || definition.has_need(Need::time) ||
         definition.has_need(Need::sensor) || definition.has_need(Need::two_sensors) ||
         definition.has_need(Need::material_temperature) || definition.has_need(Need::air);
}

bool may_be_wander(const NoiseModel& noise, const EffectInstance& effect) {
  return is_like_wander(effect) || effect.definition().is_set_by_hand() || !noise.pure.all_from_repeats();
}

}  // namespace ecs::model
