#include "params/observed_datum.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/words.hpp"

namespace ecs::params {
namespace {

constexpr double kTurnedBack_mm = 0.5;            ///< a servo swings less when it stops
constexpr std::size_t kChangesOfOneApproach = 2;  ///< the switch reached and left again

/// Whether the axis went back from where it had come to after this sample.
bool turned_back(const DatumSequence& sequence, std::size_t from) {
  const double onward = sequence.speed_mm_min[from] >= 0.0 ? 1.0 : -1.0;
  const auto along_mm = [&](std::size_t i) {
    return onward * sequence.samples[i].counts * sequence.um_per_count * 1e-3;
  };
  double furthest = along_mm(from);
  for (std::size_t i = from; i < sequence.samples.size(); ++i) {
    furthest = std::max(furthest, along_mm(i));
    if (along_mm(i) < furthest - kTurnedBack_mm) return true;
  }
  return false;
}

DatumKind kind_of(bool turned, bool closed_at_marker) {
  if (turned) return DatumKind::allen_bradley;
  return closed_at_marker ? DatumKind::siemens : DatumKind::fanuc;
}

}  // namespace

std::string_view word_of(DatumKind kind) {
  return WordTable<DatumKind, 3>{{"fanuc", "allen_bradley", "siemens"}}.of(kind);
}

ObservedDatum observed_datum(const DatumSequence& sequence) {
  ObservedDatum out;
  const auto& samples = sequence.samples;
  if (samples.empty() || !sequence.moved) {
    out.lack = ObservedDatum::Lack::motion;
    return out;
  }
  std::size_t at_switch = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].switch_closed == samples[i - 1].switch_closed) continue;
    if (out.switch_changes++ == 0) at_switch = i;
  }
  if (out.switch_changes == 0) out.lack = ObservedDatum::Lack::switch_change;
  if (out.switch_changes > kChangesOfOneApproach) out.lack = ObservedDatum::Lack::clear_start;
  if (out.lack != ObservedDatum::Lack::none) return out;
  out.forward = sequence.speed_mm_min[at_switch] >= 0.0;
  out.approach_mm_min = std::abs(sequence.speed_mm_min[at_switch]);
  out.initially_closed = samples.front().switch_closed;
  std::optional<std::size_t> marker;
  for (std::size_t i = at_switch; i < samples.size(); ++i)
    if (samples[i].marker) marker = i;
  if (!marker) {
    out.lack = ObservedDatum::Lack::marker;
    return out;
  }
  out.marker = *marker;
  out.finally_closed = samples[*marker].switch_closed;
  out.turned_back = turned_back(sequence, at_switch);
  out.kind = kind_of(out.turned_back, out.finally_closed);
  return out;
}

}  // namespace ecs::params
