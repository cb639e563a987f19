#include "ecs_emulator/referencing.hpp"

#include <algorithm>
#include <cmath>

namespace ecs::emulator {
namespace {

/// Far enough beyond the marker to have passed it, not so far as to meet the next.
constexpr double kPastMarker = 0.2;
/// How far onto the switch a controller goes that backs off again.
constexpr double kOntoSwitch = 0.5;

struct Leg {
  double to_mm = 0.0;
  double feed_mm_min = 0.0;  ///< 0: rapid
};

std::vector<Leg> legs_of(const AxisOfMachine& axis) {
  const AxisSettings& s = axis.settings();
  const double onward = static_cast<double>(static_cast<std::int8_t>(s.reference_direction));
  const auto [low_mm, high_mm] = axis.switch_mm();
  const double near_mm = onward > 0.0 ? low_mm : high_mm;
  const double past_mm = kPastMarker * s.marker_pitch_mm * onward;
  std::vector<Leg> legs{{start_position_mm(axis.facts(), s), 0.0}};
  if (s.reference_kind == DatumKind::allen_bradley) {
    legs.push_back({near_mm + onward * kOntoSwitch * s.switch_width_mm, s.reference_speed_mm_min});
    legs.push_back({axis.datum_marker_mm() - past_mm, s.reference_speed_mm_min});
  } else {
    legs.push_back({axis.datum_marker_mm() + past_mm, s.reference_speed_mm_min});
  }
  legs.push_back({axis.facts().datum_mm, s.reference_speed_mm_min});
  return legs;
}

}  // namespace

bool reference(Simulation& simulation, const std::vector<Axis>& axes) {
  for (const Axis a : axes) {
    for (const Leg& leg : legs_of(simulation.machine().axis(a))) {
      Vector3 target_mm = simulation.machine().command_mm();
      target_mm[index_of(a)] = leg.to_mm;
      if (!simulation.move_to(target_mm, leg.feed_mm_min)) return false;
    }
  }
  return true;
}

}  // namespace ecs::emulator
