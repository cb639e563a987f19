// `ecs laser prepare`.
#include <fmt/format.h>

#include "tests/support/test.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

/// Two lines, two runs each, three targets.
std::string two_lines() {
  std::string text = "axis,x_mm,y_mm,z_mm,sense,reading,approach,run\n";
  for (const char* sense : {"EX", "EY"})
    for (int run = 1; run <= 2; ++run)
      for (int k = 0; k < 3; ++k) text += fmt::format("X,{},-700,0,{},{}.5,1,{}\n", 50 * k, sense, k + run, run);
  return text;
}
const std::string kEy = "EY along X at Y -700, Z 0";

TEST_CASE("a line becomes a file of its own, without what is left out, which it says with the reason") {
  const Folder folder;
  const std::string file = folder.with("both.csv", two_lines()), out = folder / "eyx.csv";
  REQUIRE(
      ran({"laser", "prepare", file, "--line", kEy, "--leave-out-run", "2=cold", "--leave-out-reading", "3", "-o", out})
          .code == 0);
  const std::string text = content_of(out);
  CHECK(contains(text, "left_out: run 2 (cold)"));
  CHECK(contains(text, "left_out: run 1 at 100 mm"));
  CHECK(contains(text, "prepared_from: both.csv"));
  const auto shown = ran({"laser", "import", out, "--json"}).json();
  CHECK(shown["readings"] == 2);
}

TEST_CASE("several files of a line are joined, their runs numbered on, and put where they were measured") {
  const Folder folder;
  const std::string first = folder.with("first.csv", two_lines()), second = folder.with("second.csv", two_lines());
  const std::string out = folder / "joined.csv";
  REQUIRE(ran({"laser", "prepare", first, second, "--line", kEy, "--place", "y=-500", "-o", out}).code == 0);
  const auto shown = ran({"laser", "import", out, "--json"}).json();
  CHECK(shown["readings"] == 12);
  CHECK(contains(content_of(out), "-500"));
  CHECK_FALSE(contains(content_of(out), "-700"));
}

TEST_CASE("what is not there is refused with what there is, and nothing is written") {
  const Folder folder;
  const std::string file = folder.with("both.csv", two_lines()), out = folder / "out.csv";
  const auto refused = [&](std::vector<std::string> words, const std::string& said) {
    words.insert(words.begin(), {"laser", "prepare", file, "-o", out});
    const Ran r = ran(words);
    CAPTURE(r.messages);
    CHECK(r.code == 2);
    CHECK(contains(r.messages, said));
    CHECK_FALSE(std::filesystem::exists(out));
  };
  refused({}, kEy);
  refused({"--line", "EZ along X"}, kEy);
  refused({"--line", kEy, "--leave-out-run", "3"}, "there are 1, 2");
  refused({"--line", kEy, "--leave-out-reading", "7"}, "6 readings");
  refused({"--line", kEy, "--leave-out-run", "two=cold"}, "two=cold");
  refused({"--line", kEy, "--place", "y=nowhere"}, "y");
  CHECK(ran({"laser", "prepare", file, "--line", kEy, "-o", file}).code == 2);
}

}  // namespace
}  // namespace ecs::app
