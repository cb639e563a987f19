// A wave of a screw or scale, two harmonics: A·sin(2πp/P + φ) + A₂·sin(4πp/P + φ₂); both approaches or one.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

constexpr double kMostWaves = 60.0;  ///< that are tried over a travel

/// Periods at which to try it: ever closer, as many waves as the targets can show.
std::vector<double> periods_mm(const Scene&, const Ground& ground, const PlacedEffect& effect) {
  std::vector<double> periods;
  const auto& places = ground.cover(*effect.sense, *effect.axis).places_mm;
  const double length_mm = places.back() - places.front();
  const double most = std::min(kMostWaves, static_cast<double>(places.size()) / 2.0);
  for (double waves = 1.0; waves < most; waves *= 1.0 + 0.2 / (waves + 1.0)) periods.push_back(length_mm / waves);
  return periods;
}

/// A period that the machine's facts suggest, or any.
double draw_period_mm(Random& random, const Scene& scene, Axis axis) {
  const auto pitch = scene.machine.axes[index_of(axis)]->screw_pitch_mm;
  if (pitch && chance(random, 0.7)) return *pitch * one(random, std::vector{1.0, 1.0, 1.0, 1.0, 2.0, 0.5});
  return rounded(log_between(random, 4.0, 40.0), 1000.0);
}

/// The targets show a wave of this period without taking it for another.
bool period_shows(const Scene& scene, const std::vector<double>& places, double period_mm) {
  const double length_mm = places.back() - places.front();
  const double step_mm = length_mm / static_cast<double>(places.size() - 1);
  if (length_mm < 3.0 * period_mm) return false;
  return scene.even_grid ? period_mm > 2.5 * step_mm : places.size() >= 16;
}

bool draw_cyclic(const Drawing& drawing, PlacedEffect& e) {
  const auto& [random, scene, ground, sign] = drawing;
  const auto& cover = ground.cover(*e.sense, *e.axis);
  const double period_mm = draw_period_mm(random, scene, *e.axis);
  if (!period_shows(scene, cover.places_mm, period_mm)) return false;
  e.parameters = {{"period_mm", period_mm},
                  {"amplitude_um", 1.4},
                  {"phase_rad", rounded(between(random, 0.0, 2.0 * std::numbers::pi), 1000.0)},
                  {"amplitude2_um", 0.0},
                  {"phase2_rad", 0.0}};
  if (period_shows(scene, cover.places_mm, period_mm / 2.0) && chance(random, 0.4)) {
    e.parameters["amplitude2_um"] = 1.4 * between(random, 0.2, 0.7);
    e.parameters["phase2_rad"] = rounded(between(random, 0.0, 2.0 * std::numbers::pi), 1000.0);
  }
  if (cover.both_ways && scene.shown.approach && chance(random, 0.3))
    e.approach = chance(random, 0.5) ? Approach::forward : Approach::reverse;
  return true;
}

/// Sine and cosine of either harmonic.
std::vector<PlacedEffect> cyclic_units(const PlacedEffect& effect) {
  std::vector<PlacedEffect> units;
  for (const double phase : {0.0, std::numbers::pi / 2.0}) {
    PlacedEffect first = effect;
    first.parameters["amplitude_um"] = 1.0;
    first.parameters["phase_rad"] = phase;
    first.parameters["amplitude2_um"] = 0.0;
    units.push_back(first);
    PlacedEffect second = effect;
    second.parameters["amplitude_um"] = 0.0;
    second.parameters["amplitude2_um"] = 1.0;
    second.parameters["phase2_rad"] = phase;
    units.push_back(second);
  }
  return units;
}

}  // namespace

extern const EffectDefinition kCyclic{
    .id = "cyclic",
    .parameters = {{.name = "period_mm", .unit = "mm", .range = kPositive, .search = periods_mm},
                   {.name = "amplitude_um", .unit = "um", .growth = Growth::linear},
                   {.name = "phase_rad", .unit = "rad", .optional = true},
                   {.name = "amplitude2_um", .unit = "um", .growth = Growth::linear, .optional = true},
                   {.name = "phase2_rad", .unit = "rad", .optional = true}},
    .needs_axis = true,
    .value =
        [](const PlacedEffect& e, const Conditions& at) {
          const double turn = 2.0 * std::numbers::pi * at.p_mm / e.parameter("period_mm");
          return e.parameter("amplitude_um") * std::sin(turn + e.parameter("phase_rad")) +
                 e.parameter("amplitude2_um") * std::sin(2.0 * turn + e.parameter("phase2_rad"));
        },
    .needs = {.fine = true},
    .places = on_all_axes,
    .draw = draw_cyclic,
    .units = cyclic_units,
    .base_probability = 0.35,
};

}  // namespace ecs::emulator
