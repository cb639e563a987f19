// A small machine with a map by hand, for the tests of the exports. Does not live here: tests.
#pragma once

#include "modules/controllers/tables.hpp"
#include "tests/support/readings.hpp"

namespace ecs::controllers {

/// XYTZ (both table axes carry the workpiece), travel 0 … 200 mm, reference at 0; lines off the machine zero.
inline ExportSource small_machine() {
  ExportSource source;
  const std::string chain = "XYTZ";
  std::copy(chain.begin(), chain.end(), source.parameters.configuration.begin());
  source.parameters.C0Y_um_per_m = 30.0;
  source.parameters.B0Z_um_per_m = -20.0;
  source.parameters.A0Z_um_per_m = 10.0;
  source.parameters.measurement_lines_mm = {{{0, 50, 100}, {25, 0, 150}, {10, 20, 0}}};
  for (auto& travel : source.travel_mm) travel = {0.0, 200.0};
  source.map.header.machine = "small machine";
  source.map.header.configuration = chain;
  return source;
}

inline void add_table(ExportSource& source, Component component, std::vector<double> p, std::vector<double> forward,
                      std::vector<double> reverse) {
  source.map.tables.push_back({component, Approach::forward, p, std::move(forward)});
  source.map.tables.push_back({component, Approach::reverse, std::move(p), std::move(reverse)});
}

/// Every curve, each with another shape and a reversal of 1 um (um/m).
inline ExportSource whole_machine() {
  ExportSource source = small_machine();
  for (std::size_t c = 0; c < kCurves; ++c) {
    const double k = static_cast<double>(c) + 1.0;
    add_table(source, static_cast<Component>(c), {0, 50, 100, 200}, {0.5, k + 0.5, -2 * k + 0.5, k / 3 + 0.5},
              {-0.5, k - 0.5, -2 * k - 0.5, k / 3 - 0.5});
  }
  return source;
}

inline const ExportFile& file_named(const ControllerExport& made, const std::string& name) {
  for (const ExportFile& file : made.files)
    if (file.name == name) return file;
  FAIL("no file " << name);
  return made.files.front();
}

inline bool leaves(const ControllerExport& made, const std::string& what) {
  return std::any_of(made.not_carried.begin(), made.not_carried.end(),
                     [&](const LeftBehind& one) { return one.what == what; });
}

}  // namespace ecs::controllers
