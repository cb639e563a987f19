// `ecs model fit` and `ecs model predict`.
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("fit finds the parameters with sigmas, and keeps them in the model it writes") {
  const ModelWorkspace workspace;
  const std::string data = workspace.folder.with("line.csv", measured_x(straight_x));
  const std::string fitted = workspace.folder / "fitted.toml";
  const Ran r = ran({"model", "fit", workspace.model, data, "--machine", workspace.machine, "-o", fitted, "--json"});
  REQUIRE(r.code == 0);
  const nlohmann::json j = r.json();
  REQUIRE(j["effects"].size() == 2);
  const nlohmann::json& scale = j["effects"][1]["parameters"][0];
  CHECK(scale["name"] == "um_per_m");
  CHECK(scale["value"].get<double>() == Approx(5.0).epsilon(0.03));
  CHECK(std::abs(scale["value"].get<double>() - 5.0) < 4.0 * scale["sigma"].get<double>());
  CHECK(scale["held"] == false);
  CHECK(j["condition"].is_number());
  CHECK(content_of(fitted).find("fitted = { um_per_m = ") != std::string::npos);

  const std::string points = workspace.folder.with("points.csv", "axis,sense,x_mm,approach\nX,EX,0,1\nX,EX,1000,-1\n");
  const std::string out = workspace.folder / "predicted.csv";
  const Ran p = ran({"model", "predict", fitted, points, "--machine", workspace.machine, "-o", out, "--json"});
  REQUIRE(p.code == 0);
  const nlohmann::json rows = p.json()["predictions"];
  REQUIRE(rows.size() == 2);
  CHECK(rows[0]["predicted"].get<double>() == Approx(1.0).epsilon(0.1));
  CHECK(rows[1]["predicted"].get<double>() == Approx(6.0).epsilon(0.03));
  CHECK(rows[1]["approach"] == -1);
  CHECK(rows[0]["measured"].is_null());
  CHECK(ran({"laser", "import", out, "--json"}).json()["readings"] == 2);
}

TEST_CASE("fixed parameters are reported as fixed, terms with the same effect as undetermined") {
  const ModelWorkspace workspace;
  const std::string held =
      workspace.folder.with("held.toml", "[[effect]]\nid = \"scale\"\naxis = \"X\"\nparameters = { um_per_m = 5.0 }\n");
  const nlohmann::json j = ran({"model", "fit", held, workspace.data, "--json"}).json();
  CHECK(j["effects"][0]["parameters"][0]["held"] == true);
  CHECK(j["effects"][0]["parameters"][0]["sigma"].is_null());
  const std::string twice = workspace.folder.with(
      "twice.toml", std::string(kStraightModel) + "\n[[effect]]\nid = \"cosine\"\naxis = \"X\"\nsense = \"EX\"\n");
  const nlohmann::json t = ran({"model", "fit", twice, workspace.data, "--json"}).json();
  CHECK_FALSE(t["undetermined"].empty());
}

TEST_CASE("fit prints the strongest correlations and counts the rest; JSON has all") {
  const ModelWorkspace workspace;
  std::string model;
  for (int power = 1; power <= 5; ++power)
    model += "[[effect]]\nid = \"user\"\nname = \"p" + std::to_string(power) + "\"\nformula = { EX = \"k*(x_mm/1000)^" +
             std::to_string(power) + "\" }\n";
  const std::string powers = workspace.folder.with("powers.toml", model);
  const auto sum = [](double x_mm, int, int) {
    const double x = x_mm / 1000.0;
    return 20.0 * x * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x))));
  };
  const std::string data = workspace.folder.with("powers.csv", measured_x(sum, {.noise_um = 0.001}));
  const Ran text = ran({"model", "fit", powers, data});
  const auto pairs = ran({"model", "fit", powers, data, "--json"}).json()["correlations"].size();
  REQUIRE(pairs > 5);
  std::size_t lines = 0;
  for (std::size_t at = text.out.find("correlated "); at != std::string::npos;
       at = text.out.find("correlated ", at + 1))
    ++lines;
  CHECK(lines == 5);
  CHECK(text.out.find("correlated: " + std::to_string(pairs - 5) + " more pairs above 0.9") != std::string::npos);
}

TEST_CASE("fit keeps to plain least squares when asked, and lists no outliers then") {
  const ModelWorkspace workspace;
  CHECK(workspace.verb("fit", {"--plain", "--json"}).json()["outliers"].empty());
}

TEST_CASE("a model without values predicts nothing") {
  const ModelWorkspace workspace;
  const Ran r = workspace.verb("predict", {"--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["error"]["file"] == workspace.model);
  CHECK(r.json()["error"]["message"].get<std::string>().find("fit the model") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
