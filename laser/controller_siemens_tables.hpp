// One table as a SINUMERIK holds it, before it is text.
// Does not live here: which tables a map becomes (controller_siemens.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "laser/controller_curve.hpp"
#include "laser/controller_siemens.hpp"

namespace ecs::laser {

/// One table for the control, still as compensation.
struct SiemensTable {
  Component component = Component::EXX;
  std::string name;  ///< of the component in the report
  Axis input = Axis::X, output = Axis::X;
  int direction = 0;  ///< $AN_CEC_DIRECTION: 0 both, 1, -1
  EvenGrid grid;
  std::vector<double> compensation_um;
  std::string comment;
  [[nodiscard]] double largest() const {
    double most = 0.0;
    for (const double value : compensation_um) most = std::max(most, std::abs(value));
    return most;
  }
};

/// `AX_EEC.INI`: every table of them for its axis. @pre input and output are the same
[[nodiscard]] std::string encoder_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options);
/// `NC_CEC.INI`: numbered from 0 in this order.
[[nodiscard]] std::string cross_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options);

}  // namespace ecs::laser
