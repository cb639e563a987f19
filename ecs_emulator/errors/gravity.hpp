// Gravity in the machine: a ram that droops, a carriage that bends the bed it travels on, a workpiece that sinks and
// tilts the table. Closed forms of beam theory; values are errors of the tool against the workpiece.
// Does not live here: how they are written down (body_reader.cpp), how errors add up at the tool (kinematics.hpp).
#pragma once

#include <vector>

#include "core/terms.hpp"

namespace ecs::emulator {

inline constexpr double kGravity_m_s2 = 9.80665;  ///< standard gravity (ISO 80000-3)

/// Deflection at a place, and the slope there in the direction of travel: both along gravity.
struct Bending {
  double sag_um = 0.0;
  double slope_um_per_m = 0.0;
};

/// A cantilever under its own weight and a load at its end (Euler-Bernoulli): sag wL⁴/8EI + PL³/3EI,
/// slope at the end wL³/6EI + PL²/2EI. S. Timoshenko, Strength of Materials, part I, beams with one end built in.
struct Cantilever {
  double stiffness_N_m2 = 0.0;  ///< EI, above 0
  double mass_kg_m = 0.0;       ///< per metre
  double tip_kg = 0.0;
};
[[nodiscard]] Bending at_the_end(const Cantilever& beam, double length_m);

/// A load on a beam on two supports, at the load: sag Px²(L−x)²/3LEI, slope Px(L−x)(L−2x)/3LEI (the same source).
/// Outside of the supports: 0, as on them.
[[nodiscard]] Bending under_the_load(double stiffness_N_m2, double span_m, double place_m, double load_N);

/// `[ram.Z]`: the carriage is a beam that comes out of its guide.
struct Ram {
  Axis axis = Axis::Z;
  double retracted_mm = 0.0;  ///< coordinate at which it is in
  int extends = -1;           ///< direction in which it comes out
  double overhang_mm = 0.0;   ///< what sticks out when it is in
  Cantilever beam;
};

/// `[bed.X]`: a bed on two supports under the weight of the carriage.
struct Bed {
  Axis axis = Axis::X;
  std::array<double, 2> supports_mm{};  ///< coordinates at which the carriage stands over the supports, ascending
  double stiffness_N_m2 = 0.0;          ///< EI of the bed
  double carriage_kg = 0.0;             ///< with all that it carries but the workpiece
  double centre_mm = 0.0;               ///< workpiece side: coordinate at which the tool stands over its centre
};

/// `[table.X]`: springs in the guideways under the two ends of a saddle; the table with the workpiece overhangs them.
struct Table {
  Axis axis = Axis::X;
  double stiffness_N_um = 0.0;  ///< of both ends together
  double base_mm = 0.0;         ///< distance of the two ends
  double load_at_mm = 0.0;      ///< coordinate at which the tool stands over the middle of the workpiece
  double saddle_mm = 0.0;       ///< from the tool to the middle of the saddle, along the axis
};

/// `[gravity]`, and what it bends.
struct GravitySettings {
  Axis axis = Axis::Z;
  int sign = -1;
  std::vector<Ram> rams;
  std::vector<Bed> beds;
  std::vector<Table> tables;
};

/// What the bodies know of the machine they belong to.
struct MachinePlace {
  Chain chain{};
  MeasurementLines lines_mm{};  ///< rotations act about these points
  Vector3 datum_mm{};
};

/// Adds what gravity does to the components at these positions, with so much workpiece on the table [um, um/m].
void add_gravity(const GravitySettings& gravity, const MachinePlace& place, const Vector3& position_mm, double load_kg,
                 ComponentValues& values);

}  // namespace ecs::emulator
