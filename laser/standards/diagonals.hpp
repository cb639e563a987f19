// Diagonal displacement tests by ISO 230-6: body and face diagonals with the quantities of ISO 230-2, and step
// diagonals with the warning that belongs to them. Does not live here: the quantities of one line
// (laser/analysis/iso230.hpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/analysis/iso230.hpp"
#include "laser/csv_table.hpp"

namespace ecs::laser {

/// A diagonal: for X, Y, Z whether it runs with the axis (P, +1), against it (N, −1) or not along it (0).
using DiagonalDirection = std::array<int, kAxes>;

struct DiagonalReadings {
  std::string name;  ///< "PPN": letters of X, Y, Z
  DiagonalDirection direction{};
  MeasurementSet readings;  ///< as one line: position along the diagonal from its start [mm], deviation [um]
  /// Sum of the deviations that came while one axis alone moved, mean over the passes; of a step diagonal only [um].
  std::array<std::optional<double>, kAxes> while_moving_um{};
};

struct DiagonalTest {
  std::string source;
  std::vector<MetadataEntry> metadata;
  std::array<double, kAxes> span_mm{};      ///< edges of the measured volume; 0: not needed by any diagonal
  bool steps = false;                       ///< the axes moved one after the other
  std::vector<DiagonalReadings> diagonals;  ///< in file order
};

/// Reads `diagonal,position_mm,deviation_um` and, where known, `approach` and `run`, below `# x_mm: 800` … with the
/// edges of the volume. Of a step diagonal (`# kind: step`) a column `moved` names the axis that moved last. Refuses:
/// names other than of P, N and 0 (two of P and N at least), a diagonal twice, from either end; edges missing; a
/// position beyond the diagonal; body or face diagonals that are incomplete (four of the body, two of a face), which
/// are named.
[[nodiscard]] Result<DiagonalTest> parse_diagonals(std::string_view text, const std::string& file_name);

struct DiagonalValues {
  std::string name;
  DiagonalDirection direction{};
  double length_mm = 0.0;
  Iso230 iso;                    ///< symbols of ISO 230-2 along the diagonal
  double growth_um_per_m = 0.0;  ///< slope of the means by least squares
  double growth_sigma = 0.0;
};

/// Squareness, as the diagonals show it where nothing but squareness and common growth is wrong.
struct DiagonalSquareness {
  std::string name;       ///< "C0Y", "B0Z", "A0Z"
  double um_per_m = 0.0;  ///< sign of E_X = −C0Y·Y + B0Z·Z, E_Y = −A0Z·Z
  double sigma = 0.0;
};

struct DiagonalResults {
  std::vector<DiagonalValues> diagonals;
  std::optional<double> E_body_um;             ///< largest E of the four body diagonals
  std::optional<double> B_body_um;             ///< largest B of them
  std::optional<double> body_difference_um;    ///< largest less smallest growth over the body's length
  std::vector<DiagonalSquareness> squareness;  ///< that the diagonals reach
  std::vector<std::string> notes;
};

/// Problem: what iso230_of() refuses.
[[nodiscard]] Result<DiagonalResults> diagonal_results_of(const DiagonalTest& test);

}  // namespace ecs::laser
