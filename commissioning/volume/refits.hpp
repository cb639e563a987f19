// Fits of what the same machine could have shown instead: how far the values of a model may be off.
// Does not live here: what follows for a volume (repair.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// The largest of so many equally likely results is exceeded by the next one with a chance of 1/20.
inline constexpr std::size_t kRefits = 19;

/// Parametric bootstrap: readings of the fit with noise drawn anew (white and correlated, by sense), fitted again.
/// @param fit  of `model` to `data`
struct Refit {
  model::Fit fit;
  /// The same with places that every value between two neighbouring targets fits alike, such as that of a step, drawn
  /// from there; nothing where the model has none.
  std::optional<model::Fit> displaced;
};
[[nodiscard]] std::vector<Refit> refits(const model::Model& model, const model::Observations& data,
                                        const model::Fit& fit, std::size_t count, std::uint64_t seed);

}  // namespace ecs::commissioning
