// The one rule for files: nothing is overwritten without --force; a verb's own input is changed in place.
#include "base/overwriting.hpp"

#include "base/file.hpp"
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

}  // namespace
}  // namespace ecs::app
