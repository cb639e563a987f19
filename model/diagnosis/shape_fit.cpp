// Shapes compared by Schwarz's criterion (1978) on the means of repeated places; what one shape leaves is taken for at
// least the noise of those means, so that of shapes that all reach it the simplest is named. Waves by least squares
// over frequencies (Lomb 1976; Scargle 1982).
#include "model/diagnosis/shape_fit.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <utility>

#include "model/data/curve_basis.hpp"
#include "model/fit/statistics.hpp"
#include "model/linear/decompositions.hpp"

namespace ecs::model {
namespace {

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
  explicit ShapeSearch(const Points& points) : points_(points), y_(static_cast<Index>(points.size())) {
    for (Index i = 0; i < y_.size(); ++i) y_(i) = mean(i) / sigma(i);
    constant_ = fitted({[](double) { return 1.0; }}, nullptr);
  }

  /// The shape that the points prove; nothing where none is, or two are about as good.
  [[nodiscard]] std::optional<ShapeFit> proved() const {
    const double n = static_cast<double>(y_.size());
    if (points_.size() < kFewestPoints || constant_ < 2.0 * n) return std::nullopt;
    std::vector<ShapeFit> fits{line(), curve(), jump(), bump(), wave(), chirp(), fading_wave()};
    std::sort(fits.begin(), fits.end(),
              [&](const ShapeFit& a, const ShapeFit& b) { return a.criterion(points_) < b.criterion(points_); });
    const ShapeFit& best = fits.front();
    if (1.0 - (best.left - n) / (constant_ - n) < kLeastOfShape) return std::nullopt;
    if (fits[1].criterion(points_) < best.criterion(points_) + kClearMargin && !is_form_of(fits[1], best))
      return std::nullopt;
    return best;
  }

  /// The best single wave.
  [[nodiscard]] ShapeFit wave() const {
    ShapeFit best{ShapeKind::wave, constant_, 4.0};
    const auto look = [&](double waves) { keep_better(best, wave_at(waves, 0.0, 0.0)); };
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
  /// Phase of a wave with so many waves over the range, `bend` more a range at its end than at its beginning.
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

  /// A wave with sizes that fall by e^(−decay·x), or by e^(decay·(1 − x)) where that is negative: three sizes by the
  /// normal equations.
  [[nodiscard]] ShapeFit wave_at(double waves, double bend, double decay) const {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d products = Eigen::Vector3d::Zero();
    for (Index i = 0; i < y_.size(); ++i) {
      const double x = place(i), angle = phase(x, waves, bend);
      const double size = decay >= 0.0 ? std::exp(-decay * x) : std::exp(decay * (1.0 - x));
      const Eigen::Vector3d row = Eigen::Vector3d(1.0, size * std::sin(angle), size * std::cos(angle)) / sigma(i);
      squares += row * row.transpose();
      products += y_(i) * row;
    }
    ShapeFit fit;
    fit.sizes = squares.ldlt().solve(products);
    fit.left = std::max(0.0, y_.squaredNorm() - fit.sizes.dot(products));
    fit.waves = waves;
    fit.size = std::hypot(fit.sizes(1), fit.sizes(2));
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
    ShapeFit best{ShapeKind::chirp, constant_, 5.0};
    for (const double waves : steps(kFewestWaves, std::min(most_waves(), kMostWavesOfChirp), kStepOfWaves))
      for (const double bend : steps(-1.5 * waves, 1.5 * waves, 2.0 * kStepOfWaves)) {
        ShapeFit fit = wave_at(waves, bend, 0.0);
        fit.first = waves - 0.5 * bend;
        fit.second = waves + 0.5 * bend;
        keep_better(best, fit);
      }
    return best;
  }

  [[nodiscard]] ShapeFit fading_wave() const {
    ShapeFit best{ShapeKind::fading_wave, constant_, 5.0};
    for (const double waves : steps(kFewestWaves, most_waves(), kStepOfWaves))
      for (const double decay : {-6.0, -3.5, -2.0, -1.0, 1.0, 2.0, 3.5, 6.0}) {
        ShapeFit fit = wave_at(waves, 0.0, decay);
        fit.first = decay > 0.0 ? 1.0 : std::exp(decay);
        fit.second = decay > 0.0 ? std::exp(-decay) : 1.0;
        keep_better(best, fit);
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

}  // namespace

std::optional<ShapeFit> proved_shape(const Points& points) {
  const auto fit = ShapeSearch(points).proved();
  return fit && is_itself(*fit) ? fit : std::nullopt;
}

ShapeFit wave_in(const Points& points) { return ShapeSearch(points).wave(); }

std::vector<double> means_without(const Points& points, const ShapeFit& wave) {
  return ShapeSearch(points).without(wave);
}

double squares_about_mean(const Points& points) { return ShapeSearch(points).constant(); }

}  // namespace ecs::model
