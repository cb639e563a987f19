// A file of the wrong kind, in any verb; folders where files are wanted.
#include <filesystem>

#include <doctest/doctest.h>

#include "tests/support/verb_run.hpp"

using namespace ecs;
using namespace ecs::app;

namespace {

constexpr const char* kMap = "axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,100,1\n";
constexpr const char* kModel = "[[effect]]\nid = \"offset\"\naxis = \"X\"\nsense = \"EX\"\n";
constexpr const char* kReadings = "axis,x_mm,sense,reading,run\nX,0,EX,1,1\nX,50,EX,2,1\nX,90,EX,2.5,1\n";

}  // namespace

TEST_CASE("a file of the wrong kind is named for what it is, in whatever verb it is given to") {
  const Folder folder;
  const std::string map = folder.with("map.csv", kMap);
  const std::string model = folder.with("model.toml", kModel);
  const std::string data = folder.with("x.csv", kReadings);
  const std::string book = folder.with("book.xlsx", std::string("PK\x03\x04 [Content_Types].xml xl/") + '\0');
  struct Case {
    std::vector<std::string> words;
    std::string says;
  };
  const std::vector<Case> cases{
      {{"laser", "import", map}, map + ":1:1: this is an error map, not a measurement: ecs map show " + map},
      {{"laser", "stats", map}, "this is an error map, not a measurement"},
      {{"model", "fit", model, map}, "this is an error map, not a measurement"},
      {{"laser", "show", model}, "this is an error model, not a measurement: ecs model diagnose " + model + " DATA"},
      {{"map", "show", data}, "this is a measurement, not an error map: ecs laser show " + data},
      {{"params", "show", model}, "this is an error model, not a parameter file"},
      {{"model", "fit", model, data, "--machine", data}, "this is a measurement, not a machine file"},
      {{"test", "circle", data}, "this is a measurement, not a circular test"},
      {{"laser", "import", book}, "this is a workbook of a spreadsheet program, not a measurement: save the sheet"},
      {{"map", "show", book}, "this is a workbook"},
  };
  for (const Case& one : cases) {
    const Ran refused = ran(one.words);
    CAPTURE(one.words[0] + " " + one.words[1]);
    CHECK(refused.code == 3);
    CHECK_MESSAGE(contains(refused.messages, one.says), refused.messages);
  }
}

TEST_CASE("a model and measurements that are swapped are told so") {
  const Folder folder;
  const Ran refused = ran({"model", "diagnose", folder.with("x.csv", kReadings), folder.with("m.toml", kModel)});
  CHECK(refused.code == 2);
  CHECK_MESSAGE(contains(refused.messages, "MODEL and DATA are swapped: " + (folder / "m.toml") + " is a model"),
                refused.messages);
}

TEST_CASE("a verb that takes several files takes the measurements of a folder, the others name its files") {
  const Folder folder;
  static_cast<void>(folder.with("runs/b.csv", kReadings));
  static_cast<void>(folder.with("runs/a.csv", kReadings));
  const std::string model = folder.with("runs/m.toml", kModel);
  static_cast<void>(folder.with("runs/notes.txt", "warm day\n"));
  const Ran stats = ran({"laser", "stats", folder / "runs", "--json"});
  REQUIRE_MESSAGE(stats.code == 0, stats.all());
  CHECK(stats.json()["lines"][0]["files"].size() == 2);
  const Ran imported = ran({"laser", "import", folder / "runs"});
  CHECK(imported.code == 0);
  CHECK_MESSAGE(contains(imported.messages, "a folder; its measurement files are a.csv, b.csv; 2 other files are left"),
                imported.messages);
  CHECK(ran({"model", "fit", model, folder / "runs"}).code == 0);
  const Ran one = ran({"laser", "show", folder / "runs"});
  CHECK(one.code == 3);
  CHECK_MESSAGE(contains(one.messages, "expected a file, found a directory; it holds a.csv, b.csv, m.toml, notes.txt"),
                one.messages);
  static_cast<void>(folder.with("none/notes.txt", "warm day\n"));
  const Ran none = ran({"laser", "import", folder / "none"});
  CHECK(none.code == 3);
  CHECK_MESSAGE(contains(none.messages, "none of them is a measurement file"), none.messages);
}

TEST_CASE("the approach that the order of the targets gives is the first note of laser and model verbs") {
  const Folder folder;
  const std::string data = folder.with(
      "x.csv", "axis,x_mm,sense,reading\nX,0,EX,1\nX,50,EX,2\nX,90,EX,2.5\nX,90,EX,7\nX,50,EX,6.4\nX,0,EX,6\n");
  const std::string model = folder.with("m.toml", kModel);
  const std::string said = "no column approach: it is taken from the order of the targets, for 5 of 6 readings";
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"laser", "stats", data}, {"laser", "process", data}, {"model", "fit", model, data}}) {
    const Ran done = ran(words);
    CHECK(done.code == 0);
    CHECK_MESSAGE(done.messages.substr(0, 400).find(said) != std::string::npos, done.messages);
  }
  const Ran none = ran({"laser", "stats", data, "--columns", "approach=none", "--json"});
  REQUIRE_MESSAGE(none.code == 0, none.messages);
  CHECK(none.json()["lines"][0]["targets"][1]["n_forward"] == 0);
  CHECK(ran({"laser", "stats", data, "--json"}).json()["lines"][0]["targets"][1]["n_forward"] == 1);
}
