#include "ecs_emulator/hidden_cases/background.hpp"

#include <algorithm>

#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

struct Chance {
  EffectKind kind;
  double probability;
};
/// How often an engineer's model holds such an effect at a place where it can be.
constexpr std::array<Chance, 16> kChances{{{EffectKind::scale, 0.6},
                                           {EffectKind::progressive, 0.35},
                                           {EffectKind::cyclic, 0.35},
                                           {EffectKind::backlash, 0.4},
                                           {EffectKind::reversal_curve, 0.08},
                                           {EffectKind::step, 0.05},
                                           {EffectKind::sag, 0.08},
                                           {EffectKind::angular, 0.3},
                                           {EffectKind::squareness, 0.5},
                                           {EffectKind::measurement_line, 0.3},
                                           {EffectKind::thermal_scale, 0.4},
                                           {EffectKind::thermal_drift, 0.1},
                                           {EffectKind::warm_up, 0.03},
                                           {EffectKind::time_drift, 0.12},
                                           {EffectKind::servo_lag, 0.1},
                                           {EffectKind::load, 0.15}}};

bool same_place(const PlacedEffect& a, const PlacedEffect& b) { return place_of(a) == place_of(b); }

class Background {
 public:
  Background(Random& random, const Scene& scene, const Ground& ground, const Reserved& reserved, Absorbed& absorbed)
      : random_(random), scene_(scene), ground_(ground), reserved_(reserved), absorbed_(absorbed) {
    for (const PlacedEffect& hidden : reserved.hidden) hidden_.push_back(vector_of(contribution(scene, hidden)));
    most_functions_ = std::min<Eigen::Index>(45, static_cast<Eigen::Index>(scene.stops.size()) / 8);
  }

  std::vector<PlacedEffect> draw() {
    if (!reserved_.without_offset)
      for (const PlacedEffect& place : good_places(scene_, ground_, EffectKind::offset)) take(place, 0.0);
    for (const PlacedEffect& place : reserved_.needed) take(place, 0.0);
    std::vector<PlacedEffect> wanted;
    for (const auto& [kind, probability] : kChances)
      for (const PlacedEffect& place : good_places(scene_, ground_, kind))
        if (chance(random_, probability)) wanted.push_back(place);
    shuffle(random_, wanted);
    const std::size_t most = taken_.size() + static_cast<std::size_t>(whole(random_, 1, 4)) + ground_.senses.size();
    for (const PlacedEffect& place : wanted)
      if (taken_.size() < most) take_with_its_line(place);
    return std::move(taken_);
  }

 private:
  /// A curve without mean and slope stands beside an effect that has them.
  void take_with_its_line(PlacedEffect place) {
    const EffectKind kind = place.kind;
    if (kind == EffectKind::progressive || kind == EffectKind::reversal_curve) {
      PlacedEffect line = place;
      line.kind = kind == EffectKind::progressive ? EffectKind::scale : EffectKind::backlash;
      if (!holds(line) && !take(line, 0.1)) return;
    }
    take(place, 0.1);
  }

  [[nodiscard]] bool holds(const PlacedEffect& place) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const auto& t) { return same_place(t, place); });
  }
  [[nodiscard]] bool is_free(const PlacedEffect& place) const {
    const auto& no = reserved_.without;
    return !holds(place) && std::find(no.begin(), no.end(), place.kind) == no.end() &&
           std::none_of(reserved_.hidden.begin(), reserved_.hidden.end(),
                        [&](const auto& hidden) { return same_place(hidden, place); });
  }

  /// @param share  least part of its mean square that the model did not hold before
  bool take(const PlacedEffect& place, double share) {
    if (!is_free(place)) return false;
    const auto effect = with_shape(random_, scene_, ground_, place);
    if (!effect) return false;
    const Eigen::MatrixXd columns = columns_of(scene_, ground_, *effect);
    const Eigen::VectorXd own = vector_of(contribution(scene_, *effect));
    if (rms_of(own) == 0.0 || absorbed_.size() + columns.cols() > most_functions_) return false;
    if (absorbed_.left_of(own).squaredNorm() < share * own.squaredNorm()) return false;
    Absorbed more = absorbed_;
    more.add(columns);
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

std::vector<PlacedEffect> draw_background(Random& random, const Scene& scene, const Ground& ground,
                                          const Reserved& reserved, Absorbed& absorbed) {
  return Background(random, scene, ground, reserved, absorbed).draw();
}

}  // namespace ecs::emulator
