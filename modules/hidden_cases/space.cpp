#include "modules/hidden_cases/space.hpp"

#include <algorithm>
#include <cmath>

#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/effects/drawing.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {
namespace {

constexpr double kSmallStep = 1e-4;  ///< of a parameter, for a slope
constexpr double kNothing = 1e-7;    ///< of its size: what is left of a column that is absorbed already

double distance(const Eigen::MatrixXd& left_columns, const Eigen::VectorXd& left, const EffectDefinition& kind) {
  if (kind.fixed_size) return (left - left_columns.col(0)).norm();
  if (left_columns.cols() == 1) {
    const double length2 = left_columns.col(0).squaredNorm();
    const double coefficient = left_columns.col(0).dot(left) / length2;
    if (has_one_sign(kind) && coefficient < 0.0) return left.norm();
    return (left - coefficient * left_columns.col(0)).norm();
  }
  Absorbed own(static_cast<std::size_t>(left.size()));
  own.add(left_columns);
  return own.left_of(left).norm();
}

constexpr double kLeastInFreeBase = 0.08;  ///< how often a free base holds an effect at a good place

bool same_place(const PlacedEffect& a, const PlacedEffect& b) { return name_of(a) == name_of(b); }

class Background {
 public:
  Background(Random& random, const Scene& scene, const Ground& ground, const Reserved& reserved, Absorbed& absorbed)
      : random_(random), scene_(scene), ground_(ground), reserved_(reserved), absorbed_(absorbed) {
    for (const PlacedEffect& hidden : reserved.hidden) hidden_.push_back(vector_of(contribution(scene, hidden)));
    most_functions_ = std::min<Eigen::Index>(45, static_cast<Eigen::Index>(scene.stops.size()) / 8);
  }

  std::vector<PlacedEffect> draw() {
    for (const EffectDefinition* kind : effects())
      if (kind->in_every_base)
        for (const PlacedEffect& place : good_places(scene_, ground_, *kind)) take(place, 0.0);
    for (const PlacedEffect& place : reserved_.needed) take(place, 0.0);
    std::vector<PlacedEffect> wanted;
    for (const EffectDefinition* kind : effects())
      if (const double probability = base_probability(*kind); probability > 0.0)
        for (const PlacedEffect& place : good_places(scene_, ground_, *kind))
          if (chance(random_, probability)) wanted.push_back(place);
    shuffle(random_, wanted);
    const std::size_t most = taken_.size() + static_cast<std::size_t>(whole(random_, 1, 4)) + ground_.senses.size();
    for (const PlacedEffect& place : wanted)
      if (taken_.size() < most) take_with_its_line(place);
    return std::move(taken_);
  }

 private:
  [[nodiscard]] double base_probability(const EffectDefinition& kind) const {
    if (!reserved_.free || kind.seat == Seat::unit) return kind.base_probability;
    return std::max(kind.base_probability, kLeastInFreeBase);
  }

  /// A curve without mean and slope comes with the effect that has them.
  void take_with_its_line(const PlacedEffect& place) {
    const auto line = line_of(place);
    if (line && !holds(*line) && !take(*line, 0.1)) return;
    take(place, 0.1);
  }

  [[nodiscard]] bool holds(const PlacedEffect& place) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const auto& t) { return same_place(t, place); });
  }
  [[nodiscard]] bool is_free(const PlacedEffect& place) const {
    return !holds(place) && (place.kind->excluded_from & reserved_.design) == 0 &&
           std::none_of(reserved_.hidden.begin(), reserved_.hidden.end(),
                        [&](const auto& hidden) { return same_place(hidden, place); });
  }

  /// @param share  least part of its mean square that the model did not hold before
  bool take(const PlacedEffect& place, double share) {
    if (!is_free(place)) return false;
    const auto effect = with_shape(random_, scene_, ground_, place);
    if (!effect) return false;
    const Eigen::MatrixXd columns = contribution_columns(scene_, ground_, *effect);
    const Eigen::VectorXd own = vector_of(contribution(scene_, *effect));
    if (rms_of(own) == 0.0 || absorbed_.size() + columns.cols() > most_functions_) return false;
    if (absorbed_.left_of(own).squaredNorm() < share * own.squaredNorm()) return false;
    Absorbed more = absorbed_;
    more.add(columns);
    if (reserved_.free) more.add(slope_columns(scene_, *effect));
    for (const Eigen::VectorXd& hidden : hidden_)
      if (more.left_of(hidden).squaredNorm() < kLeastShare * hidden.squaredNorm()) return false;
    absorbed_ = more;
    taken_.push_back(*effect);
    return true;
  }

  Random& random_;
  const Scene& scene_;
  const Ground& ground_;
  const Reserved& reserved_;
  Absorbed& absorbed_;
  std::vector<Eigen::VectorXd> hidden_;
  std::vector<PlacedEffect> taken_;
  Eigen::Index most_functions_ = 45;
};

}  // namespace

Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

double rms_of(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

Eigen::MatrixXd contribution_columns(const Scene& scene, const Ground& ground, const PlacedEffect& effect) {
  const auto units = unit_effects(ground, effect);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), static_cast<Eigen::Index>(units.size()));
  for (std::size_t k = 0; k < units.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = vector_of(contribution(scene, units[k]));
  return columns;
}

Eigen::MatrixXd slope_columns(const Scene& scene, const PlacedEffect& effect) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(scene.stops.size()), 0);
  for (const ParameterDefinition& parameter : effect.kind->parameters) {
    if (parameter.search == nullptr) continue;
    const auto at = [&](double factor) {
      PlacedEffect moved = effect;
      moved.parameters[std::string(parameter.name)] *= factor;
      return vector_of(contribution(scene, moved));
    };
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
    columns.rightCols(1) = at(1.0 + kSmallStep) - at(1.0 - kSmallStep);
  }
  return columns;
}

void Absorbed::add(const Eigen::MatrixXd& columns) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const double size = columns.col(k).norm();
    if (!(size > 0.0)) continue;
    Eigen::VectorXd left = columns.col(k) / size;
    for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
    if (left.norm() < kNothing) continue;
    basis_.conservativeResize(Eigen::NoChange, basis_.cols() + 1);
    basis_.col(basis_.cols() - 1) = left.normalized();
  }
}

Eigen::MatrixXd Absorbed::left_of(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = columns;
  for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
  for (Eigen::Index k = 0; k < left.cols(); ++k)
    if (left.col(k).norm() < kNothing * columns.col(k).norm()) left.col(k).setZero();
  return left;
}

Eigen::VectorXd Absorbed::left_of(const Eigen::VectorXd& values) const {
  Eigen::VectorXd left = values;
  for (int twice = 0; twice < 2; ++twice) left -= basis_ * (basis_.transpose() * left);
  return left;
}

std::vector<Rival> rivals_of(const Scene& scene, const Ground& ground, const Absorbed& absorbed,
                             const Eigen::VectorXd& hidden, double sigma_um, bool flexible,
                             const std::function<bool(const Rival&)>& enough) {
  const Eigen::VectorXd left = absorbed.left_of(hidden);
  std::vector<Rival> rivals;
  for (const EffectDefinition* kind : effects()) {
    if (is_flexible(*kind) && !flexible) continue;
    for (const PlacedEffect& place : possible_places(scene, ground, *kind)) {
      Rival rival{place, left.norm() / sigma_um, 0.0, is_flexible(*kind)};
      for (const PlacedEffect& trial : trials_of(scene, ground, place)) {
        const Eigen::MatrixXd columns = contribution_columns(scene, ground, trial);
        if (columns.cols() == 0) continue;
        const Eigen::MatrixXd left_columns = absorbed.left_of(columns);
        if (left_columns.norm() == 0.0) continue;
        const double separation = distance(left_columns, left, *kind) / sigma_um;
        if (separation < rival.separation) {
          rival.separation = separation;
          rival.effect = trial;
          rival.size =
              left_columns.cols() == 1 ? left_columns.col(0).dot(left) / left_columns.col(0).squaredNorm() : 1.0;
        }
      }
      rivals.push_back(rival);
      if (enough && enough(rival)) return rivals;
    }
  }
  return rivals;
}

std::optional<PlacedEffect> line_of(const PlacedEffect& effect) {
  if (effect.kind->line.empty()) return std::nullopt;
  return at_place(*effect_named(effect.kind->line), effect.axis, effect.sense);
}

std::vector<PlacedEffect> draw_background(Random& random, const Scene& scene, const Ground& ground,
                                          const Reserved& reserved, Absorbed& absorbed) {
  return Background(random, scene, ground, reserved, absorbed).draw();
}

}  // namespace ecs::emulator
