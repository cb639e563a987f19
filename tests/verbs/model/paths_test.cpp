// The verbs of MODEL on circles and diagonals.
#include <doctest/doctest.h>

#include "base/random.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

constexpr const char* kCircleHead =
    "# plane: XY\n# radius_mm: 100\n# feed_mm_min: 2000\n# centre_x_mm: 400\n# centre_y_mm: 250\n"
    "angle_deg,deviation_um,direction,run\n";

/// Two runs both ways with lost motion of X, a reading every 3 degrees.
std::string circle_with_lost_motion(double lost_um, const char* head = kCircleHead, int last_deg = 357) {
  std::mt19937_64 random(5);
  NormalDraws normal;
  std::string text = head;
  for (int run = 1; run <= 2; ++run)
    for (const int way : {1, -1})
      for (int degree = 0; degree <= last_deg; degree += 3) {
        const double angle = (degree + 0.4) * std::numbers::pi / 180.0;
        const double motion = -std::sin(angle) * way > 0.0 ? 1.0 : -1.0;
        text += fmt::format("{:.1f},{:.4f},{},{}\n", degree + 0.4,
                            4.0 + 0.5 * lost_um * motion * std::cos(angle) + 0.2 * normal(random),
                            way > 0 ? "ccw" : "cw", run);
      }
  return text;
}

/// X along a line with the same lost motion.
std::string line_with_lost_motion(double lost_um) {
  return measured_x([&](double, int approach, int) { return 0.5 * lost_um * approach; }, {.noise_um = 0.2});
}

TEST_CASE("a model is begun on a circle and its diagnosis names the lost motion") {
  const ModelWorkspace workspace;
  const std::string circle = workspace.folder.with("circle.csv", circle_with_lost_motion(3.0));
  const std::string model = workspace.folder / "circle.toml";
  REQUIRE(ran({"model", "new", model, circle, "--machine", workspace.machine}).code == 0);
  const Ran r = ran({"model", "diagnose", model, circle, "--machine", workspace.machine, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  CHECK(j["observations"] == 480);
  CHECK(j["verdict"] == "missing_effect");
  CHECK(j["candidates"][0]["effect"] == "backlash");
  CHECK(j["candidates"][0]["axis"] == "X");
  CHECK(j["candidates"][0]["parameters"]["um"].get<double>() == doctest::Approx(3.0).epsilon(0.05));
  const std::string answer = workspace.folder.with("answer.json", r.out);
  CHECK(ran({"model", "check", answer, circle, "--machine", workspace.machine}).code == 0);
}

TEST_CASE("compare shows lines and circles by their names, and draws both") {
  const ModelWorkspace workspace;
  const std::string circle = workspace.folder.with("circle.csv", circle_with_lost_motion(3.0));
  const std::string line = workspace.folder.with("line.csv", line_with_lost_motion(3.0));
  const std::string model = workspace.folder / "both.toml", plot = workspace.folder / "both.svg";
  REQUIRE(ran({"model", "new", model, line, circle, "--machine", workspace.machine}).code == 0);
  const Ran r =
      ran({"model", "compare", model, line, circle, "--machine", workspace.machine, "--json", "--plot", plot});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  CHECK(j["observations"] == 246 + 480);
  REQUIRE(j["directions"].size() == 4);
  CHECK(j["directions"][0]["sense"] == "EX");
  CHECK(j["directions"][2]["sense"] == "circle XY");
  CHECK(j["directions"][2]["axis"] == "XY");
  CHECK(j["directions"][2]["rms_um"].get<double>() < 0.3);
  CHECK(content_of(plot).find("circle XY") != std::string::npos);
  CHECK(ran({"model", "diagnose", model, line, circle, "--machine", workspace.machine, "--json"}).json()["verdict"] ==
        "adequate");
}

TEST_CASE("a circle that is open, has no plane or no place beside a line is refused in words, and no model is left") {
  const ModelWorkspace workspace;
  const std::string model = workspace.folder / "none.toml";
  const auto refused = [&](const std::string& circle, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"model", "new", model, workspace.folder.with("wrong.csv", circle)};
    words.insert(words.end(), more.begin(), more.end());
    const Ran r = ran(words);
    CHECK(r.code == 3);
    CHECK_FALSE(std::filesystem::exists(model));
    return r.messages;
  };
  CHECK(refused(circle_with_lost_motion(3.0, kCircleHead, 300)).find("the circle is open") != std::string::npos);
  CHECK(refused(circle_with_lost_motion(3.0, "# radius_mm: 100\nangle_deg,deviation_um,direction,run\n"))
            .find("expected `# plane: `") != std::string::npos);
  const std::string nowhere =
      circle_with_lost_motion(3.0, "# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um,direction,run\n");
  const std::string line = workspace.folder.with("line.csv", line_with_lost_motion(3.0));
  CHECK(refused(nowhere, {line}).find("no centre_x_mm and centre_y_mm") != std::string::npos);
  const std::string lathe =
      workspace.folder.with("lathe.toml",
                            "name = \"lathe\"\nconfiguration = \"XTZ\"\n[axis.X]\ntravel_mm = [0.0, 500.0]\n[axis.Z]\n"
                            "travel_mm = [0.0, 900.0]\n");
  CHECK(refused(circle_with_lost_motion(3.0), {"--machine", lathe}).find("it has no Y") != std::string::npos);
  const std::string other = std::string("# machine: mill 8\n") + kCircleHead;
  const std::string of_mill = workspace.folder.with("mill_7.csv", "# machine: mill 7\n" + line_with_lost_motion(3.0));
  const Ran mixed = ran({"model", "new", model, of_mill,
                         workspace.folder.with("wrong.csv", circle_with_lost_motion(3.0, other.c_str()))});
  CHECK(mixed.code != 0);
  CHECK(mixed.messages.find("files of different machines are not joined") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(model));
}

TEST_CASE("the sample circle holds its wave, and what friction of Y leaves between two readings") {
  const auto r = ran({"model", "diagnose", "samples/investigation/model.toml", "samples/standards/circle.csv",
                      "--machine", "samples/investigation/machine.toml", "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json answer = r.json();
  CHECK(answer["verdict"] == "missing_effect");
  const nlohmann::json& candidates = answer["candidates"];
  CHECK(candidates[0]["effect"] == "cyclic");
  CHECK(candidates[1]["effect"] == "reversal_spike");
  CHECK(candidates[1]["indistinguishable_from"] == nlohmann::json{"friction:Y:EY"});
  CHECK_FALSE(candidates[2]["named"].get<bool>());
  CHECK(contains(answer["headline"].get<std::string>(), "an undetermined amount"));
}

}  // namespace
}  // namespace ecs::app
