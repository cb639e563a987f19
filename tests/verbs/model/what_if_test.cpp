// `ecs model what-if`.
#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("what-if predicts the rms after compensation and gives what was achieved") {
  const ModelWorkspace workspace;
  const std::string full = workspace.folder / "full.toml";
  REQUIRE(ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "-o", full}).code == 0);
  const std::string after = workspace.folder.with(
      "after.csv", measured_x([](double, int, int) { return 0.0; }, {.noise_um = 0.3, .seed = 5, .compensated = true}));
  const Ran r =
      ran({"model", "what-if", full, workspace.data, "--after", after, "--machine", workspace.machine, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  CHECK(j["rms_after_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(j["rms_now_um"].get<double>() > 3.0);
  CHECK(j["achieved"]["rms_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(j["achieved"]["of_predicted"].get<double>() == Approx(1.0).epsilon(0.2));
  REQUIRE(j["directions"].size() == 2);
  CHECK(j["directions"][0]["achieved_rms_um"].get<double>() == Approx(0.3).epsilon(0.2));
  CHECK(ran({"model", "what-if", full, workspace.data, "--json"}).json()["achieved"].is_null());
}

TEST_CASE("along an axis that the machine does not have nothing is compensated") {
  const ModelWorkspace workspace;
  const std::string machine =
      workspace.folder.with("x_only.toml", "configuration = \"XT\"\n[axis.X]\ntravel_mm = [-10.0, 1010.0]\n");
  std::string straightness = measured_x(straight_x);
  for (std::size_t at = 0; (at = straightness.find("X,EX", at)) != std::string::npos;)
    straightness.replace(at, 4, "X,EY");
  const std::string model = workspace.folder.with("ey.toml",
                                                  "[[effect]]\nid = \"offset\"\naxis = \"X\"\nsense = \"EY\"\n"
                                                  "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EY\"\n");
  const nlohmann::json j =
      ran({"model", "what-if", model, workspace.folder.with("ey.csv", straightness), "--machine", machine, "--json"})
          .json();
  for (const nlohmann::json& effect : j["effects"]) {
    CHECK(effect["carried"] == false);
    CHECK(effect["how"] == "the machine has no axis Y that could correct it");
  }
  CHECK(j["rms_after_um"] == j["rms_now_um"]);
}

}  // namespace
}  // namespace ecs::app
