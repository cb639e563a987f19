// Scale of X, Y and Z and their squareness as readings of a ball show them: an axis moves as far as the ball is from
// the pivots, while the ball stays (ISO 230-1; ISO 10791-6, BK1 to BK4, which ask for linear axes without such errors).
#include <array>
#include <string>

#include "model/effects/artefact_place.hpp"

namespace ecs::model::effects {
namespace {

/// Every rotary axis carries the tool and lies beyond the linear ones, so that these err in the frame of the bed.
bool all_in_head(const std::string& letters) {
  const std::size_t tool = letters.find('T'), first = letters.find_first_of("ABC");
  return tool != std::string::npos && first != std::string::npos && first > tool && first > letters.find_last_of("XYZ");
}

/// Scale of X, Y, Z along themselves, then C0Y, B0Z, A0Z: E_X = -C0Y Y + B0Z Z, E_Y = -A0Z Z (docs/physics.md).
std::array<double, 2 * kAxes> linear_errors(const Observations& data, std::size_t k) {
  std::array<double, 2 * kAxes> row{};
  if (data.place_mm.empty() || is_rotation(data.sense[k])) return row;
  const auto sense = static_cast<std::size_t>(data.sense[k]);
  const Vector3& place_mm = data.place_mm[k];
  row[sense] = place_mm[sense] / 1000.0;
  if (data.sense[k] == Sense::EX) {
    row[kAxes] = -place_mm[1] / 1000.0;
    row[kAxes + 1] = place_mm[2] / 1000.0;
  } else if (data.sense[k] == Sense::EY) {
    row[kAxes + 2] = -place_mm[2] / 1000.0;
  }
  return row;
}

}  // namespace

EffectDefinition linear_axes() {
  return {
      .id = "linear_axes",
      .title = "Scale and squareness of X, Y and Z",
      .formula = "k p of X, Y, Z; C0Y, B0Z, A0Z; through the chain",
      .cause = "scale or squareness of the linear axes, which follow the ball",
      .tells_apart = "grows with the distance that the linear axes move while a rotary axis turns",
      .check = "measure the positioning of X, Y and Z with a laser, and their squareness with a square",
      .headline = "Linear axes with scale and squareness errors: {sizes}",
      .parameters = {{"x_um_per_m", "um/m", "scale of X"},
                     {"y_um_per_m", "um/m", "scale of Y"},
                     {"z_um_per_m", "um/m", "scale of Z"},
                     {"c0y_um_per_m", "um/m", "squareness C0Y of X and Y"},
                     {"b0z_um_per_m", "um/m", "squareness B0Z of X and Z"},
                     {"a0z_um_per_m", "um/m", "squareness A0Z of Y and Z"}},
      .carrier = Carrier::none,
      .how = "measure the linear axes on their own, compensate them, then measure the ball again",
      .separated_by =
          {94,
           "Measure the ball at a second place that differs in one linear axis, and with a second length of "
           "tool: an error of the linear axes changes with the distance that they move."},
      .traits = {.on_rotary_axes = true},
      .place = Place::artefact,
      .preference = 60,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const auto all = linear_errors(at.data, at.k);
            for (std::size_t i = 0; i < row.size(); ++i) row[i] = all[i];
          },
      .of_sense =
          [](const Site& site) {
            return all_in_head(site.data.machine.rotary_configuration) ? once_for_ball(site)
                                                                       : std::vector<EffectInstance>{};
          },
  };
}

}  // namespace ecs::model::effects
