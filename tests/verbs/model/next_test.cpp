// `ecs model next`.
#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

TEST_CASE("next proposes a run, and says of a plan whether it can determine the model") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("next", {"--json"});
  REQUIRE(r.code == 0);
  check_has(r.json(), {"rivals", "proposals", "notes"});
  const std::string good =
      workspace.folder.with("plan.csv", "axis,sense,x_mm,approach\nX,EX,0,1\nX,EX,500,1\nX,EX,1000,1\n");
  const Ran yes = ran({"model", "next", workspace.model, "--check", good, "--machine", workspace.machine, "--json"});
  CHECK(yes.code == 0);
  CHECK(yes.json()["determines"] == true);
  const std::string poor = workspace.folder.with("poor.csv", "axis,sense,x_mm,approach\nX,EX,500,1\nX,EX,500,1\n");
  const Ran no = ran({"model", "next", workspace.model, "--check", poor, "--machine", workspace.machine, "--json"});
  CHECK(no.code == 1);
  CHECK(no.json()["determines"] == false);
  CHECK_FALSE(no.json()["undetermined"].empty());
  CHECK(ran({"model", "next", workspace.model}).code == 2);
}

TEST_CASE("a proposal is written as a part program and as a target list, which is a plan") {
  ModelWorkspace workspace;
  workspace.data = workspace.folder.with("few.csv", measured_x(straight_x, {0.3, 1, 6, 190.0}));
  const std::string program = workspace.folder / "next.txt", targets = workspace.folder / "targets.csv";
  const Ran r = workspace.verb("next", {"--program", program, "--targets", targets, "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["program"] == program);
  CHECK(content_of(program).find("M08") != std::string::npos);
  CHECK(ran({"model", "next", workspace.model, "--check", targets, "--machine", workspace.machine}).code == 0);
  CHECK(workspace.verb("next", {"--targets", targets, "--proposal", "99", "--force"}).code == 1);
  CHECK(ran({"model", "next", workspace.model, workspace.data, "--program", program}).code == 2);
}

TEST_CASE("where one cause is proved and nothing else fits no run is proposed, and none is written") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("next");
  CHECK(r.code == 0);
  CHECK(contains(r.out, "Nothing is in doubt"));
  CHECK_FALSE(contains(r.out, "1. "));
  const std::string program = workspace.folder / "next.txt";
  const Ran refused = workspace.verb("next", {"--program", program});
  CHECK(refused.code == 1);
  CHECK(contains(refused.messages, "Nothing is in doubt"));
  CHECK(content_of(program).empty());
}

}  // namespace
}  // namespace ecs::app
