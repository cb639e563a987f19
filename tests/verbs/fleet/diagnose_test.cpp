#include <doctest/doctest.h>
#include <sys/stat.h>

#include "tests/support/fleet_folder.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a fleet with missing, unreadable and doubled sets is told by line, the rest is done, exit code 1") {
  const FleetFolder fleet;
  static_cast<void>(fleet.folder.with("odd.csv", "axis,sense,x_mm,reading\nX,EX,0,nonsense\n"));
  REQUIRE(::mkfifo((fleet.folder / "pipe.csv").c_str(), 0600) == 0);
  const Ran r = fleet.diagnose(fleet.manifest(FleetFolder::row(0) + "gone,model.toml,gone.csv,machine.toml,mill,b\n" +
                                              "odd,model.toml,odd.csv,machine.toml,mill,b\n" + FleetFolder::row(0) +
                                              "pipe,model.toml,pipe.csv,,,\ntoo,few\n" + FleetFolder::row(2)));
  CHECK(r.code == 1);
  const auto answer = r.json();
  CHECK(answer["machines"] == 7);
  CHECK(answer["diagnosed"] == 2);
  CHECK(answer["error_count"] == 5);
  CHECK(answer["errors"][0]["line"] == 3);
  CHECK(answer["errors"][0]["id"] == "gone");
  CHECK(contains(answer["errors"][1]["message"].get<std::string>(), "odd.csv:2"));
  CHECK(contains(answer["errors"][2]["message"].get<std::string>(), "that of line 2"));
  CHECK(contains(answer["errors"][3]["message"].get<std::string>(), "expected a file"));
  CHECK(answer["errors"][4]["id"].is_null());
  CHECK(contains(r.messages, "fleet.csv:3: "));
  std::size_t errors = 0, answers = 0;
  for (const std::string& line : fleet.lines()) {
    const auto one = nlohmann::json::parse(line);
    ++(one.contains("error") ? errors : answers);
    if (!one.contains("error")) check_has(one, {"id", "hash", "verdict", "causes", "processor_s", "type", "batch"});
  }
  CHECK(answers == 2);
  CHECK(errors == 5);
  const auto cause = nlohmann::json::parse(fleet.lines()[1])["causes"];
  CHECK((cause.empty() || cause[0].contains("e_value")));
}

TEST_CASE("a second run of a fleet does nothing again, and mended sets are done") {
  const FleetFolder fleet;
  const std::string rows = FleetFolder::row(0) + "late,model.toml,late.csv,machine.toml,mill,b\n";
  CHECK(fleet.diagnose(fleet.manifest(rows)).code == 1);
  static_cast<void>(fleet.folder.with("late.csv", measured_x(straight_x)));
  const Ran again = fleet.diagnose(fleet.manifest(rows));
  CHECK(again.code == 0);
  CHECK(again.json()["skipped"] == 1);
  CHECK(again.json()["diagnosed"] == 1);
  CHECK(fleet.answers().size() == 2);
}

TEST_CASE("a file that holds no results of a fleet is not written to") {
  const FleetFolder fleet;
  const std::string manifest = fleet.manifest(FleetFolder::row(0));
  const std::string letter = fleet.folder.with("results.jsonl", "Dear Sir,\nno results here.\n");
  const Ran r = fleet.diagnose(manifest);
  CHECK(r.code == 2);
  CHECK(content_of(letter) == "Dear Sir,\nno results here.\n");
  CHECK(fleet.diagnose(fleet.folder.with("bad.csv", "id,data\nm,a\n")).code == 3);
  CHECK(fleet.diagnose(fleet.folder / "none.csv").code == 3);
}

}  // namespace
}  // namespace ecs::app
