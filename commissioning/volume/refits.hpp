// Fits of what the same machine could have shown instead: how far the values of a model may be off.
// Does not live here: what follows for a volume (repair.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// The largest of so many equally likely results is exceeded by the next one with a chance of 1/20.
inline constexpr std::size_t kRefits = 19;

/// The neighbouring targets between which every place of the effect fits alike, such as that of a step, from the datum
/// of its axis [mm]; nothing where the effect has no such place or it is held.
[[nodiscard]] std::optional<std::array<double, 2>> targets_about(const model::EffectInstance& effect,
                                                                 const model::Observations& data);

/// Parametric bootstrap: readings of the fit with noise drawn anew (white and correlated, by sense), fitted again. A
/// place between two targets (targets_about) is drawn from there, one draw from each of `count` equal parts: all are
/// equally likely.
/// @param fit  of `model` to `data`
[[nodiscard]] std::vector<model::Fit> refits(const model::Model& model, const model::Observations& data,
                                             const model::Fit& fit, std::size_t count, std::uint64_t seed);

}  // namespace ecs::commissioning
