// Every mode, fault, stage and failure has words for the person who must act on it.
#include "core/fault.hpp"

#include <set>

#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("every fault has its own name, a meaning and an action") {
  std::set<std::string> names;
  for (std::uint16_t f = 0; f < kFaultCount; ++f) {
    const FaultText text = text_of(static_cast<Fault>(f));
    CHECK(names.insert(std::string(text.name)).second);
    CHECK(!text.meaning.empty());
    CHECK(!text.action.empty());
  }
  CHECK(text_of(Fault::ram_test).name == "ram_test");
  CHECK(text_of(Fault::user_software).name == "user_software");
  CHECK(text_of(static_cast<Fault>(kFaultCount)).name == "unknown");
}

TEST_CASE("modes, stages and failures have names, numbers beyond them are unknown") {
  CHECK(name_of(UnitMode::halted) == "halted");
  CHECK(name_of(static_cast<UnitMode>(5)) == "unknown");
  CHECK(name_of(DatumStage::failed) == "failed");
  CHECK(name_of(static_cast<DatumStage>(6)) == "unknown");
  CHECK(name_of(DatumFailure::no_marker) == "no marker");
  CHECK(advice_for(DatumFailure::no_marker) == "check the marker signal of the transducer");
  CHECK(name_of(DatumFailure::stopped_early) == "stopped early");
  CHECK(name_of(static_cast<DatumFailure>(8)) == "unknown");
}
