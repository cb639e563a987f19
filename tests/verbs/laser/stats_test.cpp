// `laser stats`: files of one line are its runs; outliers and drift between runs are reported.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/folder.hpp"
#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;
using doctest::Approx;

namespace {

/// Runs there and back over six targets, repeating within 0.2 um; `offset` of each run, one reading 9 um off.
std::string file_of(int runs, double offset_per_run, bool outlier, const std::string& serial = "7") {
  std::string text = "# serial_number: " + serial + "\naxis,x_mm,sense,reading,approach,run\n";
  for (int run = 1; run <= runs; ++run)
    for (const int approach : {1, -1})
      for (int target = 0; target < 6; ++target) {
        const double repeat = 0.1 * (((run * 7 + target * 3 + approach) % 5) - 2);
        const bool bad = outlier && run == 2 && approach == 1 && target == 3;
        text += fmt::format("X,{},EX,{:.3f},{},{}\n", 80 * target, offset_per_run * run + repeat + (bad ? 9.0 : 0.0),
                            approach, run);
      }
  return text;
}

}  // namespace

TEST_CASE("files of one line are joined as its runs") {
  const Folder folder;
  const std::string a = folder.with("a.csv", file_of(2, 0.0, false)), b = folder.with("b.csv", file_of(3, 0.0, false));
  const auto lines = ran({"laser", "stats", a, b, "--json"}).json()["lines"];
  REQUIRE(lines.size() == 1);
  CHECK(lines[0]["files"].size() == 2);
  CHECK(lines[0]["targets"][0]["n_forward"] == 5);
  const std::string other = folder.with("c.csv", file_of(2, 0.0, false, "8"));
  CHECK(ran({"laser", "stats", a, other, "--json"}).json()["lines"].size() == 2);  // another machine
}

TEST_CASE("an outlier is reported with its file and line, drift between runs with its size") {
  const Folder folder;
  const Ran text = ran({"laser", "stats", folder.with("x.csv", file_of(5, 1.0, false))});
  CHECK(contains(text.out, "drift: +1 +- "));
  CHECK(contains(text.out, "um per run, +4.02 um from the first to the last run"));
  const auto line = ran({"laser", "stats", folder.with("y.csv", file_of(5, 0.0, true)), "--json"}).json()["lines"][0];
  REQUIRE(line["outliers"].size() == 1);
  CHECK(line["outliers"][0]["line"] == 18);
  CHECK(line["outliers"][0]["run"] == 2);
  const auto quiet = ran({"laser", "stats", folder.with("z.csv", file_of(5, 0.0, false)), "--json"}).json()["lines"][0];
  CHECK(quiet["outliers"].empty());
  CHECK(quiet["drift"]["drifts"] == false);
}

TEST_CASE("a rotary axis: its letter, degrees and the angular positioning; other verbs refuse it") {
  const Folder folder;
  std::string text = "axis,c_deg,sense,reading,approach,run\n";
  for (int k = 0; k <= 8; ++k) text += fmt::format("C,{},EC,{},1,1\n", 45 * k, 0.5 * k);
  const std::string file = folder.with("c.csv", text);
  const auto line = ran({"laser", "stats", file, "--json"}).json()["lines"][0];
  CHECK(line["axis"] == "C");
  CHECK(line["component"] == "ECC");
  CHECK(line["targets"][8]["position_deg"] == 360.0);
  CHECK(contains(ran({"laser", "show", file}).out, "target [deg]"));
  CHECK(contains(ran({"laser", "import", file}).out, "from [deg]"));
  const Ran refused = ran({"laser", "process", file});
  CHECK(refused.code == 3);
  CHECK(contains(refused.messages, "c.csv:2:1: expected readings of linear axes, found the rotary axis C"));
  CHECK(contains(refused.messages, "`ecs laser stats` and `ecs model` take it"));
}

TEST_CASE("a rotary axis has a model of its turn: offset, reversal, waves with what they usually come from") {
  const Folder folder;
  std::string text = "axis,a_deg,sense,reading,approach,run\n";
  unsigned seed = 7;
  for (int run = 1; run <= 2; ++run)
    for (const int approach : {1, -1})
      for (int k = 0; k < 36; ++k) {
        seed = seed * 1664525U + 1013904223U;
        const double noise = 0.04 * (static_cast<double>(seed >> 8) / 16777216.0 - 0.5);
        text += fmt::format("A,{},EA,{:.4f},{},{}\n", 10 * k,
                            2.0 + 0.75 * approach + 9.7 * std::cos(10.0 * k * 3.14159265358979 / 180.0) + noise,
                            approach, run);
      }
  const std::string file = folder.with("a.csv", text);
  const auto turn = ran({"laser", "stats", file, "--json"}).json()["lines"][0]["turn"];
  CHECK(turn["reversal"].get<double>() == Approx(1.5).epsilon(0.02));
  REQUIRE(turn["waves"].size() == 1);
  CHECK(turn["waves"][0]["period_deg"] == 360.0);
  const std::string shown = ran({"laser", "stats", file}).out;
  CHECK(contains(shown, "model of a turn: offset +2.00 um/m, reversal +1.50 um/m"));
  CHECK(contains(shown, "1 a turn (360 deg): +-9.70 um/m (2.00 arcsec)"));
  CHECK(contains(shown, ": an eccentric scale or table"));
}

TEST_CASE("many measurement lines are summarised in few rows; --all and JSON give each whole") {
  const Folder folder;
  std::string text = "axis,x_mm,y_mm,sense,reading,approach,run\n";
  for (int line = 0; line < 300; ++line)
    for (int target = 0; target < 3; ++target)
      for (const int approach : {1, -1})
        text += fmt::format("X,{},{},EX,{},{},1\n", 100 * target, line, line == 77 ? 9 * target : target, approach);
  const std::string file = folder.with("plate.csv", text);
  const std::string summary = ran({"laser", "stats", file}).out;
  CHECK(std::count(summary.begin(), summary.end(), '\n') < 40);
  CHECK(contains(summary, "EXX      300      1800      18.000     18.000"));
  const auto worst = summary.find("the worst:");
  REQUIRE(worst != std::string::npos);
  CHECK(contains(summary.substr(worst, 200), "EXX   Y 77, Z 0"));  // first
  CHECK(contains(summary, "note on 300 of 300 lines: fewer than 5 targets (3)"));
  CHECK(contains(summary, "300 measurement lines: --all shows each with all its quantities"));
  const std::string all = ran({"laser", "stats", file, "--all"}).out;
  CHECK(std::count(all.begin(), all.end(), '\n') > 300 * 15);
  CHECK(ran({"laser", "stats", file, "--json"}).json()["lines"].size() == 300);
}
