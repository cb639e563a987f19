// The causes of a circular test, ranked by their share: which faults of circle_faults() the deviations hold, how large,
// and which others these readings cannot tell from them. Does not live here: G, F and D (laser/standards/circle.hpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/circle_test.hpp"

namespace ecs::model {

/// Chance that noise alone has any fault named, of all that are tried.
inline constexpr double kFalseCircleFault = 0.01;

struct CircleFaultFound {
  std::string name;                          ///< "backlash:X"
  std::string title;                         ///< "backlash of X"
  double value = 0.0;                        ///< in `unit`; of a wave its amplitude
  double sigma = 0.0;                        ///< standard uncertainty of it
  std::string unit;                          ///< "um", "um/m"
  std::string component;                     ///< "C0Y" where the value is that of ISO 230-1, in its sign; empty: none
  double nonlinear_mm = 0.0;                 ///< decay of a spike, pitch of a wave; 0: none
  std::optional<double> nonlinear_sigma_mm;  ///< standard uncertainty of a decay; none: it is at a limit, or no decay
  double rms_um = 0.0;                       ///< of its part of the deviations, centre and radius taken off
  double range_um = 0.0;  ///< largest less smallest of its part: the circular deviation that it makes alone
  double share = 0.0;     ///< of the mean squares of all parts and of the rest, which add up to 1
  double ln_p = 0.0;      ///< ln of the chance of noise to do as well, times the number of faults tried
  std::vector<std::string>
      indistinguishable_from;  ///< names of faults that explain these readings as well in its place
};

struct CircleDiagnosis {
  double rms_um = 0.0;                   ///< of the deviations, centre and radius of each pass taken off
  double noise_um = 0.0;                 ///< of a single reading
  bool noise_from_repeats = false;       ///< else from neighbouring readings, which cannot see slow noise
  double inflation = 1.0;                ///< variance of a mean of correlated noise in that of independent readings
  double left_um = 0.0;                  ///< rms of what the faults leave
  double explained = 0.0;                ///< 1 − (left/rms)²
  double lack_of_fit_ln_p = 0.0;         ///< ln of the chance that noise leaves as much
  std::vector<CircleFaultFound> faults;  ///< the largest rms first; empty: what is there is noise, or no fault fits
  std::vector<std::string> notes;        ///< what these data cannot say, in words
};

/// Structure is left where noise leaves as much with a smaller chance than this.
inline constexpr double kLackOfFit = 0.001;

/// Where pitches come from: what to do for missing ones.
enum class PitchSource { nowhere, machine_file };

/// @param pitches_mm  known pitches of the first and the second axis, for waves
/// Problem (bad_input): fewer than 48 readings.
[[nodiscard]] Result<CircleDiagnosis> diagnose_circle(const laser::CircleTest& test,
                                                      const std::array<std::vector<double>, 2>& pitches_mm,
                                                      PitchSource source = PitchSource::nowhere);

}  // namespace ecs::model
