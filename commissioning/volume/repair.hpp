// Repair or compensate: what each cause of an error model costs if it is left, if the unit compensates it, if it is
// repaired at the machine; in the readings, in the volume and on a circle.
// Does not live here: the fit (model/), what the unit does with a map (volume/).
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/models/work.hpp"

namespace ecs::commissioning {

/// Over what the fit leaves possible.
struct Expected {
  double um = 0.0;  ///< the size that most of it agrees with, within 10 % or 1 um
  double least_um = 0.0;
  double at_most_um = 0.0;  ///< with 95 %
  double share = 0.0;       ///< of what is possible that agrees
};

/// One quantity, everything that the unit can compensate being compensated but for the cause itself. The map is that of
/// the fitted values; the machine has others, as far as the fit leaves them uncertain.
struct Remaining {
  Expected left;         ///< the cause is as it is
  Expected compensated;  ///< the unit compensates it, if it can
  Expected repaired;     ///< the machine does not have it any more
};

enum class Remedy : std::uint8_t {
  compensate,  ///< the unit can; repairing gains no more
  repair,      ///< the unit cannot
  set_up,      ///< the machine does not have it: put the measurement right
  nothing,     ///< neither gains anything
};

struct CauseCost {
  model::EffectInstance effect;
  Remedy remedy = Remedy::nothing;
  std::string how;  ///< what to do about it
  Remaining readings_rms;
  Remaining volume_largest;
  Remaining volume_rms;
  Remaining circle;  ///< G: range of the radial deviations about their least-squares centre (ISO 230-4)
};

struct RepairAnswer {
  std::vector<CauseCost> causes;  ///< those that cost most first
  std::size_t readings = 0;
  std::size_t places = 0;    ///< of the volume, each from both sides
  double diameter_mm = 0.0;  ///< of the circle; 0: the machine has one axis only
  std::string plane;         ///< "XY"
  double noise_um = 0.0;     ///< of one reading
  std::vector<std::string> notes;
};

/// @param places  in the volume, at most
/// The same input gives the same answer: the draws of repair_places.hpp have a fixed seed.
/// Refused: no machine file, an axis without a travel, an effect without a value, rotary axes.
[[nodiscard]] Result<RepairAnswer> repair_answer(const ModelWork& work, const std::string& model_file,
                                                 std::size_t places);

[[nodiscard]] Cell repair_cell(const RepairAnswer& answer);

}  // namespace ecs::commissioning
