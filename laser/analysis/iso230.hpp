// Accuracy and repeatability of positioning by ISO 230-2:2014, the thesis's ±3 sigma band (BS 4656 Part 16), and
// VDI/DGQ 3441. Does not live here: finding the groups (laser/groups.hpp), maps and their processing (process.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/groups.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// One target position i. Values in um, or um/m for a rotation; absent = the readings do not give it.
/// Symbols of ISO 230-2:2014 clause 3; forward = ↑, reverse = ↓.
struct Iso230Target {
  double position_mm = 0.0;  ///< of a rotary axis [deg]
  int n_forward = 0;
  int n_reverse = 0;
  std::optional<double> mean_forward;  ///< x̄_i↑
  std::optional<double> mean_reverse;  ///< x̄_i↓
  std::optional<double> mean;          ///< x̄_i = (x̄_i↑ + x̄_i↓)/2; of all readings where no approach is known
  std::optional<double> s_forward;     ///< s_i↑, n − 1
  std::optional<double> s_reverse;     ///< s_i↓
  std::optional<double> s_undirected;  ///< where no approach is known
  std::optional<double> B;             ///< B_i = x̄_i↑ − x̄_i↓, reversal error
  std::optional<double> R_forward;     ///< R_i↑ = 4 s_i↑
  std::optional<double> R_reverse;     ///< R_i↓ = 4 s_i↓
  std::optional<double> R;             ///< R_i = max(2 s_i↑ + 2 s_i↓ + |B_i|, R_i↑, R_i↓)
};

/// The axis. Bidirectional values are absent where one approach only was measured; those with s where no target has
/// two readings from one side.
struct Iso230 {
  Axis axis = Axis::X;
  bool rotary = false;  ///< positions are in degrees
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  std::optional<bool> compensated;
  double merge_tolerance_mm = 0.0;    ///< positions closer than this were taken as one target
  std::vector<Iso230Target> targets;  ///< ascending
  std::optional<double> B;            ///< max |B_i|
  std::optional<double> B_mean;       ///< mean of B_i
  std::optional<double> M;            ///< range of x̄_i
  std::optional<double> R_forward;    ///< max R_i↑
  std::optional<double> R_reverse;    ///< max R_i↓
  std::optional<double> R;            ///< max R_i
  std::optional<double> E_forward;    ///< range of x̄_i↑
  std::optional<double> E_reverse;    ///< range of x̄_i↓
  std::optional<double> E;            ///< range of x̄_i↑ and x̄_i↓ together
  std::optional<double> A_forward;    ///< max(x̄_i↑ + 2 s_i↑) − min(x̄_i↑ − 2 s_i↑)
  std::optional<double> A_reverse;
  std::optional<double> A;  ///< the same over both approaches together
  std::optional<double>
      three_sigma_band;  ///< max(mean + 3s) − min(mean − 3s), both approaches (BS 4656 Pt 16, thesis 3.5.2)
  std::optional<double> non_repeatability;  ///< largest 6s at any target and approach (BS 4656 Pt 16, thesis 3.5.2)
  /// VDI/DGQ 3441, both approaches: positional scatter Ps_i = 6 (s_i↑ + s_i↓)/2, the largest; positional uncertainty
  /// P = max(x̄_i + (|B_i| + Ps_i)/2) − min(x̄_i − (|B_i| + Ps_i)/2). Its Pa is M, its U_max is B.
  std::optional<double> vdi_Ps;
  std::optional<double> vdi_P;
  double range = 0.0;              ///< largest minus smallest reading
  std::vector<std::string> notes;  ///< conditions of the standard that are not met, and what was left out
};

/// Evaluates one group. Readings of unknown approach are left out where others have one; where none has, the means,
/// M, the band and the range are given over all readings. `refused` if the group has no readings.
[[nodiscard]] Result<Iso230> iso230_of(const MeasurementSet& set, const Group& group);

}  // namespace ecs::laser
