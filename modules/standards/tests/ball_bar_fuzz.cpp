// Results of ball bars (text_fuzz.cpp says how).
#include "modules/standards/ball_bar.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

const AddedParsers kBallBar("ball_bar", [](std::string_view text) {
  const auto read = commissioning::parse_ball_bar(text, kFile);
  if (!was_read(read)) return;
  check(!read->features.empty() && read->plane[0] != read->plane[1]);
  for (const commissioning::BallBarFeature& feature : read->features) check_finite(feature.value);
});

}  // namespace ecs::fuzz
