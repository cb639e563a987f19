// The error vector over the travels, predicted before and after compensation: by the map, or by an error model that
// knows all that the map holds. Nothing here was measured across the volume.
// Does not live here: how it is reckoned (controllers/residual.hpp), how it is shown (volume_section.cpp).
#pragma once

#include <optional>
#include <string>

#include "controllers/residual.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::app {

struct PredictedVolume {
  [[nodiscard]] bool from_map() const { return from == "the map"; }
  std::string from;                 ///< "the map", or "the error model"
  std::string remark;               ///< why not from the model that was given; empty: none was, or it is from it
  std::string travels;              ///< "X 0 … 1000 mm, …"
  bool travels_of_machine = false;  ///< false: as far as the map reaches
  std::size_t places = 0;
  PerAxis<bool> present{};
  controllers::ResidualSize before;  ///< nothing compensated
  controllers::ResidualSize after;   ///< the unit with its parameters and the whole map
};

/// @param model  fitted; null: none was given
[[nodiscard]] Result<PredictedVolume> predicted_volume(const laser::ErrorMap& map, const UnitParameters& parameters,
                                                       const std::optional<params::Machine>& machine,
                                                       const model::Model* model);

}  // namespace ecs::app
