// `ecs model remove` and `ecs model decide`.
#include "tests/support/model_workspace.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {
namespace {

TEST_CASE("an effect is removed wherever it stands; the rest is fitted again, and the ladder says so") {
  const ModelWorkspace workspace;
  const std::string model = workspace.folder / "m.toml";
  std::filesystem::copy_file(workspace.model, model);
  for (const char* effect : {"cyclic:X:EX", "backlash:X:EX"})
    REQUIRE(ran({"model", "add", model, effect, "--data", workspace.data, "--machine", workspace.machine, "-o", model})
                .code == 0);
  const Ran r =
      ran({"model", "remove", "cyclic:X:EX", model, workspace.data, "--machine", workspace.machine, "--json"});
  CAPTURE(r.messages);
  REQUIRE(r.code == 0);
  CHECK(r.json()["rms_after_um"].get<double>() > 2.0 * r.json()["rms_before_um"].get<double>());
  CHECK(r.json()["history"].back()["effect"] == "without cyclic:X:EX");
  CHECK_FALSE(contains(content_of(model), "id = \"cyclic\""));
  CHECK(contains(content_of(model), "id = \"backlash\""));
  const Ran none = ran({"model", "remove", "cyclic:X:EX", model, workspace.data});
  CHECK(none.code == 2);
  CHECK(contains(none.messages, "backlash:X"));
}

TEST_CASE("a model keeps at least one effect") {
  const ModelWorkspace workspace;
  const std::string one =
      workspace.folder.with("one.toml", "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n");
  CHECK(ran({"model", "remove", "scale:X:EX", one, workspace.data}).code == 1);
}

TEST_CASE("what was kept as an alternative is decided against, once") {
  const ModelWorkspace workspace;
  const std::string model = workspace.folder / "m.toml";
  REQUIRE(ran({"model", "add", workspace.model, "cyclic:X:EX", "--or", "servo_lag:X:EX", "--data", workspace.data, "-o",
               model})
              .code == 0);
  REQUIRE(contains(content_of(model), "servo_lag"));
  const Ran r = ran({"model", "decide", "cyclic:X:EX", model, "--json"});
  CAPTURE(r.messages);
  REQUIRE(r.code == 0);
  CHECK(r.json()["alternatives"] == "servo_lag:X:EX");
  CHECK_FALSE(contains(content_of(model), "servo_lag"));
  CHECK(ran({"model", "decide", "cyclic:X:EX", model}).code == 1);
}

}  // namespace
}  // namespace ecs::app
