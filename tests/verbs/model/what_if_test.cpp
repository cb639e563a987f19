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

}  // namespace
}  // namespace ecs::app
