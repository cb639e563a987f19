// `ecs model diagnose`.
#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("diagnose names a missing periodic error, with the keys of the contract") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("diagnose", {"--json", "--blanks", "100"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  check_has(j, {"observations", "rms_um", "noise_um", "lack_of_fit", "verdict", "candidates", "where", "outliers"});
  check_has(j["lack_of_fit"], {"F", "p"});
  CHECK(j["observations"] == 246);
  CHECK(j["verdict"] == "missing_effect");
  CHECK(j["noise_um"].get<double>() == Approx(0.3).epsilon(0.2));
  const nlohmann::json& first = j["candidates"][0];
  check_has(first, {"effect", "axis", "sense", "approach", "code", "sensor", "parameters", "rms_after_um", "explained",
                    "p_value", "false_naming", "indistinguishable_from", "because", "next_measurement"});
  CHECK(first["effect"] == "cyclic");
  CHECK(first["axis"] == "X");
  CHECK(first["sense"] == "EX");
  CHECK(first["approach"] == "both");
  CHECK(first["code"].is_null());
  CHECK(first["sensor"].is_null());
  CHECK(first["parameters"]["period_mm"].get<double>() == Approx(8.0).epsilon(0.001));
  CHECK(first["parameters"]["amplitude_um"].get<double>() == Approx(2.0).epsilon(0.1));
  CHECK(first["rms_after_um"].get<double>() < 0.4);
  const double rms = j["rms_um"].get<double>(), after = first["rms_after_um"].get<double>();
  CHECK(first["explained"].get<double>() == Approx(1.0 - after * after / (rms * rms)));
  REQUIRE_FALSE(j["where"].empty());
  check_has(j["where"][0], {"variable", "strength"});
}

TEST_CASE("diagnose says first, in one sentence, what is missing, and keeps within 80 columns") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("diagnose", {"--blanks", "100"});
  REQUIRE(r.code == 0);
  CHECK(r.out.starts_with("X positions with a periodic error of +-2.0 um, 8.0"));
  CHECK(r.out.find("(cyclic:X:EX)") != std::string::npos);
  CHECK(r.out.find("period_mm") != std::string::npos);
  CHECK(widest_line(r.out) <= 80);
}

TEST_CASE("noise alone is adequate, and exits 0 too") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("noise.csv", measured_x(straight_x));
  const Ran r =
      ran({"model", "diagnose", workspace.model, data, "--machine", workspace.machine, "--json", "--blanks", "100"});
  CHECK(r.code == 0);
  CHECK(r.json()["verdict"] == "adequate");
  const nlohmann::json candidates = r.json()["candidates"];
  for (const auto& candidate : candidates) CHECK_FALSE(candidate["named"]);
}

TEST_CASE("one bad run is reported as structure that depends on the run, and exits 0") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with(
      "bad_run.csv",
      measured_x([](double x, int, int run) { return straight_x(x, 1, run) + (run == 2 ? 4.0 : 0.0); }, {.runs = 4}));
  const Ran r =
      ran({"model", "diagnose", workspace.model, data, "--machine", workspace.machine, "--json", "--blanks", "100"});
  CHECK(r.code == 0);
  CHECK(r.json()["verdict"] == "unexplained_structure");
  bool by_run = false;
  const nlohmann::json where = r.json()["where"];
  for (const nlohmann::json& one : where) by_run = by_run || one["variable"] == "run";
  CHECK(by_run);
}

TEST_CASE("gross outliers are listed by row") {
  const ModelWorkspace workspace;
  std::string text = measured_x(straight_x);
  const std::size_t row = text.find("X,EX,", text.find("X,EX,", 200) + 1);  // some row in the middle
  const auto number = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(row), '\n');
  const std::size_t reading = text.find(',', row + 5) + 1;
  text.replace(reading, text.find(',', reading) - reading, "250.0");
  const Ran r =
      ran({"model", "diagnose", workspace.model, workspace.folder.with("o.csv", text), "--json", "--blanks", "100"});
  CHECK(r.json()["outliers"] == nlohmann::json::array({number}));
}

TEST_CASE(
    "what is likely is told as likely, with what is not excluded, what would decide and what adding it would do") {
  const std::vector<std::string> verb{"model", "diagnose", "tests/data/made_up/two_zeros.toml",
                                      "tests/data/made_up/two_zeros.csv"};
  std::vector<std::string> as_json = verb;
  as_json.emplace_back("--json");
  const nlohmann::json answer = ran(as_json).json();
  CHECK(answer["verdict"] == "likely_effect");
  const nlohmann::json& first = answer["candidates"][0];
  CHECK(first["standing"] == "likely");
  CHECK(first["named"] == false);
  CHECK(first["but"].is_string());
  CHECK(first["decide"].is_string());
  CHECK(answer["candidates"].back()["standing"] == "possible");
  CHECK(answer["candidates"].back()["but"].is_null());
  CHECK(answer["add"]["effects"] == nlohmann::json::array({"offset:Y:EY", "offset:X:EX"}));
  CHECK(answer["add"]["held_out_rms_um"] < answer["add"]["held_out_rms_before_um"]);
  const std::string text = ran(verb).out;
  CHECK(text.starts_with("Probably Y positions"));
  CHECK(text.find("what is likely, but not proved") != std::string::npos);
  CHECK(text.find("To try it: add offset:Y:EY, then offset:X:EX") != std::string::npos);
}

TEST_CASE("bad measurements get a clear answer, never a confident name") {
  const ModelWorkspace workspace;
  const auto verdict = [&](const std::string& name, const std::string& text) {
    const Ran r =
        ran({"model", "diagnose", workspace.model, workspace.folder.with(name, text), "--json", "--blanks", "50"});
    return r.code == 0 ? r.json()["verdict"].get<std::string>() : fmt::format("exit {}", r.code);
  };
  const std::string head = "axis,sense,x_mm,reading,approach,run\n";
  CHECK(verdict("three.csv", head + "X,EX,0,1,1,1\nX,EX,100,5,1,1\nX,EX,200,-3,1,1\n") == "cannot_tell");
  CHECK(verdict("one.csv", head + "X,EX,0,1,1,1\n") == "cannot_tell");
  std::string constant = head;
  for (int i = 0; i < 30; ++i) constant += "X,EX,100,1.0,1,1\n";
  CHECK(verdict("constant.csv", constant) == "adequate");
  CHECK(verdict("empty.csv", head) == "exit 3");
  CHECK(verdict("axis.csv", head + "W,EX,0,1,1,1\n") == "exit 3");
  CHECK(verdict("none.csv", "") == "exit 3");
  CHECK(verdict("one_run.csv", measured_x(straight_x, {.runs = 1})) == "adequate");
}

}  // namespace
}  // namespace ecs::app
