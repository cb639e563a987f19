// The Etalon exchange format: the 21 errors of three linear axes for controls that compensate by a rigid-body model
// (TwinCAT CNC, ISG kernel). Source: Beckhoff TF5280, "Etalon Exchange Format"; lengths mm, angles rad, names ISO
// 230-1.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "modules/controllers/curve.hpp"
#include "modules/controllers/tables.hpp"

namespace ecs::controllers {

/// Comments of our own files: where lever arms count from.
inline constexpr std::string_view kLeversFromZero =
    "Lever arms count from the machine zero: the curves hold what the rotations do there.";
inline constexpr std::string_view kLeversFromLines =
    "The curves are those of their measurement lines; lever arms count from there.";

struct EtalonOptions {
  std::string file_name = "errors.txt";
  /// The control counts lever arms from the machine zero. True: the curves are brought there from the lines on which
  /// they were measured. False: they are written as they are in the map.
  bool levers_from_zero = true;
  std::size_t most_points = 0;  ///< of one function; 0: as many as the map has
};

/// The curve of a component for a control that levers rotations from the machine zero: a translation is brought there
/// from its measurement line. Nothing where the machine lacks the axis or the map has nothing to write.
[[nodiscard]] std::optional<ControlCurve> curve_at_machine_zero(const ExportSource& source, const TermTable& terms,
                                                                Component component);

/// One file with the errors (not the compensations): every curve of the map as grid points, C0Y, B0Z, A0Z as values.
/// The format has one function for both approaches: the mean. Refused: squareness and terms in the printed signs.
[[nodiscard]] Result<ControllerExport> etalon_export(const ExportSource& source, const EtalonOptions& options);

/// `[NAME]`, then `VALUE = number` or `Gridpoints = {` rows `}`; `//` comments; any case of the key words. Functions of
/// rotary axes are left out with a note. `levers_from_lines` is what the head of a file of ours says. Refused, all at
/// once: other lines, names that are none, positions that do not rise or fall throughout, values no machine can have,
/// functions that do not end.
[[nodiscard]] Result<ControllerTables> parse_etalon(std::string_view text, const std::string& file_name);

/// A map read from this format as parameters expect it: curves on their measurement lines, angles by their angular
/// scale. @param levers_from_lines  the curves stand on the lines already; false: at the machine zero
[[nodiscard]] laser::ErrorMap at_measurement_lines(const laser::ErrorMap& read, const UnitParameters& parameters,
                                                   bool levers_from_lines = false);

}  // namespace ecs::controllers
