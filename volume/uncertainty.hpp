// How certain the error of a volume is after compensation by a map: each value of the map with its standard
// uncertainty, propagated to the tool. Linearly with the covariance along each curve (JCGM 100:2008, GUM, 5.2.2), and
// by drawing whole maps (JCGM 101:2008), because the largest error of a volume is no linear function of them.
// Does not live here: the repeatability of measured lines (laser/analysis/shrinking.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "volume/volume.hpp"

namespace ecs::volume {

/// Standard uncertainties (k = 1) of what neither a map nor its measurements state.
struct UncertaintySettings {
  std::optional<double> repeatability;    ///< of every table value [um, um/m]; absent: as the map states
  double instrument_um_per_m = 0.25;      ///< of positioning, by the distance from the reference
  double temperature_degC = 0.05;         ///< of the scale or workpiece while positioning was measured
  double expansion_um_per_m_degC = 11.7;  ///< that turns it into a length (steel)
  double declared_zero = 1.0;             ///< of a component that nobody measured [um, um/m]
  double squareness_um_per_m = 1.0;       ///< of the square or of what else squareness was taken from
  std::size_t draws = 400;                ///< of whole maps
  std::size_t seed = 1;
};

/// Where the repeatability of a table is known from.
enum class RepeatabilityFrom { header, option, roughness, nothing };

/// Standard uncertainties (k = 1) of one curve of a map, by cause [um, um/m].
struct CurveUncertainty {
  Component component = Component::EXX;
  RepeatabilityFrom from = RepeatabilityFrom::nothing;
  double value = 0.0;               ///< of each table value, independent of the others
  double pass = 0.0;                ///< common to a table: a smooth shape along the travel
  double degrees_of_freedom = 0.0;  ///< of `pass`, as an estimate
  double between = 0.0;             ///< midway between two values: the curvature that straight lines leave out
  double per_m = 0.0;       ///< by the distance from the reference, the same from both sides: instrument, temperature
  double unmeasured = 0.0;  ///< declared zero or missing: a smooth shape, the same from both sides
};

struct UncertaintyBudget {
  std::array<CurveUncertainty, kCurves> curves{};  ///< by component; those that do not act at the tool are 0
  ComponentValues squareness_um_per_m{};
};

/// What the header of a map states, completed by the settings. A table without a stated repeatability gets that of its
/// own roughness: third differences, of which noise has √20 times its standard deviation.
[[nodiscard]] UncertaintyBudget budget_of(const CompensatedMachine& machine, const UncertaintySettings& settings);

/// Standard uncertainty of every value of a table of the map, all causes together [um, um/m].
[[nodiscard]] std::vector<double> uncertainties_of(const laser::MapTable& table, const CompensatedMachine& machine,
                                                   const UncertaintyBudget& budget);

using Covariance = std::array<Vector3, kAxes>;  ///< [um²]

/// Linear propagation.
/// @return of the error vector at a place, counted from the reference, all axes having arrived by that side
[[nodiscard]] Covariance covariance_at(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                       const Vector3& position_mm, std::size_t side);

/// √(mean squared standard uncertainty of the error vector) over the places of a grid, by linear propagation [um].
[[nodiscard]] double linear_rms_um(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                   const Grid& grid);

/// Of the mean squared standard uncertainty over the places of a grid, to which each curve contributes an estimated
/// `pass` (F. E. Satterthwaite, Biometrics Bull. 2 (1946) 110; GUM G.4.1, eq. G.2b). Infinite: nothing is an estimate.
[[nodiscard]] double effective_degrees_of_freedom(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                                  const Grid& grid);

/// Drawing whole maps: normal, all of a map by one factor larger or smaller as Student's t with the effective degrees
/// of freedom is. Were each curve drawn from a t of its own few degrees, the sum of many would be wider by √(ν/(ν −
/// 2)), although estimates that are independent do not err together.
class MapDraws {
 public:
  MapDraws(const CompensatedMachine& machine, const UncertaintyBudget& budget, std::uint64_t seed);
  /// Draws the errors of one map.
  void next();
  /// Those of the last draw over a grid, counted from the reference.
  [[nodiscard]] Field over(const Grid& grid) const;
  /// The same as components.
  [[nodiscard]] Components components_over(const Grid& grid) const;

 private:
  /// Drawn numbers of one table; one without values has shapes alone.
  struct Table {
    std::vector<double> value, between;
    std::array<double, 6> pass{};
  };
  struct Curve {
    std::array<Table, 2> side;
    std::array<double, 6> unmeasured{};
    double per_m = 0.0;
  };
  const CompensatedMachine& machine_;
  const UncertaintyBudget& budget_;
  Kinematics kinematics_;
  std::mt19937_64 generator_;
  double degrees_of_freedom_;
  std::array<Curve, kCurves> curves_{};
  ComponentValues squareness_{};
};

/// What the volume may hold after compensation.
struct VolumeUncertainty {
  double largest_95_um = 0.0;  ///< the largest error after compensation is below this with 95 %
  double rms_95_um = 0.0;
  double largest_50_um = 0.0;  ///< and below this with 50 %
  double rms_50_um = 0.0;
  double linear_rms_um = 0.0;  ///< √(mean squared standard uncertainty of the error vector) over the volume, by linear
                               ///< propagation
  double drawn_rms_um = 0.0;  ///< the same, by the draws
};

/// @param machine  its errors are what is known: what is left of them is the expected value
/// @param places   of the grid of which the largest error is asked for
[[nodiscard]] Result<VolumeUncertainty> uncertainty_of(const CompensatedMachine& machine,
                                                       const UncertaintyBudget& budget,
                                                       const UncertaintySettings& settings, std::size_t places);

}  // namespace ecs::volume
