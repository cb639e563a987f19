// `laser import` of tables by their columns, profiles, `laser normalise` and `laser air`.
#include <cmath>

#include <doctest/doctest.h>

#include "laser/groups.hpp"
#include "tests/support/verb_run.hpp"
#include "tests/verbs/support/measured_log.hpp"

using namespace ecs;
using namespace ecs::app;
using doctest::Approx;

namespace {

const char* const kTable = "My gauge\npos;dev;T\n0;1,5;68\n10;2,5;77\n10;2,9;77\n0;1,0;68\n";
const char* const kColumns = "x_mm=pos[in],reading=dev[um],t_material_degC=T[degF],approach=motion,run=motion";

}  // namespace

TEST_CASE("an unknown table is explained, imported by its columns, and again by the profile kept of them") {
  const StateFolder folder;
  const std::string file = folder.with("gauge.txt", kTable);
  const Ran unknown = ran({"laser", "show", file});
  CHECK(unknown.code == 3);
  CHECK(contains(unknown.messages, "4 rows and 3 columns between semicolons"));
  CHECK(contains(unknown.messages, "--skip 2"));
  const std::string out = folder / "gauge.csv";
  const Ran first =
      ran({"laser", "import", file, "--columns", kColumns, "--skip", "1", "--save-profile", "gauge", "-o", out});
  CHECK_MESSAGE(first.code == 0, first.messages);
  CHECK(contains(content_of(out), "X,254,0,0,EX,2.9,-1,1,25"));
  CHECK(std::filesystem::exists(folder / "config/ecs/import/gauge.toml"));
  const std::string again = folder / "again.csv";
  CHECK(ran({"laser", "import", file, "--profile", "gauge", "-o", again}).code == 0);
  CHECK(content_of(again) == content_of(out));
  CHECK(ran({"laser", "stats", file, "--profile", folder / "config/ecs/import/gauge.toml"}).code == 0);
  const auto turned =
      ran({"laser", "import", file, "--profile", "gauge", "--values", "compensation", "-o", again, "--force"});
  CHECK(turned.code == 0);
  CHECK(contains(content_of(again), "X,254,0,0,EX,-2.9,-1,1,25"));
}

TEST_CASE("the output's extension chooses another instrument's file, which is read back") {
  const Folder folder;
  for (const char* name : {"x.rtl", "x.ren", "x.dat", "x.pos"}) {
    const std::string out = folder / name;
    const Ran written = ran({"laser", "import", "samples/laser/vmc_x.rtl", "-o", out});
    REQUIRE_MESSAGE(written.code == 0, written.messages);
    const auto back = ran({"laser", "import", out, "--axis", "X", "--json"}).json();
    CHECK(back["lines"][0]["targets"] == 3);
  }
  CHECK(ran({"laser", "import", "samples/laser/vmc_x.rtl", "-o", folder / "x.rta"}).code == 2);
  CHECK(ran({"laser", "import", "samples/laser/vmc_x.rtl", "-o", folder / "x.rtx"}).code == 1);
}

TEST_CASE("a log of channels selects its profile: headings are targets, several channels need a name") {
  const auto set = read_log("samples/laser/sensor.log");
  REQUIRE(set.readings.size() == 3);
  CHECK(set.readings[0].error == Approx(-28.73));
  CHECK(laser::target_mm(set.readings[2]) == 6.0);
  CHECK(*set.readings[2].time_s == Approx(60.2));
  const Ran several = ran({"laser", "import", "samples/laser/channels.log", "--axis", "X"});
  CHECK(several.code == 2);
  CHECK(contains(several.messages, "give one of IOC:A (1 values), IOC:B (1 values) (--channel NAME)"));
  CHECK(read_log("samples/laser/channels.log", "IOC:B").readings[0].error == Approx(9490.0));
  const Folder folder;
  std::string utf16{"\xFF\xFE", 2};
  for (const char c : content_of("samples/laser/sensor.log")) utf16 += {c, '\0'};
  CHECK(read_log(folder.with("utf16.log", utf16)).readings.size() == 3);
}

TEST_CASE("wrong columns and wrong profiles are refused with what was expected") {
  const StateFolder folder;
  const std::string file = folder.with("gauge.txt", kTable);
  CHECK(ran({"laser", "import", file, "--skip", "1"}).code == 2);
  CHECK(ran({"laser", "import", file, "--columns", "x_mm"}).code == 2);
  CHECK(ran({"laser", "import", file, "--columns", "x_mm=1,reading=2", "--delimiter", "many"}).code == 2);
  CHECK(ran({"laser", "import", file, "--target-unit", "furlong"}).code == 2);
  const Ran none = ran({"laser", "import", file, "--profile", "gauge"});
  CHECK(none.code == 2);
  CHECK(contains(none.messages, "klipper_bed_mesh"));  // the profiles that there are
  const Ran wrong = ran({"laser", "import", file, "--profile", folder.with("p.toml", "columns = 3\nspeed = 1\n")});
  CHECK(wrong.code == 3);
  CHECK(contains(wrong.messages, "p.toml:1:1: columns: expected a text"));
  CHECK(contains(wrong.messages, "p.toml:2:1: speed: expected a key of import profiles"));
  CHECK(ran({"laser", "import", file, "--columns", kColumns, "--skip", "1", "--save-profile", ""}).code == 0);
  CHECK(ran({"laser", "import", "samples/laser/x_axis.csv", "--save-profile", "empty"}).code == 2);
}

TEST_CASE("normalise refers errors to 20 degC and takes it back") {
  const Folder folder;
  const std::string file = folder.with(
      "warm.csv", "axis,x_mm,sense,reading,t_material_degC\nX,0,EX,1,30\nX,500,EX,60.25,30\nX,1000,EX,120.5,30\n");
  const std::string cold = folder / "cold.csv";
  const Ran done = ran({"laser", "normalise", file, "--coefficient", "11.7", "-o", cold, "--json"});
  REQUIRE_MESSAGE(done.code == 0, done.messages);
  CHECK(done.json()["changed"] == 3);
  CHECK(done.json()["largest_um"].get<double>() == Approx(117.0));
  CHECK(done.json()["per_coefficient_um"].get<double>() == Approx(10.0));
  CHECK(contains(done.out, "several materials"));
  CHECK(ran({"laser", "normalise", cold, "--coefficient", "11.7"}).code == 1);
  const std::string back = folder / "back.csv";
  CHECK(ran({"laser", "normalise", cold, "--back", "-o", back}).code == 0);
  CHECK(content_of(back) == content_of(file));
  CHECK(ran({"laser", "normalise", file}).code == 2);
}

TEST_CASE("air gives the index by both equations") {
  const auto j = ran({"laser", "air", "--wavelength", "633", "--json"}).json();
  CHECK(std::abs(j["ciddor"].get<double>() - 1.000271373) < 1e-9);
  CHECK(std::abs(j["modified_edlen"].get<double>() - 1.000271374) < 1e-9);
  CHECK(ran({"laser", "air", "--pressure", "101325"}).code == 2);
}
