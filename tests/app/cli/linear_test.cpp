// `ecs --linear`: numbers and lines in, the same verbs out.
#include <sstream>

#include <doctest/doctest.h>

#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

struct Asked {
  int code = 0;
  std::string out;
};

Asked asked(const std::string& lines) {
  std::istringstream in(lines);
  std::ostringstream out, messages;
  const int code = run_linear_program(in, out, messages);
  return {code, out.str() + messages.str()};
}

TEST_CASE("a menu and a verb are chosen by number or by name, and the command is shown before it runs") {
  const Asked effects = asked("model\neffects\n\nq\n");
  CHECK(effects.code == 0);
  CHECK(contains(effects.out, "ecs model effects\n"));
  CHECK(contains(effects.out, "cyclic"));
  CHECK(contains(effects.out, "done"));
  CHECK(contains(asked("1\n1\n\n\nq\n").out, "ecs params show"));
}

TEST_CASE("arguments are asked for in words; options only when wanted") {
  const Folder folder;
  const std::string file = folder.with("x.csv", "axis,x_mm,sense,reading,approach,run\nX,0,EX,1,1,1\nX,10,EX,2,1,1\n");
  const Asked stats = asked("laser\nstats\n" + file + "\n\nq\n");
  CHECK(contains(stats.out, "measurement files"));
  CHECK(contains(stats.out, "ecs laser stats " + file));
  CHECK(contains(stats.out, "EXX"));
  const Asked json = asked("laser\nstats\n" + file + "\ny\ny\n" + std::string(80, '\n') + "q\n");
  CHECK(contains(json.out, "--json"));
}

TEST_CASE(
    "what is no number of the list is said; a needed argument left empty and the end of the input end nothing badly") {
  CHECK(contains(asked("99\nq\n").out, "expected a number from 1 to"));
  CHECK(contains(asked("laser\nstats\n\nq\n").out, "needed: back to the menu"));
  CHECK(asked("").code == 0);
  CHECK(asked("laser\n").code == 0);
}

}  // namespace
}  // namespace ecs::app
