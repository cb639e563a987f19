// The rules behind check(), one function for each part of the parameters. Users call check() of check.hpp.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "params/check.hpp"

namespace ecs::params {

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
[[nodiscard]] std::string key_of(Axis axis, std::string_view name);

/// Chain against axes, scope and plane against both, convention against chain, modules against rack.
void check_configuration(const UnitParameters& parameters, Findings& findings);
/// Letters of the chain without an axis: only where no machine file says whether that is meant.
void check_spare_letters(const UnitParameters& parameters, Findings& findings);
/// Loop period, squareness, levers.
void check_compensation(const UnitParameters& parameters, Findings& findings);
/// Position and output of one axis.
void check_axis_output(const UnitParameters& parameters, Axis axis, Findings& findings);
void check_datum(const UnitParameters& parameters, Axis axis, Findings& findings);
/// Parameters against the machine they are meant for.
void check_against(const UnitParameters& parameters, const Machine& machine, Findings& findings);

/// Shortest period in which the unit's 68000 at 8 MHz is likely to finish one loop [us]: our estimate from its
/// instruction times (multiply 9 us, divide 20 us), per axis read and written, per term and per curve looked up.
[[nodiscard]] double loop_work_us(const UnitParameters& parameters);

}  // namespace ecs::params
