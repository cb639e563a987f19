// `ecs model repair`: sums that a hand can check, and the emulated machine as the witness of what is left.
#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

constexpr const char* kMachine = R"(name = "two axes"
configuration = "TXY"
[axis.X]
travel_mm = [0.0, 1000.0]
datum_mm = 0.0
measurement_line_mm = { y = 0.0, z = 0.0 }
[axis.Y]
travel_mm = [0.0, 500.0]
datum_mm = 0.0
measurement_line_mm = { x = 0.0, z = 0.0 }
)";

constexpr const char* kModel = R"([[effect]]
id = "scale"
axis = "X"
sense = "EX"
parameters = { um_per_m = 30.0 }

[[effect]]
id = "squareness"
code = "C0Y"
parameters = { um_per_m = 40.0 }

[[effect]]
id = "servo_lag"
axis = "X"
sense = "EX"
parameters = { um_per_m_min = 3.0 }
)";

/// EX along X at 2 m/min: 30 um/m and 6 um by direction, no noise.
std::string lagging() {
  std::string text = "axis,sense,x_mm,reading,approach,run,feed_mm_min\n";
  for (const int approach : {1, -1})
    for (int i = 0; i <= 10; ++i)
      text += fmt::format("X,EX,{},{},{},1,2000\n", 100 * i, 3.0 * i + 6.0 * approach, approach);
  return text;
}

struct TwoAxes : Folder {
  std::string model = with("model.toml", kModel), data = with("data.csv", lagging()),
              machine = with("machine.toml", kMachine);
  [[nodiscard]] Ran repair(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"model", "repair", model, data, "--machine", machine};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
  [[nodiscard]] nlohmann::json cause(const std::string& name) const {
    const nlohmann::json answer = repair({"--json"}).json();
    for (const nlohmann::json& one : answer["causes"])
      if (one["name"] == name) return one;
    return {};
  }
};

TEST_CASE("what the unit can compensate is compensated: repairing gains no more") {
  const TwoAxes files;
  const nlohmann::json scale = files.cause("scale:X:EX");
  CHECK(scale["remedy"] == "compensate");
  CHECK(scale["readings_rms"]["left_um"].get<double>() == Approx(std::sqrt(315.0 + 36.0)));
  CHECK(scale["readings_rms"]["compensated_um"].get<double>() == Approx(6.0));
  CHECK(scale["readings_rms"]["repaired_um"].get<double>() == Approx(6.0));
  CHECK(scale["volume_largest"]["left_um"].get<double>() == Approx(30.0));
  CHECK(scale["volume_largest"]["compensated_um"].get<double>() == Approx(0.0));
  // 30 um/m over a circle of 300 mm: radial 4.5 um cos^2, of which the ellipse stays
  CHECK(scale["circle"]["left_um"].get<double>() == Approx(4.5).epsilon(0.001));
}

TEST_CASE("what the unit cannot compensate is to be repaired") {
  const TwoAxes files;
  const nlohmann::json lag = files.cause("servo_lag:X:EX");
  CHECK(lag["remedy"] == "repair");
  CHECK(lag["readings_rms"]["left_um"].get<double>() == Approx(6.0));
  CHECK(lag["readings_rms"]["compensated_um"].get<double>() == Approx(6.0));
  CHECK(lag["readings_rms"]["repaired_um"].get<double>() < 1e-6);
  const Ran text = files.repair();
  CHECK(contains(text.out, "servo_lag:X:EX: repair ("));
  CHECK(contains(text.out, "shows in the readings"));
  CHECK(widest_line(text.out) <= 80);
}

TEST_CASE("the emulated machine without a cause has what was predicted to be left") {
  const TwoAxes files;
  const std::string parameters = files / "parameters.toml";
  REQUIRE(ran({"params", "new", "--machine", files.machine, "-o", parameters}).code == 0);
  const std::string map = files.with("map.csv", "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1000,0\n");
  const auto truth = [&](const std::string& errors) {
    const Ran r = ran({"volume", map, "--params", parameters, "--machine", files.machine, "--errors",
                       files.with("errors.toml", errors), "--points", "1331", "--json"});
    REQUIRE_MESSAGE(r.code == 0, r.all());
    return r.json()["before"];
  };
  constexpr const char* kSquare = "[squareness]\nC0Y = 40.0\n";
  constexpr const char* kScale = "[[contribution]]\ncomponent = \"EXX\"\nformula = \"0.03*p\"\n";
  const nlohmann::json square = files.cause("squareness:Y:C0Y"), scale = files.cause("scale:X:EX");
  const auto near = [](double predicted_um, double true_um) {
    CHECK(std::abs(predicted_um - true_um) < std::max(1.0, 0.1 * true_um));
  };
  const nlohmann::json only_square = truth(kSquare), only_scale = truth(kScale);
  near(square["volume_largest"]["left_um"], only_square["largest_um"]);
  near(square["volume_rms"]["left_um"], only_square["rms_um"]);
  near(scale["volume_largest"]["left_um"], only_scale["largest_um"]);
  near(scale["volume_rms"]["left_um"], only_scale["rms_um"]);
}

/// Two runs along X, forward, with a scatter of 0.05 um.
template <class Error>
std::string measured_along_x(int targets, const Error& error_um) {
  std::string text = "axis,sense,x_mm,reading,approach,run\n";
  for (const int run : {1, 2})
    for (int i = 0; i < targets; ++i) {
      const double x_mm = 1000.0 * i / (targets - 1);
      text += fmt::format("X,EX,{},{:.6f},1,{}\n", x_mm, error_um(x_mm) + ((i * run) % 3 == 1 ? 0.05 : -0.05), run);
    }
  return text;
}

TEST_CASE("where a step falls between two targets nobody knows: there its whole height is left") {
  const TwoAxes files;
  const std::string data =
      files.with("step.csv", measured_along_x(11, [](double x_mm) { return x_mm > 450.0 ? 10.0 : 0.0; }));
  const std::string model = files.with("step.toml", "[[effect]]\nid = \"step\"\naxis = \"X\"\nsense = \"EX\"\n");
  const Ran r = ran({"model", "repair", model, data, "--machine", files.machine, "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const nlohmann::json step = r.json()["causes"][0];
  // less only if it falls within the 5 mm in which the map climbs
  CHECK(step["volume_largest"]["compensated_um"].get<double>() == Approx(10.0).epsilon(0.1));
  CHECK(step["volume_largest"]["compensated_at_most_um"].get<double>() == Approx(10.0).epsilon(0.02));
  CHECK(step["volume_largest"]["repaired_um"].get<double>() < 0.1);
  // a slab of 0 to 50 mm of 1000, 10 um: 10 um times the root of 1/20 at most
  CHECK(step["volume_rms"]["compensated_um"].get<double>() > 0.5);
  CHECK(step["volume_rms"]["compensated_at_most_um"].get<double>() == Approx(10.0 * std::sqrt(0.05)).epsilon(0.05));
}

TEST_CASE("a wave as long as the places of a volume are apart is seen whole") {
  const TwoAxes files;
  // 1331 places of two axes: 36 on each, 1000/35 mm apart
  constexpr double kPeriod_mm = 1000.0 / 35.0;
  const std::string data = files.with("wave.csv", measured_along_x(21, [](double x_mm) {
                                        return 8.0 * std::sin(2.0 * M_PI * x_mm / kPeriod_mm + 0.3);
                                      }));
  const std::string model =
      files.with("wave.toml",
                 fmt::format("[[effect]]\nid = \"cyclic\"\naxis = \"X\"\nsense = \"EX\"\nparameters = {{ period_mm = "
                             "{:.9f}, amplitude_um = 8.0, phase_rad = 0.3, amplitude2_um = 0.0, phase2_rad = 0.0 }}\n",
                             kPeriod_mm));
  const Ran r = ran({"model", "repair", model, data, "--machine", files.machine, "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const nlohmann::json wave = r.json()["causes"][0];
  // from the datum, where the wave stands at 8 sin 0.3: 8 um + 2.36 um at most, the root of 32 + 5.6 in the mean
  CHECK(wave["volume_largest"]["left_um"].get<double>() == Approx(8.0 + 8.0 * std::sin(0.3)).epsilon(0.05));
  CHECK(wave["volume_rms"]["left_um"].get<double>() == Approx(std::sqrt(32.0 + 5.59)).epsilon(0.03));
}

TEST_CASE("a wave that the targets do not determine is said to make predictions that may be far off") {
  const TwoAxes files;
  // the half period is the distance of the targets: its harmonic is the same at all of them
  const std::string data = files.with(
      "even.csv", measured_along_x(21, [](double x_mm) { return 8.0 * std::sin(2.0 * M_PI * x_mm / 99.999 + 1.0); }));
  const std::string model =
      files.with("even.toml",
                 "[[effect]]\nid = \"cyclic\"\naxis = \"X\"\nsense = \"EX\"\nparameters = { "
                 "period_mm = 99.999 }\n[[effect]]\nid = \"offset\"\naxis = \"X\"\nsense = \"EX\"\n"
                 "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n");
  const Ran r = ran({"model", "repair", model, data, "--machine", files.machine, "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  CHECK(contains(r.json()["notes"].dump(), "these readings do not determine them"));
}

TEST_CASE("a prediction that the place of a step decides is said to be unsure") {
  const TwoAxes files;
  // 30 um/m and a step of 20 um between 450 and 500 mm: left alone, the slope and the slab beside the map's step add up
  // to 34 um if the step lies before it, to 30 um at the end of the travel if behind
  const std::string data = files.with(
      "both.csv", measured_along_x(21, [](double x_mm) { return 0.03 * x_mm + (x_mm > 475.0 ? 20.0 : 0.0); }));
  const std::string model = files.with("both.toml",
                                       "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n[[effect]]\nid = "
                                       "\"step\"\naxis = \"X\"\nsense = \"EX\"\n");
  const Ran r = ran({"model", "repair", model, data, "--machine", files.machine, "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  for (const nlohmann::json& cause : r.json()["causes"])
    if (cause["name"] == "scale:X:EX") {
      const nlohmann::json& largest = cause["volume_largest"];
      CHECK(largest["left_um"].get<double>() == Approx(30.0).epsilon(0.2));
      CHECK(largest["left_at_most_um"].get<double>() == Approx(34.3).epsilon(0.02));
      CHECK(largest["left_share"].get<double>() < 0.8);
      CHECK(cause["volume_rms"]["left_share"].get<double>() == Approx(1.0));
    }
  const Ran text = ran({"model", "repair", model, data, "--machine", files.machine});
  CHECK(contains(text.out, "may be anywhere from 450 to 500 mm"));
  CHECK(contains(text.out, "measure there in fine"));
  CHECK(widest_line(text.out) <= 80);
}

TEST_CASE("without travels there is no volume") {
  const TwoAxes files;
  const Ran refused = ran({"model", "repair", files.model, files.data});
  CHECK(refused.code == 2);
  CHECK(contains(refused.messages, "--machine"));
}

}  // namespace
}  // namespace ecs::app
