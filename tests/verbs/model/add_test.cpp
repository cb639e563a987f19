// `ecs model add, undo, history`.
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("add refits with the effect, prints the ladder and keeps it; undo takes it back") {
  const ModelWorkspace workspace;
  const std::string out = workspace.folder / "added.toml";
  const Ran r = ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "--machine",
                     workspace.machine, "-o", out, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  check_has(j, {"rms_before_um", "rms_after_um", "noise_um", "history"});
  CHECK(j["rms_before_um"].get<double>() == Approx(std::sqrt(2.0 + 0.09)).epsilon(0.1));
  CHECK(j["rms_after_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(j["noise_um"].get<double>() == Approx(0.3).epsilon(0.2));
  CHECK(content_of(workspace.model) == kStraightModel);

  const nlohmann::json history = ran({"model", "history", out, "--json"}).json()["history"];
  REQUIRE(history.size() == 1);
  CHECK(history[0]["effect"] == "cyclic:X:EX");
  CHECK(history[0]["held_out_rms_um"].get<double>() < 0.5);
  const std::string plot = workspace.folder / "ladder.svg";
  CHECK(ran({"model", "history", out, "--plot", plot}).code == 0);
  CHECK(is_svg(plot));
  CHECK(content_of(plot).find("+ cyclic:X:EX") != std::string::npos);

  CHECK(ran({"model", "undo", out}).code == 0);
  CHECK(content_of(out).find("cyclic") == std::string::npos);
  CHECK(ran({"model", "undo", out}).code == 1);
}

TEST_CASE("add takes approach, sense and code from its options; an unknown effect gets a suggestion") {
  const ModelWorkspace workspace;
  const Ran r = ran(
      {"model", "add", workspace.model, "cyclic:X:EX", "--data", workspace.data, "--approach", "reverse", "--json"});
  CHECK(r.json()["effect"]["approach"] == "reverse");
  CHECK(r.json()["model"].is_null());
  const Ran wrong = ran({"model", "add", workspace.model, "cyclc:X:EX", "--data", workspace.data});
  CHECK(wrong.code == 2);
  CHECK(wrong.messages.find("cyclic") != std::string::npos);
  CHECK(ran({"model", "add", workspace.model, "cyclic:Q:EX", "--data", workspace.data}).code == 2);
  CHECK(ran({"model", "add", workspace.model, "angular", "--code", "EQX", "--data", workspace.data}).code == 2);
}

TEST_CASE("readings that do not say what was measured are asked for it by --reading-sense") {
  const ModelWorkspace workspace;
  const std::vector<std::string> words{"model",       "add",    workspace.model,
                                       "offset:X:EB", "--data", "samples/laser/pitch.rta"};
  const Ran asked = ran(words);
  CHECK(asked.code == 2);
  CHECK(asked.messages.find("--reading-sense EX") != std::string::npos);
  std::vector<std::string> given = words;
  given.insert(given.end(), {"--reading-sense", "EB"});
  CHECK(ran(given).messages.find("--reading-sense") == std::string::npos);
}

TEST_CASE("add writes over a file that is there only with --force") {
  const ModelWorkspace workspace;
  const std::string other = workspace.folder.with("other.toml", "# mine\n");
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", other}).code == 2);
  CHECK(content_of(other) == "# mine\n");
  const std::string out = workspace.folder / "out.toml";
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", out}).code == 0);
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", out}).code == 2);
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", out, "--force"}).code == 0);
  CHECK(ran({"model", "add", workspace.model, "cyclic", "--data", workspace.data, "-o", workspace.model}).code == 0);
}

TEST_CASE("the ladder leaves out the outliers, as the headline does, and says how many") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("data.csv", measured_x([](double x_mm, int approach, int run) {
                                                   const bool slip =
                                                       run == 2 && approach > 0 && std::abs(x_mm - 500.0) < 13.0;
                                                   return cyclic_x(x_mm, approach, run) + (slip ? 300.0 : 0.0);
                                                 }));
  const std::string out = workspace.folder / "out.toml";
  const Ran r =
      ran({"model", "add", workspace.model, "cyclic:X:EX", "--data", data, "--machine", workspace.machine, "-o", out});
  REQUIRE(r.code == 0);
  CHECK_MESSAGE(r.out.find("with 1 outlier,") != std::string::npos, r.out);
  CHECK_MESSAGE(r.out.find("rms and peak of step 1 are without 1 outlier\n") != std::string::npos, r.out);
  const nlohmann::json rung = ran({"model", "history", out, "--json"}).json()["history"][0];
  CHECK(rung["rms_before_um"].get<double>() == Approx(std::sqrt(2.0 + 0.09)).epsilon(0.1));
  CHECK(rung["rms_um"].get<double>() == Approx(0.3).epsilon(0.15));
  CHECK(rung["peak_um"].get<double>() < 2.0);
  CHECK(rung["outliers"] == 1);
}

}  // namespace
}  // namespace ecs::app
