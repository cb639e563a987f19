// `ecs model compare`.
#include <algorithm>
#include <cmath>
#include <set>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

std::set<std::string> keys_of(const nlohmann::json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST_CASE("compare gives bias, rms, peak, lack of fit and count for every sense, axis and direction") {
  const ModelWorkspace workspace;
  const nlohmann::json j = workspace.verb("compare", {"--json"}).json();
  REQUIRE(j["directions"].size() == 2);
  for (const nlohmann::json& one : j["directions"]) {
    CHECK(keys_of(one) == std::set<std::string>{"sense", "axis", "approach", "bias_um", "rms_um", "peak_um",
                                                "lack_of_fit", "readings"});
    CHECK(one["sense"] == "EX");
    CHECK(one["axis"] == "X");
    CHECK(one["readings"] == 123);
    CHECK(one["rms_um"].get<double>() == Approx(std::sqrt(2.0 + 0.09)).epsilon(0.1));
    CHECK(one["lack_of_fit"]["F"].get<double>() > 10.0);
  }
  CHECK(j["directions"][0]["approach"] == 1);
  CHECK(j["worst"].size() == 10);
  CHECK(std::abs(j["worst"][0]["residual_um"].get<double>()) >= std::abs(j["worst"][9]["residual_um"].get<double>()));
  std::set<std::string> variables;
  for (const nlohmann::json& view : j["variables"]) variables.insert(view["variable"].get<std::string>());
  for (const char* name : {"x_mm", "approach", "run", "time_s"}) CHECK(variables.contains(name));
  CHECK(widest_line(workspace.verb("compare").out) <= 80);
}

TEST_CASE("compare keeps the values of the model unless it is to refit, and says what it fits") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("line.csv", measured_x(straight_x));
  const auto shifted = [](double x_mm, int d, int run) { return straight_x(x_mm, d, run) + 197.0; };
  const std::string other = workspace.folder.with("shifted.csv", measured_x(shifted));
  const std::string fitted = workspace.folder / "fitted.toml";
  REQUIRE(ran({"model", "fit", workspace.model, data, "--machine", workspace.machine, "-o", fitted}).code == 0);
  const auto compared = [&](const std::string& model, std::vector<std::string> more) {
    std::vector<std::string> words{"model", "compare", model, other, "--machine", workspace.machine, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words).json();
  };
  const nlohmann::json kept = compared(fitted, {});
  for (const nlohmann::json& one : kept["directions"])
    CHECK(one["bias_um"].get<double>() == Approx(197.0).epsilon(0.01));
  CHECK(kept["rms_um"].get<double>() == Approx(197.0).epsilon(0.01));
  CHECK(kept["notes"].dump().find("no values") == std::string::npos);
  for (const nlohmann::json& refitted : {compared(fitted, {"--refit"}), compared(workspace.model, {})})
    for (const nlohmann::json& one : refitted["directions"]) CHECK(std::abs(one["bias_um"].get<double>()) < 0.5);
  CHECK(compared(workspace.model, {})["notes"].dump().find(
            "fitted to these data, since the model has no values for it: offset:X:EX, scale:X:EX") !=
        std::string::npos);
}

TEST_CASE("compare breaks the model down by effect at one place") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("line.csv", measured_x(straight_x, {.noise_um = 0.01}));
  const Ran r = ran({"model", "compare", workspace.model, data, "--machine", workspace.machine, "--at",
                     "x=1000,y=0,z=0,axis=X", "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json at = r.json()["at"];
  CHECK(at["x_mm"] == 1000.0);
  const nlohmann::json& ex = at["senses"][0];
  CHECK(ex["total_um"].get<double>() == Approx(6.0).epsilon(0.01));
  CHECK(ex["effects"][0]["effect"] == "offset:X:EX");
  CHECK(ex["effects"][1]["um"].get<double>() == Approx(5.0).epsilon(0.01));
  for (const char* wrong : {"x", "x=1,axis=Q", "u=3", "x=one", "approach=2"})
    CHECK(workspace.verb("compare", {"--at", wrong}).code == 2);
}

TEST_CASE("compare predicts the volume, and needs a machine for it") {
  const ModelWorkspace workspace;
  const std::string csv = workspace.folder / "volume.csv";
  const Ran r = workspace.verb("compare", {"--volume", "3", "-o", csv, "--json"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["volume"]["forward"]["points"] == 27);
  const std::string text = content_of(csv);
  CHECK(text.starts_with("x_mm,y_mm,z_mm,approach,EX_um,EY_um,EZ_um\n"));
  CHECK(std::count(text.begin(), text.end(), '\n') == 55);
  CHECK(ran({"model", "compare", workspace.model, workspace.data, "--volume", "3"}).code == 2);
  CHECK(workspace.verb("compare", {"-o", csv}).code == 2);
}

}  // namespace
}  // namespace ecs::app
