// Periods compared with each other and with the facts of the machine; frequencies closer than the resolution of the
// travel beat (VanderPlas 2018, 7). Sum of the periodograms of the passes (Lomb 1976; Scargle 1982; averaged over
// segments: Bartlett 1948): on noise χ² of two degrees a pass; the price of the frequencies by Bonferroni.
#include "model/diagnosis/waves.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/moved_targets.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Periods agree to a percent: a fit on a short travel knows them no better.
constexpr double kSamePeriod = 0.01;
/// A period is a pitch, a tenth to ten times it: ratios of small whole numbers are further apart than a percent. It is
/// surely another beyond four standard deviations, each a ten-thousandth at least: a machine that is 10 degC warmer.
constexpr int kMostOfPitch = 10;
constexpr double kSurelyOther = 4.0, kLeastSigma = 1e-4;
/// Of so many periods that fit as well one is a pitch, a multiple or a part of it, by chance.
constexpr std::size_t kManyPeriods = 4;
constexpr double kWholeTurn_deg = 360.0;
/// A period is a part of another up to this number.
constexpr double kMostParts = 12.5;
/// Frequencies closer than this many turns over the travel beat: one wave whose amplitude or period changes looks so.
constexpr double kBeating = 3.0;
/// Targets are even to this share of their distance: a choice; ISO 230-2 moves them by a third.
constexpr double kEvenStep = 0.02;

/// Mean of u² over −1 … 1, taken off so that the second pair differs from the wave itself.
constexpr double kThird = 1.0 / 3.0;
/// A change of a wave counts from this share of its gain and this many digits of its chance: one in a million, since it
/// denies a cause; no wave of a machine is steady to a hundredth. Choices.
constexpr double kLeastChange = 0.01, kFarDigits = 6.0;

bool is_whole_fraction(double a, double b) {
  const double ratio = std::max(a, b) / std::min(a, b);
  return ratio < kMostParts && std::abs(ratio / std::round(ratio) - 1.0) < kSamePeriod;
}

bool same_line(const EffectInstance& a, const EffectInstance& b) { return a.axis == b.axis && a.sense == b.sense; }

bool is_jump(const EffectInstance& effect) {
  return effect.traits().shape_of_position && !effect.definition().search.has_slope;
}

}  // namespace

double frequency_seen(const Observations& data, const Family& family, double period) {
  const std::vector<double> places = acting_positions(data.motions(), family.acting, *family.effect.axis);
  const double step =
      (places.back() - places.front()) / static_cast<double>(std::max<std::size_t>(places.size(), 2) - 1);
  for (std::size_t i = 1; i < places.size(); ++i)
    if (std::abs(places[i] - places[i - 1] - step) > kEvenStep * step) return 1.0 / period;
  return std::abs(1.0 / period - std::round(step / period) / step);
}

bool is_pitch_or_no_wave(const Family& family, const Choice& choice) {
  return !family.effect.traits().periodic || is_fact(family, choice.nonlinear);
}

bool are_pitches_or_fractions(const std::vector<Family>& families, const std::vector<Choice>& chosen) {
  double longest = 0.0;
  bool pitches = true;
  for (const Choice& choice : chosen)
    if (families[choice.family].effect.traits().periodic) longest = std::max(longest, choice.nonlinear);
  for (const Choice& choice : chosen) pitches = pitches && is_pitch_or_no_wave(families[choice.family], choice);
  const auto jumps_beside = [&](const EffectInstance& wave) {
    return std::ranges::any_of(chosen, [&](const Choice& other) {
      const EffectInstance& effect = families[other.family].effect;
      return is_jump(effect) && same_line(effect, wave);
    });
  };
  return pitches || std::ranges::all_of(chosen, [&](const Choice& choice) {
           const EffectInstance& effect = families[choice.family].effect;
           return !effect.traits().periodic || (is_whole_fraction(choice.nonlinear, longest) && !jumps_beside(effect));
         });
}

bool are_shape_that_repeats(const std::vector<Family>& families, const std::vector<Choice>& chosen) {
  const auto is_other_wave = [&](const Choice& choice) {
    return !is_pitch_or_no_wave(families[choice.family], choice);
  };
  return std::ranges::any_of(chosen, [&](const Choice& one) {
    const EffectInstance& wave = families[one.family].effect;
    return is_other_wave(one) && std::ranges::any_of(chosen, [&](const Choice& other) {
             const EffectInstance& rival = families[other.family].effect;
             return is_other_wave(other) && same_line(wave, rival) &&
                    (other.nonlinear > one.nonlinear * (1.0 + kSamePeriod) || rival.approach != wave.approach);
           });
  });
}

std::optional<ChangeOfWave> change_of_wave(const Regressors& regressors, const Whitener& whitener, const Space& space,
                                           const Family& family, const Choice& choice, double noise_freedom) {
  if (!family.effect.traits().periodic) return std::nullopt;
  const Observations& data = regressors.data();
  // every harmonic in use: of a wave told as the second one of its double the first is nothing
  const Eigen::MatrixXd wave =
      regressors.columns(family.effect, choice.nonlinear, family.acting).of(Eigen::all, choice.columns);
  const std::pair<double, double> range = acting_range(regressors.motions(), family.acting, *family.effect.axis);
  double last_s = 0.0;
  for (const double t : data.time_s)
    if (!std::isnan(t)) last_s = std::max(last_s, t);
  const auto change = [&](const auto& factor, const char* how) -> std::optional<ChangeOfWave> {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(wave.rows(), 2 * wave.cols());
    for (const std::size_t k : family.acting.readings) {
      const auto row = static_cast<Eigen::Index>(k);
      const double u = factor(k);
      columns.row(row) << u * wave.row(row), (u * u - kThird) * wave.row(row);
    }
    Space more = space;
    absorb(more, whitener(columns));
    const double gain = space.chi2() - more.chi2();
    const auto freedom = static_cast<double>(more.q.cols() - space.q.cols());
    // if the wave changes between repeats, the noise contains this change: its own residual is another measure of noise
    const double spare = static_cast<double>(space.y.size() - more.q.cols());
    const double square = more.chi2() / std::max(spare, 1.0);
    double digits = minus_log_p(gain, freedom, noise_freedom);
    if (spare >= 1.0) digits = std::max(digits, minus_log_p(gain / std::max(square, kLeastDivisor), freedom, spare));
    if (gain <= kLeastChange * choice.gain || digits <= kFarDigits) return {};
    return ChangeOfWave{
        fmt::format("the wave of {:.4g} {} changes its size or its {}", choice.nonlinear, data.position_unit(), how),
        gain};
  };
  auto along = change(
      [&](std::size_t k) {
        return 2.0 * (data.p_mm(k, *family.effect.axis) - range.first) / (range.second - range.first) - 1.0;
      },
      "period along the travel");
  if (along || last_s <= 0.0) return along;
  return change([&](std::size_t k) { return std::isnan(data.time_s[k]) ? 0.0 : 2.0 * data.time_s[k] / last_s - 1.0; },
                "phase in time");
}

std::string objection_to_smoothness(const Regressors& regressors, const Whitener& whitener, const Space& space,
                                    const Family& family, const Choice& choice, double noise_freedom) {
  constexpr std::size_t kMostTargets = 200;  // more take long, and a curve follows them less and less
  const EffectDefinition& definition = family.effect.definition();
  const Observations& data = regressors.data();
  if (!definition.traits.is_curve || !data.paths.empty()) return "";
  const std::vector<double> places = acting_positions(data, family.acting, *family.effect.axis);
  if (places.size() > kMostTargets) return "";
  Eigen::MatrixXd straight = Eigen::MatrixXd::Zero(space.y.size(), 2);  // a backlash, a slope: these are smooth
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(space.y.size(), static_cast<Eigen::Index>(places.size()));
  for (const std::size_t k : family.acting.rows) {
    const auto row = static_cast<Eigen::Index>(k);
    const double p_mm = data.p_mm(k, *family.effect.axis), factor = definition.curve_factor({data, k, family.effect});
    const auto at = std::ranges::lower_bound(places, p_mm - kSamePlace_mm) - places.begin();
    straight.row(row) << factor, factor * p_mm;
    values(row, std::min<Eigen::Index>(at, values.cols() - 1)) = factor;
  }
  Space smooth = space;
  absorb(smooth, whitener(straight));
  Space more = smooth;
  absorb(more, whitener(values));
  const double gain = smooth.chi2() - more.chi2();
  const auto freedom = static_cast<double>(more.q.cols() - smooth.q.cols());
  if (gain - freedom <= kLeastBesideCurve * choice.gain || minus_log_p(gain, freedom, noise_freedom) <= kFarDigits)
    return "";
  return fmt::format("{} has jumps from target to target that no smooth curve has", to_text(family.effect));
}

std::string objection_to_waves(const Observations& data, const std::vector<Family>& families,
                               const std::vector<Choice>& chosen, const std::vector<bool>& proved,
                               const std::vector<std::size_t>& periods) {
  const auto shapes_on_line_of = [&](const EffectInstance& wave) {
    return std::ranges::count_if(chosen, [&](const Choice& choice) {
      const EffectInstance& effect = families[choice.family].effect;
      return effect.traits().shape_of_position && !effect.traits().of_approach && same_line(effect, wave);
    });
  };
  const auto is_known_pitch = [&](std::size_t i) {
    const Family& family = families[chosen[i].family];
    const bool is_any_of_many =
        i < periods.size() && periods[i] >= kManyPeriods && shapes_on_line_of(family.effect) > 2;
    return !is_any_of_many && is_pitch_or_no_wave(family, chosen[i]);
  };
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Family& one = families[chosen[i].family];
    if (!one.effect.traits().periodic) continue;
    const double period = chosen[i].nonlinear, travel = one.travel;
    for (std::size_t j = 0; j < chosen.size(); ++j) {
      const Family& other = families[chosen[j].family];
      if (i == j || !same_line(one.effect, other.effect)) continue;
      const bool two_causes = proved[i] && proved[j] && shapes_on_line_of(one.effect) == 2;
      if (is_jump(other.effect) && !two_causes && !is_known_pitch(i))
        return fmt::format(
            "a wave of {:.4g} {} explains the residual only together with a step: any shape can be described in this "
            "way",
            period, data.position_unit());
      if (j < i || !other.effect.traits().periodic) continue;
      const double period2 = chosen[j].nonlinear;
      const bool same = std::abs(period / period2 - 1.0) < kSamePeriod;
      if (same && one.effect.approach != other.effect.approach) continue;
      const double apart = std::abs(frequency_seen(data, one, period) - frequency_seen(data, other, period2));
      if (!data.rotary && apart * travel < kBeating)
        return fmt::format("waves of {:.4g} and {:.4g} mm beat: one wave whose size or period changes along the travel",
                           period, period2);
      if (!is_known_pitch(i) && !is_known_pitch(j) && !is_whole_fraction(period, period2))
        return fmt::format(
            "waves of {:.4g} and {:.4g} mm are unrelated and match no pitch of the machine: any shape can be described "
            "by enough waves",
            period, period2);
    }
  }
  return "";
}

std::optional<PitchMatch> pitch_matching(const EffectInstance& wave, const std::optional<double>& sigma_mm,
                                         const Observations& data) {
  const auto period = searched_value(wave);
  if (!wave.traits().periodic || !period || !wave.axis || wave.rotary) return std::nullopt;
  const auto& axis = data.machine.axes[index_of(*wave.axis)];
  if (!axis) return std::nullopt;
  for (const bool of_scale : {false, true}) {
    const std::optional<double>& pitch_mm = of_scale ? axis->scale_pitch_mm : axis->screw_pitch_mm;
    if (!pitch_mm) continue;
    for (int n = 1; n <= kMostOfPitch; ++n)
      for (const auto& [times, parts] : {std::pair(1, n), std::pair(n, 1)}) {
        const double expected_mm = *pitch_mm * times / parts, off = std::abs(*period - expected_mm);
        if (off >= kSamePeriod * expected_mm) continue;
        const bool excluded = sigma_mm && off > kSurelyOther * std::max(*sigma_mm, kLeastSigma * expected_mm);
        return PitchMatch{expected_mm, times, parts, of_scale, excluded};
      }
  }
  return std::nullopt;
}

bool are_one_wave(const EffectInstance& one, const EffectInstance& other) {
  const auto period = searched_value(one), period2 = searched_value(other);
  return one.traits().periodic && one.id == other.id && same_place(one, other) && one.approach != other.approach &&
         period && period2 && std::abs(*period / *period2 - 1.0) < kSamePeriod;
}

double waves_a_turn(const EffectInstance& wave) {
  const auto period_deg = searched_value(wave);
  if (!wave.traits().periodic || !period_deg || !wave.rotary) return 0.0;
  const double order = std::round(kWholeTurn_deg / *period_deg);
  return std::abs(*period_deg * order / kWholeTurn_deg - 1.0) > kSamePeriod ? 0.0 : order;
}

namespace {

constexpr std::string_view kPeriod = "period_mm", kSize = "amplitude_um", kSecondSize = "amplitude2_um";

auto estimate(auto& wave, std::string_view name) {
  return std::ranges::find(wave.parameters, name, &ParameterEstimate::name);
}

bool has_second_harmonic(const NamedWave& wave) {
  const auto has = [&](std::string_view name) { return estimate(wave, name) != wave.parameters.end(); };
  return wave.effect.traits().periodic && has(kPeriod) && has(kSize) && has(kSecondSize) &&
         estimate(wave, kSecondSize)->value > 0.0;
}

bool is_second_larger(const NamedWave& wave) { return estimate(wave, kSecondSize)->value > wave.size().value; }

/// As if its second harmonic were all of it. @pre it has one
NamedWave second_harmonic(NamedWave wave) {
  const auto first = estimate(wave, kSize), second = estimate(wave, kSecondSize), period = estimate(wave, kPeriod);
  first->value = second->value;
  first->sigma = second->sigma;
  first->undetermined = second->undetermined;
  period->value /= 2.0;
  wave.effect.fitted[period->name] = period->value;
  return wave;
}

}  // namespace

const ParameterEstimate& NamedWave::size() const { return *estimate(*this, kSize); }
const ParameterEstimate& NamedWave::period() const { return *estimate(*this, kPeriod); }

NamedWave larger_wave(const NamedWave& wave) {
  return has_second_harmonic(wave) && is_second_larger(wave) ? second_harmonic(wave) : wave;
}

std::optional<NamedWave> smaller_wave(const NamedWave& wave) {
  if (!has_second_harmonic(wave)) return std::nullopt;
  return is_second_larger(wave) ? wave : second_harmonic(wave);
}

std::optional<int> steps_a_turn(double step_deg) {
  constexpr double kRounding = 1e-3;  // of the targets as a file gives them
  const double steps = kWholeTurn_deg / step_deg;
  if (std::abs(steps - std::round(steps)) > kRounding) return std::nullopt;
  return static_cast<int>(std::round(steps));
}

std::vector<double> aliases_of(const EffectInstance& wave, const Observations& data) {
  const auto period = searched_value(wave);
  if (!wave.traits().periodic || !period || !wave.axis || !wave.sense || pitch_matching(wave, std::nullopt, data))
    return {};
  std::vector<double> targets_mm;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.on_path(k) || !data.through_chain.empty()) return {};
    if (data.axis[k] == *wave.axis && data.sense[k] == *wave.sense)
      targets_mm.push_back(data.position_mm[k][index_of(*wave.axis)]);
  }
  const auto step_mm = even_step_mm(targets_mm);
  if (!step_mm || *period <= *step_mm || (wave.rotary && !steps_a_turn(*step_mm))) return {};
  const double fewer = 1.0 / *step_mm - 1.0 / *period, more = 1.0 / *step_mm + 1.0 / *period;
  if (fewer * *period < 1.0 + 1e-6) return {1.0 / more};  // two targets a period: that is the wave itself
  return {1.0 / fewer, 1.0 / more};
}

bool may_be_wave(const EffectInstance& curve, const Observations& data) {
  const EffectTraits& traits = curve.traits();
  if (!traits.is_smooth || traits.of_approach || curve.rotary || !curve.axis || !curve.sense) return false;
  std::vector<double> targets_mm;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.on_path(k) || !data.through_chain.empty()) return false;
    if (data.axis[k] == *curve.axis && data.sense[k] == *curve.sense) targets_mm.push_back(data.p_mm(k, *curve.axis));
  }
  std::ranges::sort(targets_mm);
  const auto end = std::unique(targets_mm.begin(), targets_mm.end());
  return end - targets_mm.begin() < static_cast<std::ptrdiff_t>(kFewestWaveTargets);
}

namespace {

/// Readings of a pass below which its periodogram is left out: a mean, a slope and a wave leave four.
constexpr std::size_t kFewestInPassOfWave = 8;
/// Turns over the travel from which a shape is a wave; frequencies tried per 1/travel; targets a turn at the highest.
constexpr double kFewestTurnsOfWave = 2.0, kStepsATurn = 2.0, kTargetsATurn = 2.5;
constexpr double kOneInAMillion = 6.0;

struct Pass {
  std::vector<double> p_mm, value;
  std::string_view unit;  ///< of p_mm: "deg" instead where a rotary axis or a circle turns
};

/// Power of a pass at a frequency [turns a mm], complex: twice the mean of the values turned back.
std::complex<double> part_at(const Pass& pass, double turns_a_mm) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < pass.p_mm.size(); ++i)
    sum += std::polar(pass.value[i], 2.0 * std::numbers::pi * turns_a_mm * pass.p_mm[i]);
  return 2.0 * sum / static_cast<double>(pass.p_mm.size());
}

/// Power of noise at a frequency, of its mean over all frequencies: 1 of white noise, more at long periods where
/// neighbouring readings are alike beside the wave itself (an autoregression of first order: Box and Jenkins
/// 1976, 3.2).
double background_at(const std::map<std::size_t, Pass>& passes, double turns_a_mm, double step_mm) {
  double neighbours = 0.0, squares = 0.0;
  for (const auto& [number, pass] : passes) {
    const std::complex<double> part = part_at(pass, turns_a_mm);
    double last = 0.0;
    for (std::size_t i = 0; i < pass.p_mm.size(); ++i) {
      const auto wave = part * std::polar(1.0, -2.0 * std::numbers::pi * turns_a_mm * pass.p_mm[i]);
      const double left = pass.value[i] - wave.real();
      neighbours += left * last;
      squares += left * left;
      last = left;
    }
  }
  if (neighbours <= 0.0 || neighbours >= squares) return 1.0;
  const double alike = neighbours / squares;
  const double turned = 2.0 * alike * std::cos(2.0 * std::numbers::pi * turns_a_mm * step_mm);
  return std::max(1.0, (1.0 - alike * alike) / (1.0 - turned + alike * alike));
}

}  // namespace

std::optional<FreeWave> free_wave(const Observations& data, const Eigen::VectorXd& residual,
                                  const std::vector<bool>& left_out) {
  const std::vector<std::size_t> number = passes_of(data);
  std::map<std::pair<Channel, Axis>, std::map<std::size_t, Pass>> lines;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (left_out[k]) continue;
    Pass& pass = lines[{data.channel(k), data.axis[k]}][number[k]];
    pass.p_mm.push_back(data.along_of(k));
    pass.unit = data.unit_along(k);
    pass.value.push_back(residual(static_cast<Eigen::Index>(k)));
  }
  std::optional<FreeWave> strongest;
  for (auto& [line, passes] : lines) {
    std::erase_if(passes, [](const auto& each) { return each.second.p_mm.size() < kFewestInPassOfWave; });
    if (passes.size() < 2) continue;
    double square = 0.0, count = 0.0, travel = 0.0, densest = 0.0;
    for (auto& [pass_number, pass] : passes) {
      const auto [least, greatest] = std::ranges::minmax_element(pass.p_mm);
      travel = std::max(travel, *greatest - *least);
      densest = std::max(densest, static_cast<double>(pass.p_mm.size()));
      for (const double v : pass.value) square += v * v;
      count += static_cast<double>(pass.value.size());
    }
    if (travel <= 0.0 || square <= 0.0) continue;
    // half a turn below the shortest that the targets show: there a wave has but one phase
    const double highest = 0.5 * densest - 1.0, lowest = kFewestTurnsOfWave;
    const double frequencies = std::max(1.0, highest - lowest);
    for (int step = 0; lowest + step / kStepsATurn <= highest; ++step) {
      const double turns = lowest + step / kStepsATurn;
      double power = 0.0;
      for (const auto& [pass_number, pass] : passes)
        power += 0.5 * std::norm(part_at(pass, turns / travel)) * static_cast<double>(pass.p_mm.size());
      const double freedom = 2.0 * static_cast<double>(passes.size());
      const double white = power * count / square, looks = std::log(kStepsATurn * frequencies);
      const auto minus_log_p = [&](double ratio) {
        return -(ln_chi2_tail(ratio, freedom) + looks) / std::numbers::ln10;
      };
      if (minus_log_p(white) <= kOneInAMillion) continue;
      const FreeWave wave{travel / turns, passes.begin()->second.unit,
                          minus_log_p(white / background_at(passes, turns / travel, travel / densest))};
      if (wave.minus_log_p > kOneInAMillion && (!strongest || wave.minus_log_p > strongest->minus_log_p))
        strongest = wave;
    }
  }
  return strongest;
}

namespace {

/// Usual time from one reading of a pass to the next; 0 where no pass has two.
double interval_in_passes_s(const Observations& data) {
  const std::vector<std::size_t> number = passes_of(data);
  std::map<std::size_t, double> last_s;
  std::vector<double> intervals_s;
  for (std::size_t k = 0; k < data.time_s.size(); ++k) {
    if (std::isnan(data.time_s[k])) continue;
    const auto [last, is_first] = last_s.try_emplace(number[k], data.time_s[k]);
    if (!is_first) intervals_s.push_back(std::abs(data.time_s[k] - std::exchange(last->second, data.time_s[k])));
  }
  return intervals_s.empty() ? 0.0 : upper_median(std::move(intervals_s));
}

/// Sine and cosine; 0 where the time is not known.
Eigen::MatrixXd wave_in_time(const Observations& data, double period_s) {
  Eigen::MatrixXd wave = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), 2);
  for (std::size_t k = 0; k < data.time_s.size(); ++k) {
    if (std::isnan(data.time_s[k])) continue;
    const double angle = 2.0 * std::numbers::pi * data.time_s[k] / period_s;
    wave.row(static_cast<Eigen::Index>(k)) << std::sin(angle), std::cos(angle);
  }
  return wave;
}

std::map<Channel, std::vector<std::size_t>> rows_of_channels(const Observations& data) {
  std::map<Channel, std::vector<std::size_t>> rows;
  for (std::size_t k = 0; k < data.size(); ++k) rows[data.channel(k)].push_back(k);
  return rows;
}

/// What a wave takes from χ² in one channel. Noise does not reach from one channel to another: Whitener.
class GainInChannel {
 public:
  GainInChannel(const Space& alone, std::vector<std::size_t> rows)
      : rows_(std::move(rows)), q_(alone.q(rows_, Eigen::all)), y_(alone.y(rows_)) {}
  [[nodiscard]] double of(const Eigen::MatrixXd& white) const {
    const Eigen::MatrixXd wave = white(rows_, Eigen::all), absorbed = q_.transpose() * wave;
    const Eigen::VectorXd products = wave.transpose() * y_;
    const Eigen::MatrixXd squares = wave.transpose() * wave - absorbed.transpose() * absorbed;
    return (products.transpose() * solved_symmetric(squares, products)).value();
  }
  /// Of a sine and a cosine.
  [[nodiscard]] double price() const { return 2.0 * std::log(static_cast<double>(rows_.size())); }
  [[nodiscard]] const std::vector<std::size_t>& rows() const { return rows_; }

 private:
  std::vector<std::size_t> rows_;
  Eigen::MatrixXd q_;
  Eigen::VectorXd y_;
};

}  // namespace

std::optional<double> period_in_time_s(const Observations& data, const Whitener& whitener, const Space& alone,
                                       double score) {
  constexpr double kTurbulence_s = 60.0;  // what is faster is noise
  constexpr double kFarMore = 100.0;
  constexpr int kFiner = 10;  // steps from the best to its neighbour: a step costs a wave a hundredth of its square
  double session_s = 0.0, readings = 0.0;
  for (const double t : data.time_s) {
    if (std::isnan(t)) continue;
    session_s = std::max(session_s, t);
    readings += 1.0;
  }
  // If clocks restart, the runs have times in common. A wave that no single pass resolves is not reported.
  const double shortest_s = std::max(kTurbulence_s, 2.0 * interval_in_passes_s(data));
  const double highest = std::min(readings / kTargetsATurn, session_s / shortest_s);
  if (highest < kFewestTurnsOfWave) return std::nullopt;
  std::vector<GainInChannel> channels;
  for (auto& [channel, rows] : rows_of_channels(data)) channels.emplace_back(alone, std::move(rows));
  double most = 0.0, period_s = 0.0;
  const auto look_at = [&](double turns) {
    const Eigen::MatrixXd white = whitener(wave_in_time(data, session_s / turns));
    double gain = 0.0;
    for (const GainInChannel& channel : channels) gain += std::max(0.0, channel.of(white) - channel.price());
    if (gain <= most) return;
    most = gain;
    period_s = session_s / turns;
  };
  for (int step = 0; kFewestTurnsOfWave + step / kStepsATurn <= highest; ++step)
    look_at(kFewestTurnsOfWave + step / kStepsATurn);
  if (most <= 0.0) return std::nullopt;
  const double coarse = session_s / period_s;
  if (score > 0.0)  // it has to be better than effects, which are refined too
    for (int step = -kFiner; step <= kFiner; ++step) look_at(coarse + step / (kFiner * kStepsATurn));
  // what the channels show together: the model may have terms in common
  const Eigen::MatrixXd white = whitener(wave_in_time(data, period_s));
  Space beside = alone;
  double paid = 2.0 * std::log(std::max(1.0, kFiner * (highest - kFewestTurnsOfWave)));
  for (const GainInChannel& channel : channels) {
    if (channel.of(white) <= channel.price()) continue;
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(white.rows(), white.cols());
    columns(channel.rows(), Eigen::all) = white(channel.rows(), Eigen::all);
    absorb(beside, columns);
    paid += channel.price();
  }
  const double gain = alone.chi2() - beside.chi2() - paid;
  return gain < score + 2.0 * std::log(kFarMore) ? std::nullopt : std::optional(period_s);
}

std::string objection_by_wave_in_time(double period_s) {
  return fmt::format(
      "a wave in time with a period of {:.2g} min explains the readings better than all effects together. Look for a "
      "cause outside the machine with this period (cooling, air conditioning)",
      period_s / 60.0);
}

bool is_mostly_wave_in_time(const Observations& data, double period_s, const Eigen::VectorXd& residual,
                            const std::vector<bool>& left_out) {
  constexpr double kMost = 0.5;
  const Eigen::MatrixXd wave = wave_in_time(data, period_s);
  return std::ranges::any_of(rows_of_channels(data), [&](const auto& channel) {
    std::vector<std::size_t> rows = channel.second;
    std::erase_if(rows, [&](std::size_t k) { return left_out[k]; });
    if (static_cast<double>(rows.size()) < kManyDegrees) return false;
    const auto n = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(n, 3);
    Eigen::VectorXd values(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto row = static_cast<Eigen::Index>(rows[static_cast<std::size_t>(i)]);
      columns.row(i).tail(2) = wave.row(row);
      values(i) = residual(row);
    }
    return least_squares(columns, values).squares_left < kMost * values.squaredNorm();
  });
}

}  // namespace ecs::model
