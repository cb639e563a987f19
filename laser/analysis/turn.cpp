// Harmonic regression with forward selection (Bloomfield, Fourier Analysis of Time Series, 2000; Efroymson 1960). The
// F test of a wave has two degrees of freedom above, for which P(F > f) = (1 + 2f/n)^(−n/2); its level is divided by
// the orders tried (Bonferroni).
#include "laser/analysis/turn.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "base/linear/decompositions.hpp"

namespace ecs::laser {
namespace {

constexpr double kWholeTurn_deg = 360.0;
constexpr double kLevel = 0.01;            ///< of all orders together
constexpr std::size_t kLeastAngles = 8;    ///< a wave, offset and reversal, and as many to judge them by
constexpr std::size_t kAnglesAnOrder = 3;  ///< two would fit any readings
constexpr std::size_t kMostWaves = 12;     ///< named
constexpr double kSameAngle_deg = 1e-3;

struct TurnReadings {
  std::vector<double> angle_deg, approach, error;
  bool both_ways = false;
};

TurnReadings readings_in_turn(const MeasurementSet& set, const Group& group) {
  TurnReadings line;
  const bool known = has_known_approach(set, group);
  bool forward = false, reverse = false;
  for (const std::size_t i : group.readings) {
    const Reading& reading = set.readings[i];
    if (known && reading.approach == Approach::unknown) continue;
    line.angle_deg.push_back(target_of(reading));
    line.approach.push_back(reading.approach == Approach::reverse ? -0.5 : 0.5);
    line.error.push_back(reading.error);
    forward = forward || reading.approach == Approach::forward;
    reverse = reverse || reading.approach == Approach::reverse;
  }
  line.both_ways = forward && reverse;
  return line;
}

/// Different angles of a turn, ascending.
std::vector<double> angles_of(const TurnReadings& line) {
  std::vector<double> angles;
  for (const double deg : line.angle_deg) angles.push_back(deg - kWholeTurn_deg * std::floor(deg / kWholeTurn_deg));
  std::ranges::sort(angles);
  angles.erase(
      std::unique(angles.begin(), angles.end(), [](double a, double b) { return std::abs(a - b) < kSameAngle_deg; }),
      angles.end());
  return angles;
}

/// The fewest waves a turn of which one fits into what was measured.
int least_order(const TurnReadings& line, std::size_t angles) {
  const auto [least, most] = std::ranges::minmax_element(line.angle_deg);
  const double span_deg = *most - *least;
  const double step_deg = span_deg / static_cast<double>(std::max<std::size_t>(1, angles - 1));
  return std::max(1, static_cast<int>(std::ceil(kWholeTurn_deg / (span_deg + step_deg) - 0.01)));
}

struct TurnFit {
  Eigen::MatrixXd columns;
  LeastSquares solved;
};

TurnFit waves_fitted(const TurnReadings& line, const std::vector<int>& orders) {
  const auto rows = static_cast<Eigen::Index>(line.error.size());
  const Eigen::Index first = line.both_ways ? 2 : 1;
  TurnFit fit;
  fit.columns = Eigen::MatrixXd::Ones(rows, first + 2 * static_cast<Eigen::Index>(orders.size()));
  for (Eigen::Index k = 0; k < rows; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (line.both_ways) fit.columns(k, 1) = line.approach[i];
    for (std::size_t j = 0; j < orders.size(); ++j) {
      const double angle = line.angle_deg[i] * orders[j] * std::numbers::pi / 180.0;
      fit.columns(k, first + 2 * static_cast<Eigen::Index>(j)) = std::cos(angle);
      fit.columns(k, first + 2 * static_cast<Eigen::Index>(j) + 1) = std::sin(angle);
    }
  }
  const Eigen::Map<const Eigen::VectorXd> errors(line.error.data(), rows);
  fit.solved = least_squares(fit.columns, errors);
  return fit;
}

/// That noise alone lowers the squares so far. @param freedom  degrees of freedom that are left
double chance_of(double squares_before, double squares_after, double freedom) {
  if (!(freedom > 0.0)) return 1.0;
  if (!(squares_after > 0.0)) return 0.0;
  const double f = (squares_before - squares_after) / 2.0 / (squares_after / freedom);
  return std::pow(1.0 + 2.0 * std::max(0.0, f) / freedom, -freedom / 2.0);
}

double freedom_of(const TurnFit& fit) { return static_cast<double>(fit.columns.rows() - fit.columns.cols()); }

/// Adds the order that lowers the squares most as long as it stands out of the noise.
std::vector<int> orders_found(const TurnReadings& line, int least, int most) {
  std::vector<int> chosen;
  TurnFit now = waves_fitted(line, chosen);
  while (chosen.size() < kMostWaves) {
    int best = 0;
    TurnFit after = now;
    for (int order = least; order <= most; ++order) {
      if (std::ranges::find(chosen, order) != chosen.end()) continue;
      std::vector<int> with = chosen;
      with.push_back(order);
      if (TurnFit tried = waves_fitted(line, with); tried.solved.squares_left < after.solved.squares_left) {
        after = std::move(tried);
        best = order;
      }
    }
    if (best == 0 ||
        chance_of(now.solved.squares_left, after.solved.squares_left, freedom_of(after)) > kLevel / (most - least + 1))
      break;
    chosen.push_back(best);
    now = std::move(after);
  }
  return chosen;
}

TurnWave wave_of(const TurnReadings& line, const std::vector<int>& orders, std::size_t j, const TurnFit& fit,
                 const Eigen::MatrixXd& covariance) {
  const Eigen::Index at = (line.both_ways ? 2 : 1) + 2 * static_cast<Eigen::Index>(j);
  const double c = fit.solved.sizes(at), s = fit.solved.sizes(at + 1);
  TurnWave wave;
  wave.order = orders[j];
  wave.amplitude = std::hypot(c, s);
  const double phase_deg = std::atan2(s, c) * 180.0 / std::numbers::pi;
  wave.phase_deg = phase_deg < 0.0 ? phase_deg + kWholeTurn_deg : phase_deg;
  if (wave.amplitude > 0.0) {
    const Eigen::Vector2d along(c / wave.amplitude, s / wave.amplitude);
    const Eigen::Matrix2d of_wave = covariance.block<2, 2>(at, at);
    wave.amplitude_sigma = std::sqrt(std::max(0.0, along.dot(of_wave * along)));
  }
  std::vector<int> without = orders;
  without.erase(without.begin() + static_cast<std::ptrdiff_t>(j));
  wave.p_value = chance_of(waves_fitted(line, without).solved.squares_left, fit.solved.squares_left, freedom_of(fit));
  return wave;
}

}  // namespace

std::optional<TurnModel> turn_of(const MeasurementSet& set, const Group& group) {
  if (!group.rotary) return std::nullopt;
  const TurnReadings line = readings_in_turn(set, group);
  const auto angles = angles_of(line);
  if (angles.size() < kLeastAngles) return std::nullopt;
  TurnModel turn;
  turn.least_waves = least_order(line, angles.size());
  turn.most_waves = static_cast<int>(angles.size() / kAnglesAnOrder);
  const auto orders = orders_found(line, turn.least_waves, turn.most_waves);
  const TurnFit fit = waves_fitted(line, orders);
  const double readings = static_cast<double>(line.error.size());
  const double noise_squared = freedom_of(fit) > 0.0 ? fit.solved.squares_left / freedom_of(fit) : 0.0;
  const Eigen::MatrixXd covariance = noise_squared * inverse_gram(fit.columns);
  turn.offset = fit.solved.sizes(0);
  if (line.both_ways) turn.reversal = fit.solved.sizes(1);
  for (std::size_t j = 0; j < orders.size(); ++j) turn.waves.push_back(wave_of(line, orders, j, fit, covariance));
  std::ranges::sort(turn.waves, [](const TurnWave& a, const TurnWave& b) { return a.amplitude > b.amplitude; });
  const double mean = *mean_of(line.error);
  double squares = 0.0;
  for (const double error : line.error) squares += (error - mean) * (error - mean);
  turn.rms = std::sqrt(squares / readings);
  turn.rms_left = std::sqrt(fit.solved.squares_left / readings);
  turn.explained = squares > 0.0 ? 1.0 - fit.solved.squares_left / squares : 0.0;
  return turn;
}

}  // namespace ecs::laser
