// What was done goes to whoever keeps records of it, and nowhere where nobody does.
#include "commissioning/session/records.hpp"

#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

std::vector<std::string> kept_kinds;

constexpr RecordKeeper kListOfKinds{
    .record = [](LogRecord one) { kept_kinds.push_back(one.kind); },
    .watch = []() -> std::unique_ptr<FileWatch> { return nullptr; },
    .rest = [](std::chrono::milliseconds) { kept_kinds.emplace_back("rest"); },
    .end = []() -> std::optional<RecordsEnd> {
      return RecordsEnd{"list", kept_kinds.size(), "none"};
    },
    .uses = [](const std::vector<std::string>& sha256) -> std::optional<std::vector<RecordedUse>> {
      return std::vector(1, RecordedUse{.number = 7, .sha256 = sha256.front()});
    },
};

TEST_CASE("what was done is told to the keeper, as long as there is one") {
  REQUIRE_FALSE(records_are_kept());
  record(LogRecord{.kind = "map"});
  let_records_rest();
  CHECK(kept_kinds.empty());
  CHECK(watch_for_records() == nullptr);
  CHECK_FALSE(records_end());
  CHECK_FALSE(recorded_uses({"00"}));
  let_keep_records(&kListOfKinds);
  record(LogRecord{.kind = "parameters"});
  let_records_rest();
  CHECK(records_end()->entries == 2);
  CHECK(only(*recorded_uses({"00"})).number == 7);
  let_keep_records(nullptr);
  record(LogRecord{.kind = "report"});
  CHECK(kept_kinds == std::vector<std::string>{"parameters", "rest"});
}

}  // namespace
}  // namespace ecs::commissioning
