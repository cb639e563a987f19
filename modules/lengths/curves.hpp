// The unknown components of a machine as sums of smooth curves, under the convention that makes lengths determine them:
// every curve is zero at the reference position (mean of both approaches), a straightness has no slope over the
// travel. What a rigid body could do to the whole machine is thereby taken out: lengths do not see it.
// Lengths as linear observations of these curves and of the stations and zeros of the instruments.
// Does not live here: the noise that readings share and least squares (shared_noise.hpp).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "core/terms.hpp"
#include "modules/lengths/length_test.hpp"
#include "params/machine.hpp"

namespace ecs::model {

[[nodiscard]] inline Eigen::Vector3d eigen(const Vector3& v) { return {v[0], v[1], v[2]}; }

/// Cubic B-splines (C. de Boor, A Practical Guide to Splines, 1978) on even knots over a travel, made orthonormal over
/// it, zero at the reference, on request without slope.
class SplineCurves {
 public:
  SplineCurves() = default;
  SplineCurves(const std::array<double, 2>& travel_mm, double reference_mm, int intervals, bool without_slope);
  [[nodiscard]] Eigen::Index size() const { return combine_.cols(); }
  /// Every function at a position; beyond the travel the end value holds.
  [[nodiscard]] Eigen::VectorXd at(double position_mm) const;

 private:
  [[nodiscard]] Eigen::VectorXd splines(double position_mm) const;
  [[nodiscard]] Eigen::VectorXd anchored(double position_mm) const;
  std::array<double, 2> travel_mm_{};
  int intervals_ = 1;
  double reference_mm_ = 0.0;
  Eigen::VectorXd at_reference_, slope_;
  Eigen::MatrixXd combine_;
};

/// The machine that lengths are measured on.
struct LengthMachine {
  Chain chain{};
  MeasurementLines lines_mm{};
  PerAxis<std::array<double, 2>> travel_mm{};
  Vector3 reference_mm{};
};
/// Refused: a machine with fewer than three axes.
[[nodiscard]] Result<LengthMachine> length_machine(const params::Machine& machine);

/// Which unknowns there are.
struct CurveSettings {
  PerAxis<double> knots_mm{};                      ///< spacing of the knots, about
  int reversal_degree = 1;                         ///< of half the difference of both approaches, as a polynomial
  std::array<bool, kComponents> zero{};            ///< declared zero
  std::vector<Vector3> tools_mm{{0.0, 0.0, 0.0}};  ///< in use: a component that none of them levers is left out
};

class MachineCurves {
 public:
  MachineCurves(const LengthMachine& machine, const CurveSettings& settings);

  /// Unknowns of a component.
  struct Block {
    Eigen::Index first = 0;
    Eigen::Index even = 0;  ///< of the mean of both approaches
    Eigen::Index odd = 0;   ///< of the reversal
    [[nodiscard]] Eigen::Index size() const { return even + odd; }
  };
  [[nodiscard]] const Block& block(Component c) const { return blocks_[index_of(c)]; }
  /// Whether it acts at the tool with one of the tools in use.
  [[nodiscard]] bool acts(Component c) const { return acts_[index_of(c)]; }
  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] const LengthMachine& machine() const { return machine_; }
  [[nodiscard]] const TermTable& terms() const { return terms_; }
  [[nodiscard]] int intervals(Axis axis) const { return intervals_[index_of(axis)]; }

  /// Value of a component by its unknowns [um, um/m]. @param approach  1, -1, or 0 for the mean of both
  [[nodiscard]] Eigen::VectorXd value_row(Component c, double position_mm, int approach) const;
  /// Error vector of the tool by all unknowns [um]: 3 rows. @param approach  of each axis; 0: mean of both
  [[nodiscard]] Eigen::MatrixXd error_rows(const Vector3& position_mm, const PerAxis<int>& approach,
                                           const Vector3& tool_mm) const;
  /// The same counted from the reference position, where the error is the mean of both approaches.
  [[nodiscard]] Eigen::MatrixXd volume_rows(const Vector3& position_mm, const PerAxis<int>& approach,
                                            const Vector3& tool_mm) const;
  /// The lever of a term [mm].
  [[nodiscard]] double lever_mm(const Term& term, const Vector3& position_mm, const Vector3& tool_mm) const;

 private:
  LengthMachine machine_;
  TermTable terms_;
  int reversal_degree_ = 0;
  PerAxis<int> intervals_{};
  PerAxis<std::array<SplineCurves, 2>> splines_;  ///< with slope, without
  std::array<Block, kComponents> blocks_{};
  std::array<bool, kComponents> acts_{};
  Eigen::Index size_ = 0;
};

/// Places over the volume: `count` even coordinates of each axis, all axes forward, then all in reverse.
struct VolumePlace {
  Vector3 position_mm{};
  PerAxis<int> approach{1, 1, 1};
};
[[nodiscard]] std::vector<VolumePlace> volume_places(const LengthMachine& machine, int count);

/// Mean over places and tools of JᵀJ: rms² of the error vector = trace(weight · covariance).
[[nodiscard]] Eigen::MatrixXd volume_weight(const MachineCurves& curves, const std::vector<Vector3>& tools_mm,
                                            int count);

/// Columns of what belongs to the measurement: of each set-up and tool a correction of the station [mm → um], of each
/// set-up, run and tool a zero [um], of each set-up a scale [um/m] of known standard deviation. A placement of points
/// has a translation in place of the station and the zeros, and a rotation.
struct NuisanceColumns {
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Index> station;     ///< by set-up and tool: first of three
  std::map<std::tuple<std::size_t, int, std::size_t>, Eigen::Index> zero;  ///< by set-up, run and tool
  std::map<std::size_t, Eigen::Index> scale;                               ///< by set-up
  std::map<std::size_t, Eigen::Index> rotation;  ///< by set-up of points: first of three [um/m]
  std::optional<Eigen::Index> bar;  ///< in place of the zeros of ball bars, where the length of the bar is known
  Eigen::Index first = 0;           ///< behind the machine's unknowns
  Eigen::Index end = 0;
};
[[nodiscard]] NuisanceColumns nuisance_of(const LengthTest& test, Eigen::Index first);

/// Where the unknowns stand about which the observations are linear.
struct Linearised {
  Eigen::MatrixXd columns;     ///< by reading and unknown
  Eigen::VectorXd nominal_um;  ///< deviation at the values given
  Eigen::MatrixXd direction;   ///< unit vectors, a row each
};
/// How the translation [um] and the rotation [um/m] of a placement change a deviation.
/// @param from_mm  the point about which it turns
struct PlacementRows {
  Eigen::RowVector3d translation, rotation;
};
[[nodiscard]] PlacementRows placement_rows(const Vector3& along, const Eigen::Vector3d& point_mm,
                                           const Eigen::Vector3d& from_mm);

/// @param values  of all unknowns; zeros to begin with
[[nodiscard]] Linearised linearised(const LengthTest& test, const MachineCurves& curves,
                                    const NuisanceColumns& nuisance, const Eigen::VectorXd& values);

}  // namespace ecs::model
