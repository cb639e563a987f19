// Rules on one axis: its output, its datum, and how it fits the machine.
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "params/check_rules.hpp"

namespace ecs::params {
namespace {

constexpr double kMostCounts = 32'767.0;     ///< of a 16-bit D/A converter
constexpr double kRapid_mm_min = 10'000.0;   ///< no parameter holds the highest feed; this is an ordinary rapid
constexpr double kSteepest_um_per_mm = 1.0;  ///< slope of a short cyclic error (±3 um over a 20 mm pitch)
constexpr double kWideDeadband_um = 1000.0;

bool is_sound(double value) { return std::isfinite(value) && value > 0.0; }

void check_deadband(const AxisParameters& a, Axis axis, Findings& findings) {
  const double resolution_um = std::abs(a.position_scale_um_per_count);
  const std::string key = key_of(axis, "deadband_um");
  if (a.deadband_um < resolution_um)
    findings.error({key, key_of(axis, "position_scale_um_per_count")},
                   fmt::format("{} um is less than one position count ({} um): a standing axis would change between "
                               "the forward and the reverse table; take at least two counts",
                               shortest(a.deadband_um), shortest(resolution_um)));
  if (a.deadband_um > kWideDeadband_um)
    findings.warning({key}, fmt::format("{} um is more than 1 mm: after a reversal the unit uses the wrong table for "
                                        "all that way; take a few position counts",
                                        shortest(a.deadband_um)));
}

void check_output_size(const AxisParameters& a, Axis axis, Findings& findings) {
  const std::string key = key_of(axis, "output_limit_um");
  const std::string scale_key = key_of(axis, "output_scale_counts_per_um");
  const double counts = a.output_limit_um * a.output_scale_counts_per_um;
  if (counts > kMostCounts)
    findings.error({key, scale_key},
                   fmt::format("{} um × {} counts/um = {:.0f} counts, more than a 16-bit D/A converter has (32767): "
                               "lower the limit to {:.6g} um or less",
                               shortest(a.output_limit_um), shortest(a.output_scale_counts_per_um), counts,
                               std::floor(kMostCounts / a.output_scale_counts_per_um)));
  if (a.output_limit_um == 0.0)
    findings.warning({key}, "0 um lets no compensation out of this axis: set it above the largest error of the map");
  else if (counts < 1.0)
    findings.error({key, scale_key},
                   "the limit is less than one D/A count, so nothing is ever put out: raise the "
                   "limit or correct the output scale");
}

void check_slew(const UnitParameters& p, const AxisParameters& a, Axis axis, Findings& findings) {
  if (!is_sound(a.output_slew_um_per_s)) return;
  const std::string key = key_of(axis, "output_slew_um_per_s");
  const double needed_um_per_s = kRapid_mm_min / 60.0 * kSteepest_um_per_mm;
  if (a.output_slew_um_per_s < needed_um_per_s)
    findings.warning({key}, fmt::format("{} um/s cannot follow an error that changes by {} um per mm at a feed of {} "
                                        "mm/min: take at least {:.0f} um/s, or keep the feed lower",
                                        shortest(a.output_slew_um_per_s), shortest(kSteepest_um_per_mm),
                                        shortest(kRapid_mm_min), std::ceil(needed_um_per_s)));
  const double step_um = a.output_slew_um_per_s * p.loop_period_us * 1e-6;
  if (a.output_limit_um > 0.0 && step_um > 2.0 * a.output_limit_um)
    findings.warning({key, "compensation.loop_period_us"},
                     fmt::format("one loop lets the output jump by {:.6g} um, from limit to limit: the slew limit "
                                 "protects nothing; lower it",
                                 step_um));
}

struct SwitchRule {
  bool same;  ///< final state = initial state
  std::string_view why;
};

std::optional<SwitchRule> rule_of(DatumKind kind) {
  switch (kind) {
    case DatumKind::fanuc:
      return SwitchRule{true, "fanuc takes the marker after leaving the switch"};
    case DatumKind::allen_bradley:
      return SwitchRule{true, "allen_bradley takes the marker after backing off the switch"};
    case DatumKind::siemens:
      return SwitchRule{false, "siemens takes the marker while still on the switch"};
  }
  return std::nullopt;  // no such kind: its range says so
}

std::string_view state_word(bool active) { return active ? "true" : "false"; }

void check_switch(const DatumParameters& d, Axis axis, Findings& findings) {
  const auto rule = rule_of(d.kind);
  if (!rule) return;
  const std::string final_key = key_of(axis, "datum.switch_finally_active");
  const std::string initial_key = key_of(axis, "datum.switch_initially_active");
  const bool wanted = rule->same == d.switch_initially_active;
  if (d.switch_finally_active != wanted)
    findings.error({final_key, initial_key, key_of(axis, "datum.kind")},
                   fmt::format("{}, so from the initial state {} the final state is {}: set it so, or the routine "
                               "always fails",
                               rule->why, state_word(d.switch_initially_active), state_word(wanted)));
  if (d.switch_initially_active)
    findings.warning({initial_key, key_of(axis, "datum.switch_polarity")},
                     "the switch would be active before the axis reaches it: if it is wired to open on the cam, set "
                     "switch_polarity = -1 and this to false");
}

void check_null_offset(const DatumParameters& d, Axis axis, const MachineAxis& on, Findings& findings) {
  const double travel_mm = on.travel_mm[1] - on.travel_mm[0];
  if (std::abs(d.null_offset_mm) > travel_mm)
    findings.error({key_of(axis, "datum.null_offset_mm")},
                   fmt::format("{} mm is more than the whole travel of {} mm: take the value set in the control",
                               shortest(d.null_offset_mm), shortest(travel_mm)));
  if (d.reference_position_mm < on.travel_mm[0] || d.reference_position_mm > on.travel_mm[1])
    findings.error(
        {key_of(axis, "datum.reference_position_mm")},
        fmt::format("{} mm lies outside the machine's travel of {} to {} mm: every compensation would be "
                    "taken from the wrong place; read the position from the control after datuming",
                    shortest(d.reference_position_mm), shortest(on.travel_mm[0]), shortest(on.travel_mm[1])));
  else if (d.reference_position_mm != on.datum_mm)
    findings.warning({key_of(axis, "datum.reference_position_mm")},
                     fmt::format("{} mm, but the machine file has its datum at {} mm: make them agree, or the map is "
                                 "shifted",
                                 shortest(d.reference_position_mm), shortest(on.datum_mm)));
}

/// A switch at the end of the travel is reached by driving towards that end.
void check_approach_direction(const DatumParameters& d, Axis axis, const MachineAxis& on, Findings& findings) {
  constexpr double kAtTheEnd = 0.02;  ///< of the travel
  const double part = (on.datum_mm - on.travel_mm[0]) / (on.travel_mm[1] - on.travel_mm[0]);
  const bool away = (part < kAtTheEnd && d.approach_direction == Approach::forward) ||
                    (part > 1.0 - kAtTheEnd && d.approach_direction == Approach::reverse);
  if (away)
    findings.warning({key_of(axis, "datum.approach_direction")},
                     fmt::format("away from the datum, which is at the {} end of the travel ({} mm): the unit would "
                                 "wait for the switch in the wrong direction; a recorded datum sequence shows it",
                                 part < 0.5 ? "lower" : "upper", shortest(on.datum_mm)));
}

void check_transducer(const AxisParameters& a, Axis axis, const MachineAxis& on, Findings& findings) {
  if (a.transducer != on.transducer)
    findings.error({key_of(axis, "transducer")},
                   "differs from the machine file: the axis module would not fit the "
                   "signals; correct the one that is wrong");
  if (std::abs(a.position_scale_um_per_count) != on.resolution_um)
    findings.warning({key_of(axis, "position_scale_um_per_count")},
                     fmt::format("{} um/count, but the machine file says {} um: positions would be read at the wrong "
                                 "scale; move a known distance and compare with the control",
                                 shortest(a.position_scale_um_per_count), shortest(on.resolution_um)));
}

}  // namespace

void check_axis_output(const UnitParameters& p, Axis axis, Findings& findings) {
  const AxisParameters& a = p.axes[index_of(axis)];
  check_deadband(a, axis, findings);
  check_output_size(a, axis, findings);
  check_slew(p, a, axis, findings);
}

void check_datum(const UnitParameters& p, Axis axis, Findings& findings) {
  const DatumParameters& d = p.axes[index_of(axis)].datum;
  check_switch(d, axis, findings);
  constexpr double kFastApproach_mm_min = 5000.0;
  if (d.approach_speed_mm_min > kFastApproach_mm_min)
    findings.warning({key_of(axis, "datum.approach_speed_mm_min")},
                     fmt::format("{} mm/min onto the switch is a rapid: record a datum sequence and take its speed",
                                 shortest(d.approach_speed_mm_min)));
}

void check_against(const UnitParameters& p, const Machine& machine, Findings& findings) {
  if (configuration_of(p) != machine.configuration)
    findings.error({"configuration.chain"},
                   fmt::format("\"{}\", but the machine file says \"{}\": angular errors would act over the wrong "
                               "levers; correct the one that is wrong",
                               configuration_of(p), machine.configuration));
  for (const Axis axis : kAllAxes) {
    const auto& on = machine.axes[index_of(axis)];
    const bool present = p.axis_present[index_of(axis)];
    if (present != on.has_value())
      findings.error({"configuration.axes"},
                     fmt::format("axis {} is {} here, but the machine file {}: correct the one that is wrong",
                                 letter_of(axis), present ? "present" : "absent", on ? "has it" : "has none"));
    if (!present || !on) continue;
    check_transducer(p.axes[index_of(axis)], axis, *on, findings);
    check_null_offset(p.axes[index_of(axis)].datum, axis, *on, findings);
    check_approach_direction(p.axes[index_of(axis)].datum, axis, *on, findings);
  }
}

}  // namespace ecs::params
