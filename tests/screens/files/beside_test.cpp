// Which files of a folder belong to the model in it.
#include "commissioning/files/known_files.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

constexpr const char* kMachineText =
    "name = \"m\"\nconfiguration = \"TX\"\n[axis.X]\ntravel_mm = [0.0, 1000.0]\ndatum_mm = 0.0\n";
constexpr const char* kParametersText = "[configuration]\naxes = \"X\"\n# end of parameters\n";
constexpr const char* kEffect = "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"EX\"\n";
constexpr const char* kReadings = "axis,x_mm,sense,reading,approach,run\nX,0,EX,0.1,1,1\nX,100,EX,0.9,1,1\n";

TEST_CASE("machine.toml, parameters.toml and the measured file that is alone beside a model are found") {
  const Folder folder;
  const std::string model = folder.with("model.toml", kEffect);
  const std::string machine = folder.with("machine.toml", kMachineText);
  const std::string parameters = folder.with("parameters.toml", kParametersText);
  const std::string readings = folder.with("x_axis.csv", kReadings);
  (void)folder.with("notes.csv", "who,what\nme,coffee\n");
  const FilesBeside found = files_beside(model);
  CHECK(found.machine == machine);
  CHECK(found.parameters == parameters);
  CHECK(found.data == std::vector<std::string>{readings});
  CHECK(files_beside(folder / "not_yet.toml").machine == machine);
}

TEST_CASE("a file of another kind is refused by its name and both kinds, without options of a verb") {
  const Folder folder;
  const std::string machine = folder.with("machine.toml", kMachineText);
  CHECK(refusal_as(FileKind::parameters, machine) == "machine.toml is a machine file, not a parameter file.");
  CHECK(refusal_as(FileKind::parameters, folder.with("notes.txt", "cold\n")) ==
        "notes.txt: expected parameters, found unknown kind.");
  CHECK(refusal_as(FileKind::machine, machine).empty());
  CHECK(refusal_as(FileKind::machine, "").empty());
  CHECK(refusal_as(FileKind::machine, folder / "none.toml").starts_with("There is no file "));
}

TEST_CASE("files that ECS wrote and no chooser opens are named for what they are") {
  const Folder folder;
  CHECK(looked_at(folder.with("recipe.toml", "[[component]]\ncode = \"EXX\"\n")).what == "recipe");
  auto recording = must(MonitorRecording::begun(folder / "monitor.csv"));
  REQUIRE(recording.add({}, {}));
  REQUIRE(recording.end());
  CHECK(looked_at(folder / "monitor.csv").what == "a recording of the monitor");
}

TEST_CASE("of two measured files the one is taken that the model was fitted to, else data.csv, else none") {
  const Folder folder;
  const std::string model = folder.with("model.toml", kEffect);
  const std::string first = folder.with("first.csv", kReadings), second = folder.with("second.csv", kReadings);
  CHECK(files_beside(model).data.empty());
  const std::string fitted = folder.with(
      "fitted.toml", std::string(kEffect) +
                         "[[history]]\neffect = \"\"\ndata = \"elsewhere/second.csv\"\nrms_before_um = 1.0\n"
                         "rms_um = 1.0\npeak_um = 1.0\nnoise_um = 1.0\n");
  CHECK(files_beside(fitted).data == std::vector<std::string>{second});
  const std::string usual = folder.with("data.csv", kReadings);
  CHECK(files_beside(model).data == std::vector<std::string>{usual});
}

TEST_CASE("a file of the usual name that is something else is not taken") {
  const Folder folder;
  (void)folder.with("machine.toml", kEffect);
  (void)folder.with("data.csv", "who,what\nme,coffee\n");
  const FilesBeside found = files_beside(folder.with("model.toml", kEffect));
  CHECK(found.machine.empty());
  CHECK(found.data.empty());
}

}  // namespace
}  // namespace ecs::commissioning
