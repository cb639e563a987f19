#include "model/effects/effect.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>

namespace ecs::model {
namespace {

using enum EffectId;

constexpr std::string_view kByTable = "a table of the error map";

std::vector<EffectInfo> geometric_effects() {
  return {
      {offset,
       "offset",
       "Datum shift",
       "c",
       "datum or laser zero shifted",
       "the same everywhere and always",
       {{"um", "um", 0, 0, false, "shift"}},
       false,
       Carrier::error_map,
       "a constant in the map, or the datum's null offset"},
      {scale,
       "scale",
       "Scale error",
       "k p",
       "screw lead or scale factor wrong",
       "grows with position; constant in time and temperature",
       {{"um_per_m", "um/m", 0, 0, false, "slope"}},
       false,
       Carrier::error_map,
       kByTable},
      {progressive,
       "progressive",
       "Progressive error",
       "s(p)",
       "wear of screw or guideway, form of the guideway",
       "a smooth curve over position, the same in both approaches, with no single period",
       {{"rms_um", "um", 0, 0, false, "size of the curve"}},
       false,
       Carrier::error_map,
       kByTable},
      {cyclic,
       "cyclic",
       "Periodic error",
       "A sin(2 pi p/P + phi), harmonics 1-2",
       "screw pitch, grating pitch, gear mesh or electronic subdivision",
       "one period over the whole travel, often a pitch of screw or scale",
       {{"period_mm", "mm", 0, 0, true, "length of one period"},
        {"amplitude_um", "um", 0, 0, false, "of the fundamental"},
        {"phase_rad", "rad", 0, 0, false, "of the fundamental, sin(2 pi p/P + phase)"},
        {"amplitude2_um", "um", 0, 0, false, "of the second harmonic"},
        {"phase2_rad", "rad", 0, 0, false, "of the second harmonic"}},
       false,
       Carrier::error_map,
       "a table of the error map with increments well below the period"},
      {backlash,
       "backlash",
       "Backlash",
       "b d/2",
       "lost motion in the drive",
       "two levels, one per approach, whatever the position and the feed",
       {{"um", "um", 0, 0, false, "forward minus reverse"}},
       true,
       Carrier::error_map,
       "forward and reverse tables"},
      {reversal_curve,
       "reversal_curve",
       "Reversal error along the axis",
       "s(p) d/2",
       "lost motion that varies along the axis: worn nut, screw sag",
       "forward and reverse curves drift apart along the axis",
       {{"rms_um", "um", 0, 0, false, "size of the curve"}},
       true,
       Carrier::error_map,
       "forward and reverse tables"},
      {step,
       "step",
       "Step",
       "h [p > p0]",
       "joint between two pieces of scale, damaged screw",
       "a jump at one place, level on both sides",
       {{"height_um", "um", 0, 0, false, "jump"},
        {"position_mm", "mm", 0, 0, true, "place of the jump, from the datum"}},
       false,
       Carrier::error_map,
       kByTable},
      {sag,
       "sag",
       "Droop",
       "k2 e^2 + k3 e^3, e = |p|",
       "ram droop, a beam bending under its weight",
       "grows with the square and cube of the extension",
       {{"k2", "um/m2", 0, 0, false, "square"}, {"k3", "um/m3", 0, 0, false, "cube"}},
       false,
       Carrier::error_map,
       kByTable},
      {angular,
       "angular",
       "Angular error",
       "eps(p) L",
       "roll, pitch or yaw of a carriage acting through an offset",
       "proportional to the distance from the line on which the axis was measured",
       {{"rms_um", "um/m", 0, 0, false, "size of the angle"}},
       false,
       Carrier::error_map,
       "a table of the angle; the unit multiplies by the lever arm"},
      {squareness,
       "squareness",
       "Squareness",
       "linear in another axis",
       "two axes not square to each other",
       "one direction leans in proportion to the position of another axis",
       {{"um_per_m", "um/m", 0, 0, false, "angle"}},
       false,
       Carrier::parameters,
       "the squareness parameter"},
      {measurement_line,
       "measurement_line",
       "Abbe offset of the measurement",
       "c eps_known(p)",
       "the map was measured on another line than the one measured now",
       "has the shape of an angular error known from elsewhere",
       {{"lever_mm", "mm", 0, 0, false, "distance between the lines"}},
       false,
       Carrier::parameters,
       "the measurement line among the unit's parameters"},
  };
}

std::vector<EffectInfo> conditions_effects() {
  return {
      {thermal_scale,
       "thermal_scale",
       "Thermal expansion",
       "alpha p (T - 20)",
       "screw or scale expands with temperature",
       "a slope that follows the material's temperature",
       {{"um_per_m_degC", "um/m/degC", 0, 0, false, "expansion"}},
       false,
       Carrier::none,
       "a scale that follows temperature; the unit has no sensor, so set the scale for the working temperature"},
      {thermal_drift,
       "thermal_drift",
       "Thermal drift",
       "c (T - T0)",
       "spindle or column grows with temperature",
       "the same at every position; follows one sensor",
       {{"um_per_degC", "um/degC", 0, 0, false, "growth"}},
       false,
       Carrier::none,
       "the unit has no temperature input"},
      {warm_up,
       "warm_up",
       "Warming up",
       "c (1 - exp(-t/tau)), and the same times p",
       "self-heating without a sensor",
       "fast at first, then it levels off",
       {{"tau_s", "s", 0, 0, true, "time constant"},
        {"c_um", "um", 0, 0, false, "final shift"},
        {"c_um_per_m", "um/m", 0, 0, false, "final change of scale"}},
       false,
       Carrier::none,
       "let the machine warm up before measuring and cutting"},
      {time_drift,
       "time_drift",
       "Drift in time",
       "c t",
       "laser head or fixture creeps",
       "steady in time, whatever the position",
       {{"um_per_h", "um/h", 0, 0, false, "rate"}},
       false,
       Carrier::set_up,
       "an error of the measurement, not of the machine"},
      {air_refraction,
       "air_refraction",
       "Air not corrected",
       "p dn(T_air, pressure, humidity)",
       "the laser's wavelength was not corrected for air",
       "a slope that follows the refractive index of air",
       {{"factor", "", 0, 2, false, "1 = not corrected at all"}},
       false,
       Carrier::set_up,
       "an error of the measurement: correct the readings for air"},
      {dead_path,
       "dead_path",
       "Dead path",
       "L_d dn",
       "uncompensated path between the optics at reset",
       "follows the refractive index of air, the same at every position",
       {{"length_m", "m", -10, 10, false, "length of the dead path"}},
       false,
       Carrier::set_up,
       "an error of the measurement: reset with the optics close together"},
      {cosine,
       "cosine",
       "Cosine error",
       "-p phi^2/2",
       "laser not aligned with the axis",
       "always shortens: a slope of one sign only",
       {{"angle_mrad", "mrad", 0, 0, false, "misalignment"}},
       false,
       Carrier::set_up,
       "an error of the measurement: align the beam"},
      {servo_lag,
       "servo_lag",
       "Following error",
       "c feed d",
       "readings taken on the fly lag behind",
       "changes sign with the approach and grows with the feed",
       {{"um_per_m_min", "um/(m/min)", 0, 0, false, "lag"}},
       true,
       Carrier::set_up,
       "the drive's gain; readings at rest do not show it"},
      {load,
       "load",
       "Load",
       "c m, and c m p",
       "mass of the workpiece or of a moving part",
       "changes with the load alone",
       {{"um_per_kg", "um/kg", 0, 0, false, "shift"}, {"um_per_kg_m", "um/kg/m", 0, 0, false, "change of slope"}},
       false,
       Carrier::none,
       "the unit does not know the load; measure at the load that is used"},
      {reversal_spike,
       "reversal_spike",
       "Reversal spike",
       "c d exp(-u/u0), u = travel since reversal",
       "stick-slip, wind-up of the screw",
       "dies away with the travel since the last reversal",
       {{"c_um", "um", 0, 0, false, "size at the reversal"},
        {"u0_mm", "mm", 0, 0, true, "travel over which it decays"}},
       true,
       Carrier::none,
       "the unit knows the approach, not the travel since reversal"},
  };
}

std::vector<EffectInfo> map_effects() {
  constexpr std::string_view kCommissioning = "a setting of the unit: put it right and measure again";
  return {
      {map_polarity,
       "map_polarity",
       "Compensation applied with the wrong sign",
       "-2 x map",
       "polarity of the output or sign convention of a component",
       "minus twice the uploaded map",
       {{"fraction", "", 0, 0, false, "1 = all of it"}},
       false,
       Carrier::parameters,
       "compensation polarity, or the sign of that component's table"},
      {map_gain,
       "map_gain",
       "Output scaling wrong",
       "(g - 1) x map",
       "D/A scaling or unit of the map wrong",
       "in proportion to the uploaded map",
       {{"gain", "", 0, 0, false, "1 = right"}},
       false,
       Carrier::parameters,
       "the output scale"},
      {map_shift,
       "map_shift",
       "Map shifted along the axis",
       "map(p + delta) - map(p)",
       "datum of the map and of the machine differ",
       "has the shape of the map's own slope",
       {{"shift_mm", "mm", 0, 0, true, "shift"}},
       false,
       Carrier::parameters,
       "the reference position"},
      {map_direction_swap,
       "map_direction_swap",
       "Forward and reverse tables exchanged",
       "map(p, -d) - map(p, d)",
       "approach sensed with the wrong sign",
       "the map's own reversal, twice and with opposite sign",
       {},
       true,
       Carrier::parameters,
       kCommissioning},
      {user,
       "user",
       "Written by the user",
       "formulas of the model file",
       "as the user says",
       "as the user says",
       {},
       false,
       Carrier::none,
       "only effects of the library compile into a map"},
  };
}

std::vector<EffectInfo> whole_library() {
  std::vector<EffectInfo> all;
  for (auto part : {geometric_effects(), conditions_effects(), map_effects()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

const std::vector<EffectInfo>& effect_library() {
  static const std::vector<EffectInfo> library = whole_library();
  return library;
}

const EffectInfo& info_of(EffectId id) {
  const EffectInfo& info = effect_library()[static_cast<std::size_t>(id)];
  assert(info.id == id);
  return info;
}

std::string_view name_of(EffectId id) { return info_of(id).name; }

std::optional<EffectId> effect_named(std::string_view name) {
  for (const EffectInfo& info : effect_library())
    if (info.name == name) return info.id;
  return std::nullopt;
}

namespace {
constexpr std::array<std::string_view, 3> kModes{"both", "forward", "reverse"};
}

std::string_view name_of(ApproachMode mode) { return kModes[static_cast<std::size_t>(mode)]; }

std::optional<ApproachMode> approach_mode_named(std::string_view name) {
  const auto found = std::find(kModes.begin(), kModes.end(), name);
  if (found == kModes.end()) return std::nullopt;
  return static_cast<ApproachMode>(found - kModes.begin());
}

std::string to_text(const EffectInstance& effect) {
  if (effect.id == EffectId::user) return fmt::format("user:{}", effect.name);
  std::string text(name_of(effect.id));
  if (!effect.axis && !effect.sense && !effect.code) return text;
  text += effect.axis ? fmt::format(":{}", letter_of(*effect.axis)) : ":";
  if (effect.id == EffectId::measurement_line && effect.sense) return text + fmt::format(":{}", name_of(*effect.sense));
  if (effect.code) return text + fmt::format(":{}", name_of(*effect.code));
  if (effect.sense) text += fmt::format(":{}", name_of(*effect.sense));
  return text;
}

bool same_place(const EffectInstance& a, const EffectInstance& b) {
  return a.id == b.id && a.axis == b.axis && a.sense == b.sense && a.code == b.code && a.name == b.name;
}

}  // namespace ecs::model
