// Radial deviations of faults of two axes: Kakino, Ihara and Shinohara, "Accuracy inspection of NC machine tools by
// double ball bar method" (1993); Knapp, "Circular test for three-coordinate measuring machines and machine tools"
// (1983).
#include "modules/standards/circle_faults.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Decay lengths of spikes that are tried first, as shares of the radius: 1.4 to 14 degrees after the reversal.
constexpr std::array<double, 5> kDecays_of_radius{0.0003, 0.001, 0.003, 0.01, 0.03};
/// The decay itself may be down to the travel of 0.8 degrees, and up to that of 26; beyond, it is a backlash.
constexpr double kLeastDecay_of_radius = 0.0001, kGreatestDecay_of_radius = 0.1;
/// A wave needs this many readings a period where the axis moves fastest.
constexpr double kReadingsAPeriod = 2.5;

double sign_of(double value) { return value < 0.0 ? -1.0 : 1.0; }

/// One axis of the plane: where it stands, how it moves, and what its error does to the radius.
struct AxisOnCircle {
  Eigen::VectorXd place;      ///< u/R
  Eigen::VectorXd across;     ///< of the other axis, v/R: what an error of this one across its motion does
  Eigen::VectorXd motion;     ///< sign of the velocity
  Eigen::VectorXd travelled;  ///< since the reversal, of R
};

AxisOnCircle axis_on_circle(const CirclePoints& points, std::size_t which) {
  const Eigen::Index n = points.angle.size();
  AxisOnCircle axis{Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const double c = std::cos(points.angle[i]), s = std::sin(points.angle[i]);
    axis.place[i] = which == 0 ? c : s;
    axis.across[i] = which == 0 ? s : c;
    axis.motion[i] = sign_of((which == 0 ? -s : c) * points.sense[i]);
    axis.travelled[i] = 1.0 + axis.motion[i] * axis.place[i];
  }
  return axis;
}

/// The longest step between readings of a pass [rad].
double widest_step(const CirclePoints& points) {
  double widest = 0.0;
  for (Eigen::Index i = 1; i < points.angle.size(); ++i)
    if (points.sense[i] == points.sense[i - 1] && points.angle[i] > points.angle[i - 1])
      widest = std::max(widest, points.angle[i] - points.angle[i - 1]);
  return widest;
}

void add_of_axis(std::vector<CircleFault>& faults, const CirclePoints& points, std::size_t which,
                 const std::vector<double>& pitches_mm) {
  const AxisOnCircle axis = axis_on_circle(points, which);
  const std::string letter(1, letter_of(points.plane[which]));
  const Eigen::ArrayXd u = axis.place, v = axis.across, d = axis.motion;
  faults.push_back({"backlash", letter, "backlash of " + letter, 0.0, (u * d / 2.0).matrix(), 1.0, "um"});
  const double step = widest_step(points), least_mm = decay_limits(points).least_mm;
  for (const double decay : kDecays_of_radius)
    if (const double decay_mm = decay * points.radius_mm; decay_mm >= least_mm)
      faults.push_back({kReversalSpike, letter, "reversal spikes of " + letter, decay_mm,
                        spike_columns(points, which, decay_mm).leftCols(1), 1.0, "um"});
  for (const double pitch_mm : pitches_mm) {
    if (!(pitch_mm > 0.0) || pitch_mm > points.radius_mm || kReadingsAPeriod * step * points.radius_mm > pitch_mm)
      continue;
    const Eigen::ArrayXd phase = u * (kTurn * points.radius_mm / pitch_mm);
    Eigen::MatrixXd waves(u.size(), 2);
    waves << (u * phase.sin()).matrix(), (u * phase.cos()).matrix();
    faults.push_back({"cyclic", letter,
                      fmt::format("periodic error of {} at the pitch of its screw, {:g} mm", letter, pitch_mm),
                      pitch_mm, std::move(waves), 1.0, "um"});
  }
  faults.push_back({"straightness", letter, "straightness of " + letter + " (bow)", 0.0,
                    (v * (2.0 * u * u - 1.0)).matrix(), 1.0, "um"});
  faults.push_back({"straightness_s", letter, "straightness of " + letter + " (S)", 0.0,
                    (v * (4.0 * u * u * u - 3.0 * u)).matrix(), 1.0, "um"});
}

/// The squareness of two axes as ISO 230-1 names it, and its sign in E_X = −C0Y·Y + B0Z·Z, E_Y = −A0Z·Z. Either order:
/// the product of both coordinates makes the deviation.
struct SquarenessName {
  const char* component;
  double sign;
};

SquarenessName squareness_of(const std::array<Axis, 2>& plane) {
  const auto has = [&](Axis axis) { return plane[0] == axis || plane[1] == axis; };
  if (!has(Axis::Z)) return {"C0Y", -1.0};
  return has(Axis::X) ? SquarenessName{"B0Z", 1.0} : SquarenessName{"A0Z", -1.0};
}

}  // namespace

DecayLimits decay_limits(const CirclePoints& points) {
  const double step = widest_step(points);
  return {std::max(kLeastDecay_of_radius, step * step / 2.0) * points.radius_mm,
          kGreatestDecay_of_radius * points.radius_mm};
}

Eigen::MatrixXd spike_columns(const CirclePoints& points, std::size_t which, double decay_mm) {
  const AxisOnCircle axis = axis_on_circle(points, which);
  const Eigen::ArrayXd travelled = axis.travelled.array() * (points.radius_mm / decay_mm);
  Eigen::MatrixXd columns(points.angle.size(), 2);
  columns.col(0) = (axis.place.array() * axis.motion.array() * (-travelled).exp()).matrix();
  columns.col(1) = (columns.col(0).array() * travelled).matrix();
  return columns;
}

Eigen::MatrixXd centring_columns(const CirclePoints& points) {
  Eigen::MatrixXd columns(points.angle.size(), 3);
  columns << Eigen::VectorXd::Ones(points.angle.size()), points.angle.array().cos().matrix(),
      points.angle.array().sin().matrix();
  return columns;
}

std::vector<CircleFault> circle_faults(const CirclePoints& points,
                                       const std::array<std::vector<double>, 2>& pitches_mm) {
  const std::string both = laser::plane_name(points.plane);
  const Eigen::ArrayXd c = points.angle.array().cos(), s = points.angle.array().sin();
  const double radius_m = points.radius_mm / kMmPerM;
  std::vector<CircleFault> faults;
  faults.push_back({"scale_mismatch", both, fmt::format("scale mismatch of {} and {}", both[0], both[1]), 0.0,
                    (c * c - s * s).matrix(), 2.0 / radius_m, "um/m"});
  const SquarenessName square = squareness_of(points.plane);
  faults.push_back({"squareness", both, fmt::format("{} and {} out of square ({})", both[0], both[1], square.component),
                    0.0, (square.sign * s * c).matrix(), 1.0 / radius_m, "um/m", square.component});
  faults.push_back({"servo_mismatch", both, fmt::format("servo mismatch of {} and {}", both[0], both[1]), 0.0,
                    (points.sense.array() * s * c).matrix(), 1.0, "um"});
  for (std::size_t which = 0; which < 2; ++which) add_of_axis(faults, points, which, pitches_mm[which]);
  return faults;
}

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kMostDecaySteps = 30;
constexpr int kMostDecayHalvings = 10;
/// The longest step of the logarithm of a decay, and the one below which it has arrived.
constexpr double kLongestDecayStep = 0.5;
constexpr double kShortestDecayStep = 1e-5;

/// Everything but decays is solved for at every place: sizes of the spikes, and of their derivatives where asked.
struct DecayFit {
  double squares = 0.0;
  VectorXd sizes, slopes;  ///< of each spike; slopes: empty without derivatives
};

DecayFit fit_at(const VectorXd& deviation, const MatrixXd& others, const SpikeColumns& columns,
                const std::vector<double>& decays_mm, bool derivatives) {
  const auto spikes = static_cast<Index>(decays_mm.size());
  MatrixXd all(deviation.size(), (derivatives ? 2 : 1) * spikes + others.cols());
  for (Index i = 0; i < spikes; ++i) {
    const MatrixXd own = columns(static_cast<std::size_t>(i), decays_mm[static_cast<std::size_t>(i)]);
    all.col(i) = own.col(0);
    if (derivatives) all.col(spikes + i) = own.col(1);
  }
  all.rightCols(others.cols()) = others;
  const VectorXd solved = PivotedQr(all).solve(deviation);
  return {(deviation - all * solved).squaredNorm(), solved.head(spikes),
          derivatives ? VectorXd(solved.segment(spikes, spikes)) : VectorXd()};
}

}  // namespace

std::vector<double> best_decays(const VectorXd& deviation, const MatrixXd& others, const SpikeColumns& columns,
                                std::vector<double> start_mm, const DecayLimits& limits) {
  std::vector<double> decays_mm = std::move(start_mm);
  double least = fit_at(deviation, others, columns, decays_mm, false).squares;
  for (int round = 0; round < kMostDecaySteps; ++round) {
    const DecayFit linear = fit_at(deviation, others, columns, decays_mm, true);
    double longest = 0.0;
    bool better = false;
    for (double share = 1.0; !better && share > std::pow(0.5, kMostDecayHalvings); share /= 2.0) {
      std::vector<double> tried = decays_mm;
      longest = 0.0;
      for (std::size_t i = 0; i < tried.size(); ++i) {
        const double size = linear.sizes[static_cast<Index>(i)], slope = linear.slopes[static_cast<Index>(i)];
        if (std::abs(size) < kLeastDivisor) continue;
        const double step = share * std::clamp(slope / size, -kLongestDecayStep, kLongestDecayStep);
        tried[i] = std::clamp(decays_mm[i] * std::exp(step), limits.least_mm, limits.greatest_mm);
        longest = std::max(longest, std::abs(std::log(tried[i] / decays_mm[i])));
      }
      const double squares = fit_at(deviation, others, columns, tried, false).squares;
      better = squares < least;
      if (!better) continue;
      least = squares;
      decays_mm = tried;
    }
    if (!better || longest < kShortestDecayStep) break;
  }
  return decays_mm;
}

}  // namespace ecs::model
