// Opening the truth of hidden cases and scoring what was answered.
#include <cmath>

#include <doctest/doctest.h>

#include "base/sealed.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

nlohmann::json truth_of_cyclic() {
  return {{"seed", 1},
          {"kind", "single"},
          {"noise_um", 0.3},
          {"effects",
           {{{"effect", "cyclic"},
             {"axis", "X"},
             {"sense", "EX"},
             {"code", nullptr},
             {"approach", "both"},
             {"sensor", ""},
             {"name", "cyclic:X:EX"},
             {"parameters", {{"period_mm", 8.0}, {"amplitude_um", 2.0}, {"phase_rad", 0.4 + 2.0 * std::numbers::pi}}},
             {"rms_um", 1.41},
             {"snr", 4.7}}}},
          {"group", nlohmann::json::array()},
          {"variables", nlohmann::json::array()},
          {"true_model_rms_um", 0.3},
          {"text", "a periodic error of the screw"}};
}

void lay_out(const Folder& folder, const std::string& name, const std::string& data, const std::string& truth,
             bool sealed_truth) {
  static_cast<void>(folder.with(name + "/machine.toml", kTestMachine));
  static_cast<void>(folder.with(name + "/model.toml", kStraightModel));
  static_cast<void>(folder.with(name + "/data.csv", data));
  if (sealed_truth)
    static_cast<void>(folder.with(name + "/truth.sealed", sealed(truth, "the truth of a test")));
  else
    static_cast<void>(folder.with(name + "/truth.json", truth));
}

TEST_CASE("reveal opens the truth and scores the diagnosis") {
  const Folder folder;
  lay_out(folder, "case", measured_x(cyclic_x), truth_of_cyclic().dump(), true);
  const Ran r = ran({"model", "reveal", folder / "case", "--json", "--blanks", "100"});
  CHECK(r.code == 0);
  const nlohmann::json j = r.json();
  CHECK(j["kind"] == "single");
  CHECK(j["right"] == true);
  CHECK(j["truth"]["effects"][0]["name"] == "cyclic:X:EX");
  CHECK(j["verdict"] == "missing_effect");
  CHECK(j["rms_ratio"].get<double>() == Approx(1.0).epsilon(0.1));
  REQUIRE(j["parameters"].size() == 3);
  for (const nlohmann::json& one : j["parameters"]) CHECK(std::abs(one["sigmas_off"].get<double>()) < 4.0);
  const Ran text = ran({"model", "reveal", folder / "case", "--blanks", "100"});
  CHECK(text.out.find("Hidden: a periodic error of the screw") != std::string::npos);
  CHECK(text.out.find("RIGHT") != std::string::npos);
}

TEST_CASE("reveal scores a saved diagnosis by the rules of the contract") {
  const Folder folder;
  lay_out(folder, "case", measured_x(cyclic_x), truth_of_cyclic().dump(), false);
  const auto judged = [&](const nlohmann::json& answer) {
    return ran({"model", "reveal", folder / "case", "--diagnosis", folder.with("answer.json", answer.dump())});
  };
  const auto candidate = [](const char* effect, const char* approach, nlohmann::json group) {
    return nlohmann::json{{"effect", effect},
                          {"axis", "X"},
                          {"sense", "EX"},
                          {"approach", approach},
                          {"code", nullptr},
                          {"parameters", nlohmann::json::object()},
                          {"indistinguishable_from", std::move(group)}};
  };
  const auto answer = [](const char* verdict, nlohmann::json candidates) {
    return nlohmann::json{
        {"verdict", verdict}, {"candidates", std::move(candidates)}, {"where", nlohmann::json::array()}};
  };
  CHECK(judged(answer("missing_effect", nlohmann::json::array({candidate("cyclic", "both", nlohmann::json::array())})))
            .code == 0);
  CHECK(
      judged(answer("missing_effect", nlohmann::json::array({candidate("cyclic", "reverse", nlohmann::json::array())})))
          .code == 1);
  CHECK(judged(answer("missing_effect", nlohmann::json::array({candidate("step", "both", {"cyclic:X:EX"})}))).code ==
        0);
  CHECK(judged(answer("missing_effect", {candidate("step", "both", nlohmann::json::array()),
                                         candidate("cyclic", "both", nlohmann::json::array())}))
            .code == 1);
  CHECK(judged(answer("adequate", nlohmann::json::array())).code == 1);
  CHECK(judged(answer("unexplained_structure",
                      nlohmann::json::array({candidate("cyclic", "both", nlohmann::json::array())})))
            .code == 1);
  CHECK(judged(nlohmann::json{{"rms", 1.0}}).code == 3);
}

TEST_CASE("pairs need both effects, confounded cases exactly the group, noise alone an adequate model") {
  const Folder folder;
  const auto judged = [&](const nlohmann::json& truth, const nlohmann::json& candidates, const char* verdict) {
    lay_out(folder, "case", measured_x(straight_x), truth.dump(), false);
    const nlohmann::json answer{{"verdict", verdict}, {"candidates", candidates}, {"where", nlohmann::json::array()}};
    return ran({"model", "reveal", folder / "case", "--diagnosis", folder.with("answer.json", answer.dump())}).code;
  };
  const nlohmann::json scale{
      {"effect", "scale"}, {"axis", "X"}, {"sense", "EX"}, {"indistinguishable_from", {"cosine:X:EX"}}};
  const nlohmann::json backlash{{"effect", "backlash"}, {"axis", "X"}, {"sense", "EX"}};
  nlohmann::json pair = truth_of_cyclic();
  pair["kind"] = "pair";
  pair["effects"] = {{{"effect", "backlash"}, {"axis", "X"}, {"sense", "EX"}, {"name", "backlash:X:EX"}},
                     {{"effect", "cosine"}, {"axis", "X"}, {"sense", "EX"}, {"name", "cosine:X:EX"}}};
  CHECK(judged(pair, {scale, backlash}, "missing_effect") == 0);
  CHECK(judged(pair, nlohmann::json::array({backlash}), "missing_effect") == 1);
  const nlohmann::json confounded{
      {"kind", "confounded"}, {"effects", nlohmann::json::array()}, {"group", {"cosine:X:EX", "scale:X:EX"}}};
  CHECK(judged(confounded, nlohmann::json::array({scale}), "missing_effect") == 0);
  CHECK(judged(confounded, nlohmann::json::array({backlash}), "missing_effect") == 1);
  const nlohmann::json three{{"kind", "confounded"},
                             {"effects", nlohmann::json::array()},
                             {"group", {"cosine:X:EX", "scale:X:EX", "dead_path:X:EX"}}};
  CHECK(judged(three, nlohmann::json::array({scale}), "missing_effect") == 1);
  const nlohmann::json blank{{"kind", "blank"}, {"effects", nlohmann::json::array()}};
  CHECK(judged(blank, nlohmann::json::array(), "adequate") == 0);
  CHECK(judged(blank, nlohmann::json::array({backlash}), "missing_effect") == 1);
  const nlohmann::json outside{
      {"kind", "out_of_library"}, {"effects", nlohmann::json::array()}, {"variables", {"run"}}};
  CHECK(judged(outside, nlohmann::json::array(), "unexplained_structure") == 0);
  CHECK(judged(outside, nlohmann::json::array(), "adequate") == 1);
}

TEST_CASE("a folder of cases gives a line each and the total") {
  const Folder folder;
  lay_out(folder, "a", measured_x(cyclic_x), truth_of_cyclic().dump(), true);
  lay_out(folder, "b", measured_x(straight_x),
          nlohmann::json{{"kind", "blank"}, {"effects", nlohmann::json::array()}}.dump(), false);
  const Ran r = ran({"model", "reveal", folder / ".", "--json", "--blanks", "100"});
  CHECK(r.code == 0);
  CHECK(r.json()["of"] == 2);
  CHECK(r.json()["right_cases"] == 2);
  CHECK(r.json()["cases"].size() == 2);
  static_cast<void>(folder.with("b/data.csv", "axis,sense\n"));
  const Ran spoiled = ran({"model", "reveal", folder / ".", "--json", "--blanks", "100"});
  CHECK(spoiled.code == 1);
  CHECK(spoiled.json()["right_cases"] == 1);
}

TEST_CASE("a folder without a hidden case and a file that is not a truth are refused") {
  const Folder folder;
  CHECK(ran({"model", "reveal", folder / "."}).code == 3);
  lay_out(folder, "case", measured_x(straight_x), R"({"kind": "riddle"})", false);
  const Ran r = ran({"model", "reveal", folder / "case", "--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["error"]["message"].get<std::string>().find("out_of_library") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
