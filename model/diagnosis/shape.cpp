// Means of a residual over a variable, a line, a run or an approach; simple shapes of them compared by Schwarz's
// criterion (1978) on the means of repeated places; what one shape leaves is taken for at least the noise of those
// means, so that of shapes that all reach it the simplest is named. Waves by least squares over frequencies (Lomb 1976;
// Scargle 1982). Sentences for the shapes found.
#include "model/diagnosis/shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/bad_run.hpp"
#include "model/diagnosis/words.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Points below which no shape is looked for: four free parameters and as many to refute them.
constexpr std::size_t kFewestPoints = 8;

/// Means of a residual over places from 0 to 1.
struct Points {
  std::vector<double> place, mean, sigma;  ///< sigma of the mean
  double from = 0.0, to = 1.0;             ///< of the variable
  [[nodiscard]] std::size_t size() const { return mean.size(); }
  [[nodiscard]] double at(double place_of) const { return from + (to - from) * place_of; }
};

enum class ShapeKind { line, curve, jump, bump, wave, chirp, fading_wave };

struct ShapeFit {
  ShapeKind kind = ShapeKind::line;
  double left = 0.0;  ///< weighted squares
  double parameters = 1.0;
  double first = 0.0, second = 0.0;  ///< place; waves at both ends; sizes at both ends
  double waves = 0.0;
  double size = 0.0;
  Eigen::Vector3d sizes = Eigen::Vector3d::Zero();  ///< of a wave: mean, sine, cosine
  [[nodiscard]] double criterion(const Points& points) const {
    const double n = static_cast<double>(points.size());
    return n * std::log(std::max(left, n) / n) + parameters * std::log(n);
  }
};

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A shape is proved where it explains this share of what is above noise, and no other shape comes nearer than this to
/// its criterion: a Bayes factor of about 20. Choices.
constexpr double kLeastOfShape = 0.85, kClearMargin = 6.0;
/// Waves over the range that are tried: none slower than one and a half, none faster than the points show.
constexpr double kFewestWaves = 1.5, kPointsAWave = 2.5;
/// A period changes where the ends differ by this ratio; an amplitude dies where one end has this share of the other.
constexpr double kOtherPeriod = 1.25, kDead = 0.35;
constexpr double kWaveTurn = 2.0 * std::numbers::pi;
/// least, least + step, … up to most.
std::vector<double> steps(double least, double most, double step) {
  std::vector<double> values;
  for (int i = 0; least + i * step <= most; ++i) values.push_back(least + i * step);
  return values;
}

class ShapeSearch {
 public:
  explicit ShapeSearch(const Points& points)
      : points_(points),
        y_(static_cast<Index>(points.size())),
        inverse_sigma_(Eigen::Map<const ArrayXd>(points.sigma.data(), y_.size()).inverse()) {
    for (Index i = 0; i < y_.size(); ++i) y_(i) = mean(i) / sigma(i);
    constant_ = fitted({[](double) { return 1.0; }}, nullptr);
  }

  /// The shape that the points prove; nothing where none is, or two are about as good.
  [[nodiscard]] std::optional<ShapeFit> proved() const {
    const double n = static_cast<double>(y_.size());
    if (points_.size() < kFewestPoints || constant_ < 2.0 * n) return std::nullopt;
    std::vector<ShapeFit> fits{line(), curve(), jump(), bump(), wave(), chirp(), fading_wave()};
    std::ranges::sort(
        fits, [&](const ShapeFit& a, const ShapeFit& b) { return a.criterion(points_) < b.criterion(points_); });
    const ShapeFit& best = fits.front();
    if (1.0 - (best.left - n) / (constant_ - n) < kLeastOfShape) return std::nullopt;
    if (fits[1].criterion(points_) < best.criterion(points_) + kClearMargin && !is_form_of(fits[1], best))
      return std::nullopt;
    return best;
  }

  /// The best single wave.
  [[nodiscard]] ShapeFit wave() const {
    ShapeFit best{ShapeKind::wave, constant_, 4.0};
    const auto look = [&](double waves) { keep_better(best, fitted_to(turns(waves, 0.0), inverse_sigma_, waves)); };
    for (const double waves : steps(kFewestWaves, most_waves(), kStepOfWaves)) look(waves);
    const double middle = best.waves;
    for (int i = -kFineSteps; i <= kFineSteps && middle > 0.0; ++i) look(middle + i * kStepOfWaves / kFineSteps);
    best.first = best.second = best.waves;
    return best;
  }
  /// What is left of the means without a wave that was found.
  [[nodiscard]] std::vector<double> without(const ShapeFit& wave) const {
    std::vector<double> left = points_.mean;
    for (Index i = 0; i < y_.size(); ++i) {
      const double angle = phase(place(i), wave.waves, 0.0);
      left[static_cast<std::size_t>(i)] -=
          wave.sizes(0) + wave.sizes(1) * std::sin(angle) + wave.sizes(2) * std::cos(angle);
    }
    return left;
  }
  [[nodiscard]] double constant() const { return constant_; }

 private:
  using Function = std::function<double(double)>;
  static constexpr double kStepOfWaves = 0.25, kMostWavesOfChirp = 25.0;
  static constexpr int kFineSteps = 5;
  static double one(double) { return 1.0; }
  /// Phase of a wave with this many waves over the range, `bend` more a range at its end than at its beginning.
  static double phase(double x, double waves, double bend) {
    return kWaveTurn * (waves * x + 0.5 * bend * x * (x - 1.0));
  }
  [[nodiscard]] double place(Index i) const { return points_.place[static_cast<std::size_t>(i)]; }
  [[nodiscard]] double mean(Index i) const { return points_.mean[static_cast<std::size_t>(i)]; }
  [[nodiscard]] double sigma(Index i) const { return points_.sigma[static_cast<std::size_t>(i)]; }
  [[nodiscard]] double most_waves() const { return static_cast<double>(points_.size()) / kPointsAWave; }

  /// Weighted squares that functions leave.
  [[nodiscard]] double fitted(const std::vector<Function>& functions, VectorXd* sizes) const {
    MatrixXd columns(y_.size(), static_cast<Index>(functions.size()));
    for (std::size_t j = 0; j < functions.size(); ++j)
      for (Index i = 0; i < y_.size(); ++i) columns(i, static_cast<Index>(j)) = functions[j](place(i)) / sigma(i);
    const VectorXd solved = PivotedQr(columns).solve(y_);
    if (sizes != nullptr) *sizes = solved;
    return (y_ - columns * solved).squaredNorm();
  }

  /// Sine and cosine at the points.
  struct Turns {
    ArrayXd sine, cosine;
    /// Both turned further at each point.
    void turn_by(const Turns& more) {
      const ArrayXd turned = sine * more.cosine + cosine * more.sine;
      cosine = cosine * more.cosine - sine * more.sine;
      sine = turned;
    }
  };
  [[nodiscard]] Turns turns(double waves, double bend) const {
    Turns at{ArrayXd(y_.size()), ArrayXd(y_.size())};
    for (Index i = 0; i < y_.size(); ++i) {
      const double angle = phase(place(i), waves, bend);
      at.sine(i) = std::sin(angle);
      at.cosine(i) = std::cos(angle);
    }
    return at;
  }
  /// A mean and a wave: three sizes by the normal equations.
  [[nodiscard]] ShapeFit fitted_to(const Turns& turns, const ArrayXd& sizes, double waves) const {
    Eigen::Matrix<double, Eigen::Dynamic, 3> columns(y_.size(), 3);
    columns.col(0) = inverse_sigma_;
    columns.col(1) = turns.sine * sizes;
    columns.col(2) = turns.cosine * sizes;
    const Eigen::Matrix3d squares = columns.transpose().lazyProduct(columns);
    const Eigen::Vector3d products = columns.transpose().lazyProduct(y_);
    ShapeFit fit;
    fit.sizes = solved_symmetric(squares, products);
    fit.left = std::max(0.0, y_.squaredNorm() - fit.sizes.dot(products));
    fit.waves = waves;
    fit.size = fit.sizes.tail<2>().norm();
    return fit;
  }
  /// Kind and number of parameters stay.
  static void keep_better(ShapeFit& best, ShapeFit fit) {
    if (!(fit.left < best.left)) return;
    fit.kind = best.kind;
    fit.parameters = best.parameters;
    best = fit;
  }

  [[nodiscard]] ShapeFit line() const {
    ShapeFit fit{ShapeKind::line, 0.0, 2.0};
    VectorXd sizes;
    fit.left = fitted({one, [](double x) { return x; }}, &sizes);
    fit.size = sizes(1);
    return fit;
  }

  [[nodiscard]] ShapeFit curve() const {
    ShapeFit best = line();
    best.kind = ShapeKind::curve;
    std::vector<Function> functions{one, [](double x) { return x; }};
    for (int power = 2; power <= 5; ++power) {
      functions.emplace_back([power](double x) { return std::pow(2.0 * x - 1.0, power); });
      ShapeFit fit{ShapeKind::curve, 0.0, static_cast<double>(power) + 1.0};
      VectorXd sizes;
      fit.left = fitted(functions, &sizes);
      double least = kBeyondAll, greatest = -kBeyondAll;
      for (Index i = 0; i < y_.size(); ++i) {
        double value = 0.0;
        for (std::size_t j = 0; j < functions.size(); ++j)
          value += sizes(static_cast<Index>(j)) * functions[j](place(i));
        least = std::min(least, value);
        greatest = std::max(greatest, value);
      }
      fit.size = greatest - least;
      if (power == 2 || fit.criterion(points_) < best.criterion(points_)) best = fit;
    }
    return best;
  }

  [[nodiscard]] ShapeFit jump() const {
    ShapeFit best{ShapeKind::jump, constant_, 3.0};
    for (Index i = 1; i < y_.size(); ++i) {
      const double edge = 0.5 * (place(i - 1) + place(i));
      VectorXd sizes;
      const double left = fitted({one, [=](double x) { return x > edge ? 1.0 : 0.0; }}, &sizes);
      if (left < best.left) best = {ShapeKind::jump, left, 3.0, edge, 0.0, 0.0, sizes(1), Eigen::Vector3d::Zero()};
    }
    return best;
  }

  [[nodiscard]] ShapeFit bump() const {
    ShapeFit best{ShapeKind::bump, constant_, 4.0};
    for (Index i = 1; i + 1 < y_.size(); ++i)
      for (const double width : {0.02, 0.04, 0.07}) {
        const double centre = place(i);
        VectorXd sizes;
        const double left =
            fitted({one, [=](double x) { return std::exp(-0.5 * std::pow((x - centre) / width, 2)); }}, &sizes);
        if (left < best.left) best = {ShapeKind::bump, left, 4.0, centre, 0.0, 0.0, sizes(1), Eigen::Vector3d::Zero()};
      }
    return best;
  }

  [[nodiscard]] ShapeFit chirp() const {
    constexpr double kStepOfBend = 2.0 * kStepOfWaves;
    ShapeFit best{ShapeKind::chirp, constant_, 5.0};
    const Turns more = turns(0.0, kStepOfBend);
    for (const double waves : steps(kFewestWaves, std::min(most_waves(), kMostWavesOfChirp), kStepOfWaves)) {
      Turns now = turns(waves, -1.5 * waves);
      for (const double bend : steps(-1.5 * waves, 1.5 * waves, kStepOfBend)) {
        ShapeFit fit = fitted_to(now, inverse_sigma_, waves);
        now.turn_by(more);
        fit.first = waves - 0.5 * bend;
        fit.second = waves + 0.5 * bend;
        keep_better(best, fit);
      }
    }
    return best;
  }

  /// Sizes fall by e^(−decay·x), or by e^(decay·(1 − x)) where that is negative.
  [[nodiscard]] ShapeFit fading_wave() const {
    ShapeFit best{ShapeKind::fading_wave, constant_, 5.0};
    std::vector<std::pair<double, ArrayXd>> fading;
    for (const double decay : {-6.0, -3.5, -2.0, -1.0, 1.0, 2.0, 3.5, 6.0}) {
      ArrayXd& sizes = fading.emplace_back(decay, inverse_sigma_).second;
      for (Index i = 0; i < y_.size(); ++i)
        sizes(i) *= decay >= 0.0 ? std::exp(-decay * place(i)) : std::exp(decay * (1.0 - place(i)));
    }
    for (const double waves : steps(kFewestWaves, most_waves(), kStepOfWaves)) {
      const Turns now = turns(waves, 0.0);
      for (const auto& [decay, sizes] : fading) {
        ShapeFit fit = fitted_to(now, sizes, waves);
        fit.first = decay > 0.0 ? 1.0 : std::exp(decay);
        fit.second = decay > 0.0 ? std::exp(-decay) : 1.0;
        keep_better(best, fit);
      }
    }
    return best;
  }

  /// A general shape that is the special one with more parameters does not speak against it.
  [[nodiscard]] static bool is_form_of(const ShapeFit& general, const ShapeFit& special) {
    if (special.kind == ShapeKind::line) return general.kind == ShapeKind::curve;
    return special.kind == ShapeKind::wave &&
           (general.kind == ShapeKind::chirp || general.kind == ShapeKind::fading_wave) &&
           general.parameters > special.parameters;
  }

  const Points& points_;
  VectorXd y_;  ///< in standard deviations
  ArrayXd inverse_sigma_;
  double constant_ = 0.0;
};

/// The shape is what its name says, not the limit of another.
bool is_itself(const ShapeFit& fit) {
  if (fit.kind == ShapeKind::chirp)
    return fit.first > 0.0 && fit.second > 0.0 &&
           std::max(fit.first, fit.second) > kOtherPeriod * std::min(fit.first, fit.second);
  if (fit.kind == ShapeKind::fading_wave)
    return std::min(fit.first, fit.second) < kDead * std::max(fit.first, fit.second);
  return true;
}

/// The shape that explains most of what is above noise, where no other does nearly as well; none if the data prove none
/// or it is the limit of another shape.
std::optional<ShapeFit> proved_shape(const Points& points) {
  const auto fit = ShapeSearch(points).proved();
  return fit && is_itself(*fit) ? fit : std::nullopt;
}

/// The best wave of one period and size.
ShapeFit wave_in(const Points& points) { return ShapeSearch(points).wave(); }

/// The means with that wave taken off.
std::vector<double> means_without(const Points& points, const ShapeFit& wave) {
  return ShapeSearch(points).without(wave);
}

/// Weighted squares about their common mean.
double squares_about_mean(const Points& points) { return ShapeSearch(points).constant(); }

/// Means at the utmost: a choice; more cost time, fewer hide short waves.
constexpr std::size_t kMostPoints = 120;

/// Means over equal values of a variable, or over equal shares of the readings where there are more than `most`.
template <class Value>
Points points_over(const VectorXd& residual, double noise_um, const std::vector<std::size_t>& rows, const Value& value,
                   std::size_t most, double tolerance) {
  std::vector<std::pair<double, double>> pairs;
  for (const std::size_t k : rows)
    if (!std::isnan(value(k))) pairs.emplace_back(value(k), residual(static_cast<Index>(k)));
  std::ranges::sort(pairs);
  Points points;
  if (pairs.empty() || pairs.back().first <= pairs.front().first) return points;
  points.from = pairs.front().first;
  points.to = pairs.back().first;
  const std::size_t least = (pairs.size() + most - 1) / most;
  for (std::size_t from = 0; from < pairs.size();) {
    std::size_t to = from + 1;
    double place = pairs[from].first, sum = pairs[from].second;
    while (to < pairs.size() && (pairs[to].first - pairs[from].first <= tolerance || to - from < least)) {
      place += pairs[to].first;
      sum += pairs[to++].second;
    }
    const double n = static_cast<double>(to - from);
    points.place.push_back((place / n - points.from) / (points.to - points.from));
    points.mean.push_back(sum / n);
    points.sigma.push_back(std::max(noise_um, kLeastDivisor) / std::sqrt(n));
    from = to;
  }
  return points;
}

std::string with_unit(double value, std::string_view unit) { return fmt::format("{} {}", in_digits(value), unit); }

/// @param unit  of the variable  @param name  "X", "time": where the shape runs along  @param um  unit of the readings
std::string words_of(const ShapeFit& fit, const Points& points, std::string_view unit, const std::string& name,
                     std::string_view um) {
  const double range = points.to - points.from;
  const auto period = [&](double waves) { return range / waves; };
  const auto end = [&](bool last) {
    return fmt::format("{} = {}", name, with_unit(last ? points.to : points.from, unit));
  };
  switch (fit.kind) {
    case ShapeKind::line:
      return fmt::format("a straight line, {:+.3g} {} from {} to {}", fit.size, um, end(false), end(true));
    case ShapeKind::curve:
      return fmt::format("a smooth curve over {}, {} from smallest to largest", name, with_unit(fit.size, um));
    case ShapeKind::jump:
      return fmt::format("a jump of {:+.3g} {} at {} = {}", fit.size, um, name, with_unit(points.at(fit.first), unit));
    case ShapeKind::bump:
      return fmt::format("a bump of {:+.3g} {} near {} = {}", fit.size, um, name,
                         with_unit(points.at(fit.first), unit));
    case ShapeKind::wave:
      return fmt::format("a wave of {} and a period of {} along {}", with_unit(fit.size, um),
                         with_unit(period(fit.waves), unit), name);
    case ShapeKind::chirp: {
      const double first = period(fit.first), second = period(fit.second);
      return fmt::format("a wave of {} whose period {} from {} to {} along {}", with_unit(fit.size, um),
                         second > first ? "grows" : "falls", in_digits(first), with_unit(second, unit), name);
    }
    default:
      return fmt::format("a wave with a period of {} whose amplitude decays towards {}",
                         with_unit(period(fit.waves), unit), end(fit.first > fit.second));
  }
}

std::string proved_words(const Points& points, std::string_view unit, const std::string& name, std::string_view um) {
  const auto fit = proved_shape(points);
  return fit ? words_of(*fit, points, unit, name, um) : "";
}

/// Rows of the sense in which most is left, and of the axis that moves there most.
struct MainLine {
  Channel channel = 0;
  Axis axis = Axis::X;
  std::vector<std::size_t> rows;
};
MainLine main_line(const Observations& data, const VectorXd& residual, const std::vector<bool>& left_out) {
  std::map<std::pair<Channel, Axis>, double> squares;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k])
      squares[{data.channel(k), data.axis[k]}] += residual(static_cast<Index>(k)) * residual(static_cast<Index>(k));
  MainLine line;
  double most = -1.0;
  for (const auto& [place, sum] : squares)
    if (sum > most) {
      most = sum;
      line.channel = place.first;
      line.axis = place.second;
    }
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k] && data.channel(k) == line.channel && data.axis[k] == line.axis) line.rows.push_back(k);
  return line;
}

std::string_view unit_of_readings(const Observations& data, const MainLine& line) {
  return laser::unit_of(data.sense[line.rows.front()]);
}

/// What runs along a line: "X", of a path "angle_deg"; and its unit.
std::string name_along(const Observations& data, const MainLine& line) {
  return data.on_path(line.rows.front()) ? std::string(variable_along(data.path_of(line.rows.front())))
                                         : std::string(1, data.letter(line.axis));
}
std::string_view unit_along(const Observations& data, const MainLine& line) {
  const std::size_t first = line.rows.front();
  return data.on_path(first) && data.path_of(first).kind == PathKind::circle ? "deg" : data.position_unit();
}

Points along_axis_of(const Observations& data, const VectorXd& residual, double noise_um, const MainLine& line) {
  return points_over(
      residual, noise_um, line.rows,
      [&](std::size_t k) { return data.on_path(k) ? data.along[k] : data.position_mm[k][index_of(line.axis)]; },
      kMostPoints, 10.0 * kSamePlace_mm);
}

std::string approach_words(const Observations& data, const VectorXd& residual, double noise_um, const MainLine& line) {
  VectorXd half = residual;
  double forward = 0.0, reverse = 0.0, n_forward = 0.0, n_reverse = 0.0;
  for (const std::size_t k : line.rows) {
    const double r = residual(static_cast<Index>(k));
    half(static_cast<Index>(k)) = r * data.approach[k];
    (data.approach[k] > 0 ? forward : reverse) += data.approach[k] == 0 ? 0.0 : r;
    (data.approach[k] > 0 ? n_forward : n_reverse) += data.approach[k] == 0 ? 0.0 : 1.0;
  }
  if (n_forward < 2.0 || n_reverse < 2.0) return "";
  const double difference = forward / n_forward - reverse / n_reverse;
  const double sigma = noise_um * std::sqrt(1.0 / n_forward + 1.0 / n_reverse);
  const std::string shape = proved_words(along_axis_of(data, half, noise_um, line), unit_along(data, line),
                                         name_along(data, line), unit_of_readings(data, line));
  if (!shape.empty()) return fmt::format("half the difference of the directions is {}", shape);
  if (std::abs(difference) < 4.0 * sigma) return "";
  return fmt::format("forward lies {:+.3g} {} from reverse", difference, unit_of_readings(data, line));
}

std::string run_words(const Observations& data, const VectorXd& residual, double noise_um, const MainLine& line) {
  std::map<int, std::vector<double>> runs;
  for (const std::size_t k : line.rows) runs[data.run[k]].push_back(residual(static_cast<Index>(k)));
  if (runs.size() < 3) return "";
  std::vector<double> means, sigmas;
  std::vector<int> names;
  for (const auto& [run, values] : runs) {
    double sum = 0.0;
    for (const double v : values) sum += v;
    means.push_back(sum / static_cast<double>(values.size()));
    sigmas.push_back(noise_um / std::sqrt(static_cast<double>(values.size())));
    names.push_back(run);
  }
  const auto spread = [&](std::size_t without) {  // of the means, weighted squares about their mean
    double n = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < means.size(); ++i)
      if (i != without) {
        n += 1.0;
        sum += means[i];
      }
    for (std::size_t i = 0; i < means.size(); ++i)
      if (i != without) squares += std::pow((means[i] - sum / n) / sigmas[i], 2);
    return std::pair{squares, sum / n};
  };
  const double all = spread(means.size()).first;
  if (all < 8.0 * static_cast<double>(means.size())) return "";
  std::size_t apart = 0;
  for (std::size_t i = 1; i < means.size(); ++i)
    if (spread(i).first < spread(apart).first) apart = i;
  if (spread(apart).first < 0.1 * all)
    return fmt::format("run {} lies {:+.3g} {} from the others", names[apart], means[apart] - spread(apart).second,
                       unit_of_readings(data, line));
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  const double n = static_cast<double>(means.size());
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double x = static_cast<double>(i);
    sx += x;
    sy += means[i];
    sxx += x * x;
    sxy += x * means[i];
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), start = (sy - slope * sx) / n;
  double left = 0.0;
  for (std::size_t i = 0; i < means.size(); ++i)
    left += std::pow((means[i] - start - slope * static_cast<double>(i)) / sigmas[i], 2);
  if (means.size() >= 4 && left < 0.15 * all)
    return fmt::format("a trend by run, {:+.3g} {} from run {} to run {}", slope * (n - 1.0),
                       unit_of_readings(data, line), names.front(), names.back());
  if (const auto step = step_of_runs(data, residual, std::vector<bool>(data.size())))
    return fmt::format(
        "a step of {:+.2g} {} between runs {} and {} in addition to a trend; range of the means of the runs {:.3g} {}",
        step->height_um, unit_of_readings(data, line), step->before, step->after,
        *std::ranges::max_element(means) - *std::ranges::min_element(means), unit_of_readings(data, line));
  return fmt::format("each run has a different zero, with a range of {:.3g} {}",
                     *std::ranges::max_element(means) - *std::ranges::min_element(means), unit_of_readings(data, line));
}

constexpr std::size_t kBinsOfTime = 40, kBinsOfCondition = 24;

std::string_view unit_of_variable(const std::string& variable) {
  for (const std::string_view unit : {"degC", "hPa", "pct", "kg", "mm_min", "mm", "s"})
    if (variable.ends_with(fmt::format("_{}", unit))) return unit == "mm_min" ? "mm/min" : unit == "pct" ? "%RH" : unit;
  return "";
}

}  // namespace

std::string shape_in_words(const Observations& data, const VectorXd& residual, double noise_um,
                           const std::vector<bool>& left_out, const std::string& variable) {
  const MainLine line = main_line(data, residual, left_out);
  if (variable == "approach") return approach_words(data, residual, noise_um, line);
  if (variable == "run") return run_words(data, residual, noise_um, line);
  for (const Axis axis : kAllAxes)
    if (variable == data.position_name(axis))
      return proved_words(
          points_over(
              residual, noise_um, line.rows, [&](std::size_t k) { return data.position_mm[k][index_of(axis)]; },
              kMostPoints, 10.0 * kSamePlace_mm),
          data.position_unit(), std::string(1, data.letter(axis)), unit_of_readings(data, line));
  const Points points = points_over(
      residual, noise_um, line.rows, [&](std::size_t k) { return variable_of(data, k, variable); },
      variable == "time_s" || variable == "row" ? kBinsOfTime : kBinsOfCondition, 0.0);
  const bool is_angle = variable == name_along(data, line);
  return proved_words(points, is_angle ? unit_along(data, line) : unit_of_variable(variable),
                      variable == "time_s" ? "time" : variable, unit_of_readings(data, line));
}

std::string spectrum_in_words(const Observations& data, const VectorXd& residual, double noise_um,
                              const std::vector<bool>& left_out) {
  constexpr std::size_t kMostPeriods = 3;
  constexpr double kLeastShareOfWave = 0.1;
  const MainLine line = main_line(data, residual, left_out);
  Points points = along_axis_of(data, residual, noise_um, line);
  if (points.size() < kFewestPoints) return "";
  std::vector<std::string> periods;
  const double all = squares_about_mean(points), n = static_cast<double>(points.size());
  const double least = n + 20.0;  // what noise leaves, and a wave that it shows in one of thousands of sets
  double before = all;
  while (periods.size() < kMostPeriods && before > least) {
    const ShapeFit wave = wave_in(points);
    if (before - wave.left < std::max(kLeastShareOfWave * (all - n), 20.0)) break;
    periods.push_back(fmt::format("{} ({:.0f} %)",
                                  with_unit((points.to - points.from) / wave.waves, unit_along(data, line)),
                                  kPercent * (before - wave.left) / all));
    points.mean = means_without(points, wave);
    before = wave.left;
  }
  return periods.empty() ? "" : fmt::format("periods along {}: {}", name_along(data, line), fmt::join(periods, ", "));
}

void describe_what_is_left(Diagnosis& diagnosis, const Observations& data, const std::vector<double>& residual,
                           const std::vector<bool>& left_out) {
  constexpr double kWorthWords = 0.05, kClearlyStronger = 0.1;  // shares of the residual variance
  const VectorXd left = Eigen::Map<const VectorXd>(residual.data(), static_cast<Index>(residual.size()));
  double strongest = 0.0;  // of the others: any order of runs is an order of rows
  for (const Dependence& one : diagnosis.where)
    if (one.variable != "row") strongest = std::max(strongest, one.strength);
  std::erase_if(diagnosis.where, [&](const Dependence& one) {
    return one.variable == "row" && one.strength < strongest + kClearlyStronger;
  });
  for (Dependence& one : diagnosis.where)
    if (one.strength >= kWorthWords)
      one.looks_like = shape_in_words(data, left, diagnosis.noise.noise_um, left_out, one.variable);
  const std::string spectrum = spectrum_in_words(data, left, diagnosis.noise.noise_um, left_out);
  if (!spectrum.empty()) diagnosis.notes.push_back(fmt::format("residual by {}", spectrum));
}

}  // namespace ecs::model
