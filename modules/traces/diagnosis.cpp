// The search for the wrong constant of a servo axis: constants one by one, then in pairs, by least loss; constants
// whose sensitivities are nearly collinear are one group (collinearity index: Brun, Reichert and Künsch 2001). Does not
// live here: the fit of given constants (fit.cpp).
#include "modules/traces/diagnosis.hpp"

#include <algorithm>
#include <cmath>

#include "model/fit/statistics.hpp"
#include "modules/traces/fit.hpp"

namespace ecs::model {
namespace {

/// Two constants act as one where all but this share of what one does to the recording is done by the other: the sine
/// of the angle between their sensitivities. The thesis's own model is no closer to its oscilloscope (rise 67 and 74
/// ms).
constexpr double kAlike = 0.06;
/// Share of the largest signal that a change may leave and still explain the recording: what the equations leave out. A
/// choice: smaller names a second constant for what the model is not made for.
constexpr double kModelError = 0.004;
/// A change that leaves more than this share of the loss is no candidate. A choice, to keep the list short.
constexpr double kLeastFall = 0.95;
/// A pair has one of this many of the best single directions in it: a choice of processor time.
constexpr std::size_t kMostFirsts = 4;
/// Sensitivities below this share of the largest are no sensitivities.
constexpr double kSilent = 1e-3;
/// An rms may exceed the noise by this factor and still be noise: the noise is known to 10 % or so from second
/// differences.
constexpr double kNoiseMargin = 1.2;
/// Share of the largest value of a further signal that may be left: signals beside the D/A voltage are calibrated less
/// well. A choice.
constexpr double kFurtherError = 0.02;
/// Whole pulses of the position error counter add up to half a pulse.
constexpr double kPulsePart = 0.5;

struct Single {
  DriveConstant constant = DriveConstant::Kd;
  DriveFit fit;
  double rms_V = 0.0;
};

class DriveSearch {
 public:
  DriveSearch(const DriveParameters& drive, const DriveTrace& trace)
      : trace_(trace), fitter_(trace), given_(fitter_.aligned(drive)) {}

  DriveDiagnosis run() {
    found_.observations = trace_.time_s.size();
    found_.notes = trace_.notes;
    found_.noise_V = trace_.dac().noise;
    found_.floor_V = std::hypot(kNoiseMargin * found_.noise_V, kPulsePart * given_.drive[DriveConstant::Kd]);
    found_.rms_V = fitter_.rms(given_, 0);
    found_.measured = shape_of(trace_.time_s, trace_.dac().value, found_.noise_V);
    found_.as_given = simulated_shape(given_);
    if (!given_.possible) found_.notes.emplace_back("the loop as given is unstable: its simulation diverges");
    DriveFit best = given_;
    if (!explains(given_)) best = search();
    conclude(best);
    return std::move(found_);
  }

 private:
  [[nodiscard]] bool explains(const DriveFit& fit) const {
    if (!fit.possible) return false;
    const double tolerance = std::hypot(found_.floor_V, kModelError * largest());
    if (fitter_.rms(fit, 0, true) > tolerance) return false;
    for (std::size_t s = 1; s < trace_.signals.size(); ++s)
      if (fitter_.rms(fit, s, true) > std::hypot(kNoiseMargin * trace_.signals[s].noise, kFurtherError * largest_of(s)))
        return false;
    return true;
  }
  [[nodiscard]] double largest_of(std::size_t signal) const {
    double most = 0.0;
    for (const double x : trace_.signals[signal].value) most = std::max(most, std::abs(x));
    return most;
  }
  /// Of dac_V at the times of the samples, without the recorder's zero.
  [[nodiscard]] StepShape simulated_shape(const DriveFit& fit) const {
    std::vector<double> value = fitter_.predicted(fit, 0);
    for (double& v : value) v -= fit.zero[0];
    return shape_of(trace_.time_s, value, 0.0);
  }
  [[nodiscard]] double largest() const { return largest_of(0); }

  DriveFit search();
  void try_singles();
  void gather_groups();
  void try_pairs();
  [[nodiscard]] std::vector<std::vector<DriveConstant>> directions() const;
  [[nodiscard]] DriveFit best_pair(DriveConstant one, DriveConstant two) const;
  [[nodiscard]] DriveChange change_of(DriveConstant constant, const DriveFit& fit) const;
  void compare_signals(DriveCandidate& candidate, const std::vector<const DriveFit*>& fits) const;
  void conclude(const DriveFit& best);
  [[nodiscard]] std::vector<DriveConstant> silent_at(const Eigen::MatrixXd& columns) const;

  const DriveTrace& trace_;
  DriveFitter fitter_;
  DriveFit given_;
  DriveDiagnosis found_;
  std::vector<Single> singles_;  ///< best first
};

Eigen::Index column_of(DriveConstant c) { return static_cast<Eigen::Index>(index_of(c)); }

/// Sine of the angle between two columns: the share of one that the other cannot make.
double sine_between(const Eigen::MatrixXd& columns, DriveConstant a, DriveConstant b) {
  const auto u = columns.col(column_of(a)), v = columns.col(column_of(b));
  const double lengths = u.norm() * v.norm();
  if (lengths <= 0.0) return 1.0;
  const double cosine = u.dot(v) / lengths;
  return std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
}

std::vector<DriveConstant> DriveSearch::silent_at(const Eigen::MatrixXd& columns) const {
  std::vector<DriveConstant> silent;
  const double most = columns.colwise().norm().maxCoeff();
  for (const DriveConstantInfo& info : drive_constants())
    if (columns.col(column_of(info.id)).norm() < kSilent * most) silent.push_back(info.id);
  return silent;
}

void DriveSearch::try_singles() {
  for (const DriveConstantInfo& info : drive_constants()) {
    Single single{info.id, fitter_.best_factor(given_, info.id), 0.0};
    single.rms_V = fitter_.rms(single.fit, 0);
    if (single.fit.possible && single.fit.cost < kLeastFall * given_.cost) singles_.push_back(std::move(single));
  }
  std::ranges::stable_sort(singles_, [](const Single& a, const Single& b) { return a.fit.cost < b.fit.cost; });
}

DriveChange DriveSearch::change_of(DriveConstant constant, const DriveFit& fit) const {
  DriveChange change;
  change.constant = constant;
  change.factor = std::exp(fit.ln_factor.at(constant));
  change.value = fit.drive[constant];
  change.sigma = change.value * fit.ln_sigma.at(constant);
  change.rms_after = fitter_.rms(fit, 0);
  return change;
}

/// Every signal that was not recorded, with each member of the group mended.
void DriveSearch::compare_signals(DriveCandidate& candidate, const std::vector<const DriveFit*>& fits) const {
  if (fits.size() < 2) return;
  std::vector<DriveResponse> responses;
  for (const DriveFit* fit : fits) responses.push_back(fitter_.response(fit->drive));
  for (const DriveSignalInfo& info : drive_signals()) {
    const bool recorded = std::ranges::any_of(trace_.signals, [&](const RecordedSignal& s) { return s.id == info.id; });
    if (recorded) continue;
    SignalDifference difference{info.id, 0.0, {}};
    for (std::size_t i = 1; i < responses.size(); ++i) {
      double square = 0.0, a_square = 0.0, b_square = 0.0, b_most = 0.0;
      const double span = trace_.time_s.back() - trace_.time_s.front();
      for (double t = 0.0; t <= span; t += fitter_.step_s()) {
        const double a = responses[0].at(info.id, t), b = responses[i].at(info.id, t);
        square += (a - b) * (a - b);
        a_square += a * a;
        b_square += b * b;
        difference.peak = std::max(difference.peak, std::abs(a));
        b_most = std::max(b_most, std::abs(b));
      }
      const double smaller = std::max(kLeastDivisor, std::min(a_square, b_square));
      difference.members.push_back({candidate.alternatives[i].constant, std::sqrt(square / smaller), b_most});
    }
    candidate.signals.push_back(std::move(difference));
  }
  std::ranges::stable_sort(candidate.signals, [](const auto& a, const auto& b) { return a.least() > b.least(); });
  for (const SignalDifference& s : candidate.signals)
    if (s.least() >= kClearDifference) candidate.separated_by.push_back(s.signal);
}

/// The best single becomes the head of a group: all whose effect on the recording is its own, as far as the recording
/// and the model go; then the best of those left, and so on.
void DriveSearch::gather_groups() {
  std::vector<bool> taken(singles_.size(), false);
  for (std::size_t head = 0; head < singles_.size(); ++head) {
    if (taken[head]) continue;
    const Single& first = singles_[head];
    const Eigen::MatrixXd columns = fitter_.sensitivities(first.fit);
    DriveCandidate candidate;
    candidate.explains = explains(first.fit);
    candidate.rms_after_V = first.rms_V;
    candidate.cost = first.fit.cost;
    std::vector<const DriveFit*> fits;
    const double close = std::hypot(first.rms_V, kModelError * largest());
    for (std::size_t i = head; i < singles_.size(); ++i) {
      if (taken[i]) continue;
      const bool alike = i == head || (sine_between(columns, first.constant, singles_[i].constant) < kAlike &&
                                       singles_[i].rms_V <= kNoiseMargin * close);
      if (!alike) continue;
      taken[i] = true;
      candidate.alternatives.push_back(change_of(singles_[i].constant, singles_[i].fit));
      fits.push_back(&singles_[i].fit);
    }
    compare_signals(candidate, fits);
    found_.candidates.push_back(std::move(candidate));
  }
}

/// Constants that act as one on the recording as the best single leaves it; those whose single fit gained most first.
std::vector<std::vector<DriveConstant>> DriveSearch::directions() const {
  const Eigen::MatrixXd columns = fitter_.sensitivities(singles_.front().fit);
  const std::vector<DriveConstant> silent = silent_at(columns);
  std::vector<DriveConstant> order;
  for (const Single& single : singles_) order.push_back(single.constant);
  for (const DriveConstantInfo& info : drive_constants())
    if (std::ranges::find(order, info.id) == order.end()) order.push_back(info.id);
  std::vector<std::vector<DriveConstant>> found;
  for (const DriveConstant c : order) {
    if (std::ranges::find(silent, c) != silent.end()) continue;
    const auto direction_of_c = std::ranges::find_if(
        found, [&](const auto& direction) { return sine_between(columns, direction.front(), c) < kAlike; });
    if (direction_of_c != found.end())
      direction_of_c->push_back(c);
    else
      found.push_back({c});
  }
  return found;
}

/// The best fit of two constants, from the single fits of either.
DriveFit DriveSearch::best_pair(DriveConstant one, DriveConstant two) const {
  DriveFit best = given_;
  for (const auto& [from, free] : {std::pair(one, two), std::pair(two, one)}) {
    const auto single = std::ranges::find_if(singles_, [&](const Single& s) { return s.constant == from; });
    if (single == singles_.end()) continue;
    for (const DriveFit& begin : {single->fit, fitter_.best_factor(single->fit, free)}) {
      const DriveFit fit = fitter_.fitted(begin, {one, two});
      if (fit.possible && (fit.cost < best.cost || best.ln_factor.empty())) best = fit;
    }
  }
  return best;
}

/// Pairs of directions: of constants that act as one only the first is tried, the others are named beside it.
void DriveSearch::try_pairs() {
  if (singles_.empty()) return;
  const auto all = directions();
  std::vector<std::pair<DriveCandidate, double>> pairs;
  for (std::size_t a = 0; a < std::min(kMostFirsts, all.size()); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      const DriveConstant one = all[a].front(), two = all[b].front();
      const DriveFit best = best_pair(one, two);
      if (best.ln_factor.size() < 2 || !explains(best)) continue;
      DriveCandidate candidate;
      candidate.together = true;
      candidate.explains = true;
      candidate.rms_after_V = fitter_.rms(best, 0);
      candidate.cost = best.cost;
      candidate.alternatives = {change_of(one, best), change_of(two, best)};
      candidate.like_first = {all[a].begin() + 1, all[a].end()};
      candidate.like_second = {all[b].begin() + 1, all[b].end()};
      pairs.emplace_back(std::move(candidate), std::abs(best.ln_factor.at(one)) + std::abs(best.ln_factor.at(two)));
    }
  // of pairs that explain alike the smaller change comes first
  std::ranges::stable_sort(pairs, [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<DriveCandidate> ranked;
  for (auto& [candidate, far] : pairs) ranked.push_back(std::move(candidate));
  for (DriveCandidate& candidate : found_.candidates) ranked.push_back(std::move(candidate));
  found_.candidates = std::move(ranked);
}

DriveFit DriveSearch::search() {
  try_singles();
  gather_groups();
  const auto explained = [&] { return !found_.candidates.empty() && found_.candidates.front().explains; };
  found_.verdict = DriveVerdict::wrong_constant;
  if (!explained()) {
    try_pairs();
    found_.verdict = explained() ? DriveVerdict::wrong_constants : DriveVerdict::unexplained;
  }
  if (found_.candidates.empty()) return given_;
  const DriveCandidate& first = found_.candidates.front();
  DriveParameters drive = given_.drive;
  drive[first.alternatives[0].constant] = first.alternatives[0].value;
  if (first.together) drive[first.alternatives[1].constant] = first.alternatives[1].value;
  return fitter_.aligned(drive);
}

void DriveSearch::conclude(const DriveFit& best) {
  found_.start_s = best.start_s;
  found_.mended_V = fitter_.predicted(best, 0);
  DriveFit beside = best;  // as given, on the clock and the zero of the mended one
  beside.drive = given_.drive;
  found_.as_given_V = fitter_.predicted(beside, 0);
  found_.mended = simulated_shape(best);
  found_.silent = silent_at(fitter_.sensitivities(best));
}

}  // namespace

double SignalDifference::least() const {
  double least = members.empty() ? 0.0 : members.front().relative;
  for (const MemberDifference& m : members) least = std::min(least, m.relative);
  return least;
}

std::string_view name_of(DriveVerdict verdict) {
  switch (verdict) {
    case DriveVerdict::agrees:
      return "agrees";
    case DriveVerdict::wrong_constant:
      return "wrong_constant";
    case DriveVerdict::wrong_constants:
      return "wrong_constants";
    case DriveVerdict::unexplained:
      break;
  }
  return "unexplained";
}

DriveDiagnosis diagnose_drive(const DriveParameters& drive, const DriveTrace& trace) {
  return DriveSearch(drive, trace).run();
}

}  // namespace ecs::model
