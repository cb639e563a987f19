// The errors of rotary axes: error motions over the angle (EXC … ECC) and location errors (XOC, YOC, AOC, BOC, COC) by
// the names of ISO 230-7 and ISO 230-1, the file that holds them, and readings of rotary axes as such motions. Beside
// them the bending of a head.
// Does not live here: how they act at the tool (kinematics/), readings of linear axes, whose map a unit holds
// (laser/map/).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "kinematics/machine_pose.hpp"
#include "laser/map/error_map.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::volume {

/// One error motion: straight between its points. Where the points go round a whole turn they close, else the end
/// values hold beyond the ends.
struct RotaryTable {
  kinematics::Joint joint = kinematics::Joint::C;
  Sense sense = Sense::EX;
  Approach approach = Approach::unknown;  ///< unknown: both
  std::vector<double> p_deg;              ///< ascending
  std::vector<double> error;              ///< actual − target, tool against workpiece [um, um/m]
  std::vector<double> u;                  ///< standard uncertainties of them; empty: not stated
};

/// Two location errors of which a measurement tells only a sum: where `of` is larger by 1 than stated, `other` is
/// larger by `by`. Both as places in RotaryErrors::location.
struct LocationTie {
  std::array<std::size_t, 2> of{}, other{};
  double by = 0.0;
};

struct RotaryErrors {
  std::vector<RotaryTable> tables;
  /// Of A, B, C: place (XO., YO., ZO.) and direction (AO., BO., CO.) of its axis line at its pivot [um, um/m].
  std::array<std::array<double, 6>, kAxes> location{};
  /// Standard uncertainties of them, where they are stated.
  std::array<std::array<std::optional<double>, 6>, kAxes> location_u{};
  std::array<std::array<bool, 6>, kAxes> location_given{};
  std::vector<LocationTie> ties;  ///< the uncertainty of `other` includes what `of` adds to it
  RotaryBending bending{};        ///< of a head; not in the file
};

/// The two values of a table between which an angle is, with their weights; of sum 1.
struct TableWeights {
  std::array<std::size_t, 2> value{};
  std::array<double, 2> weight{1.0, 0.0};
};
/// @pre the table has values
[[nodiscard]] TableWeights weights_in(const RotaryTable& table, double angle_deg);

[[nodiscard]] double value_at(const RotaryTable& table, double angle_deg);

/// Error motions and location errors of every rotary axis by one side, at these angles; linear axes are left at 0.
[[nodiscard]] kinematics::JointValues rotary_values(const RotaryErrors& errors, const kinematics::Angles& angles_deg,
                                                    Approach side);

/// The errors of the rotary axes, and the bending, that a map says the machine has.
/// @param factor  -1: what the unit adds by it
[[nodiscard]] RotaryErrors rotary_errors_in(const laser::MapHeader& header, double factor = 1.0);

/// The table of a component by that side; null: none.
[[nodiscard]] const RotaryTable* table_of(const RotaryErrors& errors, kinematics::Joint joint, Sense sense,
                                          Approach side);

/// "EXC", "EAB"
[[nodiscard]] std::string rotary_name(kinematics::Joint joint, Sense sense);

/// "XOC", "AOB". @param rotary  0, 1, 2: A, B, C
[[nodiscard]] std::string location_name(std::size_t rotary, std::size_t sense);

/// CSV with the columns component, approach (1|-1|0 = both), p_deg, error [um, um/m], and u, its standard uncertainty,
/// where that is known; location errors with an empty p_deg. Column `with` of a location error: "YOC:-1", where it is
/// larger by 1, YOC is larger by -1; several with a space between. Every bad row is reported: a name that is no error
/// of a rotary axis, an axis that `chain` does not have, an angle beyond 3600 or twice.
[[nodiscard]] Result<RotaryErrors> parse_rotary_errors(std::string_view text, const std::string& file_name,
                                                       const kinematics::JointChain& chain);
[[nodiscard]] Result<RotaryErrors> read_rotary_errors(const std::filesystem::path& file,
                                                      const kinematics::JointChain& chain);

/// Mean of the readings at each target, by approach where it is known.
/// Refused: readings of a linear axis, a component measured at two parked positions.
[[nodiscard]] Result<RotaryErrors> measured_rotary_errors(const laser::MeasurementSet& set);

/// The text of a file for read_rotary_errors(). @param machine  of its header; empty: none
[[nodiscard]] std::string rotary_csv(const RotaryErrors& errors, const std::string& machine);

}  // namespace ecs::volume
