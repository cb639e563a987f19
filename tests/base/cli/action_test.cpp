// An action by its parts: fields of a plain request, what is added for all actions, how its answer becomes an outcome.
#include "base/cli/action.hpp"

#include "base/answer_table.hpp"
#include "base/cli/command_tree.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::cli {
namespace {

struct Place {
  std::string unit = "mm";
  std::vector<std::string> at;
  static Fields<Place> fields() {
    return Fields<Place>{{"--unit", &Place::unit, "unit", Words{"mm", "in"}}, {"--at", &Place::at, "places"}}.under(
        "Where");
  }
};

struct DrawRequest {
  std::string file, output;
  std::size_t points = 100;
  std::optional<double> scale;
  bool bare = false;
  Place place;
  static Fields<DrawRequest> fields() {
    using R = DrawRequest;
    return {{"FILE", &R::file, "what to draw", Need::required},
            {"-o,--output", &R::output, "picture", Is::output},
            {"--points", &R::points, "of the curve", Range{2, 1000}},
            {"--scale", &R::scale, "of the picture"},
            {"--bare", &R::bare, "no frame"},
            &R::place};
  }
};

struct DrawAnswer {
  DrawRequest request;
  [[nodiscard]] bool holds() const { return request.points > 10; }
};
Cell describe(const DrawAnswer& answer) { return record_cell("{points} points\n", "points"_is(answer.request.points)); }

struct Runner {
  std::string link{}, arm_code{};
};
DrawRequest last;
Result<DrawAnswer> draw(Runner&, const DrawRequest& request) {
  last = request;
  return DrawAnswer{request};
}
const Action<Runner> kDraw = action("draw", "draws", "tool draw a.csv", draw, {.link = Link::writes});

Result<Outcome> drawn(const std::vector<std::string>& words) {
  Runner runner;
  CommandTree tree("tool", {{}, "A tool."}, {});
  Action<Runner>::Run run;
  const auto bound = kDraw.bound({{}, &runner.link, &runner.arm_code});
  tree.add_verb("draw", "draws", "tool draw a.csv", bound.arguments, [&] { run = bound.run; });
  REQUIRE(tree.parsed(words).kind == Request::Kind::run);
  return run(runner);
}

TEST_CASE("every field fills its member, also in a group of its own") {
  REQUIRE(drawn({"draw", "a.csv", "-o", "/no/such/b.svg", "--points", "7", "--scale", "0.5", "--bare", "--unit", "IN",
                 "--at", "1", "2"}));
  CHECK(last.file == "a.csv");
  CHECK(last.output == "/no/such/b.svg");
  CHECK(last.points == 7);
  CHECK(last.scale == 0.5);
  CHECK(last.bare);
  CHECK(last.place.unit == "in");
  CHECK(last.place.at == std::vector<std::string>{"1", "2"});
}

TEST_CASE("presets are those of the request, headings those of its groups") {
  Runner runner;
  const auto bound = kDraw.bound({{}, &runner.link, &runner.arm_code});
  const Arguments& arguments = bound.arguments;
  CHECK(arguments[2].preset() == "100");
  CHECK(arguments[5].preset() == "mm");
  CHECK(arguments[5].heading == "Where");
  CHECK(arguments[4].heading.empty());
}

TEST_CASE("an action that writes to a unit takes a link and a secret code; one that writes a file takes --force") {
  Runner runner;
  const auto bound = kDraw.bound({{}, &runner.link, &runner.arm_code});
  const Arguments& arguments = bound.arguments;
  REQUIRE(arguments.size() == 10);
  CHECK(arguments[7].name == "--link");
  CHECK(arguments[8].name == "--arm-code");
  CHECK(arguments[8].is_secret);
  CHECK(arguments[9].name == "--force");
}

TEST_CASE("an answer is described once, as text and JSON; where it does not hold the exit code is 1") {
  const auto few = must(drawn({"draw", "a.csv", "--points", "7"}));
  CHECK(few.text == "7 points\n");
  CHECK(few.json == "{\"points\":7}");
  CHECK(few.exit_code == kDoesNotHold);
  CHECK(drawn({"draw", "a.csv"})->exit_code == kDone);
}

TEST_CASE("an output file that is there is refused unless --force is given") {
  const Folder folder;
  const std::string there = folder.with("b.svg", "former");
  CHECK(must_fail(drawn({"draw", "a.csv", "-o", there})).kind == ProblemKind::usage);
  CHECK(drawn({"draw", "a.csv", "-o", there, "--force"}));
  CHECK(drawn({"draw", there, "-o", there}));  // changed in place
}

}  // namespace
}  // namespace ecs::cli
