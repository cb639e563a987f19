// Recordings of the servo and its constants (tests/fuzz/text_fuzz.cpp says how).
#include <algorithm>
#include <array>
#include <cmath>

#include "modules/traces/trace.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

void drive(std::string_view text) {
  const auto read = model::parse_drive(text, kFile);
  if (!was_read(read)) return;
  for (const double value : read->value) check(std::isfinite(value) && value > 0.0);
}

void trace(std::string_view text) {
  const auto read = model::parse_trace(text, kFile);
  if (!was_read(read)) return;
  all_finite(read->time_s);
  check(!read->signals.empty() && std::is_sorted(read->time_s.begin(), read->time_s.end()));
  for (const model::RecordedSignal& signal : read->signals) {
    check(signal.value.size() == read->time_s.size() && signal.noise > 0.0);
    all_finite(signal.value);
    all_finite(std::array{signal.quantum, signal.noise});
    all_finite(std::array{signal.clipped_above, signal.clipped_below});
    const model::StepShape shape = model::shape_of(read->time_s, signal.value, signal.noise);
    all_finite(std::array{shape.start_s, shape.steady, shape.rise_s, shape.decay_start_s, shape.fall_s});
  }
}

const AddedParsers kTraces{{"drive", drive}, {"trace", trace}};

}  // namespace ecs::fuzz
