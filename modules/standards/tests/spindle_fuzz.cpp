// Traces of spindles (tests/fuzz/text_fuzz.cpp says how).
#include <algorithm>
#include <array>

#include "modules/standards/spindle.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

void spindle_trace(std::string_view text) {
  const auto read = laser::parse_spindle_trace(text, kFile);
  if (!was_read(read)) return;
  all_finite(read->turn);
  check(std::is_sorted(read->turn.begin(), read->turn.end()));
  for (const auto& values : read->value_um) {
    check(values.empty() || values.size() == read->turn.size());
    all_finite(values);
  }
  const laser::SpindleTest test = laser::spindle_test_of(*read);
  check(!test.motions.empty() && test.turns >= laser::kLeastSpindleTurns);
  for (const laser::SpindleMotion& motion : test.motions) {
    all_finite(motion.mean);
    all_finite(std::array{motion.total, motion.synchronous, motion.asynchronous, motion.if_noise.asynchronous});
    check(motion.turns.size() == test.turns && motion.total >= motion.asynchronous);
  }
}

const AddedParsers kSpindle{"spindle_trace", spindle_trace};

}  // namespace ecs::fuzz
