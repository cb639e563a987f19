// What the tables of a control say, whichever control: curves of compensation that add up, and squareness. What the
// writers are asked for and what they answer. Does not live here: the files of each control (format.hpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "commissioning/maps/machine_map.hpp"

namespace ecs::controllers {

using commissioning::ExportSource;
using commissioning::MachinePlace;
using commissioning::squareness_of;

/// Tables read from a control's files. Several of one component and approach add up. A table of a translation acts by
/// the position of its moving axis alone, whatever control it is from.
struct ControllerTables {
  std::vector<laser::MapTable> tables;           ///< compensation, um or um/m
  std::array<double, kComponents> squareness{};  ///< errors, um/m; only C0Y, B0Z, A0Z are used
  /// The control has no squareness of its own: a straight line of two points across C0Y, B0Z or A0Z stands for it.
  bool lines_are_squareness = false;
  /// What a file says of its lever arms: they count from the measurement lines of its curves, or from the machine zero.
  /// Absent: nothing.
  std::optional<bool> levers_from_lines;
  std::vector<laser::SourceFile> sources;
  std::vector<std::string> notes;  ///< what had to be assumed, what was left out
  std::vector<Problem> warnings;   ///< places where the control itself would not read what is written
};

/// Adds what a further file of the same machine says. Refused: a component that both hold, where `alone` is set
/// (controls that add tables up allow it), and files whose lever arms count from different places.
[[nodiscard]] Result<void> append(ControllerTables& all, ControllerTables more, bool alone);

/// The tables as a map: tables of one component added up on all their positions, one table for both approaches where
/// they are the same. Where lines are squareness, each of them becomes that, with a note.
struct ReadMap {
  laser::ErrorMap map;
  std::array<double, kComponents> squareness{};  ///< errors, um/m
  std::vector<Component> squareness_found;
  std::vector<std::string> notes;
};
[[nodiscard]] ReadMap map_of(const ControllerTables& tables);

/// Compensation along X, Y, Z [um] that a control adds there. Rotations lever over `lines` and the
/// tool offset by the terms given. @param terms  of the chain, measured curves
[[nodiscard]] Vector3 compensation_by(const ControllerTables& tables, const TermTable& terms, const MachinePlace& place,
                                      const MeasurementLines& lines, const Vector3& tool_offset_mm);

/// One file to be written.
struct ExportFile {
  std::string name;  ///< without a folder
  std::string content;
};

/// One table of an export, and how well it follows the map.
struct ExportedTable {
  std::string component;  ///< "EXX", "C0Y"
  std::string what;       ///< "x.comp", "CEC table 3, X to Y, forward"
  std::size_t map_points = 0;
  std::size_t points = 0;
  double largest = 0.0;    ///< |value| [um, um/m]
  double deviation = 0.0;  ///< largest difference from what the unit would put out, before any shift
  double shift = 0.0;      ///< taken away everywhere, so that it is zero at the reference position
  std::string unit = "um";
};

/// A part of the map that an export cannot hold.
struct LeftBehind {
  std::string what;      ///< "EAX", "reversal of EXX"
  double largest = 0.0;  ///< |value|
  std::string unit;      ///< um, um/m
  std::string why;
};

struct ControllerExport {
  std::vector<ExportFile> files;
  std::vector<ExportedTable> tables;
  std::vector<std::string> settings;  ///< what is to be set in the control besides
  std::vector<LeftBehind> not_carried;
  std::vector<std::string> notes;
  ControllerTables applied;  ///< the files read again: what the control will add
};

[[nodiscard]] inline bool has_axis(const ExportSource& source, Axis axis) {
  return source.parameters.axis_present[index_of(axis)];
}

/// Which squareness moves the direction of a straightness by the position of its moving axis, and the sign it does it
/// with: error = sign · squareness · position. Nothing for other components.
struct Square {
  Component component = Component::C0Y;
  double sign = 1.0;
};
[[nodiscard]] std::optional<Square> square_of(Component straightness);

/// The terms of a machine for a format named after ISO 230-1. Refused: the printed signs of the thesis, a configuration
/// that is no chain. @param format  what is named so, as in "the format is"
[[nodiscard]] Result<TermTable> iso_terms(const UnitParameters& parameters, std::string_view format);

inline constexpr double kLargestPosition_mm = 1e6;    ///< in any file of a control
inline constexpr double kLargestValue_um = 32'000.0;  ///< um, um/m, in any of them

/// Refused, with every reason: no table at all, a table of one point, a component with one approach only, a position or
/// a value that no machine has, by its table and point.
[[nodiscard]] Result<void> check_exportable(const laser::ErrorMap& map);

/// What our own reader objects to in what was to be written, as an objection to the map: no file of that name exists.
[[nodiscard]] tl::unexpected<Problem> unwritable(const Problem& why);

/// Adds each component of the map, and each squareness, that is not zero and not among `carried`, and all that is not
/// zero of its rotary axes.
void leave_behind(ControllerExport& made, const ExportSource& source, const std::vector<Component>& carried,
                  const std::string& why_rotations, const std::string& why_others);

}  // namespace ecs::controllers
