// Levenberg-Marquardt (Levenberg 1944; Marquardt 1963) on the logarithms of drive constants, Huber's loss (Huber 1964)
// by weights (Holland and Welsch 1977), derivatives by differences. Does not live here: the simulation.
#include "modules/traces/fit.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear/decompositions.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Residuals beyond this many scales count by their size, not their square: a choice, far enough out to cost normal
/// noise nothing (Huber's 1.345 costs 5 %).
constexpr double kHuber = 4.0;
/// Factors looked at: 1/100 to 100; a constant further off is another machine.
constexpr double kFarthest = 4.60517;  // ln 100
/// Change of ln for derivatives: half the digits of the simulation; wider where two sides are taken.
constexpr double kSmallStep = 1e-5, kWideStep = 1e-3;
/// Samples that the start of the move is looked for with, and starts tried, before halving down to kFinestStart_s.
constexpr std::size_t kCoarseSamples = 160;
constexpr int kCoarseStarts = 60;
constexpr double kFinestStart_s = 1e-5;
/// Damping: begins at, falls and rises by (Marquardt 1963); iterations and attempts that a descent ends after at most.
constexpr double kFirstDamping = 1e-3, kDampingFalls = 0.1, kDampingRises = 10.0;
constexpr int kMostIterations = 15, kMostAttempts = 6;
/// Added to the diagonal, a share of its largest: keeps constants without influence from dividing by 0.
constexpr double kRidge = 1e-12;
/// A descent ends where the loss falls by less than this share; earlier while the scale is still coarse.
constexpr double kSettled = 1e-5, kNearlySettled = 1e-3, kCoarseScale = 3.0;
/// Zero of the recorder: its prior in steps of its converter; farthest in priors; change for derivatives in priors.
constexpr double kZeroQuanta = 1.5, kFarthestZero = 3.0, kZeroStep = 1e-3;
/// Step of the simulation: a tenth of a millisecond, a third of the current regulator's time constant as printed (0.3
/// ms); coarser where that would be more than this many steps.
constexpr double kStep_s = 1e-4, kMostSteps = 40'000.0;
/// The move began within this many sample intervals, and this share of the rise (or of 0.1 s), of where it shows.
constexpr double kStartIntervals = 3.0, kStartOfRise = 0.1, kUsualRise_s = 0.1;
/// The scale is taken again while it falls by more than this, at most so often.
constexpr double kScaleFell = 0.7;
constexpr int kMostScales = 3;
/// Factors tried from: e^-4 to e^4 (about 1/55 to 55) in steps of e^0.4 = 1.5; valleys of the loss are wider.
constexpr int kTries = 10;  // to either side
constexpr double kTrySpacing = 0.4;
/// Samples beyond this many noises are glitches where at most one in a hundred is.
constexpr double kGlitch = 8.0;
constexpr std::size_t kSamplesAGlitch = 100;

double loss(double r, double scale) {
  const double size = std::abs(r), edge = kHuber * scale;
  return size <= edge ? r * r : edge * (2.0 * size - edge);
}

double loss(const Eigen::VectorXd& r, double scale = 1.0) {
  double sum = 0.0;
  for (const double x : r) sum += loss(x, scale);
  return sum;
}

/// √weights that make the squares behave like Huber's loss.
Eigen::VectorXd root_weights(const Eigen::VectorXd& r, double scale) {
  const double edge = kHuber * scale;
  return r.unaryExpr([edge](double x) { return std::abs(x) <= edge ? 1.0 : std::sqrt(edge / std::abs(x)); });
}

/// Standard deviation that half the residuals suggest, in units of the noise; at least 1.
double scale_of(const Eigen::VectorXd& r) {
  std::vector<double> sizes;
  for (const double x : r) sizes.push_back(std::abs(x));
  return std::max(1.0, kSigmaPerMad * upper_median(std::move(sizes)));
}

DriveParameters changed(DriveParameters drive, const std::vector<DriveConstant>& free, const Eigen::VectorXd& ln) {
  for (std::size_t i = 0; i < free.size(); ++i) drive[free[i]] *= std::exp(ln[static_cast<Eigen::Index>(i)]);
  return drive;
}

}  // namespace

/// Damped Gauss-Newton from one start; unknowns: ln of the free constants, start of the move, zeros.
struct DriveFitter::Descent {
  const DriveFitter& fitter;
  const DriveFit& start;
  const std::vector<DriveConstant>& free;
  Eigen::VectorXd at{}, residual{};
  DriveResponse now{};
  Eigen::MatrixXd normal{}, weighted{};
  double scale = 1.0;

  [[nodiscard]] Eigen::Index constants() const { return static_cast<Eigen::Index>(free.size()); }
  [[nodiscard]] Eigen::Index zeros() const { return start.zero.size(); }

  void begin() {
    at = Eigen::VectorXd::Zero(constants() + 1 + zeros());
    at[constants()] = start.start_s;
    at.tail(zeros()) = start.zero;
    now = fitter.response(start.drive);
    residual = fitter.residuals(now, at[constants()], at.tail(zeros()));
  }

  [[nodiscard]] Eigen::MatrixXd jacobian() const {
    Eigen::MatrixXd columns(residual.size(), at.size());
    for (Eigen::Index j = 0; j < constants(); ++j) {
      Eigen::VectorXd moved = at.head(constants());
      moved[j] += kSmallStep;
      const DriveResponse then = fitter.response(changed(start.drive, free, moved));
      columns.col(j) = (fitter.residuals(then, at[constants()], at.tail(zeros())) - residual) / kSmallStep;
    }
    const double shift = 0.5 * fitter.step_s_;
    columns.col(constants()) = (fitter.residuals(now, at[constants()] + shift, at.tail(zeros())) -
                                fitter.residuals(now, at[constants()] - shift, at.tail(zeros()))) /
                               (2.0 * shift);
    for (Eigen::Index j = 0; j < zeros(); ++j) {
      Eigen::VectorXd moved = at.tail(zeros());
      const double small = kZeroStep * fitter.prior_of_zero(static_cast<std::size_t>(j));
      moved[j] += small;
      columns.col(constants() + 1 + j) = (fitter.residuals(now, at[constants()], moved) - residual) / small;
    }
    return columns;
  }

  /// At most one e-fold a step, and within 1/100 … 100 of the value given.
  [[nodiscard]] Eigen::VectorXd bounded(Eigen::VectorXd next) const {
    for (Eigen::Index j = 0; j < constants(); ++j) {
      const auto known = start.ln_factor.find(free[static_cast<std::size_t>(j)]);
      const double origin = known == start.ln_factor.end() ? 0.0 : known->second;
      next[j] = at[j] + std::clamp(next[j] - at[j], -1.0, 1.0);
      next[j] = std::clamp(next[j], -kFarthest - origin, kFarthest - origin);
    }
    next[constants()] = std::clamp(next[constants()], fitter.earliest_s_, fitter.latest_s_);
    for (Eigen::Index j = 0; j < zeros(); ++j) {
      const double most = kFarthestZero * fitter.prior_of_zero(static_cast<std::size_t>(j));
      next[constants() + 1 + j] = std::clamp(next[constants() + 1 + j], -most, most);
    }
    return next;
  }

  /// Takes `next` if it is possible and better.
  bool accept(const Eigen::VectorXd& next) {
    DriveResponse then = fitter.response(changed(start.drive, free, next.head(constants())));
    if (!then.bounded) return false;
    Eigen::VectorXd left = fitter.residuals(then, next[constants()], next.tail(zeros()));
    if (now.bounded && !(loss(left, scale) < loss(residual, scale))) return false;
    at = next;
    residual = std::move(left);
    now = std::move(then);
    return true;
  }

  void run(double with_scale) {
    scale = with_scale;
    double damping = kFirstDamping;
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      const double cost = loss(residual, scale);
      const Eigen::VectorXd weight = root_weights(residual, scale);
      weighted = weight.asDiagonal() * jacobian();
      normal = weighted.transpose() * weighted;
      const Eigen::VectorXd gradient = weighted.transpose() * (weight.asDiagonal() * residual);
      bool better = false;
      for (int attempt = 0; attempt < kMostAttempts && !better; ++attempt) {
        Eigen::MatrixXd damped = normal;
        damped.diagonal() *= 1.0 + damping;
        damped.diagonal().array() += kRidge * normal.diagonal().maxCoeff() + kLeastDivisor;
        const Eigen::VectorXd next = at - SymmetricSolver(damped).solve(gradient);
        better = next.allFinite() && accept(bounded(next));
        damping *= better ? kDampingFalls : kDampingRises;
      }
      if (!better || cost - loss(residual, scale) < (scale > kCoarseScale ? kNearlySettled : kSettled) * cost) return;
    }
  }

  /// Half a pulse in the position error counter while the axis moves, in units of the noise: what counting whole pulses
  /// may do to the recording.
  [[nodiscard]] Eigen::VectorXd half_pulse() const {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(residual.size());
    const DriveTrace& trace = fitter.trace_;
    for (std::size_t k = 0; k < trace.time_s.size(); ++k) {
      const double t = trace.time_s[k] - at[constants()];
      if (t > 0.0 && t < trace.move.duration_s())
        change[static_cast<Eigen::Index>(k)] = 0.5 * start.drive[DriveConstant::Kd] / trace.dac().noise;
    }
    return change;
  }

  [[nodiscard]] DriveFit fit() const {
    DriveFit found = start;
    found.drive = changed(start.drive, free, at.head(constants()));
    found.start_s = at[constants()];
    found.zero = at.tail(zeros());
    found.cost = loss(residual);
    found.possible = now.bounded;
    Eigen::MatrixXd curvature = normal;
    curvature.diagonal().array() += kRidge * normal.diagonal().maxCoeff() + kLeastDivisor;
    const SymmetricSolver solver(curvature);
    const double scale2 = std::pow(scale_of(residual), 2);
    const Eigen::VectorXd counting = solver.solve(weighted.transpose() * half_pulse());
    for (Eigen::Index j = 0; j < constants(); ++j) {
      const DriveConstant c = free[static_cast<std::size_t>(j)];
      const double variance = solver.solve(Eigen::VectorXd::Unit(at.size(), j))[j] * scale2;
      found.ln_factor[c] += at[j];
      found.ln_sigma[c] = std::hypot(std::sqrt(std::max(0.0, variance)), counting[j]);
    }
    return found;
  }
};

DriveFitter::DriveFitter(const DriveTrace& trace) : trace_(trace) {
  const double span = trace.time_s.back() - trace.time_s.front();
  // a recorder triggered late shows the response from its middle on
  duration_s_ = span + std::min(trace.move.duration_s(), 2.0 * span);
  step_s_ = std::max(kStep_s, duration_s_ / kMostSteps);
  const StepShape shape = shape_of(trace.time_s, trace.dac().value, trace.dac().noise);
  const double interval = span / static_cast<double>(trace.time_s.size() - 1);
  const double width = std::max(kStartIntervals * interval, kStartOfRise * shape.rise_s.value_or(kUsualRise_s));
  latest_s_ = shape.start_s ? *shape.start_s + width : trace.time_s.front();
  earliest_s_ = shape.start_s ? *shape.start_s - width : trace.time_s.front() - (duration_s_ - span);
}

DriveResponse DriveFitter::response(const DriveParameters& drive) const {
  return simulated(drive, trace_.move, duration_s_, step_s_);
}

double DriveFitter::prior_of_zero(std::size_t signal) const {
  return std::max(kZeroQuanta * trace_.signals[signal].quantum, trace_.signals[signal].noise);
}

/// Recorded less simulated; a clipped sample agrees with everything beyond the edge.
double DriveFitter::difference(std::size_t signal, std::size_t sample, double simulated) const {
  const RecordedSignal& s = trace_.signals[signal];
  const double recorded = s.value[sample];
  if (s.clipped_above && recorded >= *s.clipped_above) return std::max(recorded - simulated, 0.0);
  if (s.clipped_below && recorded <= *s.clipped_below) return std::min(recorded - simulated, 0.0);
  return recorded - simulated;
}

Eigen::VectorXd DriveFitter::residuals(const DriveResponse& response, double start_s,
                                       const Eigen::VectorXd& zero) const {
  const auto samples = trace_.time_s.size(), signals = trace_.signals.size();
  Eigen::VectorXd r(static_cast<Eigen::Index>(samples * signals + signals));
  Eigen::Index at = 0;
  for (std::size_t s = 0; s < signals; ++s) {
    const RecordedSignal& signal = trace_.signals[s];
    const double offset = zero[static_cast<Eigen::Index>(s)];
    for (std::size_t k = 0; k < samples; ++k)
      r[at++] = difference(s, k, response.at(signal.id, trace_.time_s[k] - start_s) + offset) / signal.noise;
  }
  for (std::size_t s = 0; s < signals; ++s) r[at++] = -zero[static_cast<Eigen::Index>(s)] / prior_of_zero(s);
  return r;
}

double DriveFitter::best_start(const DriveResponse& response) const {
  const std::size_t samples = trace_.time_s.size(), stride = std::max<std::size_t>(1, samples / kCoarseSamples);
  const auto cost_at = [&](double start_s) {
    double cost = 0.0;
    for (std::size_t s = 0; s < trace_.signals.size(); ++s)
      for (std::size_t k = 0; k < samples; k += stride)
        cost += std::abs(difference(s, k, response.at(trace_.signals[s].id, trace_.time_s[k] - start_s))) /
                trace_.signals[s].noise;
    return cost;
  };
  double best = earliest_s_, least = cost_at(best), width = (latest_s_ - earliest_s_) / kCoarseStarts;
  for (int n = 1; n <= kCoarseStarts; ++n)
    if (const double cost = cost_at(earliest_s_ + n * width); cost < least) {
      least = cost;
      best = earliest_s_ + n * width;
    }
  while (width > kFinestStart_s) {
    for (const double at : {best - 0.5 * width, best + 0.5 * width})
      if (const double cost = cost_at(at); cost < least) {
        least = cost;
        best = at;
      }
    width *= 0.5;
  }
  return best;
}

DriveFit DriveFitter::aligned(const DriveParameters& drive) const {
  DriveFit fit;
  fit.drive = drive;
  fit.zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(trace_.signals.size()));
  const DriveResponse now = response(drive);
  fit.possible = now.bounded;
  fit.start_s = best_start(now);
  fit.cost = loss(residuals(now, fit.start_s, fit.zero));
  return fitted(fit, {});
}

DriveFit DriveFitter::fitted(const DriveFit& start, const std::vector<DriveConstant>& free) const {
  Descent descent{*this, start, free};
  descent.begin();
  // first as if all that is left were noise, then by the noise that most samples show, at last by the recorder's
  descent.run(std::max(1.0, std::sqrt(descent.residual.squaredNorm() / static_cast<double>(descent.residual.size()))));
  for (int n = 0; n < kMostScales; ++n) {
    const double scale = scale_of(descent.residual);
    if (scale > kScaleFell * descent.scale) break;
    descent.run(scale);
  }
  return descent.fit();
}

DriveFit DriveFitter::best_factor(const DriveFit& start, DriveConstant constant) const {
  struct Try {
    double ln = 0.0, start_s = 0.0, cost = 0.0;
  };
  std::vector<Try> tries;
  double ln = -kTries * kTrySpacing;
  for (int k = -kTries; k <= kTries; ++k, ln += kTrySpacing) {
    DriveParameters drive = start.drive;
    drive[constant] *= std::exp(ln);
    const DriveResponse then = response(drive);
    if (!then.bounded) continue;
    const double begin = best_start(then);
    tries.push_back({ln, begin, loss(residuals(then, begin, start.zero))});
  }
  DriveFit best = start;
  best.ln_factor[constant] = 0.0;
  std::vector<Try> valleys;
  for (std::size_t i = 0; i < tries.size(); ++i)
    if ((i == 0 || tries[i].cost <= tries[i - 1].cost) && (i + 1 == tries.size() || tries[i].cost <= tries[i + 1].cost))
      valleys.push_back(tries[i]);
  std::ranges::stable_sort(valleys, [](const Try& a, const Try& b) { return a.cost < b.cost; });
  if (valleys.size() > 2) valleys.resize(2);
  for (const Try& valley : valleys) {
    DriveFit from = start;
    from.drive[constant] *= std::exp(valley.ln);
    from.ln_factor[constant] += valley.ln;
    from.start_s = valley.start_s;
    const DriveFit found = fitted(from, {constant});
    if (found.possible && (found.cost < best.cost || !best.possible || best.ln_sigma.empty())) best = found;
  }
  return best;
}

Eigen::MatrixXd DriveFitter::sensitivities(const DriveFit& at) const {
  const DriveResponse now = response(at.drive);
  const Eigen::VectorXd here = residuals(now, at.start_s, at.zero);
  const Eigen::Index rows = here.size() - at.zero.size();
  const auto slope = [&](const DriveResponse& up, const DriveResponse& down, double width) -> Eigen::VectorXd {
    return (residuals(down, at.start_s, at.zero) - residuals(up, at.start_s, at.zero)).head(rows) / width;
  };
  Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(kDriveConstants));
  for (const DriveConstantInfo& info : drive_constants()) {
    const auto with = [&](double ln) {
      return response(changed(at.drive, {info.id}, Eigen::VectorXd::Constant(1, ln)));
    };
    columns.col(static_cast<Eigen::Index>(index_of(info.id))) =
        slope(with(kWideStep), with(-kWideStep), 2.0 * kWideStep);
  }
  Eigen::MatrixXd nuisance(rows, 1 + at.zero.size());
  const double shift = step_s_;
  nuisance.col(0) =
      (residuals(now, at.start_s - shift, at.zero) - residuals(now, at.start_s + shift, at.zero)).head(rows) /
      (2.0 * shift);
  for (Eigen::Index j = 0; j < at.zero.size(); ++j) {
    Eigen::VectorXd moved = at.zero;
    moved[j] += prior_of_zero(static_cast<std::size_t>(j));
    nuisance.col(1 + j) = (residuals(now, at.start_s, moved) - here).head(rows);
  }
  return without(PivotedQr(nuisance).basis(), std::move(columns));
}

std::vector<double> DriveFitter::predicted(const DriveFit& at, std::size_t signal) const {
  const DriveResponse now = response(at.drive);
  std::vector<double> values;
  for (const double t : trace_.time_s)
    values.push_back(now.at(trace_.signals[signal].id, t - at.start_s) + at.zero[static_cast<Eigen::Index>(signal)]);
  return values;
}

double DriveFitter::rms(const DriveFit& at, std::size_t signal, bool without_glitches) const {
  const std::vector<double> simulated = predicted(at, signal);
  std::vector<double> squares;
  for (std::size_t k = 0; k < simulated.size(); ++k)
    squares.push_back(std::pow(difference(signal, k, simulated[k]), 2));
  if (without_glitches) {
    const double beyond = std::pow(kGlitch * trace_.signals[signal].noise, 2);
    const auto glitches = std::ranges::count_if(squares, [&](double s) { return s > beyond; });
    if (static_cast<std::size_t>(glitches) * kSamplesAGlitch <= squares.size())
      std::erase_if(squares, [&](double s) { return s > beyond; });
  }
  double sum = 0.0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

}  // namespace ecs::model
