// Gaussian likelihood by the innovations of a Kalman filter (Schweppe 1965) under first order Gauss-Markov processes
// (Uhlenbeck and Ornstein 1930) of long memory, or a level of its own for every pass (random effects: Laird and Ware
// 1982); compared with an effect by Schwarz's criterion (1978).
#include "model/diagnosis/wander.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "model/effects/definition.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Memories tried, as shares of the session: steps of three cost little likelihood between them.
constexpr std::array kMemories{3.0, 1.0, 0.3, 0.1, 0.03, 0.01};
/// Shares of the wander in the variance tried: closer to 1, where most is wander.
constexpr std::array kShares{0.3, 0.7, 0.9, 0.97, 0.99, 0.997};
/// Standard deviations of the level of a run tried, in those of a reading.
constexpr std::array kLevels{0.3, 1.0, 3.0, 10.0};
/// A level that is kept over a pass: longer than any.
constexpr double kForever = 1e9;
/// Memory and share of a wander.
constexpr double kParameters = 2.0;

/// The groups of a noise with so much of their variance in a process of this memory.
NoiseModel wandering(NoiseModel noise, double share, double memory) {
  for (NoiseGroup& group : noise.groups) {
    const double sigma = group.sigma();
    group.white = sigma * std::sqrt(1.0 - share);
    group.correlated = sigma * std::sqrt(share);
    group.time = memory;
  }
  return noise;
}

}  // namespace

namespace {

/// Levels of their own for every run and sense (readings × levels).
Eigen::MatrixXd levels_of_runs(const Observations& data) {
  std::map<std::pair<int, Sense>, Eigen::Index> level;
  for (std::size_t k = 0; k < data.size(); ++k)
    level.try_emplace({data.run[k], data.sense[k]}, static_cast<Eigen::Index>(level.size()));
  Eigen::MatrixXd levels =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), static_cast<Eigen::Index>(level.size()));
  for (std::size_t k = 0; k < data.size(); ++k)
    levels(static_cast<Eigen::Index>(k), level.at({data.run[k], data.sense[k]})) = 1.0;
  return levels;
}

/// @param levels  drawn from a normal distribution (readings × levels), scaled to its standard deviation
double deviance_with(const Whitener& whitener, double count, const Eigen::MatrixXd& columns,
                     const Eigen::MatrixXd& levels, const Eigen::VectorXd& target) {
  const Eigen::Index n = target.size(), fixed = columns.cols(), drawn = levels.cols();
  Eigen::MatrixXd white = Eigen::MatrixXd::Zero(n + drawn, fixed + drawn);
  white.topLeftCorner(n, fixed) = whitener(columns);
  white.topRightCorner(n, drawn) = whitener(levels);
  white.bottomRightCorner(drawn, drawn).setIdentity();
  Eigen::VectorXd y = Eigen::VectorXd::Zero(n + drawn);
  y.head(n) = whitener(target);
  const double chi2 = (y - white * least_squares(white, y)).squaredNorm();
  double ln_determinant = whitener.ln_determinant();
  if (drawn > 0) {
    const auto part = white.rightCols(drawn);
    const Eigen::MatrixXd factor = Eigen::MatrixXd(part.transpose() * part).llt().matrixL();
    ln_determinant += 2.0 * factor.diagonal().array().log().sum();
  }
  return count * std::log(std::max(chi2, kLeastDivisor) / count) + ln_determinant;
}

double counted(const std::vector<bool>& left_out) {
  return static_cast<double>(std::count(left_out.begin(), left_out.end(), false));
}

}  // namespace

double deviance_of(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                   const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  return deviance_with(Whitener(data, noise, left_out), counted(left_out), columns, Eigen::MatrixXd(columns.rows(), 0),
                       target);
}

double deviance_of(const Observations& data, const Wander& law, const std::vector<bool>& left_out,
                   const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  const Eigen::MatrixXd levels =
      law.level_um > 0.0 ? Eigen::MatrixXd(law.level_um * levels_of_runs(data)) : Eigen::MatrixXd(columns.rows(), 0);
  return deviance_with(Whitener(data, law.noise, left_out), counted(left_out), columns, levels, target);
}

LikeliestWander likeliest_wander(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                 const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  double session = static_cast<double>(data.size());  // readings
  if (noise.has_time) {
    session = 0.0;
    for (const double t : data.time_s)
      if (!std::isnan(t)) session = std::max(session, t);
  }
  LikeliestWander best{{}, kBeyondAll};
  const auto look_at = [&](Wander law) {
    const double deviance = deviance_of(data, law, left_out, columns, target);
    if (deviance < best.deviance) best = {std::move(law), deviance};
  };
  for (const double share : kShares) {
    for (const double memory : kMemories) look_at({wandering(noise, share, memory * session)});
    NoiseModel by_pass = wandering(noise, share, kForever);
    by_pass.has_time = false;
    look_at({std::move(by_pass)});
  }
  for (const double level : kLevels) look_at({noise, level * noise.pure.noise_um});
  return best;
}

double deviance_of_wander(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                          const Eigen::MatrixXd& columns, const Eigen::VectorXd& target) {
  return likeliest_wander(data, noise, left_out, columns, target).deviance +
         kParameters * std::log(static_cast<double>(data.size()));
}

bool may_be_wander(const NoiseModel& noise, const EffectInstance& effect) {
  const EffectDefinition& definition = effect.definition();
  if (definition.has_need(Need::feed) || definition.has_need(Need::load) || definition.place == Place::map)
    return false;  // set by hand, and back and forth
  const bool of_time = effect.traits().is_drift || effect.traits().of_condition || definition.has_need(Need::time) ||
                       definition.has_need(Need::sensor) || definition.has_need(Need::two_sensors) ||
                       definition.has_need(Need::material_temperature) || definition.has_need(Need::air);
  return of_time || !noise.pure.from_repeats;
}

}  // namespace ecs::model
