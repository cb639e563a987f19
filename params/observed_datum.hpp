// What a recorded datum sequence shows of the datuming parameters (thesis 5.3: datum types of the controller families).
// Does not live here: recording it and its file (commissioning/unit/datum_recording.hpp), the routine (core/datum.hpp).
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/datum.hpp"
#include "core/parameters.hpp"

namespace ecs::params {

/// A sequence as it was recorded, from the axis at rest.
struct DatumSequence {
  std::span<const DatumSample> samples;
  std::span<const double> speed_mm_min;  ///< at each sample, signed
  double um_per_count = 1.0;
  bool moved = false;
};

struct ObservedDatum {
  enum class Lack {
    none,
    motion,         ///< the axis did not move
    switch_change,  ///< it did not reach the reference switch
    clear_start,    ///< it began near the switch or on it: nothing can be read from the record
    marker,         ///< none came after the switch: kind and final state are not known
  };
  Lack lack = Lack::none;
  std::size_t switch_changes = 0;
  bool forward = true;           ///< approach direction
  double approach_mm_min = 0.0;  ///< speed at the switch
  bool initially_closed = false;
  std::size_t marker = 0;       ///< sample of the last marker: a control stops behind the one that it takes
  bool finally_closed = false;  ///< the switch at that marker
  bool turned_back = false;     ///< after it had reached the switch
  DatumKind kind = DatumKind::fanuc;
};

/// As parameter files say it.
[[nodiscard]] std::string_view word_of(DatumKind kind);

[[nodiscard]] ObservedDatum observed_datum(const DatumSequence& sequence);

}  // namespace ecs::params
