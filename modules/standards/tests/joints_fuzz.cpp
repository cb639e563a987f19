// Points around joints (text_fuzz.cpp says how).
#include "modules/standards/joints.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

const AddedParsers kJoints("joints", [](std::string_view text) {
  const auto read = laser::parse_joints(text, kFile);
  if (!was_read(read)) return;
  check(!read->empty());
  for (const laser::JointSweep& sweep : *read)
    if (const auto axis = laser::joint_axis_of(sweep, kFile); was_read(axis)) {
      all_finite(axis->centre_mm);
      all_finite(axis->direction);
      check_finite(axis->radius_mm);
      check(axis->points >= 5 && axis->radius_mm >= 0.0);
    }
});

}  // namespace ecs::fuzz
