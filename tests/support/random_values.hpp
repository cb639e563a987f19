// Random numbers for properties: decimal steps over a range, so that a counterexample can be read and retyped.
#pragma once

#include <rapidcheck.h>

#include "core/axis.hpp"
#include "core/parameters.hpp"
#include "core/terms.hpp"
#include "tests/support/test.hpp"

namespace ecs::test {

/// One of 2001 evenly spaced numbers from −most to +most.
inline double number_up_to(double most) { return most * *rc::gen::inRange(-1000, 1001) / 1000.0; }
/// One of 1001 evenly spaced numbers.
inline double number_between(double least, double most) {
  return least + (most - least) * *rc::gen::inRange(0, 1001) / 1000.0;
}
inline Vector3 vector_up_to(double most) { return {number_up_to(most), number_up_to(most), number_up_to(most)}; }
inline MeasurementLines lines_up_to(double most) {
  return {vector_up_to(most), vector_up_to(most), vector_up_to(most)};
}

/// Every configuration string: one, two or three axes in any order, T at any place.
inline std::vector<std::string> every_chain() {
  std::vector<std::string> orders{""};
  std::vector<std::string> chains;
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const std::string order = orders[i];
    for (const char letter : {'X', 'Y', 'Z'})
      if (!contains(order, letter)) orders.push_back(order + letter);
    for (std::size_t place = 0; !order.empty() && place <= order.size(); ++place)
      chains.push_back(order.substr(0, place) + "T" + order.substr(place));
  }
  return chains;
}

inline void set_configuration(UnitParameters& parameters, const std::string& chain) {
  parameters.configuration = {};
  for (std::size_t i = 0; i < chain.size(); ++i) parameters.configuration[i] = chain[i];
  for (const Axis a : kAllAxes) parameters.axis_present[index_of(a)] = contains(chain, letter_of(a));
}

inline DatumParameters random_datum() {
  return {.kind = *rc::gen::element(DatumKind::fanuc, DatumKind::allen_bradley, DatumKind::siemens),
          .switch_polarity = *rc::gen::element<std::int8_t>(-1, 1),
          .switch_initially_active = *rc::gen::arbitrary<bool>(),
          .switch_finally_active = *rc::gen::arbitrary<bool>(),
          .approach_speed_mm_min = number_between(0.1, 20'000.0),
          .approach_direction = *rc::gen::element(Approach::forward, Approach::reverse),
          .null_offset_mm = number_up_to(50.0),
          .reference_position_mm = number_up_to(5000.0)};
}

inline AxisParameters random_axis() {
  return {.transducer = *rc::gen::element(Transducer::encoder, Transducer::resolver),
          .position_scale_um_per_count = number_between(0.01, 20.0) * *rc::gen::element(-1, 1),
          .deadband_um = number_between(0.0, 50.0),
          .output_scale_counts_per_um = number_between(0.1, 100.0),
          .compensation_polarity = *rc::gen::element<std::int8_t>(-1, 1),
          .output_limit_um = number_between(0.0, 2000.0),
          .output_slew_um_per_s = number_between(1.0, 1e5),
          .datum = random_datum()};
}

/// Parameters that a unit can run with. The chains that the printed equations do not know go with the ISO signs only.
inline UnitParameters random_parameters() {
  UnitParameters p;
  p.convention = *rc::gen::element(Convention::iso, Convention::iso, Convention::as_printed);
  const bool printed = p.convention == Convention::as_printed;
  set_configuration(
      p, printed ? *rc::gen::element<std::string>("TXYZ", "XTYZ", "XYTZ") : *rc::gen::elementOf(every_chain()));
  if (printed) p.axis_present[*rc::gen::inRange<std::size_t>(0, 3)] = *rc::gen::arbitrary<bool>();
  p.measurement_system = *rc::gen::element(MeasurementSystem::metric, MeasurementSystem::imperial);
  p.memory_modules = *rc::gen::inRange<std::uint8_t>(1, 6);
  p.scope = *rc::gen::element(Scope::linear, Scope::planar, Scope::volumetric, Scope::volumetric);
  p.plane = {static_cast<Axis>(*rc::gen::inRange(0, 3)), static_cast<Axis>(*rc::gen::inRange(0, 3))};
  p.interpolation = *rc::gen::element(Interpolation::nearest, Interpolation::linear);
  p.loop_period_us = number_between(100.0, 20'000.0);
  p.angular_scale = number_up_to(2.0);
  p.C0Y_um_per_m = number_up_to(200.0);
  p.B0Z_um_per_m = number_up_to(200.0);
  p.A0Z_um_per_m = number_up_to(200.0);
  if (*rc::gen::arbitrary<bool>()) p.tool_offset_mm = vector_up_to(300.0);
  p.measurement_lines_mm = lines_up_to(2000.0);
  for (auto& axis : p.axes) axis = random_axis();
  return p;
}

}  // namespace ecs::test
