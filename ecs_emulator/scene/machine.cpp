#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "ecs_emulator/random/draw.hpp"
#include "ecs_emulator/scene/design.hpp"

namespace ecs::emulator {
namespace {

std::string draw_configuration(Random& random, int axes) {
  std::vector<char> letters{'X', 'Y', 'Z'};
  if (axes == 3 || chance(random, 0.3)) shuffle(random, letters);
  letters.resize(static_cast<std::size_t>(axes));
  std::string text(letters.begin(), letters.end());
  const int carrying_work = axes == 1 && chance(random, 0.7) ? 0 : whole(random, 0, axes);
  text.insert(static_cast<std::size_t>(carrying_work), "T");
  return text;
}

params::MachineAxis draw_axis(Random& random) {
  params::MachineAxis axis;
  const double length_mm = rounded(log_between(random, 250.0, 4000.0), 0.02);
  const int kind = whole(random, 0, 2);
  axis.travel_mm = kind == 0   ? std::array{0.0, length_mm}
                   : kind == 1 ? std::array{-length_mm, 0.0}
                               : std::array{-length_mm / 2.0, length_mm / 2.0};
  axis.datum_mm = chance(random, 0.8) ? 0.0 : one(random, std::vector{axis.travel_mm[0], axis.travel_mm[1]});
  axis.transducer = chance(random, 0.8) ? Transducer::encoder : Transducer::resolver;
  axis.resolution_um = one(random, std::vector{0.1, 0.5, 1.0});
  if (chance(random, 0.85)) axis.screw_pitch_mm = one(random, std::vector{5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0});
  if (chance(random, 0.5)) axis.scale_pitch_mm = one(random, std::vector{0.02, 0.04, 0.1});
  if (chance(random, 0.8)) axis.expansion_um_per_m_degC = one(random, std::vector{8.0, 10.5, 11.7, 12.2});
  return axis;
}

}  // namespace

params::Machine draw_machine(Random& random, int least_axes) {
  params::Machine machine;
  machine.name = fmt::format("machine {}", whole(random, 1000, 9999));
  machine.configuration = draw_configuration(random, std::max(least_axes, one(random, std::vector{1, 2, 3, 3})));
  const auto chain = ecs::chain_of(machine.configuration);
  for (const Axis a : kAllAxes)
    if (chain->has(a)) machine.axes[index_of(a)] = draw_axis(random);
  for (const Axis a : kAllAxes) {
    if (!chain->has(a) || chance(random, 0.3)) continue;
    for (const Axis other : kAllAxes) {
      if (other == a || !chain->has(other)) continue;
      const auto& travel = machine.axes[index_of(other)]->travel_mm;
      machine.axes[index_of(a)]->measurement_line_mm[index_of(other)] =
          rounded(between(random, travel[0], travel[1]), 0.1);
    }
  }
  return machine;
}

void settle_geometry(Scene& scene) {
  scene.chain = *params::chain_of(scene.machine);
  scene.lines_mm = params::measurement_lines_of(scene.machine);
  scene.terms = *terms_of(scene.chain, Convention::iso, CurveKind::carriage);
  for (const Axis a : kAllAxes)
    if (const auto& axis = scene.machine.axes[index_of(a)]) scene.datum_mm[index_of(a)] = axis->datum_mm;
}

}  // namespace ecs::emulator
