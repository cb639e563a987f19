// The rules behind check(), one function for each part of the parameters: configuration and compensation; one axis (its
// output, its datum, how it fits the machine); what a parameter file leaves open, whatever its values are.
#include "params/check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "params/fields.hpp"

namespace ecs::params {
namespace {

/// The list that the rules fill.
struct Findings {
  std::vector<Finding> list;
  void error(std::vector<std::string> keys, std::string message) {
    list.push_back({std::move(keys), Severity::error, std::move(message)});
  }
  void warning(std::vector<std::string> keys, std::string message) {
    list.push_back({std::move(keys), Severity::warning, std::move(message)});
  }
};

/// "axis.X." + name.
std::string key_of(Axis axis, std::string_view name) { return fmt::format("axis.{}.{}", letter_of(axis), name); }

/// Shortest period in which the unit's 68000 at 8 MHz is likely to finish one loop [us]: our estimate from its
/// instruction times (multiply 9 us, divide 20 us), per axis read and written, per term and per curve looked up.
double loop_work_us(const UnitParameters& p) {
  constexpr double kPerAxis_us = 50.0;
  constexpr double kPerTerm_us = 12.0;
  const double per_curve_us = p.interpolation == Interpolation::linear ? 30.0 : 10.0;
  const auto terms = terms_of(p);
  if (!terms) return 0.0;
  const ComponentSet curves = components_needed(p);
  const auto axes = static_cast<double>(std::ranges::count(p.axis_present, true));
  const auto looked_up = static_cast<double>(std::count(curves.has.begin(), curves.has.begin() + kCurves, true));
  return kPerAxis_us * axes + kPerTerm_us * static_cast<double>(terms->count) + per_curve_us * looked_up;
}

constexpr double kSteepSquareness_um_per_m = 1000.0;

std::string letters_of(const PerAxis<bool>& axes) {
  std::string letters;
  for (const Axis a : kAllAxes)
    if (axes[index_of(a)]) letters += letter_of(a);
  return letters.empty() ? "none" : letters;
}

void check_chain(const UnitParameters& p, const Chain& chain, Findings& findings) {
  for (const Axis a : kAllAxes) {
    if (p.axis_present[index_of(a)] && !chain.has(a))
      findings.error(
          {"configuration.chain", "configuration.axes"},
          fmt::format("axis {0} is present, but the kinematic chain \"{1}\" has no letter {0}: add it at the position "
                      "of the axis, or remove {0} from configuration.axes",
                      letter_of(a), configuration_of(p)));
  }
}

void check_scope(const UnitParameters& p, Findings& findings) {
  const auto axes = std::ranges::count(p.axis_present, true);
  const std::string present = letters_of(p.axis_present);
  if (p.scope == Scope::volumetric && axes < 3)
    findings.error({"compensation.scope", "configuration.axes"},
                   fmt::format("a volumetric scope needs three axes, the unit has {}: choose {}", present,
                               axes == 2 ? "planar" : "linear"));
  if (p.scope != Scope::planar) return;
  if (axes < 2)
    findings.error({"compensation.scope", "configuration.axes"},
                   fmt::format("a planar scope needs two axes, the unit has {}: choose linear", present));
  if (p.plane.first == p.plane.second) return;  // the range of the field has said so
  for (const Axis a : {p.plane.first, p.plane.second})
    if (index_of(a) < kAxes && !p.axis_present[index_of(a)] && axes >= 2)
      findings.error({"compensation.plane", "configuration.axes"},
                     fmt::format("the plane names axis {}, which is not present (the unit has {}): choose the plane of "
                                 "two axes that are present",
                                 letter_of(a), present));
}

void check_convention(const UnitParameters& p, Findings& findings) {
  const std::string_view chain = configuration_of(p);
  if (p.convention != Convention::as_printed || chain == "TXYZ" || chain == "XTYZ" || chain == "XYTZ") return;
  findings.error({"compensation.convention", "configuration.chain"},
                 fmt::format("the printed equations know only TXYZ, XTYZ and XYTZ, not \"{}\": choose iso", chain));
}

void check_rack(const UnitParameters& p, Findings& findings) {
  int encoders = 0;
  int resolvers = 0;
  for (const Axis a : kAllAxes)
    if (p.axis_present[index_of(a)]) (p.axes[index_of(a)].transducer == Transducer::resolver ? resolvers : encoders)++;
  if (rack_holds(p.memory_modules, encoders, resolvers)) return;
  findings.error({"compensation.memory_modules"},
                 fmt::format("one rack has no space for {} memory, {} encoder and {} resolver modules (a resolver "
                             "module needs two slots): use fewer memory modules",
                             p.memory_modules, encoders, resolvers));
}

void check_squareness(const UnitParameters& p, Findings& findings) {
  const bool sound = terms_of(p).has_value();
  const ComponentSet used = components_needed(p);
  for (std::size_t i = kCurves; i < kComponents; ++i) {
    const auto component = static_cast<Component>(i);
    const double um_per_m = squareness_um_per_m(p, component);
    const std::string key = fmt::format("compensation.squareness.{}_um_per_m", name_of(component));
    if (std::abs(um_per_m) > kSteepSquareness_um_per_m)
      findings.error({key}, fmt::format("{} um/m is more than 1 mm in 1 m: check for a wrong unit (one arc second is "
                                        "4.848 um/m) or a wrong decimal point",
                                        shortest(um_per_m)));
    if (sound && um_per_m != 0.0 && !used.contains(component))
      findings.warning(
          {key, "compensation.scope"},
          fmt::format("{0} um/m is given, but this scope with these axes does not use {1}: widen the scope "
                      "or set {1} to 0",
                      shortest(um_per_m), name_of(component)));
  }
}

std::string line_key(Axis measured, Axis lever) {
  return key_of(measured, fmt::format("measurement_line_mm.{}", lower(std::string(1, letter_of(lever)))));
}

void check_lines(const UnitParameters& p, Findings& findings) {
  for (const Axis b : kAllAxes) {
    for (const Axis lever : kAllAxes) {
      if (lever == b || p.measurement_lines_mm[index_of(b)][index_of(lever)] == 0.0) continue;
      const bool here = p.axis_present[index_of(b)] && p.axis_present[index_of(lever)];
      if (!here)
        findings.warning({line_key(b, lever), "configuration.axes"},
                         fmt::format("a measurement line is given for an axis that is not present (the unit has {}): "
                                     "set it to 0 or add the axis",
                                     letters_of(p.axis_present)));
    }
  }
}

void check_loop(const UnitParameters& p, Findings& findings) {
  const double work_us = loop_work_us(p);
  if (!(p.loop_period_us < work_us)) return;
  findings.warning({"compensation.loop_period_us"},
                   fmt::format("{} us may be too short for the unit's processor: these terms need about {:.0f} us; use "
                               "a longer period or a narrower scope",
                               shortest(p.loop_period_us), work_us));
}

/// Chain against axes, scope and plane against both, convention against chain, modules against rack.
void check_configuration(const UnitParameters& p, Findings& findings) {
  const auto chain = ecs::chain_of(configuration_of(p));
  if (chain) {
    check_chain(p, *chain, findings);
    check_convention(p, findings);
  }
  check_scope(p, findings);
  check_rack(p, findings);
}

/// Letters of the chain without an axis: only where no machine file says whether that is meant.
void check_spare_letters(const UnitParameters& p, Findings& findings) {
  const auto chain = ecs::chain_of(configuration_of(p));
  if (!chain) return;
  for (const Axis a : kAllAxes)
    if (chain->has(a) && !p.axis_present[index_of(a)])
      findings.warning(
          {"configuration.axes", "configuration.chain"},
          fmt::format(
              "{0} is in the kinematic chain \"{1}\" but not in configuration.axes. This is correct if no axis {0} is "
              "wired to the unit{2}: the chain may contain more axes. Otherwise add {0} to configuration.axes.",
              letter_of(a), configuration_of(p), a == Axis::Y ? ", as on a lathe with two axes" : ""));
}

/// Loop period, squareness, levers.
void check_compensation(const UnitParameters& p, Findings& findings) {
  check_squareness(p, findings);
  check_lines(p, findings);
  check_loop(p, findings);
  if (p.angular_scale == 0.0 && p.scope != Scope::linear)
    findings.warning({"compensation.angular_scale"},
                     "0 switches every angular term off: set 1 unless this is intended");
  if (p.angular_scale < 0.0)
    findings.warning({"compensation.angular_scale"},
                     "a negative factor inverts the sign of every angular curve: correct only for curves measured "
                     "clockwise positive; else set it above 0");
}

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
                   fmt::format("{} um is less than one position count ({} um): an axis at rest would change between "
                               "the forward and the reverse table; use at least two counts",
                               shortest(a.deadband_um), shortest(resolution_um)));
  if (a.deadband_um > kWideDeadband_um)
    findings.warning({key}, fmt::format("{} um is more than 1 mm: after a reversal the unit uses the wrong table over "
                                        "this distance; use a few position counts",
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
    findings.warning({key}, "0 um disables the compensation of this axis: set it above the largest error of the map");
  else if (counts < 1.0)
    findings.error(
        {key, scale_key},
        "the limit is less than one D/A count, so the output is always 0: raise the limit or correct the output scale");
}

void check_slew(const UnitParameters& p, const AxisParameters& a, Axis axis, Findings& findings) {
  if (!is_sound(a.output_slew_um_per_s)) return;
  const std::string key = key_of(axis, "output_slew_um_per_s");
  const double needed_um_per_s = kRapid_mm_min / 60.0 * kSteepest_um_per_mm;
  if (a.output_slew_um_per_s < needed_um_per_s)
    findings.warning({key}, fmt::format("{} um/s cannot follow an error that changes by {} um per mm at a feed of {} "
                                        "mm/min: use at least {:.0f} um/s, or a lower feed",
                                        shortest(a.output_slew_um_per_s), shortest(kSteepest_um_per_mm),
                                        shortest(kRapid_mm_min), std::ceil(needed_um_per_s)));
  const double step_um = a.output_slew_um_per_s * p.loop_period_us * 1e-6;
  if (a.output_limit_um > 0.0 && step_um > 2.0 * a.output_limit_um)
    findings.warning(
        {key, "compensation.loop_period_us"},
        fmt::format("the slew limit allows {:.6g} um in one loop, the output limit only {:.6g} um from end "
                    "to end: the slew limit has no effect; lower {}",
                    step_um, 2.0 * a.output_limit_um, key));
}

struct SwitchRule {
  bool same;  ///< final state = initial state
  std::string_view why;
};

std::optional<SwitchRule> rule_of(DatumKind kind) {
  switch (kind) {
    case DatumKind::fanuc:
      return SwitchRule{true, "datum type fanuc uses the marker after leaving the switch"};
    case DatumKind::allen_bradley:
      return SwitchRule{true, "datum type allen_bradley uses the marker after backing off the switch"};
    case DatumKind::siemens:
      return SwitchRule{false, "datum type siemens uses the marker while still on the switch"};
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
    findings.error(
        {final_key, initial_key, key_of(axis, "datum.kind")},
        fmt::format(
            "it is {}. Because {}, set it to {} if switch_initially_active is {}; otherwise datuming always fails",
            state_word(d.switch_finally_active), rule->why, state_word(d.switch_initially_active), state_word(wanted)));
  if (d.switch_initially_active)
    findings.warning({initial_key, key_of(axis, "datum.switch_polarity")},
                     "the switch would be active before the axis reaches it: if it is wired to open on the cam, set "
                     "switch_polarity = -1 and this to false");
}

void check_null_offset(const DatumParameters& d, Axis axis, const MachineAxis& on, Findings& findings) {
  const double travel_mm = on.travel_mm[1] - on.travel_mm[0];
  if (std::abs(d.null_offset_mm) > travel_mm)
    findings.error({key_of(axis, "datum.null_offset_mm")},
                   fmt::format("{} mm is more than the whole travel of {} mm: use the value set in the control",
                               shortest(d.null_offset_mm), shortest(travel_mm)));
  if (d.reference_position_mm < on.travel_mm[0] || d.reference_position_mm > on.travel_mm[1])
    findings.error(
        {key_of(axis, "datum.reference_position_mm")},
        fmt::format("{} mm lies outside the machine's travel of {} to {} mm: every compensation would be for the wrong "
                    "position; read the position from the control after datuming",
                    shortest(d.reference_position_mm), shortest(on.travel_mm[0]), shortest(on.travel_mm[1])));
  else if (d.reference_position_mm != on.datum_mm)
    findings.warning(
        {key_of(axis, "datum.reference_position_mm")},
        fmt::format("{} mm, but the machine file has its datum at {} mm: correct one of them, or the map is shifted",
                    shortest(d.reference_position_mm), shortest(on.datum_mm)));
}

/// A switch at the end of the travel is reached by driving towards that end.
void check_approach_direction(const DatumParameters& d, Axis axis, const MachineAxis& on, Findings& findings) {
  constexpr double kAtTheEnd = 0.02;  ///< of the travel
  const double part = (on.datum_mm - on.travel_mm[0]) / (on.travel_mm[1] - on.travel_mm[0]);
  const bool away = (part < kAtTheEnd && d.approach_direction == Approach::forward) ||
                    (part > 1.0 - kAtTheEnd && d.approach_direction == Approach::reverse);
  if (away)
    findings.warning(
        {key_of(axis, "datum.approach_direction")},
        fmt::format("it leads away from the datum at the {} end of the travel ({} mm): the unit would wait for "
                    "the switch in the wrong direction; a recorded datum sequence shows the right one",
                    part < 0.5 ? "lower" : "upper", shortest(on.datum_mm)));
}

std::string_view word_of(Transducer transducer) { return transducer == Transducer::resolver ? "resolver" : "encoder"; }

void check_transducer(const AxisParameters& a, Axis axis, const MachineAxis& on, Findings& findings) {
  if (a.transducer != on.transducer)
    findings.error({key_of(axis, "transducer")},
                   fmt::format("\"{}\", but the machine file states \"{}\": the axis module would not fit the "
                               "signals; correct the wrong file",
                               word_of(a.transducer), word_of(on.transducer)));
  if (std::abs(a.position_scale_um_per_count) != on.resolution_um)
    findings.warning({key_of(axis, "position_scale_um_per_count")},
                     fmt::format("{} um/count, but the machine file states {} um: positions would have the wrong "
                                 "scale; move a known distance and compare with the control",
                                 shortest(a.position_scale_um_per_count), shortest(on.resolution_um)));
}

/// Position and output of one axis.
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
    findings.warning(
        {key_of(axis, "datum.approach_speed_mm_min")},
        fmt::format("{} mm/min onto the switch is a rapid traverse: record a datum sequence and use its speed",
                    shortest(d.approach_speed_mm_min)));
}

/// Parameters against the machine they are meant for.
void check_against(const UnitParameters& p, const Machine& machine, Findings& findings) {
  if (configuration_of(p) != machine.configuration)
    findings.error({"configuration.chain"}, fmt::format("\"{}\", but the machine file states \"{}\": angular errors "
                                                        "would act over the wrong levers; correct the wrong file",
                                                        configuration_of(p), machine.configuration));
  for (const Axis axis : kAllAxes) {
    const auto& on = machine.axes[index_of(axis)];
    const bool present = p.axis_present[index_of(axis)];
    if (present != on.has_value())
      findings.error(
          {"configuration.axes"},
          fmt::format("axis {0} is {1} here, but the machine file has {2} [axis.{0}]: correct the wrong file",
                      letter_of(axis), present ? "present" : "absent", on ? "a table" : "no table"));
    if (!present || !on) continue;
    check_transducer(p.axes[index_of(axis)], axis, *on, findings);
    check_null_offset(p.axes[index_of(axis)].datum, axis, *on, findings);
    check_approach_direction(p.axes[index_of(axis)].datum, axis, *on, findings);
  }
}

Finding no_keys_of(Axis axis) {
  Finding finding;
  for (const Field& field : fields())
    if (field.axis == axis) finding.keys.push_back(field.key);
  finding.message = fmt::format(
      "configuration.axes lists {0}, but the file has no [axis.{0}]. Perhaps the end of the file is missing: copy it "
      "again, or read "
      "the parameters with `ecs params receive`; if there is no axis {0}, remove it from configuration.axes",
      letter_of(axis));
  return finding;
}

void check_ranges(const UnitParameters& parameters, Findings& findings) {
  for (const Field& field : fields()) {
    if (field.axis && !parameters.axis_present[index_of(*field.axis)]) continue;
    const std::string reason = objection(field, parameters);
    if (!reason.empty()) findings.error({field.key}, reason);
  }
}

}  // namespace

std::vector<Finding> check_file(const ParametersFile& file) {
  std::vector<Finding> findings;
  for (const Axis axis : file.axes_without_keys) findings.push_back(no_keys_of(axis));
  if (!file.has_end) findings.push_back({{}, Severity::warning, std::string(kNoParametersEnd)});
  return findings;
}

std::vector<std::string> defaults_taken(const ParametersFile& file) {
  std::vector<std::string> lines;
  for (const std::string& key : file.defaulted) {
    const Field& field = *field_named(key);
    lines.push_back(fmt::format("{} is not given: the default {}{}{} is used", key, text_of(field, file.parameters),
                                field.unit.empty() ? "" : " ", field.unit));
  }
  return lines;
}

std::vector<std::string> defaults_in_short(const ParametersFile& file) {
  constexpr std::size_t kFew = 5;
  if (file.defaulted.size() <= kFew) return defaults_taken(file);
  return {fmt::format("{} parameters are not given: their defaults are used. `ecs params check` lists them",
                      file.defaulted.size())};
}

std::string_view name_of(Severity severity) { return severity == Severity::error ? "error" : "warning"; }

std::vector<Finding> check(const UnitParameters& parameters, const Machine* machine) {
  Findings findings;
  check_ranges(parameters, findings);
  check_configuration(parameters, findings);
  check_compensation(parameters, findings);
  for (const Axis axis : kAllAxes) {
    if (!parameters.axis_present[index_of(axis)]) continue;
    check_axis_output(parameters, axis, findings);
    check_datum(parameters, axis, findings);
  }
  if (machine != nullptr)
    check_against(parameters, *machine, findings);
  else
    check_spare_letters(parameters, findings);
  std::ranges::stable_sort(findings.list, [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return findings.list;
}

bool has_errors(const std::vector<Finding>& findings) {
  return std::ranges::any_of(findings, [](const Finding& f) { return f.severity == Severity::error; });
}

std::string to_text(const std::vector<Finding>& findings) {
  constexpr std::size_t kMostKeys = 4;  // more are a whole table of the file, which the message names
  std::string text;
  for (const Finding& f : findings) {
    const bool with_keys = !f.keys.empty() && f.keys.size() <= kMostKeys;
    text += fmt::format("{}: {}{}{}\n", name_of(f.severity),
                        with_keys ? fmt::format("{}", fmt::join(f.keys, ", ")) : "", with_keys ? ": " : "", f.message);
  }
  return text;
}

bool rack_holds(int memory_modules, int encoder_modules, int resolver_modules) {
  constexpr int kSlots = 11;
  const bool each = memory_modules <= static_cast<int>(kMostModules) && encoder_modules <= 8 && resolver_modules <= 5;
  return each && memory_modules + encoder_modules + 2 * resolver_modules <= kSlots;
}

}  // namespace ecs::params
