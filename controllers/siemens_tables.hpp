// Tables as a SINUMERIK holds them, before they are text.
// Does not live here: which of them fit into a control (siemens.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "controllers/curve.hpp"
#include "controllers/siemens.hpp"

namespace ecs::controllers {

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

inline constexpr double kNothing_um = 0.0005;  ///< below the last digit written

/// Tables that only make sense together: the two directions of one component.
struct SiemensGroup {
  std::vector<SiemensTable> tables;
  ExportedTable report;
  std::optional<Component> square;  ///< a squareness that the tables hold besides
  [[nodiscard]] double largest() const {
    double most = 0.0;
    for (const SiemensTable& table : tables) most = std::max(most, table.largest());
    return most;
  }
};

/// Positioning: the mean for the encoder table, half the difference for each direction of the reversal.
struct SiemensPositioning {
  std::vector<SiemensTable> encoder;
  std::vector<SiemensGroup> reversal;
  std::vector<ExportedTable> reports;
};
[[nodiscard]] SiemensPositioning positioning_of(const ExportSource& source, const SiemensOptions& options);

/// How cross tables are spared: squareness inside straightness, straightness by its mean.
struct SiemensThrift {
  bool squareness_inside = false;
  bool mean_only = false;
};

[[nodiscard]] std::vector<SiemensGroup> straightness_of(const ExportSource& source, const SiemensOptions& options,
                                                        const SiemensThrift& thrift);

/// Each squareness that no straightness table holds, as a table of two points.
[[nodiscard]] std::vector<SiemensGroup> squareness_groups(const ExportSource& source,
                                                          const std::vector<SiemensGroup>& straightness);

/// Largest difference of the two approaches.
[[nodiscard]] double largest_reversal(const ControlCurve& curve);

/// `AX_EEC.INI`: every table of them for its axis. @pre input and output are the same
[[nodiscard]] std::string encoder_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options);
/// `NC_CEC.INI`: numbered from 0 in this order.
[[nodiscard]] std::string cross_text(const std::vector<SiemensTable>& tables, const SiemensOptions& options);

}  // namespace ecs::controllers
