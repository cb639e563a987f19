// Words of a command line against menus and verbs: what runs, what is shown, what is refused.
#include "base/cli/command_tree.hpp"

#include "tests/support/test.hpp"

namespace ecs::cli {
namespace {

/// A program with a verb at its first level and a menu that takes a word by its place.
struct Program {
  Program() {
    Argument mode_argument{"--mode", &mode, "how"};
    mode_argument.choices = {"slow", "fast"};
    const Arguments run{
        {"--feed", &feed, "mm/min"},
        mode_argument,
        {"--count", &count, "times", Need::optional, 1, 9},
        {"--seed", &seed, "seed"},
        {"--back", OnFlag([this] { back = true; }), "backwards"},
        {"--port", OnInteger([this](long long value) { port = value; }), "port", Need::optional, 0, 65535}};
    tree.add_verb("run", "run it", "tool run --feed 5", run, [this] { chosen = "run"; });
    Argument targets{"--targets", OnNumbers([this](const std::vector<double>& all) { numbers = all; }), "mm"};
    targets.by_commas = true;
    tree.add_verb("shop measure", "measure", "tool shop SOCKET measure", {targets}, [this] { chosen = "measure"; });
  }
  Request asked(const std::vector<std::string>& words) { return tree.parsed(words); }

  std::string chosen, socket, mode = "slow";
  std::optional<double> feed;
  int count = 1;
  std::optional<std::uint64_t> seed;
  bool back = false;
  long long port = -1;
  std::vector<double> numbers;
  CommandTree tree{"tool", {{}, "A tool."}, {{"shop", "the shop", {{"SOCKET", &socket, "socket", Need::required}}}}};
};

TEST_CASE("a verb is chosen, its arguments go into their variables and callbacks") {
  Program tool;
  CHECK(tool.asked({"run", "--feed", "2.5", "--mode", "FAST", "--count", "3", "--seed", "7", "--back", "--port", "80"})
            .kind == Request::Kind::run);
  CHECK(tool.chosen == "run");
  CHECK(tool.feed == 2.5);
  CHECK(tool.mode == "fast");
  CHECK(tool.count == 3);
  CHECK(tool.seed == 7);
  CHECK(tool.back);
  CHECK(tool.port == 80);
}

TEST_CASE("a menu takes its word by place before its verb, commas part many values") {
  Program tool;
  CHECK(tool.asked({"shop", "a.sock", "measure", "--targets", "1,-2.5"}).kind == Request::Kind::run);
  CHECK(tool.chosen == "measure");
  CHECK(tool.socket == "a.sock");
  CHECK(tool.numbers == std::vector<double>{1.0, -2.5});
}

TEST_CASE("no words and a menu without a verb list the verbs") {
  Program tool;
  CHECK(tool.asked({}).kind == Request::Kind::no_words);
  const Request menu = tool.asked({"shop", "a.sock"});
  CHECK(menu.kind == Request::Kind::wrong);
  CHECK(contains(menu.text, "`tool shop` needs a verb: measure"));
  const Request by_name = tool.asked({"shop", "measure"});  // taken for the socket
  CHECK(by_name.kind == Request::Kind::wrong);
  CHECK(contains(by_name.text, "`tool shop` needs a verb: measure"));
}

TEST_CASE("help says what a verb takes, with its example") {
  Program tool;
  const Request help = tool.asked({"run", "--help"});
  CHECK(help.kind == Request::Kind::help);
  check_holds(help.text, {"Usage: tool run", "--mode slow|fast", "--count INTEGER=1", "Example:\n  tool run --feed 5"});
  CHECK(contains(tool.asked({"shop", "measure", "--help"}).text, "Usage: tool shop SOCKET measure"));
  CHECK(tool.asked({"--version"}).kind == Request::Kind::version);
}

TEST_CASE("what is wrong is said with a hint") {
  const auto refusal = [](const std::vector<std::string>& words) {
    Program tool;
    const Request request = tool.asked(words);
    CHECK(request.kind == Request::Kind::wrong);
    return request.text;
  };
  CHECK(contains(refusal({"rum"}), "`tool` has no verb \"rum\"; did you mean \"run\"? It has: run, shop"));
  CHECK(contains(refusal({"shop", "a.sock", "mesure"}), "did you mean \"measure\"?"));
  CHECK(contains(refusal({"measure"}), "has no verb \"measure\"; did you mean `tool shop measure`? It has: run, shop"));
  CHECK(contains(refusal({"help"}), "did you mean `tool --help`?"));
  CHECK(contains(refusal({"rum", "--help"}), "`tool` has no verb \"rum\"; did you mean \"run\"?"));
  CHECK(contains(refusal({"shop", "a.sock", "pay", "--help"}), "`tool shop` has no verb \"pay\". It has: measure"));
  CHECK(contains(refusal({"run", "--fed", "1"}), "did you mean \"--feed\"?"));
  CHECK(contains(refusal({"run", "--feed", "nan"}), "expected a number, got \"nan\""));
  CHECK(contains(refusal({"run", "--mode", "odd"}), "expected slow or fast, got \"odd\""));
  CHECK(contains(refusal({"run", "--feed"}), "--feed needs a value (NUMBER) after it"));
  CHECK(contains(refusal({"run", "--seed", "-1"}), "expected 0 or more"));
  CHECK(contains(refusal({"run", "--port", "70000"}), "tool run: --port"));
  CHECK(contains(refusal({"shop"}), "SOCKET is required"));
}

}  // namespace
}  // namespace ecs::cli
