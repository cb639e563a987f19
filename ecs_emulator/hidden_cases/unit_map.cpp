#include "ecs_emulator/hidden_cases/unit_map.hpp"

#include "ecs_emulator/effects/smooth_curve.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {

void draw_map(Random& random, Scene& scene, const Ground& ground, bool two_tables) {
  for (const Sense s : ground.senses) {
    for (const Axis a : kAllAxes) {
      const auto& cover = ground.cover(s, a);
      if (!cover.moved || is_rotation(s)) continue;
      SmoothCurve shape = draw_curve(random, cover.places_mm);
      shape.slope = random.normal();
      SmoothCurve difference = draw_curve(random, cover.places_mm);
      difference.mean = random.normal();
      UnitTable table{a, s, two_tables ? Approach::forward : Approach::unknown, {}, {}};
      UnitTable reverse{a, s, Approach::reverse, {}, {}};
      const double from_mm = cover.places_mm.front();
      const double to_mm = cover.places_mm.back();
      const int count = whole(random, 12, 60);
      for (int k = 0; k <= count; ++k) {
        const double p_mm = from_mm + (to_mm - from_mm) * k / count;
        table.p_mm.push_back(rounded(p_mm + scene.datum_mm[index_of(a)], 1000.0));
        const double half = two_tables ? 0.5 * value_at(difference, p_mm) : 0.0;
        table.value.push_back(value_at(shape, p_mm) + half);
        reverse.value.push_back(value_at(shape, p_mm) - half);
      }
      reverse.p_mm = table.p_mm;
      scene.map.push_back(table);
      if (two_tables) scene.map.push_back(reverse);
    }
  }
  scene.shown.compensated = chance(random, 0.6);
}

void draw_known(Random& random, Scene& scene, const Ground& ground) {
  std::vector<Axis> moved;
  for (const Sense s : ground.senses)
    for (const Axis a : kAllAxes)
      if (ground.cover(s, a).moved && ground.cover(s, a).places_mm.size() >= 8) moved.push_back(a);
  if (moved.empty()) return;
  const Axis axis = one(random, moved);
  const Component code = curve_of(static_cast<Sense>(3 + whole(random, 0, 2)), axis);
  const auto& travel = scene.machine.axes[index_of(axis)]->travel_mm;
  SmoothCurve curve =
      draw_curve(random, {travel[0], 0.8 * travel[0] + 0.2 * travel[1], 0.5 * (travel[0] + travel[1]),
                          0.3 * travel[0] + 0.7 * travel[1], 0.2 * travel[0] + 0.8 * travel[1],
                          0.1 * travel[0] + 0.9 * travel[1], 0.05 * travel[0] + 0.95 * travel[1],
                          0.15 * travel[0] + 0.85 * travel[1], 0.4 * travel[0] + 0.6 * travel[1], travel[1]});
  curve.slope = random.normal();
  KnownCurve known{code, {}, {}};
  const int count = whole(random, 15, 50);
  for (int k = 0; k <= count; ++k) {
    known.p_mm.push_back(rounded(travel[0] + (travel[1] - travel[0]) * k / count, 100.0));
    known.value.push_back(rounded(15.0 * value_at(curve, known.p_mm.back()), 1000.0));
  }
  scene.known.push_back(known);
}

}  // namespace ecs::emulator
