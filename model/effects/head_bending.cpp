// A head that its own weight bends: with the tilting angle b of the rotary axis next to the tool the moment of gravity
// changes as sin b, the share across it as 1 - cos b (a beam under its own weight, Timoshenko 1925). The shift is one
// in the frame of the part that carries that axis.
#include <array>
#include <cmath>
#include <numbers>

#include "model/effects/artefact_place.hpp"

namespace ecs::model::effects {
namespace {

/// The rotary axis next to the tool, where one carries it.
std::optional<Axis> tilting_axis(const Observations& data) {
  const std::string& letters = data.machine.rotary_configuration;
  const std::size_t last = letters.find_last_of("ABCT");
  return last == std::string::npos || letters[last] == 'T' ? std::nullopt
                                                           : std::optional(static_cast<Axis>(letters[last] - 'A'));
}

}  // namespace

EffectDefinition head_bending() {
  return {
      .id = "head_bending",
      .title = "Bending of the head",
      .formula = "s sin b + c (1 - cos b), in the frame that carries the tilting axis",
      .cause = "head or spindle bent by its own weight, which the tilting axis turns",
      .tells_apart = "follows sine and cosine of the tilting angle; even and odd in its sign",
      .check = "hang a weight on the head at +90 and -90 degrees and watch the tool with a gauge",
      .headline = "Head bent as it tilts: {sizes}",
      .parameters = {{"x_sin_um", "um", "along X with sin b"},
                     {"y_sin_um", "um", "along Y"},
                     {"z_sin_um", "um", "along Z"},
                     {"x_cos_um", "um", "along X with 1 - cos b"},
                     {"y_cos_um", "um", "along Y"},
                     {"z_cos_um", "um", "along Z"}},
      .carrier = Carrier::none,
      .how = "the unit has no input for the angles of rotary axes",
      .separated_by = {53,
                       "Measure the ball at pairs of +b and -b of the tilting axis, with two lengths of tool: a shift "
                       "of the axis line does not change with the length, bending does."},
      .traits = {.on_rotary_axes = true},
      .place = Place::artefact,
      .preference = 65,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            constexpr std::array kAlong{Sense::EX, Sense::EY, Sense::EZ};
            const Axis axis = tilting_axis(at.data).value_or(Axis::X);  // without one its errors reach nothing
            const double b = at.data.position_mm[at.k][index_of(axis)] * std::numbers::pi / 180.0;
            const std::array<double, 2> part{std::sin(b), 1.0 - std::cos(b)};
            for (std::size_t i = 0; i < row.size(); ++i)
              row[i] = part[i / kAxes] * at.data.share_of(at.k, axis, kAlong[i % kAxes]);
          },
      .of_sense =
          [](const Site& site) {
            return tilting_axis(site.data) ? once_for_ball(site) : std::vector<EffectInstance>{};
          },
  };
}

}  // namespace ecs::model::effects
