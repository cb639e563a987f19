// Where `ecs model repair` looks: places of the volume and of a circle, and the tables that the map has between them;
// the model fitted again to simulated readings. Does not live here: what is left there (repair.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/maps/machine_map.hpp"
#include "model/fit/fit.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

using Places = std::vector<MachinePlace>;

/// In the plane of the two longest travels through the middle, run counter-clockwise: each axis arrives as it moves.
struct Circle {
  std::size_t first = 0, second = 1;  ///< axes of the plane
  double diameter_mm = 0.0;           ///< 0: the machine has one axis only
  Places places;
};
[[nodiscard]] Circle circle_of(const params::Machine& machine);

/// Places of the volume, each from both sides; the reference comes last.
struct VolumePlaces {
  Places places;
  std::vector<double> weight;  ///< share of the volume that a place stands for; of the reference 0
};

/// Points of the tables of a map that `map build --from-model` makes, machine coordinates [mm]; none where no axis is.
using TablePoints = PerAxis<std::vector<double>>;
[[nodiscard]] TablePoints tables_of(const params::Machine& machine, const model::Model& model);

/// The points of an axis's table on either side of a position: between them the unit interpolates straight lines.
[[nodiscard]] std::array<double, 2> points_about(const std::vector<double>& table_mm, double position_mm);

/// Even places; on the axis of a wave enough for it, and beside a step of which nobody knows where it falls between two
/// targets (targets_about) its place in this machine and the climb of the map.
/// @param most  without waves and steps @param possible  what the machine may have @param fit  what the map has
[[nodiscard]] VolumePlaces volume_places(const params::Machine& machine, std::size_t most, const model::Fit& possible,
                                         const model::Fit& fit, const model::Observations& data,
                                         const TablePoints& tables_mm);

/// The largest of this many equally likely results is exceeded by the next one with a chance of 1/20.
inline constexpr std::size_t kRefits = 19;

/// The neighbouring targets between which every place of the effect fits alike, such as that of a step, from the datum
/// of its axis [mm]; nothing where the effect has no such place or it is held.
[[nodiscard]] std::optional<std::array<double, 2>> targets_about(const model::EffectInstance& effect,
                                                                 const model::Observations& data);

/// Parametric bootstrap: readings of the fit with noise drawn again (white and correlated, by sense), fitted again. A
/// place between two targets (targets_about) is drawn from there, one draw from each of `count` equal parts: all are
/// equally likely.
/// @param fit  of `model` to `data`
[[nodiscard]] std::vector<model::Fit> refits(const model::Model& model, const model::Observations& data,
                                             const model::Fit& fit, std::size_t count, std::uint64_t seed);

}  // namespace ecs::commissioning
