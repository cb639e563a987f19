// Following error in readings taken on the fly, c·feed·d (the inverse of the velocity gain).
#include "model/effects/definition.hpp"

namespace ecs::model::effects {

EffectDefinition servo_lag() {
  return {
      .id = "servo_lag",
      .title = "Following error",
      .formula = "c feed d",
      .cause = "readings taken on the fly lag behind",
      .tells_apart = "changes sign with the approach and grows with the feed",
      .check =
          "read the following error of the drive at two feeds, or repeat with a dwell before each reading: it is "
          "absent at rest",
      .headline = "a following error of {um_per_m_min} in {readings}, which were read on the fly",
      .parameters = {{"um_per_m_min", "um/(m/min)", "lag"}},
      .carrier = Carrier::set_up,
      .how = "the drive's gain; readings at rest do not show it",
      .separated_by = {40, "Repeat the {axis} line both ways at a quarter and at twice the feed."},
      .traits = {.of_approach = true, .in_motion = true},
      .needs = {Need::feed},
      .preference = 40,
      .columns = [](const ReadingAt& at,
                    std::span<double> row) { row[0] = at.data.feed_mm_min[at.k] / 1000.0 * at.approach(); },
      .of_reversal = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
