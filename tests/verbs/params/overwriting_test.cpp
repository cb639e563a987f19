// The one rule for files: nothing is overwritten without --force; a verb's own input is changed in place.
#include "base/overwriting.hpp"

#include "base/file.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const std::vector<std::string> kNew{"params", "new", "--machine", "samples/mill/machine.toml", "-o"};

std::vector<std::string> with(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST_CASE("a verb overwrites a file only with --force") {
  const Folder folder;
  const std::string file = folder.with("mill.toml", "mine");
  const Ran refused = ran(with(kNew, {file}));
  CHECK(refused.code == 2);
  CHECK(contains(refused.messages, "exists already: give another name, or --force to overwrite it"));
  CHECK(ecs::read_file(file).value() == "mine");
  CHECK(ran(with(kNew, {file, "--force"})).code == 0);
  CHECK(ecs::read_file(file).value() != "mine");
}

TEST_CASE("an empty file may be written, and the verb's own input is changed in place") {
  const Folder folder;
  const std::string file = folder.with("mill.toml", "");
  REQUIRE(ran(with(kNew, {file})).code == 0);
  CHECK(ran({"params", "set", file, "axis.X.deadband_um=2.5", "-o", file}).code == 0);
}

TEST_CASE("would_overwrite() spares nothing but regular files with content that are not one's own") {
  const Folder folder;
  const std::string file = folder.with("a.csv", "x");
  CHECK(would_overwrite(file));
  CHECK_FALSE(would_overwrite(file, {file}));
  CHECK_FALSE(would_overwrite(folder.with("empty.csv", "")));
  CHECK_FALSE(would_overwrite((folder.path / "none.csv").string()));
  CHECK_FALSE(would_overwrite("/dev/null"));
  CHECK_FALSE(would_overwrite(folder.path.string()));
}

TEST_CASE("the figures of the rig overwrite none of their files without --force") {
  const Folder folder;
  const std::string figure = folder.with("figure_3_9.csv", "mine");
  CHECK(std::system((kEmulator + " rig -o " + (folder / "") + " >/dev/null 2>&1").c_str()) != 0);
  CHECK(ecs::read_file(figure).value() == "mine");
}

TEST_CASE("the emulator and its workshop overwrite a file only with --force") {
  const Folder folder;
  const std::string measured = folder.with("exx.csv", "mine"), program = folder.with("exx.nc", "mine");
  const std::string measure =
      kEmulator +
      " measure --machine samples/mill/machine.toml --axis X --sense EX --from 0 --to -100 --step 50 "
      "--runs 1 --parked y=-1400,z=0 -o " +
      measured;
  const std::string write = kEmulator + " program --axis X --from 0 --to -100 --step 50 --runs 1 -o " + program;
  for (const auto& [command, file] : {std::pair{measure, measured}, {write, program}}) {
    CHECK(std::system((command + " >/dev/null 2>&1").c_str()) != 0);
    CHECK(ecs::read_file(file).value() == "mine");
    CHECK(std::system((command + " --force >/dev/null 2>&1").c_str()) == 0);
    CHECK(ecs::read_file(file).value() != "mine");
  }
}

TEST_CASE("an import profile of the same name is replaced only with --force") {
  const StateFolder folder;
  const std::string file = folder.with("gauge.txt", "0;1\n10;2\n20;3\n");
  std::vector<std::string> words{"laser",          "import", file, "--columns",         "x_mm=1[mm],forward1=2[um]",
                                 "--save-profile", "gauge",  "-o", folder / "gauge.csv"};
  const Ran first = ran(words);
  CHECK_MESSAGE(first.code == 0, first.messages);
  words.back() = folder / "again.csv";
  CHECK(contains(ran(words).messages, "gauge.toml exists already"));
  CHECK(ran(with(words, {"--force"})).code == 0);
}

}  // namespace
}  // namespace ecs::app
