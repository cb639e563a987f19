// The sample samples/laser/x_axis.csv holds 200 mm of an axis of 4100 mm: what the verbs say of a map made from it.
#include "commissioning/maps/findings.hpp"

#include <doctest/doctest.h>

#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const char* const kParameters = R"([identity]
machine = "moving column mill"
[configuration]
chain = "TX"
axes = "X"
[compensation]
scope = "linear"
[axis.X]
transducer = "encoder"
# end of parameters
)";
const char* const kMachine = R"(configuration = "TX"
name = "moving column mill"
[axis.X]
travel_mm = [-4100.0, 0.0]
)";

struct Workspace {
  Folder folder;
  std::string params = folder.with("p.toml", kParameters);
  std::string map = folder / "map.csv";
  [[nodiscard]] Ran build(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"map", "build", "samples/laser/x_axis.csv", "--params", params, "-o", map};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

const char* const kShort = "EXX covers 200 of 4100 mm of the travel of X (-4100 to 0)";

TEST_CASE("a map of a piece of the axis is complete with remarks, wherever the travel is known from") {
  const Workspace workspace;
  SUBCASE("a machine file that is named") {
    const std::string machine = workspace.folder.with("elsewhere.toml", kMachine);
    const Ran r = workspace.build({"--machine", machine});
    CHECK(r.code == 0);
    CHECK(r.out.find(std::string("remark: ") + kShort) != std::string::npos);
    CHECK(r.out.find("EXX has 2 points forward, 2 in reverse") != std::string::npos);
    CHECK(r.out.find("EXX: forward is measured from -100 to 0 mm only, reverse from -200 to -100 mm") !=
          std::string::npos);
    CHECK(r.out.find("the map is complete, 3 remarks") != std::string::npos);
    CHECK(r.out.find("nothing is missing") == std::string::npos);
    const Ran shown = ran({"map", "show", workspace.map, "--params", workspace.params, "--machine", machine});
    CHECK(shown.out.find(kShort) != std::string::npos);
  }
  SUBCASE("machine.toml beside the parameters") {
    (void)workspace.folder.with("machine.toml", kMachine);
    CHECK(workspace.build().out.find(kShort) != std::string::npos);
    CHECK(ran({"map", "show", workspace.map, "--params", workspace.params}).out.find(kShort) != std::string::npos);
  }
  SUBCASE("but not from the file of another machine that lies there") {
    (void)workspace.folder.with("machine.toml",
                                "configuration = \"TX\"\nname = \"lathe\"\n[axis.X]\ntravel_mm = [-4100, 0]\n");
    CHECK(workspace.build().out.find("the map is complete, 2 remarks") != std::string::npos);
  }
}

TEST_CASE("the date on the command line must be a date") {
  const Workspace workspace;
  CHECK(workspace.build({"--date", "2024-05-06"}).code == 0);
  const Ran r = workspace.build({"--force", "--date", "not a date"});
  CHECK(r.code == 2);
  CHECK(r.messages.find("--date: expected year-month-day, as in 2026-03-12, found \"not a date\"") !=
        std::string::npos);
}

}  // namespace
}  // namespace ecs::app
