#include "ecs_emulator/hidden_cases/background.hpp"

#include <algorithm>

#include "ecs_emulator/effects/places.hpp"
#include "ecs_emulator/effects/registry.hpp"
#include "ecs_emulator/effects/shape.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

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

std::optional<PlacedEffect> line_of(const PlacedEffect& effect) {
  if (effect.kind->line.empty()) return std::nullopt;
  return at_place(*effect_named(effect.kind->line), effect.axis, effect.sense);
}

std::vector<PlacedEffect> draw_background(Random& random, const Scene& scene, const Ground& ground,
                                          const Reserved& reserved, Absorbed& absorbed) {
  return Background(random, scene, ground, reserved, absorbed).draw();
}

}  // namespace ecs::emulator
