// Acceptance limits and freezes (tests/fuzz/text_fuzz.cpp says how).
#include "modules/judging/judging.hpp"
#include "tests/fuzz/parsers.hpp"

namespace {

using namespace ecs;
using namespace ecs::fuzz;

void judging_limits(std::string_view text) {
  const auto read = commissioning::parse_judging_limits(text, kFile);
  if (!was_read(read)) return;
  check(!read->groups.empty());
  for (const auto& [column, range] : read->inside) check(range.least <= range.greatest);
  for (const commissioning::HeldOutGroups& groups : read->groups) {
    check(groups.readings >= 4 && groups.share >= 0.0 && groups.share < 1.0 && (groups.inside || groups.beyond));
    for (const auto& limit : {groups.inside, groups.beyond}) check(!limit || limit->rms_um > 0.0);
  }
}

/// What was read is written and read again; with one byte more it is refused. The seal holds off nearly every other
/// text.
void frozen_model(std::string_view text) {
  const auto read = commissioning::parse_frozen_model(text, kFile);
  if (!was_read(read)) return;
  const std::string written = commissioning::to_json(*read);
  const auto again = commissioning::parse_frozen_model(written, kFile);
  check(again && *again == *read);
  check(!commissioning::parse_frozen_model(written + "}", kFile));
}

const AddedParsers kJudging{{{"judging_limits", judging_limits}, {"frozen_model", frozen_model}}};

}  // namespace
