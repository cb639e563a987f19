// ISO 230-2 values against published reports of real axes (R and E by the standard, which those reports do not use).
#pragma once

#include <cmath>
#include <map>
#include <string>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/import/import.hpp"
#include "tests/support/readings.hpp"
#include "tests/support/real_data.hpp"

namespace ecs::laser {

/// "B_avg = 0.02537 [mm]" with or without asterisks → B_avg: 25.37 um.
inline std::map<std::string, double> axis_values_um(const std::string& report) {
  std::map<std::string, double> values;
  for (const std::string_view line : lines_of(report)) {
    std::string plain;
    for (const char c : line)
      if (c != '*') plain += c;
    const std::size_t equals = plain.find(" = ");
    const std::size_t unit = plain.find(" [mm]");
    if (equals == std::string::npos || unit == std::string::npos || unit < equals) continue;
    if (const auto value = number_in(plain.substr(equals + 3, unit - equals - 3)))
      values.emplace(trimmed(plain.substr(0, equals)), *value * kUmPerMm);
  }
  return values;
}

struct Published {
  const char* name;
  double R_um, E_um;  ///< recomputed by the standard
  double R_and_E_within_um;
  double within_um;  ///< a unit and a half of the last printed digit
};

inline void check_against_report(const Published& published) {
  CAPTURE(published.name);
  ImportOptions options;
  options.axis = Axis::X;
  const auto imported = read_any(real_data("ecmc-iso230-2/" + std::string(published.name) + "_ISO230.dat"), options);
  REQUIRE_MESSAGE(imported.has_value(), to_text(imported.error()));
  CHECK(imported->format->id == "iso230_assignments");
  const auto all = iso230_of(imported->set);
  REQUIRE(all.has_value());
  REQUIRE(all->size() == 1);
  const Iso230& axis = all->front();
  const auto report = read_file(real_data("ecmc-iso230-2/" + std::string(published.name) + "_report.md"));
  REQUIRE(report.has_value());
  const auto printed = axis_values_um(*report);
  // the set called FWD in the data is printed as backward in the report
  const std::map<std::string, double> ours{{"B", *axis.B},
                                           {"B_avg", -*axis.B_mean},
                                           {"R_fwd", *axis.R_reverse},
                                           {"R_bwd", *axis.R_forward},
                                           {"E_fwd", *axis.E_reverse},
                                           {"E_bwd", *axis.E_forward},
                                           {"M", *axis.M},
                                           {"A_fwd", *axis.A_reverse},
                                           {"A_bwd", *axis.A_forward},
                                           {"A", *axis.A}};
  for (const auto& [symbol, value] : ours) {
    CAPTURE(symbol);
    REQUIRE(printed.contains(symbol));
    CHECK(std::abs(value - printed.at(symbol)) <= published.within_um);
  }
  CHECK(std::abs(*axis.R - published.R_um) <= published.R_and_E_within_um);
  CHECK(std::abs(*axis.E - published.E_um) <= published.R_and_E_within_um);
}

}  // namespace ecs::laser
