// `ecs test …`: text, JSON, exit codes and refusals of the standards' tests.
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/file.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;
using doctest::Approx;

namespace {

const std::string kMoody = "samples/real/moody-plate/moody.csv";

/// Squareness of 20 um/m over 100 mm, and a little that repeats.
std::string circle_text(bool both_ways) {
  std::string text = "# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um,direction,run\n";
  for (int run = 1; run <= 2; ++run)
    for (const char* direction : {"ccw", "cw"}) {
      if (!both_ways && std::string(direction) == "cw") continue;
      for (int angle = 0; angle < 360; angle += 2)
        text += fmt::format("{},{:.4f},{},{}\n", angle,
                            std::sin(angle * std::numbers::pi / 90.0) + 0.1 * ((angle * 7 + run * 3) % 5 - 2) / 2.0,
                            direction, run);
    }
  return text;
}

}  // namespace

TEST_CASE("test flatness: Moody's plate as text and as JSON, heights and view in files") {
  const Folder folder;
  const Ran text = ran({"test", "flatness", kMoody});
  CHECK(text.code == 0);
  CHECK(contains(text.out, "    4.532 um  planes parallel to both diagonals (Moody 1955)"));
  CHECK(contains(text.out, "closure error at the centre: E-W -0.345 um, N-S 0.000 um; at most 2.54: holds"));
  const std::string heights = (folder.path / "heights.csv").string(), view = (folder.path / "view.svg").string();
  const auto json = ran({"test", "flatness", kMoody, "-o", heights, "--plot", view, "--json"}).json();
  CHECK(json["heights"] == 126);
  CHECK(json["moody_um"].get<double>() == Approx(4.532).epsilon(1e-3));
  CHECK(json["lines"][2]["line"] == "NE-NW");
  CHECK(json["output"] == heights);
  CHECK(contains(*read_file(heights), "NW-SE,0,0.0000,1016.0000,1.57"));
  CHECK(contains(*read_file(view), "<svg"));
}

TEST_CASE("test flatness: a closure error above the limit is exit 1; a missing line exit 3, in words") {
  CHECK(ran({"test", "flatness", kMoody, "--closure-um", "0.2"}).code == 1);
  const Folder folder;
  std::string text = *read_file(kMoody);
  text.erase(text.find("N-S,"));
  const Ran refused = ran({"test", "flatness", folder.with("short.csv", text)});
  CHECK(refused.code == 3);
  CHECK(refused.out.empty());
  CHECK(contains(refused.messages, "the line N-S is missing; the order is NW-SE"));
}

TEST_CASE("test circle: values, causes and plots") {
  const Folder folder;
  const std::string file = folder.with("circle.csv", circle_text(true));
  const auto json = ran({"test", "circle", file, "--json"}).json();
  REQUIRE(json["passes"].size() == 4);
  CHECK(json["passes"][0]["direction"] == "ccw");
  CHECK(json["passes"][0]["G_um"].get<double>() == Approx(2.15).epsilon(0.05));
  CHECK(json["pairs"].size() == 2);
  CHECK(json["causes"]["faults"][0]["name"] == "squareness:XY");
  // 1 um at 45 deg: E_X = +20 um/m of Y, and E_X = −C0Y·Y
  CHECK(json["causes"]["faults"][0]["component"] == "C0Y");
  CHECK(json["causes"]["faults"][0]["value"].get<double>() == Approx(-20.0).epsilon(0.03));
  CHECK(json["causes"]["faults"][0]["indistinguishable_from"].empty());
  const Ran drawn = ran({"test", "circle", file, "--draw", "--plot", (folder.path / "circle.svg").string()});
  CHECK(contains(drawn.out, "X and Y out of square (C0Y): -20."));
  CHECK(contains(drawn.out, ". least squares circle"));
  CHECK(contains(*read_file((folder.path / "circle.svg").string()), "<svg"));
}

TEST_CASE("test circle: what the machine of the sample hides comes back with its sizes") {
  const auto causes = ran({"test", "circle", "samples/standards/circle.csv", "--machine",
                           "samples/investigation/machine.toml", "--json"})
                          .json()["causes"];
  REQUIRE(causes["faults"].size() >= 4);
  const std::pair<const char*, double> hidden[] = {
      {"cyclic:Y", 2.5}, {"backlash:X", 3.0}, {"scale_mismatch:XY", 23.0}, {"backlash:Y", 2.0}};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(causes["faults"][i]["name"] == hidden[i].first);
    CHECK(causes["faults"][i]["value"].get<double>() == Approx(hidden[i].second).epsilon(0.02));
  }
}

TEST_CASE("test circle: centres that lie apart by the direction are in G(b), in H and in the plot") {
  const Folder folder;
  std::string text = "# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um,direction\n";
  for (const double sign : {1.0, -1.0})
    for (int angle = 0; angle < 360; angle += 2)
      text += fmt::format("{},{:.6f},{}\n", angle, sign * 5.0 * std::cos(angle * std::numbers::pi / 180.0),
                          sign > 0.0 ? "ccw" : "cw");
  const Ran r = ran({"test", "circle", folder.with("shifted.csv", text), "--json"});
  REQUIRE_MESSAGE(r.code == 0, r.all());
  const auto pair = r.json()["pairs"][0];
  CHECK(pair["G_um"].get<double>() == Approx(10.0).epsilon(1e-3));
  CHECK(pair["H_um"].get<double>() == Approx(10.0).epsilon(1e-3));
  CHECK(std::abs(pair["centre_um"][0].get<double>()) < 1e-6);
  // 5 um reach from the circle of both to the edge of the plot, five rows away.
  CHECK(contains(ran({"test", "circle", folder / "shifted.csv", "--draw"}).out, "a row is 1 um"));
}

TEST_CASE("test circle: one direction makes a group; an open circle is refused") {
  const Folder folder;
  const auto json = ran({"test", "circle", folder.with("one.csv", circle_text(false)), "--json"}).json();
  CHECK(json["pairs"].empty());
  CHECK(json["causes"]["faults"][0]["indistinguishable_from"].size() == 1);
  std::string open = circle_text(false);
  open.erase(open.find("300,"), open.find("0,", open.find("358,")) - open.find("300,"));
  const Ran refused = ran({"test", "circle", folder.with("open.csv", open)});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "the circle is open"));
}

TEST_CASE("test diagonals: too few are named") {
  const Folder folder;
  const Ran refused = ran({"test", "diagonals",
                           folder.with("d.csv",
                                       "# x_mm: 800\n# y_mm: 600\n# z_mm: 500\n"
                                       "diagonal,position_mm,deviation_um\nPPP,0,0\nPPP,500,1\n")});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "expected the 4 diagonals of the body, found 1; missing: PPN, PNP, PNN"));
}

TEST_CASE("test drift: ranges as text and as JSON, the figure, and sets without times refused") {
  const Folder folder;
  std::string text = "axis,x_mm,sense,reading,time_s,t_air_degC\n";
  for (int minute = 0; minute <= 240; ++minute)
    text += fmt::format("X,100,EZ,{:.3f},{},{:.3f}\n", 0.05 * minute, 60 * minute, 20.0 + 0.01 * minute);
  const std::string file = folder.with("etve.csv", text), plot = (folder.path / "etve.svg").string();
  const auto json = ran({"test", "drift", file, "--window", "0.5", "--plot", plot, "--json"}).json();
  CHECK(json["senses"][0]["sense"] == "EZ");
  CHECK(json["senses"][0]["range"].get<double>() == Approx(12.0));
  CHECK(json["senses"][0]["window_range"].get<double>() == Approx(1.5));
  CHECK(contains(*read_file(plot), "t_air_degC"));
  const Ran refused = ran({"test", "drift", folder.with("no.csv", "axis,x_mm,sense,reading\nX,100,EZ,1\n")});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "time_s: expected the time of each reading, found none"));
}

TEST_CASE(
    "test warm-up: both ends, their growth and their time constant; a line that a plan would measure is refused") {
  const Folder folder;
  std::string text = "axis,x_mm,sense,reading,time_s\n";
  for (int i = 0; i <= 48; ++i)
    for (const int end : {0, 1})
      text +=
          fmt::format("X,{},EX,{:.3f},{}\n", 500 * end,
                      (2.0 + 10.0 * end) * (1.0 - std::exp(-i / 9.6)) + 0.1 * ((i * 7) % 5 - 2), 300 * i + 30 * end);
  const std::string file = folder.with("warm_up.csv", text), plot = (folder.path / "warm_up.svg").string();
  const auto json = ran({"test", "warm-up", file, "--plot", plot, "--json"}).json();
  CHECK(json["axis"] == "X");
  REQUIRE(json["curves"].size() == 2);
  CHECK(json["curves"][1]["position_mm"] == 500.0);
  CHECK(json["curves"][1]["settled"] == true);
  CHECK(json["curves"][1]["settling"]["time_constant_h"].get<double>() == Approx(0.8).epsilon(0.1));
  CHECK(json["differences"][0]["range_um_per_m"].get<double>() == Approx(20.0).epsilon(0.05));
  CHECK(contains(*read_file(plot), "500 mm"));
  CHECK(contains(ran({"test", "warm-up", file}).out, "EX at 500 less that at 0 mm"));
  const Ran refused = ran({"test", "warm-up", folder.with("no.csv", "axis,x_mm,sense,reading\nX,100,EX,1\n")});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "no.csv:2: time_s: expected the time of each reading, found none"));
}

TEST_CASE("laser stats: uncertainty by the options that say what is known; null without them") {
  const Folder folder;
  std::string text = "axis,x_mm,sense,reading,approach,run\n";
  for (int run = 1; run <= 5; ++run)
    for (const int approach : {1, -1})
      for (int target = 0; target <= 10; ++target)
        text += fmt::format("X,{},EX,{:.3f},{},{}\n", 100 * target, 0.1 * ((run * 7 + target * 3) % 5), approach, run);
  const std::string file = folder.with("x.csv", text);
  CHECK(ran({"laser", "stats", file, "--json"}).json()["lines"][0]["uncertainty"].is_null());
  const Ran shown = ran({"laser", "stats", file, "--instrument-um-per-m", "1", "--environment-um", "1"});
  CHECK(contains(shown.out, "uncertainty (k = 2): U(A) 1.34, U(E) 1.06, U(M) 1.03, U(R) "));
  const auto json =
      ran({"laser", "stats", file, "--instrument-um-per-m", "1", "--json"}).json()["lines"][0]["uncertainty"];
  CHECK(json["coverage_factor"] == 2.0);
  CHECK(json["E"].get<double>() == Approx(1.0));
  CHECK(json["R"].get<double>() == 0.0);
  CHECK(json["parts"][0]["name"] == "instrument");
}
