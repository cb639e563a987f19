// Measured lengths of artefacts of known length (gauge blocks, step gauges, ring gauges, cut parts) and their file.
// Does not live here: scale and constant from them (modules/standards/gauge_block_fit.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/csv_table.hpp"

namespace ecs::laser {

inline constexpr double kBlockReference_degC = 20.0;  ///< ISO 1

/// Sign with which a tool or probe that is too large lengthens what a probing machine measures.
enum class Touch : signed char {
  inside = -1,  ///< faces that look at each other: a ring, a slot
  step = 0,     ///< faces that look the same way, each touched in the same direction
  outside = 1   ///< faces that look away from each other: a gauge block
};
[[nodiscard]] constexpr const char* name_of(Touch touch) {
  return touch == Touch::outside ? "outside" : touch == Touch::inside ? "inside" : "step";
}

/// One measured length.
struct BlockReading {
  int line = 0;       ///< of the file, from 1; 0: not from a file
  std::string block;  ///< readings of one block share the error of its certificate
  Touch touch = Touch::outside;
  double nominal_mm = 0.0;   ///< by certificate, at 20 degC; of a cut part the programmed length
  double measured_mm = 0.0;  ///< shown by the machine; of a cut part by the instrument, at 20 degC
  double U_um = 0.0;         ///< expanded uncertainty (k = 2) of the nominal length, independent from block to block
  std::optional<double> block_degC, machine_degC;  ///< of a cut part while it was cut
  std::optional<double> from_mm;                   ///< machine coordinate of the face with the smaller coordinate
};

struct BlockTest {
  std::string source;
  std::vector<MetadataEntry> metadata;
  Axis axis = Axis::X;                                    ///< along which the lengths lie
  bool cut = false;                                       ///< the machine cut the lengths; else it measured them
  double block_expansion_um_per_m_degC = 11.5;            ///< ISO 3650: steel gauge blocks
  std::optional<double> machine_expansion_um_per_m_degC;  ///< of its scale; none: errors at its temperature
  double resolution_um = 0.0;                             ///< of the display; 0: not stated
  double common_U_um_per_m = 0.0;      ///< expanded uncertainty (k = 2) that all nominal lengths share
  std::vector<BlockReading> readings;  ///< in file order
};

/// Error of the machine over a length, actual − target, at 20 degC where the temperatures are known [um]: of a machine
/// that measured, true minus measured length; of one that cut, measured minus programmed length.
[[nodiscard]] double error_um_of(const BlockTest& test, const BlockReading& reading);

/// Reads `nominal_mm,measured_mm` and, where known, `touch` (outside, inside, step), `block`, `U_um`, `t_block_degC`,
/// `t_machine_degC` and `from_mm`, below `# axis: X`; `# lengths: cut` (else measured), `# block_expansion: 11.5`,
/// `# machine_expansion: ` (um/m/degC), `# resolution_um: ` and `# common_U_um_per_m: ` are optional. Without `block`
/// a nominal length is one block. Refuses: no axis, lengths of 0 and less, a measured length more than a millimetre
/// from the nominal one, temperatures beyond ±100 degC, negative uncertainties.
[[nodiscard]] Result<BlockTest> parse_gauge_blocks(std::string_view text, const std::string& file_name);

}  // namespace ecs::laser
