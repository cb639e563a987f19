// The verbs of MODEL on rotary axes: letters A, B, C, positions in degrees, a turn of 360.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/file.hpp"
#include "base/random.hpp"
#include "tests/support/model_workspace.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

/// Error at an angle for an approach [um/m].
using TrueAngle = std::function<double(double angle_deg, int approach)>;

double wave(double angle_deg, double order, double amplitude) {
  return amplitude * std::sin(2.0 * std::numbers::pi * order * angle_deg / 360.0 + 0.4);
}

/// ECC at 24 places of a turn, three runs both ways, noise of 1 um/m.
std::string turned(const TrueAngle& error, double arc_deg = 360.0, unsigned seed = 1) {
  constexpr int kTargets = 24, kRuns = 3;
  std::mt19937_64 random(seed);
  NormalDraws normal;
  std::string text = "axis,sense,c_deg,reading,approach,run,time_s\n";
  double time_s = 0.0;
  for (int run = 1; run <= kRuns; ++run)
    for (const int approach : {1, -1})
      for (int i = 0; i < kTargets; ++i) {
        const int place = approach > 0 ? i : kTargets - 1 - i;
        const double angle = arc_deg / kTargets * (place + 0.2 * std::sin(3.0 * place));
        text += fmt::format("C,EC,{:.4f},{:.3f},{},{},{:.0f}\n", angle, error(angle, approach) + normal(random),
                            approach, run, time_s += 20.0);
      }
  return text;
}

constexpr const char* kTurnModel = R"([[effect]]
id = "offset"
axis = "C"
sense = "EC"

[[effect]]
id = "backlash"
axis = "C"
)";

struct Turn {
  Folder folder;
  std::string model = folder.with("turn.toml", kTurnModel);
  std::string data;

  explicit Turn(const TrueAngle& error, double arc_deg = 360.0) : data(folder.with("c.csv", turned(error, arc_deg))) {}
  [[nodiscard]] Ran verb(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"model", name, model, data};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

double eccentric(double angle_deg, int approach) { return 12.0 + wave(angle_deg, 1.0, 40.0) + 3.0 * approach; }

TEST_CASE("an eccentric table is a wave of one turn") {
  const Turn turn(eccentric);
  const Ran answer = turn.verb("diagnose", {"--json"});
  const nlohmann::json j = answer.json();
  CHECK(j["verdict"] == "missing_effect");
  REQUIRE(!j["candidates"].empty());
  const nlohmann::json& first = j["candidates"][0];
  CHECK(first["effect"] == "cyclic");
  CHECK(first["axis"] == "C");
  CHECK(first["sense"] == "EC");
  CHECK(first["name"] == "cyclic:C:EC");
  CHECK(first["parameters"]["period_deg"] == 360.0);
  CHECK_FALSE(first["parameters"].contains("period_mm"));
  CHECK(first["parameters"]["amplitude_um"].get<double>() == Approx(40.0).epsilon(0.02));
  const std::string kept = turn.folder.with("answer.json", answer.out);
  CHECK(ran({"model", "check", kept, turn.data}).code == 0);
  const Ran text = turn.verb("diagnose");
  CHECK(contains(text.out, "C positions with a periodic error of +-40 um/m, 360.0 deg = one turn"));
  CHECK_FALSE(contains(text.out, " mm"));
}

TEST_CASE("waves of several orders are named beside each other") {
  const Turn turn([](double angle, int approach) {
    return eccentric(angle, approach) + wave(angle, 2.0, 15.0) + wave(angle, 9.0, 12.0);
  });
  const nlohmann::json j = turn.verb("diagnose", {"--json"}).json();
  CHECK(j["verdict"] == "missing_effect");
  std::vector<double> periods;
  for (const nlohmann::json& one : j["candidates"])
    if (one["named"] == true) periods.push_back(one["parameters"]["period_deg"].get<double>());
  std::sort(periods.begin(), periods.end());
  if (periods.size() == 2) {  // order 2 as the second harmonic of order 1
    CHECK(periods == std::vector<double>{40.0, 360.0});
  } else {
    CHECK(periods == std::vector<double>{40.0, 180.0, 360.0});
  }
}

TEST_CASE("over part of a turn the turn is a period all the same, and nothing is called a scale error") {
  const Turn turn([](double angle, int) { return wave(angle, 1.0, 40.0); }, 120.0);
  const nlohmann::json j = turn.verb("diagnose", {"--json"}).json();
  REQUIRE(!j["candidates"].empty());
  CHECK(j["candidates"][0]["effect"] == "cyclic");
  CHECK(j["candidates"][0]["parameters"]["period_deg"] == 360.0);
  for (const nlohmann::json& one : j["candidates"]) CHECK(one["effect"] != "scale");
}

TEST_CASE("nothing is missing where the model holds the wave; its file keeps letters and degrees") {
  const Turn turn(eccentric);
  const std::string with = turn.folder / "with.toml", fitted = turn.folder / "fitted.toml";
  REQUIRE(turn.verb("add", {}).code == 2);
  const Ran added = ran({"model", "add", turn.model, "cyclic:C:EC", "--data", turn.data, "-o", with, "--json"});
  REQUIRE(added.code == 0);
  CHECK(added.json()["rms_after_um"].get<double>() < 1.3);
  REQUIRE(ran({"model", "fit", with, turn.data, "-o", fitted}).code == 0);
  const std::string text = *read_file(fitted);
  CHECK(contains(text, "axis = \"C\""));
  CHECK(contains(text, "period_deg = 360"));
  CHECK_FALSE(contains(text, "period_mm"));
  const nlohmann::json j = ran({"model", "diagnose", fitted, turn.data, "--json"}).json();
  CHECK(j["verdict"] == "adequate");
  CHECK_FALSE(contains(j["notes"].dump(), "angular"));
  CHECK(contains(ran({"model", "next", fitted, turn.data}).out, "plans are of linear axes"));
}

TEST_CASE("compare, predict and what-if show a rotary axis by its letter, in degrees") {
  const Turn turn(eccentric);
  const nlohmann::json compared = turn.verb("compare", {"--json"}).json();
  CHECK(compared["directions"][0]["axis"] == "C");
  CHECK(compared["worst"][0].contains("c_deg"));
  CHECK_FALSE(compared["worst"][0].contains("x_mm"));
  CHECK(compared["variables"][0]["variable"] == "c_deg");
  CHECK(widest_line(turn.verb("compare").out) <= 80);
  const std::string fitted = turn.folder / "fitted.toml";
  REQUIRE(turn.verb("fit", {"-o", fitted}).code == 0);
  const nlohmann::json predicted = ran({"model", "predict", fitted, turn.data, "--json"}).json();
  CHECK(predicted["predictions"][5].contains("c_deg"));
  const nlohmann::json what = ran({"model", "what-if", fitted, turn.data, "--json"}).json();
  for (const nlohmann::json& effect : what["effects"]) CHECK(effect["carried"] == false);
  CHECK(what["rms_after_um"] == what["rms_now_um"]);
  CHECK(contains(ran({"model", "what-if", fitted, turn.data}).out, "NOT CARRIED: a table of the"));
}

TEST_CASE("a formula of the user reads the angle") {
  const Turn turn(eccentric);
  const std::string model = turn.folder.with("own.toml", std::string(kTurnModel) + R"toml(
[[effect]]
id = "user"
name = "eccentric"
sense = "EC"
formula = "a * sin(c_deg * pi / 180) + b * cos(p_deg * pi / 180)"
)toml");
  const nlohmann::json j = ran({"model", "fit", model, turn.data, "--json"}).json();
  CHECK(j["rms_um"].get<double>() < 1.3);
}

TEST_CASE("what does not fit a rotary axis is refused with what does") {
  const Turn turn(eccentric);
  const auto refused = [&](const std::string& model, const std::string& data) {
    const Ran answer = ran({"model", "fit", model, data});
    CHECK(answer.code == 3);
    return answer.messages;
  };
  const std::string scale = turn.folder.with("scale.toml", "[[effect]]\nid = \"scale\"\naxis = \"C\"\n");
  CHECK(contains(refused(scale, turn.data), "scale.toml:1:1: scale: expected a linear axis"));
  const std::string period =
      turn.folder.with("period.toml", "[[effect]]\nid = \"cyclic\"\naxis = \"C\"\nparameters = { period_mm = 360 }\n");
  CHECK(contains(refused(period, turn.data), "period_mm"));
  const std::string linear = turn.folder.with("linear.toml", "[[effect]]\nid = \"offset\"\naxis = \"X\"\n");
  CHECK(contains(refused(linear, turn.data), "expected a model of rotary axes as the readings are, found offset:X:EX"));
  const std::string line = turn.folder.with("x.csv", "axis,sense,x_mm,reading\nX,EX,0,1\nX,EX,1,2\n");
  CHECK(contains(refused(turn.model, line), "expected a model of linear axes as the readings are, found offset:C:EC"));
  const std::string both = turn.folder.with("both.csv", "axis,sense,x_mm,c_deg,reading\nX,EX,0,0,1\nC,EC,0,90,2\n");
  CHECK(contains(refused(turn.model, both), "both.csv:3:1: expected readings of linear axes or of rotary ones"));
  CHECK(contains(ran({"model", "add", turn.model, "scale:C:EC", "--data", turn.data}).messages,
                 "scale: no effect of a rotary axis C"));
}

}  // namespace
}  // namespace ecs::app
