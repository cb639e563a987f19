// The unit applies its map at the wrong place, after a wrong reference: map(p + Δ) − map(p).
#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<double> shifts_mm(const Scene&, const Ground&, const PlacedEffect&) {
  return {-50.0, -20.0, -5.0, 5.0, 20.0, 50.0};
}

}  // namespace

extern const EffectDefinition kMapShift{
    .id = "map_shift",
    .seat = Seat::unit,
    .parameters = {{.name = "shift_mm", .unit = "mm", .search = shifts_mm}},
    .elsewhere = kFaultOfTheMap,
    .spoil = [](const PlacedEffect& e, MapReading& reading) { reading.position_mm += e.parameter("shift_mm"); },
    .needs = {.map = true, .translations = true},
    .places = in_map,
    .draw =
        [](const Drawing& drawing, PlacedEffect& e) {
          const double sign = sign_of_chance(drawing.random);
          e.parameters["shift_mm"] = rounded(sign * log_between(drawing.random, 5.0, 60.0), 10.0);
          return true;
        },
    .fixed_size = true,
};

}  // namespace ecs::emulator
