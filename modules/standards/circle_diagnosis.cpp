// Selection of columns by F tests against the noise of repeats: forward, each step followed by exchanges and removals
// (Efroymson 1960), at a family-wise level over all faults tried (Šidák 1967). The decay of a spike that is chosen is
// then found from the readings; its derivative stays among the columns, so that every test and every uncertainty counts
// that the decay was fitted. The noise's correlation inflates its variance by (1 + ρ)/(1 − ρ) (Bartlett 1946). The
// share of a fault is its mean square among those of all parts and of the rest.
#include "modules/standards/circle_diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "model/fit/statistics.hpp"
#include "modules/standards/circle_faults.hpp"

namespace ecs::model {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Δχ² below which two answers are equally good, as for periods (docs/statistics.md, "Sets").
constexpr double kEquallyGood = 9.0;
/// Columns of which less than this part is left beside the others add nothing.
constexpr double kNothingNew = 1e-6;
/// Variance of third differences in that of a reading: 1 + 9 + 9 + 1.
constexpr double kThirdDifference = 20.0;
/// Share of a fault, hidden by the zeros of parts, that is stated: its standard uncertainty grows by a fifth.
constexpr double kHiddenShare = 0.3;
constexpr std::size_t kFewestReadings = 48;
constexpr std::size_t kMostFaults = 8;

/// Readings of one pass by rising angle, as rows first … first + count of the whole.
struct PassRows {
  bool clockwise = false;
  int run = 1;
  Index first = 0, count = 0;
};

struct CircleData {
  CirclePoints points;
  VectorXd deviation;  ///< centre of each pass and radius of each part of it taken off
  std::vector<PassRows> passes;
  std::vector<int> part;  ///< per row
};

CircleData circle_data(const laser::CircleTest& test) {
  std::map<std::pair<bool, int>, std::vector<laser::CircleReading>> passes;
  for (const laser::CircleReading& reading : test.readings) passes[{reading.clockwise, reading.run}].push_back(reading);
  const auto n = static_cast<Index>(test.readings.size());
  CircleData data{{test.radius_mm, test.plane, VectorXd(n), VectorXd(n)}, VectorXd(n), {}, {}};
  Index row = 0;
  for (auto& [key, readings] : passes) {
    std::ranges::stable_sort(readings, [](auto& a, auto& b) { return a.angle_deg < b.angle_deg; });
    data.passes.push_back({key.first, key.second, row, static_cast<Index>(readings.size())});
    for (const laser::CircleReading& reading : readings) {
      data.points.angle[row] = reading.angle_deg * (kTurn / 360.0);
      data.points.sense[row] = reading.clockwise ? -1.0 : 1.0;
      data.part.push_back(reading.part);
      data.deviation[row++] = reading.deviation_um;
    }
  }
  return data;
}

/// A column for each part of the pass, 1 on its rows.
MatrixXd part_columns(const CircleData& data, const PassRows& pass) {
  const auto* const first = data.part.data() + pass.first;
  std::vector<int> numbers(first, first + pass.count);
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  MatrixXd columns(pass.count, static_cast<Index>(numbers.size()));
  for (Index i = 0; i < pass.count; ++i)
    for (Index k = 0; k < columns.cols(); ++k)
      columns(i, k) = first[i] == numbers[static_cast<std::size_t>(k)] ? 1.0 : 0.0;
  return columns;
}

/// Takes centre and radius of each pass out of columns: what is left cannot be a matter of centring. Each part of a
/// pass has a radius of its own, that of its zero.
MatrixXd without_centring(const CircleData& data, MatrixXd columns) {
  const MatrixXd centring = centring_columns(data.points);
  for (const PassRows& pass : data.passes) {
    MatrixXd own = centring.middleRows(pass.first, pass.count);
    if (const MatrixXd parts = part_columns(data, pass); parts.cols() > 1) own = beside(own, parts);
    auto block = columns.middleRows(pass.first, pass.count);
    block = without(PivotedQr(own).basis(), MatrixXd(block));
  }
  return columns;
}

struct CircleNoise {
  double variance = 0.0;
  double degrees_of_freedom = 0.0;
  double inflation = 1.0;
  bool from_repeats = false;
};

/// Deviation of a pass between two of its readings.
struct Interpolated {
  double value = 0.0;
  double variance = 1.0;  ///< of its noise, in that of a reading
};

/// @param angle  [rad], 0 … 2π
Interpolated interpolated(const CircleData& data, const PassRows& pass, double angle) {
  const double* const begin = data.points.angle.data() + pass.first;
  const auto above = std::lower_bound(begin, begin + pass.count, angle) - begin;
  const Index high = above == pass.count ? 0 : above, low = above == 0 ? pass.count - 1 : above - 1;
  const auto ahead = [](double from, double to) { return to < from ? to - from + kTurn : to - from; };
  const double gap = ahead(begin[low], begin[high]);
  const double t = gap > 0.0 ? ahead(begin[low], angle) / gap : 1.0;
  return {std::lerp(data.deviation[pass.first + low], data.deviation[pass.first + high], t),
          (1.0 - t) * (1.0 - t) + t * t};
}

/// From the differences of each pass from the first of its direction.
std::optional<CircleNoise> noise_of_repeats(const CircleData& data) {
  double sum = 0.0, product = 0.0, weight = 0.0;
  Index count = 0;
  for (const PassRows& pass : data.passes) {
    const auto first =
        std::ranges::find_if(data.passes, [&](const PassRows& other) { return other.clockwise == pass.clockwise; });
    if (first->run == pass.run) continue;
    double last = 0.0;
    for (Index i = 0; i < pass.count; ++i) {
      const Interpolated before = interpolated(data, *first, data.points.angle[pass.first + i]);
      const double difference = data.deviation[pass.first + i] - before.value;
      sum += difference * difference;
      weight += 1.0 + before.variance;
      if (i > 0) product += difference * last;
      last = difference;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  const double correlation = std::clamp(product / std::max(sum, kLeastDivisor), 0.0, 0.95);
  const double inflation = (1.0 + correlation) / (1.0 - correlation);
  return CircleNoise{sum / weight, static_cast<double>(count) / inflation, inflation, true};
}

/// From third differences of neighbours: a smooth circle adds little to them, reversals are outvoted by the median.
CircleNoise noise_of_neighbours(const CircleData& data) {
  std::vector<double> squares;
  for (const PassRows& pass : data.passes)
    for (Index i = pass.first; i + 3 < pass.first + pass.count; ++i) {
      const double d =
          data.deviation[i + 3] - 3.0 * data.deviation[i + 2] + 3.0 * data.deviation[i + 1] - data.deviation[i];
      squares.push_back(d * d);
    }
  const double variance = upper_median(squares) / kMedianChi2 / kThirdDifference;
  return {variance, static_cast<double>(squares.size()) / 4.0, 1.0, false};
}

/// A set of faults, fitted together.
struct JointFit {
  std::vector<std::size_t> faults;
  double squares = 0.0;  ///< left
  Index columns = 0;
};

class CircleSearch {
 public:
  CircleSearch(const CircleData& data, std::vector<CircleFault> faults, const CircleNoise& noise)
      : data_(data), noise_(noise), faults_(std::move(faults)), tried_(faults_.size()) {
    for (CircleFault& fault : faults_) fault.columns = without_centring(data, std::move(fault.columns));
  }

  [[nodiscard]] JointFit found() {
    JointFit best = fit({});
    std::set<std::set<std::string>> seen;  // an extension that is taken back would come for ever
    while (best.faults.size() < kMostFaults && seen.insert(kinds(best)).second) {
      const auto next = best_extension(best);
      if (!next) break;
      best = pruned(with_best_decays(exchanged(*next)));
    }
    return best;
  }

  [[nodiscard]] const CircleFault& fault(std::size_t i) const { return faults_[i]; }

  [[nodiscard]] MatrixXd columns_of(const std::vector<std::size_t>& chosen) const {
    Index count = 0;
    for (const std::size_t i : chosen) count += faults_[i].columns.cols();
    MatrixXd columns(data_.deviation.size(), count);
    Index at = 0;
    for (const std::size_t i : chosen) {
      columns.middleCols(at, faults_[i].columns.cols()) = faults_[i].columns;
      at += faults_[i].columns.cols();
    }
    return columns;
  }

  /// ln of the chance that noise takes so much off with this many columns, times the number of faults tried.
  [[nodiscard]] double ln_chance(double taken, Index columns) const {
    if (columns <= 0) return 0.0;
    const double k = static_cast<double>(columns);
    const double f = std::max(0.0, taken) / k / (noise_.variance * noise_.inflation);
    return std::min(0.0, ln_f_tail(f, k, noise_.degrees_of_freedom) + std::log(static_cast<double>(tried_)));
  }

  /// Faults that do as well in the place of one of the chosen, by name.
  [[nodiscard]] std::vector<std::string> rivals(const JointFit& found, std::size_t place) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
      if (has_name(found, faults_[i].name())) continue;
      auto chosen = found.faults;
      chosen[place] = i;
      const JointFit other = fit(chosen);
      const Index decay = faults_[found.faults[place]].decay_free ? 1 : 0;
      if (other.columns + decay >= found.columns && worse_by(other, found) < kEquallyGood)
        names.push_back(faults_[i].name());
    }
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }

 private:
  /// Faults by name, waves by their pitch as well; the decay of a spike follows from the others.
  [[nodiscard]] std::set<std::string> kinds(const JointFit& found) const {
    std::set<std::string> kinds;
    for (const std::size_t i : found.faults)
      kinds.insert(faults_[i].effect == kReversalSpike ? faults_[i].name()
                                                       : fmt::format("{} {}", faults_[i].name(), faults_[i].nonlinear));
    return kinds;
  }

  [[nodiscard]] MatrixXd centred_spike(const std::string& letter, double decay_mm) const {
    const std::size_t which = letter[0] == letter_of(data_.points.plane[0]) ? 0 : 1;
    return without_centring(data_, spike_columns(data_.points, which, decay_mm));
  }

  /// The same faults with the decays of their spikes where the readings want them.
  [[nodiscard]] JointFit with_best_decays(JointFit found) {
    std::vector<std::size_t> others, places;
    std::vector<double> decays_mm;
    for (std::size_t place = 0; place < found.faults.size(); ++place) {
      const CircleFault& fault = faults_[found.faults[place]];
      if (fault.effect != kReversalSpike) {
        others.push_back(found.faults[place]);
        continue;
      }
      places.push_back(place);
      decays_mm.push_back(fault.nonlinear);
    }
    if (places.empty()) return found;
    const DecayLimits limits = decay_limits(data_.points);
    decays_mm = best_decays(
        data_.deviation, columns_of(others),
        [&](std::size_t which, double decay_mm) {
          return centred_spike(faults_[found.faults[places[which]]].where, decay_mm);
        },
        std::move(decays_mm), limits);
    for (std::size_t k = 0; k < places.size(); ++k) {
      CircleFault spike = faults_[found.faults[places[k]]];
      spike.nonlinear = decays_mm[k];
      spike.decay_free = decays_mm[k] > limits.least_mm && decays_mm[k] < limits.greatest_mm;
      spike.columns = centred_spike(spike.where, spike.nonlinear).leftCols(spike.decay_free ? 2 : 1);
      faults_.push_back(std::move(spike));
      found.faults[places[k]] = faults_.size() - 1;
    }
    return fit(found.faults);
  }

  [[nodiscard]] JointFit fit(const std::vector<std::size_t>& chosen) const {
    if (chosen.empty()) return {chosen, data_.deviation.squaredNorm(), 0};
    const MatrixXd columns = columns_of(chosen);
    const PivotedQr qr(columns, kNothingNew);
    return {chosen, (data_.deviation - columns * qr.solve(data_.deviation)).squaredNorm(), qr.rank()};
  }

  [[nodiscard]] double worse_by(const JointFit& a, const JointFit& b) const {
    return (a.squares - b.squares) / (noise_.variance * noise_.inflation);
  }

  [[nodiscard]] bool has_name(const JointFit& found, const std::string& name) const {
    return std::ranges::any_of(found.faults, [&](std::size_t i) { return faults_[i].name() == name; });
  }

  [[nodiscard]] std::optional<JointFit> best_extension(const JointFit& found) const {
    std::optional<JointFit> best;
    double least = std::log(kFalseCircleFault);
    for (std::size_t i = 0; i < faults_.size(); ++i) {
      if (has_name(found, faults_[i].name())) continue;
      auto chosen = found.faults;
      chosen.push_back(i);
      const JointFit next = fit(chosen);
      const double ln_p = ln_chance(found.squares - next.squares, next.columns - found.columns);
      if (ln_p >= least) continue;
      least = ln_p;
      best = next;
    }
    return best;
  }

  /// Each chosen fault against every other in its place, until none is better.
  [[nodiscard]] JointFit exchanged(JointFit found) const {
    for (bool better = true; better;) {
      better = false;
      for (std::size_t place = 0; place < found.faults.size(); ++place)
        for (std::size_t i = 0; i < faults_.size(); ++i) {
          auto chosen = found.faults;
          chosen[place] = i;
          if (std::ranges::count(chosen, i) > 1) continue;
          const bool same = faults_[i].name() == faults_[found.faults[place]].name();
          if (!same && has_name(found, faults_[i].name())) continue;
          const JointFit other = fit(chosen);
          // A fault with more columns has to earn them; of one spike another decay is no other fault.
          const double price = same ? 0.0 : 2.0 * static_cast<double>(other.columns - found.columns);
          if (worse_by(other, found) + price >= -1e-6) continue;
          found = other;
          better = true;
        }
    }
    return found;
  }

  /// Without those that noise explains beside the others.
  [[nodiscard]] JointFit pruned(JointFit found) const {
    for (std::size_t place = 0; place < found.faults.size();) {
      auto chosen = found.faults;
      chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(place));
      const JointFit without = fit(chosen);
      if (ln_chance(without.squares - found.squares, found.columns - without.columns) < std::log(kFalseCircleFault)) {
        ++place;
        continue;
      }
      found = without;
      place = 0;
    }
    return found;
  }

  const CircleData& data_;
  const CircleNoise& noise_;
  std::vector<CircleFault> faults_;  ///< those that are tried, then spikes with decays of their own
  std::size_t tried_ = 0;
};

double rms(const VectorXd& values) { return std::sqrt(values.squaredNorm() / static_cast<double>(values.size())); }

CircleFaultFound fault_found(const CircleFault& fault, const VectorXd& sizes, const MatrixXd& covariance) {
  CircleFaultFound found;
  found.name = fault.name();
  found.title = fault.title;
  found.unit = fault.quantity;
  found.component = fault.component;
  found.nonlinear_mm = fault.nonlinear;
  // Of a wave the amplitude, with the uncertainty along it.
  const bool wave = sizes.size() > 1 && !fault.decay_free;
  const double size = wave ? sizes.norm() : sizes[0];
  found.value = size * fault.to_unit;
  const VectorXd along = wave ? VectorXd(sizes / std::max(size, kLeastDivisor)) : VectorXd::Unit(sizes.size(), 0);
  if (fault.decay_free)
    found.nonlinear_sigma_mm =
        fault.nonlinear * std::sqrt(std::max(0.0, covariance(1, 1))) / std::max(std::abs(size), kLeastDivisor);
  found.sigma = std::sqrt(std::max(0.0, along.dot(covariance * along))) * std::abs(fault.to_unit);
  return found;
}

std::vector<CircleFaultFound> ranked(const CircleSearch& search, const JointFit& best, const CircleNoise& noise,
                                     const VectorXd& deviation, VectorXd& left) {
  const MatrixXd columns = search.columns_of(best.faults);
  const VectorXd sizes = least_norm_solution(columns, deviation);
  const MatrixXd back = row_space_of(columns, kNothingNew).back;
  const MatrixXd covariance = noise.variance * noise.inflation * (back * back.transpose());
  left = deviation - columns * sizes;
  std::vector<CircleFaultFound> faults;
  Index at = 0;
  for (std::size_t place = 0; place < best.faults.size(); ++place) {
    const CircleFault& fault = search.fault(best.faults[place]);
    const Index count = fault.columns.cols();
    CircleFaultFound found = fault_found(fault, sizes.segment(at, count), covariance.block(at, at, count, count));
    const Index own = fault.decay_free ? count - 1 : count;
    const VectorXd part = fault.columns.leftCols(own) * sizes.segment(at, own);
    found.rms_um = rms(part);
    found.range_um = part.maxCoeff() - part.minCoeff();
    std::vector<std::size_t> others = best.faults;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(place));
    const MatrixXd rest = search.columns_of(others);
    const VectorXd without = others.empty() ? deviation : VectorXd(deviation - rest * PivotedQr(rest).solve(deviation));
    found.ln_p = search.ln_chance(without.squaredNorm() - left.squaredNorm(), count);
    found.indistinguishable_from = search.rivals(best, place);
    faults.push_back(std::move(found));
    at += count;
  }
  double squares = left.squaredNorm() / static_cast<double>(left.size());
  for (const CircleFaultFound& found : faults) squares += found.rms_um * found.rms_um;
  for (CircleFaultFound& found : faults) found.share = found.rms_um * found.rms_um / squares;
  std::ranges::stable_sort(faults,
                           [](const CircleFaultFound& a, const CircleFaultFound& b) { return a.rms_um > b.rms_um; });
  return faults;
}

/// Faults that stand out of `against`, and what they leave against the noise.
void explain(CircleDiagnosis& diagnosis, const CircleData& data, const std::array<std::vector<double>, 2>& pitches_mm,
             const CircleNoise& noise, const CircleNoise& against) {
  CircleSearch search(data, circle_faults(data.points, pitches_mm), against);
  const JointFit best = search.found();
  VectorXd left = data.deviation;
  diagnosis.faults.clear();
  if (!best.faults.empty()) diagnosis.faults = ranked(search, best, against, data.deviation, left);
  diagnosis.left_um = rms(left);
  diagnosis.explained = 1.0 - left.squaredNorm() / std::max(data.deviation.squaredNorm(), kLeastDivisor);
  double freedom = static_cast<double>(left.size()) - static_cast<double>(best.columns);
  for (const PassRows& pass : data.passes) freedom -= 2.0 + static_cast<double>(part_columns(data, pass).cols());
  diagnosis.lack_of_fit_ln_p =
      ln_f_tail(left.squaredNorm() / freedom / noise.variance, freedom / noise.inflation, noise.degrees_of_freedom);
}

/// The pitches that the readings of a circle resolve are those of the faults that can be tried.
bool tries_pitch(const std::vector<CircleFault>& faults, char axis, double pitch_mm) {
  return std::ranges::any_of(faults, [&](const CircleFault& fault) {
    return fault.effect == "cyclic" && fault.where == std::string(1, axis) && fault.nonlinear == pitch_mm;
  });
}

/// Faults of which the zeros of the parts hide a good share, with the share of their mean square.
std::vector<std::string> hidden_by_parts(const CircleData& data, const std::vector<CircleFault>& faults) {
  CircleData whole = data;
  std::ranges::fill(whole.part, 1);
  std::vector<std::string> hidden;
  for (const CircleFault& fault : faults) {
    const double all = without_centring(whole, fault.columns.leftCols(1)).squaredNorm();
    const double lost =
        1.0 - without_centring(data, fault.columns.leftCols(1)).squaredNorm() / std::max(all, kLeastDivisor);
    if (fault.effect != kReversalSpike && fault.effect != "cyclic" && lost > kHiddenShare)
      hidden.push_back(fmt::format("{} ({:.0f} %)", fault.title, 100.0 * lost));
  }
  return hidden;
}

std::string no_pitch_note(char axis, PitchSource source) {
  if (source == PitchSource::nowhere)
    return fmt::format("the pitch of {0} is not known, so periodic errors of {0} were not looked for. Give --machine",
                       axis);
  return fmt::format(
      "the machine file has no pitch of {0}, so its periodic errors were not looked for. Give screw_pitch_mm or "
      "scale_pitch_mm in "
      "[axis.{0}]",
      axis);
}

std::vector<std::string> circle_notes(const CircleData& data, const CircleNoise& noise,
                                      const CircleDiagnosis& diagnosis,
                                      const std::array<std::vector<double>, 2>& pitches_mm, PitchSource source) {
  std::vector<std::string> notes;
  const bool one_way = std::ranges::all_of(
      data.passes, [&](const PassRows& pass) { return pass.clockwise == data.passes.front().clockwise; });
  if (one_way)
    notes.emplace_back(
        "one direction only: squareness and servo mismatch have the same shape. Contour the other way as well");
  if (!noise.from_repeats)
    notes.emplace_back(
        "no repeated pass: the noise is estimated from neighbouring readings and excludes slow changes. Repeat the "
        "circle");
  if (const auto hidden = hidden_by_parts(data, circle_faults(data.points, pitches_mm)); !hidden.empty())
    notes.push_back(fmt::format(
        "the separate zeros of the parts hide a share of the effect (mean square) of {}. A full circle shows more",
        fmt::join(hidden, ", ")));
  for (std::size_t i = 0; i < pitches_mm.size(); ++i)
    if (pitches_mm[i].empty()) notes.push_back(no_pitch_note(letter_of(data.points.plane[i]), source));
  const auto faults = circle_faults(data.points, pitches_mm);
  for (std::size_t i = 0; i < pitches_mm.size(); ++i)
    for (const double pitch_mm : pitches_mm[i])
      if (const char axis = letter_of(data.points.plane[i]); !tries_pitch(faults, axis, pitch_mm))
        notes.push_back(
            fmt::format("a wave of {} with the pitch {:g} mm is not tried: the readings are too far apart for it, or "
                        "the circle is too small",
                        axis, pitch_mm));
  for (const CircleFaultFound& fault : diagnosis.faults)
    if (fault.name.starts_with(kReversalSpike) && !fault.nonlinear_sigma_mm)
      notes.push_back(fmt::format(
          "{}: the fitted decay length is at the limit of the range tried, {:.3g} mm. The size of the spikes "
          "is valid for this length only",
          fault.title, fault.nonlinear_mm));
  const bool without_cyclic = std::ranges::any_of(pitches_mm, &std::vector<double>::empty);
  if (diagnosis.lack_of_fit_ln_p < std::log(kLackOfFit))
    notes.push_back(fmt::format("the residual, {:.2f} um rms, is more than the noise of {:.2f} um: {}",
                                diagnosis.left_um, diagnosis.noise_um,
                                without_cyclic ? "none of the faults that were tried explains it. Cyclic errors were "
                                                 "not tried on every axis, see above"
                                               : "none of the known causes explains it"));
  return notes;
}

}  // namespace

Result<CircleDiagnosis> diagnose_circle(const laser::CircleTest& test,
                                        const std::array<std::vector<double>, 2>& pitches_mm, PitchSource source) {
  if (test.readings.size() < kFewestReadings)
    return problem_at(test.source, 0, 0, "expected {} readings or more to rank faults, found {}", kFewestReadings,
                      test.readings.size());
  CircleData data = circle_data(test);
  data.deviation = without_centring(data, data.deviation);
  const auto repeats = noise_of_repeats(data);
  CircleNoise noise = repeats ? *repeats : noise_of_neighbours(data);
  noise.variance = std::max(noise.variance, 1e-12);  // rounded simulations: below any instrument
  CircleDiagnosis diagnosis;
  diagnosis.rms_um = rms(data.deviation);
  diagnosis.noise_um = std::sqrt(noise.variance);
  diagnosis.noise_from_repeats = noise.from_repeats;
  diagnosis.inflation = noise.inflation;
  explain(diagnosis, data, pitches_mm, noise, noise);
  if (diagnosis.lack_of_fit_ln_p < std::log(kLackOfFit)) {
    // What is left is no noise, and comes again in every pass: a fault has to stand out of it as a whole.
    const double passes = static_cast<double>(data.passes.size());
    const double n = static_cast<double>(data.deviation.size());
    explain(diagnosis, data, pitches_mm, noise,
            {diagnosis.left_um * diagnosis.left_um, n / passes, passes, noise.from_repeats});
  }
  diagnosis.notes = circle_notes(data, noise, diagnosis, pitches_mm, source);
  return diagnosis;
}

}  // namespace ecs::model
