// `ecs model what-if`.
#include <algorithm>
#include <cmath>

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

TEST_CASE("what-if tells what compensating costs if it is an error of the measurement") {
  const ModelWorkspace workspace;
  std::string tied = kStraightModel;
  const std::string scale = "[[effect]]\nid = \"scale\"";
  tied.replace(tied.find(scale), scale.size(), "[[effect]]\n# or cosine:X:EX, servo_lag:X:EX\nid = \"scale\"");
  const std::string model = workspace.folder.with("tied.toml", tied);
  const std::string data = workspace.folder.with("slope.csv", measured_x([](double x_mm, int, int) {
                                                   return -0.02 * x_mm;  // 20 um at 1000 mm
                                                 }));
  const Ran r = ran({"model", "what-if", model, data, "--machine", workspace.machine, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  REQUIRE(j["notes"].size() == 1);
  const std::string note = j["notes"][0];
  CHECK_MESSAGE(
      note.starts_with("scale:X:EX may be cosine:X:EX, an error of the measurement. If it is, compensating it "
                       "puts "),
      note);
  CHECK(note.find(" um, into the machine. Decide it first: Realign the laser along X") != std::string::npos);
  CHECK(j["effects"][1]["peak_um"].get<double>() == Approx(20.0).epsilon(0.02));
  const Ran untied = ran({"model", "what-if", workspace.model, data, "--machine", workspace.machine, "--json"});
  CHECK(untied.json()["notes"].empty());
}

TEST_CASE("measured again, what is left is told by its shapes") {
  const ModelWorkspace workspace;
  const std::string after =
      workspace.folder.with("after.csv", measured_x([](double x_mm, int, int) { return -0.5 + 0.002 * (x_mm - 500.0); },
                                                    {.noise_um = 0.2, .seed = 5, .compensated = true}));
  const auto what_if = [&](const std::string& again) {
    const Ran r = workspace.verb("what-if", {"--after", again});
    REQUIRE(r.code == 0);
    std::string text = r.out;
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  };
  const std::string text = what_if(after);  // 2 um/m over 1000 mm: 0.58 um rms
  CHECK_MESSAGE(
      text.find(" um rms of it is a slope of +2 um/m of X positions: scale or temperature; ") != std::string::npos,
      text);
  CHECK_MESSAGE(text.find(" um of X positions: zero or datum. ") != std::string::npos, text);
  const nlohmann::json rest = workspace.verb("what-if", {"--after", after, "--json"}).json()["achieved"]["rest"];
  REQUIRE(rest.size() == 2);
  CHECK(rest[0]["shape"] == "slope");
  CHECK(rest[0]["size"].get<double>() == Approx(2.0).epsilon(0.1));
  CHECK(rest[0]["rms_um"].get<double>() == Approx(2.0 / std::sqrt(12.0)).epsilon(0.1));
  CHECK(rest[1]["shape"] == "constant");
  CHECK(rest[1]["size"].get<double>() == Approx(-0.5).epsilon(0.1));
  CHECK(rest[1]["rms_um"].get<double>() == Approx(0.5).epsilon(0.1));
  const std::string noise = workspace.folder.with(
      "noise.csv", measured_x([](double, int, int) { return 0.0; }, {.noise_um = 0.2, .seed = 6, .compensated = true}));
  CHECK(what_if(noise).find("of it is") == std::string::npos);
}

}  // namespace
}  // namespace ecs::app
