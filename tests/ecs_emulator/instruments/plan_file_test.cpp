#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "ecs_emulator/instruments/files.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;
using Json = nlohmann::json;

namespace {

Result<std::vector<std::string>> requests_in(const std::string& text, const std::string& phase = "before") {
  const Folder folder;
  REQUIRE(write_file(folder.path / "plan.toml", text).has_value());
  return requests_of(folder.path / "plan.toml", {phase, "/out", "1990-03-12", "B. Nada"});
}

std::string complaint_on(const std::string& text) {
  const auto requests = requests_in(text);
  REQUIRE(!requests.has_value());
  CHECK(requests.error().kind == ProblemKind::bad_input);
  return to_text(requests.error());
}

}  // namespace

TEST_CASE("the mill's plan asks for 19 measurements before compensation and for 14 after") {
  const auto before = requests_of("samples/mill/plan.toml", {"before", "/out", "", ""});
  const auto after = requests_of("samples/mill/plan.toml", {"after", "/out", "", ""});
  REQUIRE_MESSAGE(before.has_value(), (before ? "" : to_text(before.error())));
  REQUIRE(after.has_value());
  CHECK(before->size() == 19);
  CHECK(after->size() == 14);
  CHECK(Json::parse(before->front()) == Json{{"action", "measure"},
                                             {"axis", "X"},
                                             {"sense", "EX"},
                                             {"instrument", "linear"},
                                             {"from", 0.0},
                                             {"to", -4100.0},
                                             {"step", 50.0},
                                             {"runs", 3},
                                             {"feed", 2000.0},
                                             {"parked", {{"Y", -1400.0}, {"Z", 0.0}}},
                                             {"plan_name", "moving column mill, thesis chapters 6 and 7"},
                                             {"output", Json::array({"/out/EXX.csv"})}});
  CHECK(Json::parse(before->back())["output"][0] == "/out/A0Z.csv");
}

TEST_CASE("date and engineer go into every request, and rows without a phase belong to both") {
  for (const std::string phase : {"before", "after"}) {
    const auto requests = requests_in(R"(
[[measure]]
name = "EXX"
axis = "X"
[[measure]]
name = "EYY"
on_the_fly = true
)",
                                      phase);
    REQUIRE(requests.has_value());
    REQUIRE(requests->size() == 2);
    const Json second = Json::parse(requests->back());
    CHECK(second["date"] == "1990-03-12");
    CHECK(second["engineer"] == "B. Nada");
    CHECK(second["on_the_fly"] == true);
    CHECK(!second.contains("axis"));
    CHECK(!second.contains("plan_name"));
  }
}

TEST_CASE("every wrong key or value of a plan is reported with its line") {
  const std::string text = complaint_on(R"(runs = "three"
feed = 2000.0
[[measure]]
name = "a/b"
from_mm = "here"
[[measure]]
name = "EXX"
axes = "X"
phase = "between"
parked_mm = { y = "top" }
on_the_fly = "yes"
)");
  CAPTURE(text);
  for (const int line : {1, 2, 4, 5, 8, 9, 10, 11}) CHECK(contains(text, "plan.toml:" + std::to_string(line) + ":"));
  CHECK(contains(text, "without a slash"));
  CHECK(contains(text, "phase: expected before, after or both, got \"between\""));
}

TEST_CASE("a plan that is not TOML, has nothing to measure, or asks for part of a run is refused") {
  CHECK(contains(complaint_on("runs = \n"), "plan.toml:1:"));
  CHECK(contains(complaint_on("measure = 3\n"), "expected [[measure]] tables"));
  CHECK(contains(complaint_on("name = \"empty\"\n"), "[[measure]]"));
  CHECK(contains(complaint_on("runs = 2.5\n[[measure]]\nname = \"EXX\"\n"), "runs: expected a whole number"));
  CHECK(!requests_of("samples/mill/no_such_plan.toml", {"before", "/out", "", ""}).has_value());
}
