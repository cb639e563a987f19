#include "ecs_emulator/errors/gravity.hpp"

namespace ecs::emulator {
namespace {

constexpr double kMetre_um = 1e6;
constexpr double kMillimetre_m = 1e-3;

/// A carriage that goes down by `sag` and turns by `slope` (downwards along its axis), as components of its axis.
/// @param towards  direction along the axis in which the slope goes down: +1 or −1
void add_bent(const GravitySettings& gravity, Axis axis, const Bending& bent, int towards, int side,
              ComponentValues& values) {
  const auto along = static_cast<int>(index_of(axis));
  const auto down = static_cast<int>(index_of(gravity.axis));
  values[index_of(curve_of(static_cast<Sense>(down), axis))] += side * gravity.sign * bent.sag_um;
  // The axis of the turn is (direction along the axis) × (direction of gravity).
  const int about = 3 - along - down;
  const int right_handed = (along + 1) % 3 == down ? 1 : -1;
  values[index_of(curve_of(static_cast<Sense>(3 + about), axis))] +=
      side * right_handed * towards * gravity.sign * bent.slope_um_per_m;
}

/// The same on the workpiece side: the tool sees the opposite, and the rotation acts about the measurement line, so the
/// translation is that of the point on the line.
/// @param at_mm  coordinate at which the tool stands over the place of the sag
void add_bent_table(const GravitySettings& gravity, const MachinePlace& place, Axis axis, Bending bent, double at_mm,
                    ComponentValues& values) {
  const std::size_t a = index_of(axis);
  bent.sag_um += bent.slope_um_per_m * (place.lines_mm[a][a] - at_mm) * kMillimetre_m;
  add_bent(gravity, axis, bent, 1, -1, values);
}

bool carries_workpiece(const MachinePlace& place, Axis axis) { return place.chain.carries_workpiece[index_of(axis)]; }

}  // namespace

Bending at_the_end(const Cantilever& beam, double length_m) {
  const double own_N_m = beam.mass_kg_m * kGravity_m_s2;
  const double tip_N = beam.tip_kg * kGravity_m_s2;
  const double square = length_m * length_m;
  return {kMetre_um * square * length_m * (own_N_m * length_m / 8.0 + tip_N / 3.0) / beam.stiffness_N_m2,
          kMetre_um * square * (own_N_m * length_m / 6.0 + tip_N / 2.0) / beam.stiffness_N_m2};
}

Bending under_the_load(double stiffness_N_m2, double span_m, double place_m, double load_N) {
  if (place_m <= 0.0 || place_m >= span_m) return {};
  const double far_m = span_m - place_m;
  const double one = kMetre_um * load_N * place_m * far_m / (3.0 * span_m * stiffness_N_m2);
  return {one * place_m * far_m, one * (span_m - 2.0 * place_m)};
}

void add_gravity(const GravitySettings& gravity, const MachinePlace& place, const Vector3& position_mm, double load_kg,
                 ComponentValues& values) {
  for (const Ram& ram : gravity.rams) {
    const double out_mm = (position_mm[index_of(ram.axis)] - ram.retracted_mm) * ram.extends;
    const double length_mm = std::max(0.0, ram.overhang_mm + out_mm);
    add_bent(gravity, ram.axis, at_the_end(ram.beam, length_mm * kMillimetre_m), ram.extends, 1, values);
  }
  for (const Bed& bed : gravity.beds) {
    const bool workpiece = carries_workpiece(place, bed.axis);
    const double place_m = (position_mm[index_of(bed.axis)] - bed.supports_mm[0]) * kMillimetre_m;
    const double mass_kg = bed.carriage_kg + (workpiece ? load_kg : 0.0);
    Bending bent = under_the_load(bed.stiffness_N_m2, (bed.supports_mm[1] - bed.supports_mm[0]) * kMillimetre_m,
                                  place_m, mass_kg * kGravity_m_s2);
    if (!workpiece) {
      add_bent(gravity, bed.axis, bent, 1, 1, values);
      continue;
    }
    bent.slope_um_per_m = -bent.slope_um_per_m;  // the table moves against its coordinate
    add_bent_table(gravity, place, bed.axis, bent, bed.centre_mm, values);
  }
  for (const Table& table : gravity.tables) {
    const double load_N = load_kg * kGravity_m_s2;
    const double p_mm = position_mm[index_of(table.axis)];
    const double arm_m = (table.load_at_mm - p_mm - table.saddle_mm) * kMillimetre_m;
    const double base_m = table.base_mm * kMillimetre_m;
    const Bending bent{load_N / table.stiffness_N_um, load_N * arm_m / (table.stiffness_N_um * base_m * base_m / 4.0)};
    add_bent_table(gravity, place, table.axis, bent, p_mm + table.saddle_mm, values);
  }
}

}  // namespace ecs::emulator
