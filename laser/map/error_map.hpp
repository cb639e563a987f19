// The error map as the host holds it: tables of compensation with the header that says where they come from; what
// stands against sending it, and how far its tables reach: against each other and against the travels of the machine.
// Does not live here: its text form (csv.hpp), its bytes (image.hpp), how it is made (build.hpp), where the travels
// come from (a machine file).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "core/parameters.hpp"
#include "core/rotary.hpp"
#include "core/thermal.hpp"

namespace ecs::laser {

/// One table: compensation = −error, um (um/m for angles), linear between points, end values hold beyond the ends.
struct MapTable {
  Component component = Component::EXX;   ///< one of the 18 curves
  Approach approach = Approach::unknown;  ///< unknown: one table for both approaches
  std::vector<double> position_mm;        ///< machine coordinates of the moving axis, ascending
  std::vector<double> compensation;       ///< as many
  friend bool operator==(const MapTable&, const MapTable&) = default;
};

struct SourceFile {
  std::string component;  ///< "EXX", "C0Y" for a squareness, "C" for a rotary axis
  std::string name;
  std::string sha256;  ///< of the file's bytes
  friend bool operator==(const SourceFile&, const SourceFile&) = default;
};

/// A component that was not measured and is taken as zero, on somebody's word.
struct DeclaredZero {
  Component component = Component::EXX;
  std::string reason;
  friend bool operator==(const DeclaredZero&, const DeclaredZero&) = default;
};

/// Standard uncertainty (k = 1) of the values of a component, as its measurements show it [um, um/m].
struct StatedUncertainty {
  Component component = Component::EXX;
  double value = 0.0;          ///< of each value, independent of the others; of a squareness all there is
  double pass = 0.0;           ///< common to a table: what differs from pass to pass, smooth along the travel
  int degrees_of_freedom = 0;  ///< of `pass`
  friend bool operator==(const StatedUncertainty&, const StatedUncertainty&) = default;
};

/// The sensor at a temperature input of the unit.
struct NamedInput {
  std::uint8_t input = 0;  ///< from 0
  std::string sensor;      ///< "t_spindle_degC"
  friend bool operator==(const NamedInput&, const NamedInput&) = default;
};

/// A rotary axis and its six curves on one grid, which closes if it goes round a turn.
struct MapRotaryAxis {
  RotaryAxis axis{};
  double start_deg = 0.0;
  double increment_deg = 10.0;
  /// Compensation by side (reverse, forward) and sense [um, um/m]; all empty: the curves are zero.
  std::array<std::array<std::vector<double>, 6>, 2> compensation{};
  friend bool operator==(const MapRotaryAxis&, const MapRotaryAxis&) = default;
};

/// Thesis 5.3: the file header that travels with the map and can be read back from the unit.
struct MapHeader {
  std::string customer;
  std::string machine;
  std::string serial_number;
  std::string date;  ///< ISO 8601
  std::string engineer;
  std::string configuration;  ///< chain string that the map was made for
  std::vector<SourceFile> sources;
  std::vector<DeclaredZero> declared_zero;
  std::vector<StatedUncertainty> uncertainty;
  std::vector<NamedInput> inputs;
  std::vector<ThermalRow> thermal;  ///< rows of the image, not of its header text
  ThermalSettings thermal_settings{};
  std::string rotary_configuration;     ///< with the rotary axes, "XYACTZ"; of the image, not of its header text
  std::vector<MapRotaryAxis> rotary;    ///< in the order of that string; likewise
  RotaryBending bending{};              ///< of the head; likewise
  std::vector<std::string> processing;  ///< one sentence per step: slope removed, smoothing, runs left out
  friend bool operator==(const MapHeader&, const MapHeader&) = default;
};

struct ErrorMap {
  MapHeader header;
  std::vector<MapTable> tables;  ///< by component, forward before reverse
  friend bool operator==(const ErrorMap&, const ErrorMap&) = default;
};

/// The table of a component for an approach: its own or the one for both; nullptr if none.
[[nodiscard]] const MapTable* table_of(const ErrorMap& map, Component component, Approach approach);

/// Compensation at a position; @pre the table is not empty.
[[nodiscard]] double compensation_at(const MapTable& table, double position_mm);
/// What the unit puts out for a table: linear, or the value of the nearest point. @pre the table is not empty
[[nodiscard]] double unit_value_at(const MapTable& table, Interpolation interpolation, double position_mm);

/// The largest |compensation| in the tables of a component; 0 if there are none.
[[nodiscard]] double largest_in(const std::vector<MapTable>& tables, Component component);

/// The header as lines `key: value`, as the CSV shows it behind `# `; and back. The unit stores it without its thermal
/// rows and settings, which are in the image as numbers.
/// Unknown keys are kept nowhere: they are reported.
[[nodiscard]] std::string header_text(const MapHeader& header);
[[nodiscard]] Result<MapHeader> parse_header(std::string_view text, const std::string& source_name);

/// A thermal row as its line has it: "EZZ shift input=5 coefficient=2.4 reference=21.5 lag_s=0 origin_mm=0".
[[nodiscard]] std::string to_text(const ThermalRow& row);
/// What a row follows: "input 5", "the load", "the motion of X", with the name of its sensor where the header has it.
[[nodiscard]] std::string source_text(const MapHeader& header, std::uint8_t source);

/// What stands against sending this map to a unit with these parameters; empty: nothing. Objections: a missing
/// component (named with what it is) or approach, a squareness that nobody measured, another chain, a component
/// declared zero that has values, a translation beyond the output limit, a table of one point, tables that do not reach
/// the reference position, forward and reverse of different extent. Worth knowing: components the scope does not use, a
/// value that jumps.
struct MapFinding {
  bool objection = true;  ///< false: worth knowing, no reason to refuse
  std::string message;
};
[[nodiscard]] std::vector<MapFinding> findings_for(const ErrorMap& map, const UnitParameters& parameters);

/// Says which squareness was measured for the map while the parameters hold 0, as before the parameters that `map
/// build` writes are used: then the unit would not correct it. Nothing: there is none.
[[nodiscard]] std::optional<std::string> squareness_left_behind(const MapHeader& header,
                                                                const UnitParameters& parameters);

/// "X axis roll error", "squareness of Y to X": what a component is, in words.
[[nodiscard]] std::string description_of(Component component);

/// Lower and upper end of each axis's travel, machine coordinates [mm]; absent: not known.
using Travels = PerAxis<std::optional<std::array<double, 2>>>;

/// findings_for() with the travels of the machine. It warns (no objection) where
/// - a component covers less than its axis's travel by more than one spacing of its points, or 5 % of the travel, at an
///   end; where no travel is known, what all tables of the axis cover together stands for it,
/// - forward and reverse end a spacing apart (more than that is an objection already),
/// - a table has two points only.
/// Tables that the parameters do not use are not judged.
[[nodiscard]] std::vector<MapFinding> findings_for(const ErrorMap& map, const UnitParameters& parameters,
                                                   const Travels& travels);

/// The warnings above alone.
[[nodiscard]] std::vector<MapFinding> coverage_warnings(const ErrorMap& map, const UnitParameters& parameters,
                                                        const Travels& travels);

/// Fields that a header should state and does not, in words: "customer", "machine", "serial number", "engineer",
/// "date".
[[nodiscard]] std::vector<std::string> missing_in(const MapHeader& header);

}  // namespace ecs::laser
