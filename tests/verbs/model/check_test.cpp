// `ecs model check`: a saved diagnosis on its data, on others, changed, and malformed.
#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

/// An answer made once, for all cases.
const nlohmann::json& answer_of_cyclic(const ModelWorkspace& workspace) {
  static const nlohmann::json answer = workspace.verb("diagnose", {"--blanks", "100", "--json"}).json();
  return answer;
}

TEST_CASE("a saved answer holds with the data alone, exit 0") {
  const ModelWorkspace workspace;
  const nlohmann::json answer = answer_of_cyclic(workspace);
  CHECK(answer["data_sha256"].get<std::string>().size() == 64);
  CHECK(answer["machine"] == kTestMachine);
  CHECK(answer["map"].is_null());
  const std::string file = workspace.folder.with("answer.json", answer.dump());
  const Ran text = ran({"model", "check", file, workspace.data});
  CHECK(text.code == 0);
  CHECK(text.out.starts_with("The answer holds.\n"));
  CHECK(text.out.find("cyclic:X:EX e_value") != std::string::npos);
  CHECK(widest_line(text.out) <= 80);
  const nlohmann::json j = ran({"model", "check", file, workspace.data, "--json"}).json();
  CHECK(j["holds"] == true);
  CHECK(j["objections"].empty());
  REQUIRE(j["checked"].size() > 5);
  CHECK(j["checked"][1]["name"] == "rms_um");
  CHECK(j["checked"][1]["claimed"] == answer["rms_um"]);
  CHECK(j["checked"][1]["holds"] == true);
}

TEST_CASE("a changed answer does not hold, exit 1, and the number is named") {
  const ModelWorkspace workspace;
  nlohmann::json answer = answer_of_cyclic(workspace);
  answer["candidates"][0]["explained"] = 0.5;
  const Ran changed =
      ran({"model", "check", workspace.folder.with("answer.json", answer.dump()), workspace.data, "--json"});
  CHECK(changed.code == 1);
  CHECK(changed.json()["holds"] == false);
  const nlohmann::json checked = changed.json()["checked"];
  for (const nlohmann::json& one : checked) CHECK(one["holds"] == (one["name"] != "cyclic:X:EX explained"));
}

TEST_CASE("other data are refused, exit 3, and so is what is no answer") {
  const ModelWorkspace workspace;
  nlohmann::json answer = answer_of_cyclic(workspace);
  const std::string file = workspace.folder.with("answer.json", answer.dump());
  const Ran other = ran({"model", "check", file, workspace.folder.with("other.csv", measured_x(straight_x))});
  CHECK(other.code == 3);
  CHECK(other.messages.find("expected SHA-256 " + answer["data_sha256"].get<std::string>()) != std::string::npos);
  const auto refused = [&](const std::string& content, const std::string& why) {
    const Ran r = ran({"model", "check", workspace.folder.with("bad.json", content), workspace.data});
    CAPTURE(r.messages);
    CHECK(r.code == 3);
    CHECK(r.messages.find(why) != std::string::npos);
  };
  refused("{", "expected one JSON object");
  refused("[]", "expected one JSON object");
  refused("{}", "observations: expected a count");
  const auto with = [&](auto change) {
    nlohmann::json changed = answer;
    change(changed);
    return changed.dump();
  };
  refused(with([](nlohmann::json& j) { j.erase("data_sha256"); }), "data_sha256: expected a text");
  refused(with([](nlohmann::json& j) { j["candidates"][0]["effect"] = "gremlin"; }), "effect: expected one of the");
  refused(with([](nlohmann::json& j) { j["candidates"][0]["tried_at"]["coefficients"] = {-1}; }),
          "coefficients: expected a count");
  refused(with([](nlohmann::json& j) { j["candidates"] = 7; }), "candidates: expected a list");
  refused(with([](nlohmann::json& j) { j["own_terms"] = {3}; }), "effect: expected a count");
  refused(with([](nlohmann::json& j) { j["model"] = "[[effect]"; }), "bad.json: model:");
  CHECK(ran({"model", "check", workspace.folder / "none.json", workspace.data}).code == 3);
  CHECK(ran({"model", "check"}).code == 2);
}

}  // namespace
}  // namespace ecs::app
