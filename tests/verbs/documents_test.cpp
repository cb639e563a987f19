// Manual pages and completions: written from the definitions of the verbs, read by the programs they are for.
#include <doctest/doctest.h>

#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

/// What bash offers after these words, a line each. @param words  as bash parts them, the last one unfinished
std::string offered_by_bash(const Folder& folder, const std::string& words) {
  const std::string script = folder.with("completion", ran({"completion", "bash"}).out);
  return output_of("bash -c 'source " + script + "; COMP_WORDS=(" + words +
                   "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _ecs; printf \"%s\\n\" \"${COMPREPLY[@]}\"'")
      .text;
}

TEST_CASE("bash offers verbs, the verbs of a menu, options and the words of a choice") {
  const Folder folder;
  CHECK(offered_by_bash(folder, "ecs vol") == "volume\n");
  CHECK(offered_by_bash(folder, "ecs map b") == "build\n");
  CHECK(offered_by_bash(folder, "ecs utility datum t") == "test\n");
  CHECK(offered_by_bash(folder, "ecs map build --from-m") == "--from-model\n");
  CHECK(offered_by_bash(folder, "ecs model add m.toml cyclic --approach r") == "reverse\n");
  CHECK(offered_by_bash(folder, "ecs model repair --machine samp") == "\n");  // files: the shell's own
}

TEST_CASE("every verb has a manual page with its options and its example") {
  const Folder folder;
  const std::string pages = folder / "man";
  const Ran written = ran({"manual", "-o", pages});
  REQUIRE_MESSAGE(written.code == 0, written.all());
  for (const Action* verb : all_verbs().actions) {
    std::string name = "ecs";
    for (const std::string& word : verb->words()) name += "-" + word;
    const auto page = read_file(pages + "/" + name + ".1");
    REQUIRE_MESSAGE(page, name);
    CHECK(contains(*page, ".SH SYNOPSIS"));
    CHECK(contains(*page, "\\-\\-json"));
    if (!verb->example.empty()) CHECK(contains(*page, ".SH EXAMPLES"));
  }
  CHECK(contains(*read_file(pages + "/ecs.1"), ".B model diagnose"));
  CHECK(ran({"manual", "-o", pages}).code == 2);
  CHECK(ran({"manual", "-o", pages, "--force"}).code == 0);
}

TEST_CASE("groff has nothing to say about the pages") {
  SKIP_UNLESS(installed("command -v groff"), "groff is not installed");
  const Folder folder;
  REQUIRE(ran({"manual", "-o", folder / "man"}).code == 0);
  CHECK(
      output_of("for page in " + (folder / "man") + "/*.1; do groff -man -Tutf8 -ww \"$page\" >/dev/null; done").text ==
      "");
}

TEST_CASE("zsh and fish take their completion where they are installed") {
  const Folder folder;
  for (const std::string shell : {"zsh", "fish"}) {
    const std::string script = folder.with("completion." + shell, ran({"completion", shell}).out);
    CHECK(contains(*read_file(script), "repair"));
    if (installed("command -v " + shell)) CHECK(output_of(shell + " -n " + script).text == "");
  }
}

}  // namespace
}  // namespace ecs::app
