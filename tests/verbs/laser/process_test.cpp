#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "commissioning/measurements/files.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

const std::string kSample = "samples/laser/x_axis.csv";

/// Straightness with a slope of 20 um/m and ±1 um of reversal; three targets, two runs.
std::string sloping() {
  std::string text = "axis,sense,x_mm,reading,approach,run\n";
  for (const int run : {1, 2})
    for (const int approach : {1, -1})
      for (const double x : {0.0, 500.0, 1000.0})
        text += fmt::format("X,EY,{},{},{},{}\n", x, 0.02 * x + approach, approach, run);
  return text;
}

TEST_CASE("an exclusion that fits nothing is refused with what there is") {
  const Folder folder;
  const std::string file = folder.with("exx.csv",
                                       "axis,sense,x_mm,reading,approach,run\nX,EX,0,1,1,1\nX,EX,50,2,1,1\n"
                                       "X,EX,0,1,1,2\nX,EX,50,2,1,2\n");
  const Ran run = ran({"laser", "process", file, "--exclude-run", "9", "--json"});
  CHECK(run.code == 1);
  CHECK(run.json()["error"]["message"].get<std::string>().find("there are 1, 2") != std::string::npos);
  const Ran row = ran({"laser", "process", file, "--exclude-row", "99999"});
  CHECK(row.code == 1);
  CHECK(row.messages.find("the last one is 4") != std::string::npos);
  CHECK(ran({"laser", "process", file, "--exclude-run", "2"}).code == 0);
}

TEST_CASE("import says what it took a file for and sums up what is in it") {
  const Ran r = ran({"laser", "import", "samples/laser/vmc_x.rtl", "--json"});
  CHECK(r.code == 0);
  const auto j = r.json();
  CHECK(j["format"] == "Renishaw run file (.rtl .rta .rts)");
  CHECK(j["readings"] == 6);
  CHECK(j["axes"] == nlohmann::json::array({"X"}));
  CHECK(j["senses"] == nlohmann::json::array({"EX"}));
  CHECK(j["runs"] == 1);
  CHECK(j["targets"] == 3);
  CHECK(j["metadata"]["Machine"] == "VMC 7");
  CHECK(j["notes"].size() == 1);
  CHECK(j["output"].is_null());
}

TEST_CASE("an imported file reads back as the same readings") {
  const Folder folder;
  const std::string csv = folder / "out.csv";
  REQUIRE(ran({"laser", "import", "samples/laser/vmc_x.rtl", "-o", csv}).code == 0);
  const auto first = laser::read_any("samples/laser/vmc_x.rtl", {});
  const auto second = laser::read_any(csv, {});
  REQUIRE(first);
  REQUIRE(second);
  REQUIRE(second->set.readings.size() == first->set.readings.size());
  for (std::size_t i = 0; i < first->set.readings.size(); ++i) {
    CHECK(second->set.readings[i].error == first->set.readings[i].error);
    CHECK(second->set.readings[i].approach == first->set.readings[i].approach);
    CHECK(second->set.readings[i].sensors_degC == first->set.readings[i].sensors_degC);
  }
}

TEST_CASE("import keeps the file it reads") {
  const Folder folder;
  const std::string file = folder.with("x.csv", content_of(kSample));
  CHECK(ran({"laser", "import", file, "-o", file}).code == 2);
  CHECK(content_of(file) == content_of(kSample));
}

TEST_CASE("what a file does not say is asked for by the name of its option") {
  const Ran r = ran({"laser", "import", "samples/laser/straight.rts"});
  CHECK(r.code == 2);
  CHECK(r.messages.find("--sense") != std::string::npos);
  CHECK(ran({"laser", "import", "samples/laser/straight.rts", "--sense", "EY"}).code == 0);
}

TEST_CASE("parked positions are given by axis") {
  ImportArguments arguments;
  arguments.parked = "y=-1400, z=5";
  const auto good = import_options(arguments);
  REQUIRE(good);
  CHECK(good->parked_mm == Vector3{0.0, -1400.0, 5.0});
  for (const char* wrong : {"y", "y=", "u=3", "y=nan", "y=1;z=2", "=", ","}) {
    arguments.parked = wrong;
    CHECK_FALSE(import_options(arguments));
  }
}

TEST_CASE("runs of a second file on the same line are numbered on") {
  const Folder folder;
  const std::string a = folder.with("a.csv", sloping()), b = folder.with("b.csv", sloping());
  const auto j = ran({"laser", "import", a, b, "--json"}).json();
  CHECK(j["runs"] == 4);
  CHECK(j["readings"] == 24);
  CHECK(j["targets"] == 3);
  CHECK(j["files"].size() == 2);
}

TEST_CASE("files of different machines are not joined") {
  const Folder folder;
  const Ran r = ran({"laser", "import", folder.with("a.csv", "# machine: one\n" + sloping()),
                     folder.with("b.csv", "# machine: two\n" + sloping())});
  CHECK(r.code == 1);
  CHECK(r.messages.find("one") != std::string::npos);
  CHECK(r.messages.find("two") != std::string::npos);
}

TEST_CASE("every bad row of a file is named with line and column") {
  const Ran r = ran({"laser", "stats", "tests/data/laser/broken_rows.csv"});
  CHECK(r.code == 3);
  CHECK(r.out.empty());
  for (const char* place : {":3:1:", ":4:5:", ":5:8:", ":6:12:", ":7:14:", ":8:3:", ":9:8:", ":10:12:"})
    CHECK(r.messages.find(place) != std::string::npos);
  const auto error = ran({"laser", "stats", "tests/data/laser/broken_rows.csv", "--json"}).json()["error"];
  CHECK(error["file"] == "tests/data/laser/broken_rows.csv");
  CHECK(error["line"].is_number());
  CHECK(error["column"].is_number());
  CHECK(error["also"].size() == 7);
}

TEST_CASE("no verb accepts a corrupted file") {
  for (const char* file : {"broken_binary.csv", "broken_duplicate.csv", "broken_empty.csv", "broken_header.csv",
                           "broken_points.rtl", "broken_cut.rtl"})
    for (const char* verb : {"import", "show", "stats", "process"})
      CHECK(ran({"laser", verb, std::string("tests/data/laser/") + file}).code == 3);
}

TEST_CASE("a log without readings has no statistics") {
  const Ran r = ran({"laser", "stats", "samples/laser/environment.pos"});
  CHECK(r.code == 3);
  CHECK(r.messages.find("environment.pos: expected readings") != std::string::npos);
}

TEST_CASE("show gives lines, conditions and the means at every target") {
  const auto j = ran({"laser", "show", kSample, "--json"}).json();
  REQUIRE(j["lines"].size() == 1);
  const auto& line = j["lines"][0];
  CHECK(line["component"] == "EXX");
  CHECK(line["parked_mm"] == nlohmann::json{{"y", -1400.0}, {"z", 0.0}});
  CHECK(line["compensated"].is_null());
  CHECK(line["step_mm"] == Approx(100.0));
  REQUIRE(line["by_target"].size() == 3);
  CHECK(line["by_target"][1]["mean_forward"] == Approx(1.75));
  CHECK(line["by_target"][1]["mean_reverse"] == Approx(2.75));
  CHECK(line["by_target"][0]["mean_forward"].is_null());
  CHECK(j["sensors"] == nlohmann::json::array({"t_air_degC"}));
}

TEST_CASE("tables of measurements fit 80 columns") {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"laser", "show", kSample}, {"laser", "import", kSample}}) {
    const std::string text = ran(words).out;
    for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
      CHECK(end - at <= 80);
  }
}

TEST_CASE("stats gives every quantity under its symbol, null where the readings do not give it") {
  const Folder folder;
  const std::string file = folder.with("one_way.csv", "axis,sense,x_mm,reading,approach\nX,EX,0,1,1\nX,EX,10,4,1\n");
  const auto line = ran({"laser", "stats", file, "--json"}).json()["lines"][0];
  CHECK(line["unit"] == "um");
  CHECK(line["E_forward"] == Approx(3.0));
  CHECK(line["range"] == Approx(3.0));
  for (const char* key : {"A", "A_forward", "E", "E_reverse", "R", "B", "non_repeatability"}) {
    CAPTURE(key);
    CHECK(line.at(key).is_null());
  }
  CHECK_FALSE(line["notes"].empty());
}

TEST_CASE("process takes the slope of straightness away and leaves the reversal error") {
  const Folder folder;
  const std::string file = folder.with("eyx.csv", sloping());
  const auto line = ran({"laser", "process", file, "--json"}).json()["lines"][0];
  CHECK(line["slope"]["method"] == "least_squares");
  CHECK(line["slope"]["removed_per_m"] == Approx(20.0));
  CHECK(line["band_before"] == Approx(22.0));
  CHECK(line["band_after"] == Approx(2.0));
  for (const auto& point : line["points"])
    CHECK(point["forward"].get<double>() - point["reverse"].get<double>() == Approx(2.0));
  CHECK(line["smoothing"].is_null());
  CHECK(ran({"laser", "process", file, "--slope", "none", "--json"}).json()["lines"][0]["band_after"] == Approx(22.0));
}

TEST_CASE("process leaves runs and rows out of the result and says how many readings") {
  const Folder folder;
  const std::string file = folder.with("eyx.csv", sloping());
  CHECK(ran({"laser", "process", file, "--exclude-run", "2", "--json"}).json()["excluded"] == 6);
  CHECK(ran({"laser", "process", file, "--exclude-row", "1,12", "--json"}).json()["excluded"] == 2);
  CHECK(ran({"laser", "process", file, "--exclude-run", "two"}).code == 2);
  CHECK(ran({"laser", "process", file, "--exclude-run", "1", "2"}).code == 1);
}

TEST_CASE("processed means read back as a measurement that needs no more processing") {
  const Folder folder;
  const std::string file = folder.with("eyx.csv", sloping()), means = folder / "means.csv";
  REQUIRE(ran({"laser", "process", file, "-o", means}).code == 0);
  const auto line = ran({"laser", "process", means, "--json"}).json()["lines"][0];
  CHECK(line["slope"]["removed_per_m"].get<double>() == Approx(0.0).epsilon(1e-9));
  CHECK(line["band_before"] == Approx(2.0));
}

TEST_CASE("a real axis gives the ISO values that were computed from its published report") {
  const std::string file = "samples/real/ecmc-iso230-2/fat_sat_ISO230.dat";
  const auto line = ran({"laser", "stats", file, "--axis", "X", "--json"}).json()["lines"][0];
  CHECK(line["R"].get<double>() == Approx(0.0688).epsilon(0.001));  // SOURCE.md: 0.0000688 mm
  CHECK(line["E"].get<double>() == Approx(0.0368).epsilon(0.001));  // SOURCE.md: 0.0000368 mm
  CHECK(line["targets"].size() == 5);
}

}  // namespace
}  // namespace ecs::app
