// What the verbs of MODEL share: files and machines they take, plots, what they refuse.
#include <algorithm>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

bool is_png(const std::string& file) { return content_of(file).substr(1, 3) == "PNG"; }

TEST_CASE("every verb that plots writes a valid SVG or PNG") {
  const ModelWorkspace workspace;
  const std::string svg = workspace.folder / "d.svg", png = workspace.folder / "d.png";
  CHECK(workspace.verb("diagnose", {"--plot", svg, "--blanks", "50"}).code == 0);
  CHECK(is_svg(svg));
  CHECK(workspace.verb("diagnose", {"--plot", png, "--blanks", "50"}).code == 0);
  CHECK(is_png(png));
  for (const char* verb : {"fit", "compare"}) {
    const std::string file = workspace.folder / (std::string(verb) + ".svg");
    CHECK(workspace.verb(verb, {"--plot", file}).code == 0);
    CHECK(is_svg(file));
  }
  CHECK(workspace.verb("fit", {"--plot", workspace.folder / "x.pdf"}).code == 2);
}

TEST_CASE("a model is not written over another file, but over itself") {
  const ModelWorkspace workspace;
  const std::string other = workspace.folder.with("other.toml", "# something else\n");
  CHECK(workspace.verb("fit", {"-o", other}).code == 2);
  CHECK(content_of(other) == "# something else\n");
  CHECK(workspace.verb("fit", {"-o", workspace.data}).code == 2);
  CHECK(workspace.verb("fit", {"-o", workspace.model}).code == 0);
  CHECK(content_of(workspace.model).find("fitted") != std::string::npos);
}

TEST_CASE("a wrong model is refused with file and line, an unknown column in a formula with the columns there are") {
  const ModelWorkspace workspace;
  const std::string axis = workspace.folder.with("axis.toml", "[[effect]]\nid = \"scale\"\naxis = \"W\"\n");
  const nlohmann::json error = ran({"model", "fit", axis, workspace.data, "--json"}).json()["error"];
  CHECK(error["file"] == axis);
  CHECK(error["line"] == 3);
  const std::string formula = workspace.folder.with(
      "formula.toml", "[[effect]]\nid = \"user\"\nname = \"mine\"\nformula = { EX = \"k * t_oil_degC\" }\n");
  const Ran r = ran({"model", "diagnose", formula, workspace.data, "--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["error"]["file"] == formula);
  CHECK(r.json()["error"]["message"].get<std::string>().find("time_s") != std::string::npos);
  CHECK(ran({"model", "fit", workspace.folder / "none.toml", workspace.data}).code == 3);
  CHECK(workspace.verb("fit", {"--machine", workspace.folder / "none.toml"}).code != 0);
}

TEST_CASE("files of one machine are joined, their rows and runs numbered on") {
  const ModelWorkspace workspace;
  const std::string second = workspace.folder.with("second.csv", measured_x(cyclic_x, {.seed = 9}));
  const Ran r = ran({"model", "compare", workspace.model, workspace.data, second, "--json", "--worst", "400"});
  REQUIRE(r.code == 0);
  CHECK(r.json()["observations"] == 492);
  int last = 0;
  const nlohmann::json worst = r.json()["worst"];
  for (const nlohmann::json& one : worst) last = std::max(last, one["row"].get<int>());
  CHECK(last > 246);
}

TEST_CASE("files of several lines are joined without notes on what follows from them") {
  const ModelWorkspace workspace;
  const auto at = [&](const char* name, const char* parked, unsigned seed) {
    return workspace.folder.with(name, fmt::format("# parked: Y {0}\n", parked) + measured_x(cyclic_x, {.seed = seed}));
  };
  const std::string first = at("first.csv", "-1400", 3), second = at("second.csv", "-700", 4);
  const Ran r = ran({"model", "compare", workspace.model, first, second});
  REQUIRE(r.code == 0);
  CHECK_FALSE(contains(r.messages, "rows are numbered"));
  CHECK_FALSE(contains(r.messages, "left out"));
  CHECK(contains(r.messages, "its runs of EXX are numbered on from 4"));
}

TEST_CASE("instruments' own files are data as well") {
  const ModelWorkspace workspace;
  const Ran r = ran({"model", "compare", workspace.model, "samples/laser/vmc_x.rtl", "--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["observations"] == 6);
  CHECK(ran({"model", "compare", workspace.model, "samples/laser/straight.rts"}).code == 2);
  CHECK(ran({"model", "compare", workspace.model, "samples/laser/straight.rts", "--sense", "EY"}).code == 0);
}

TEST_CASE("every verb of the menu takes a machine") {
  for (const char* verb : {"effects", "predict", "fit", "compare", "diagnose", "check", "next", "add", "undo",
                           "history", "what-if", "reveal"}) {
    CAPTURE(verb);
    CHECK(ran({"model", verb, "--help"}).out.find("--machine") != std::string::npos);
  }
}

}  // namespace
}  // namespace ecs::app
