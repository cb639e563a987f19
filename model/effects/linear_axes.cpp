// Scale of X, Y and Z and their squareness as readings of a ball show them: an axis moves as far as the ball is from
// the pivots, while the ball stays (ISO 230-1; ISO 10791-6, BK1 to BK4, which ask for linear axes without such errors).
#include <array>

#include "model/effects/artefact_place.hpp"

namespace ecs::model {
namespace {

constexpr std::array<ComponentTerm, 6> kLinearAxes{{{"x_um_per_m", Component::EXX},
                                                    {"y_um_per_m", Component::EYY},
                                                    {"z_um_per_m", Component::EZZ},
                                                    {"c0y_um_per_m", Component::C0Y},
                                                    {"b0z_um_per_m", Component::B0Z},
                                                    {"a0z_um_per_m", Component::A0Z}}};

}  // namespace

std::span<const ComponentTerm> components_of(const EffectDefinition& effect) {
  if (effect.place != Place::artefact || effect.carrier != Carrier::error_map || !effect.motions.empty() ||
      effect.bending != nullptr)
    return {};
  return kLinearAxes;
}

}  // namespace ecs::model

namespace ecs::model::effects {

EffectDefinition linear_axes() {
  return {
      .id = "linear_axes",
      .title = "Scale and squareness of X, Y and Z",
      .formula = "scale k p and squareness of X, Y and Z",
      .cause = "scale or squareness of the linear axes, which follow the ball",
      .tells_apart = "grows with the distance that the linear axes move while a rotary axis turns",
      .check = "measure the positioning of X, Y and Z with a laser, and their squareness with a square",
      .headline = "scale and squareness errors of the linear axes: {sizes}",
      .parameters = {{"x_um_per_m", "um/m", "scale of X"},
                     {"y_um_per_m", "um/m", "scale of Y"},
                     {"z_um_per_m", "um/m", "scale of Z"},
                     {"c0y_um_per_m", "um/m", "squareness C0Y of X and Y"},
                     {"b0z_um_per_m", "um/m", "squareness B0Z of X and Z"},
                     {"a0z_um_per_m", "um/m", "squareness A0Z of Y and Z"}},
      .carrier = Carrier::error_map,
      .how = "tables of the error map and squareness among the unit's parameters; measure the ball again with them",
      .separated_by =
          {94,
           "Measure the ball at a second place that differs in one linear axis, and with a second length of "
           "tool: an error of the linear axes changes with the distance that they move."},
      .traits = {.on_rotary_axes = true},
      .place = Place::artefact,
      .preference = 60,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const ThroughChain& chain = at.data.through_chain[at.k];
            for (std::size_t i = 0; i < row.size(); ++i) row[i] = chain.of_linear[i];
          },
      .column_sets = {{0}, {1}, {2}, {3}, {4}, {5}, {0, 1, 2}, {3, 4, 5}, {0, 1, 2, 3, 4, 5}},
      .of_sense = [](const Site& site) { return once_for_ball(site); },
  };
}

}  // namespace ecs::model::effects
