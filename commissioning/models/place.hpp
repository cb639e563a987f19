// What a model says at one place of the machine, and over its whole volume: answers of `ecs model compare`.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "model/fit/compare.hpp"

namespace ecs::commissioning {

/// Each effect's share in each sense at one place.
struct PlaceShares {
  model::PointQuery query;            ///< of the first sense
  std::vector<Sense> senses;          ///< EX EY EZ, or the one asked for
  std::vector<model::Breakdown> per;  ///< as many
};

/// @param words  "x=100,y=-20,z=0,axis=X,approach=1", also sense, time_s, feed_mm_min, load_kg, t_<sensor>_degC.
/// Without
///               an axis, each sense is taken along its own. A usage problem for anything else
/// @param fitted  with values
[[nodiscard]] Result<PlaceShares> shares_at(const model::Model& fitted, const std::optional<params::Machine>& machine,
                                            const std::string& words);
[[nodiscard]] Cell shares_cell(const PlaceShares& shares);

/// The predicted error over the volume, for both approaches.
struct PredictedVolume {
  std::vector<model::VolumePoint> forward;
  std::vector<model::VolumePoint> reverse;
};
/// A usage problem without a machine: only it knows the travels.
[[nodiscard]] Result<PredictedVolume> volume_of(const model::Model& fitted,
                                                const std::optional<params::Machine>& machine,
                                                std::size_t points_per_axis);
[[nodiscard]] Cell volume_cell(const PredictedVolume& volume);
/// x_mm,y_mm,z_mm,approach,EX_um,EY_um,EZ_um
[[nodiscard]] std::string to_csv(const PredictedVolume& volume);

}  // namespace ecs::commissioning
