// Plans of batches (tests/fuzz/text_fuzz.cpp says how).
#include "modules/fleet/batch.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

const AddedParsers kFleet("batch_plan", [](std::string_view text) {
  const auto read = commissioning::parse_batch_plan(text, kFile, "/nowhere");
  if (!was_read(read)) return;
  check(!read->empty());
  for (const commissioning::PlannedUnit& unit : *read) check(!to_text(unit.link).empty());
});

}  // namespace ecs::fuzz
