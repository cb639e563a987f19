// Rules on configuration and compensation.
#include "params/check_rules.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::params {
namespace {

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
      findings.error({"configuration.chain", "configuration.axes"},
                     fmt::format("axis {0} is present, but the chain \"{1}\" has no letter {0}: add it where the axis "
                                 "stands, or take {0} out of configuration.axes",
                                 letter_of(a), configuration_of(p)));
  }
}

void check_scope(const UnitParameters& p, Findings& findings) {
  const auto axes = std::count(p.axis_present.begin(), p.axis_present.end(), true);
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
                                 "two axes that are",
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
                 fmt::format("one rack does not hold {} memory, {} encoder and {} resolver modules (a resolver module "
                             "takes two slots): use fewer memory modules",
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
      findings.error({key}, fmt::format("{} um/m is more than 1 mm in 1 m: look for a wrong unit (arc seconds are "
                                        "4.848 um/m) or a wrong decimal point",
                                        shortest(um_per_m)));
    if (sound && um_per_m != 0.0 && !used.contains(component))
      findings.warning({key, "compensation.scope"},
                       fmt::format("{} um/m is given, but this scope with these axes does not use {}: widen the scope "
                                   "or set it to 0",
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
  findings.warning(
      {"compensation.loop_period_us"},
      fmt::format("{} us may be too short for the unit's processor: these terms need about {:.0f} us; take "
                  "a longer period or a narrower scope",
                  shortest(p.loop_period_us), work_us));
}

}  // namespace

std::string key_of(Axis axis, std::string_view name) { return fmt::format("axis.{}.{}", letter_of(axis), name); }

double loop_work_us(const UnitParameters& p) {
  constexpr double kPerAxis_us = 50.0;
  constexpr double kPerTerm_us = 12.0;
  const double per_curve_us = p.interpolation == Interpolation::linear ? 30.0 : 10.0;
  const auto terms = terms_of(p);
  if (!terms) return 0.0;
  const ComponentSet curves = components_needed(p);
  const auto axes = static_cast<double>(std::count(p.axis_present.begin(), p.axis_present.end(), true));
  const auto looked_up = static_cast<double>(std::count(curves.has.begin(), curves.has.begin() + kCurves, true));
  return kPerAxis_us * axes + kPerTerm_us * static_cast<double>(terms->count) + per_curve_us * looked_up;
}

void check_configuration(const UnitParameters& p, Findings& findings) {
  const auto chain = ecs::chain_of(configuration_of(p));
  if (chain) {
    check_chain(p, *chain, findings);
    check_convention(p, findings);
  }
  check_scope(p, findings);
  check_rack(p, findings);
}

void check_spare_letters(const UnitParameters& p, Findings& findings) {
  const auto chain = ecs::chain_of(configuration_of(p));
  if (!chain) return;
  for (const Axis a : kAllAxes)
    if (chain->has(a) && !p.axis_present[index_of(a)])
      findings.warning({"configuration.axes", "configuration.chain"},
                       fmt::format("the chain \"{1}\" has the letter {0}, but axis {0} is not present: right for a "
                                   "machine that only lacks it (a lathe as XTYZ); else add {0} to configuration.axes",
                                   letter_of(a), configuration_of(p)));
}

void check_compensation(const UnitParameters& p, Findings& findings) {
  check_squareness(p, findings);
  check_lines(p, findings);
  check_loop(p, findings);
  if (p.angular_scale == 0.0 && p.scope != Scope::linear)
    findings.warning({"compensation.angular_scale"}, "0 switches every angular term off: set 1 unless that is meant");
  if (p.angular_scale < 0.0)
    findings.warning({"compensation.angular_scale"},
                     "a negative factor turns the sign of every angular curve: right only for curves measured "
                     "clockwise positive; else set it above 0");
}

}  // namespace ecs::params
