// What a verb says to run next can be pasted into a shell as it is printed.
#include <deque>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/model_workspace.hpp"

namespace ecs::app {
namespace {

/// The commands behind "next: " and between backquotes.
std::vector<std::string> commands_in(const std::string& text) {
  std::vector<std::string> commands;
  for (const std::string_view line : lines_of(text)) {
    if (line.starts_with("next: ecs ")) commands.emplace_back(line.substr(6));
    const auto parts = split(line, '`');
    for (std::size_t k = 1; k < parts.size(); k += 2)
      if (parts[k].starts_with("ecs ")) commands.emplace_back(parts[k]);
  }
  return commands;
}

Output pasted(const std::string& command) {
  const std::string build = ECS_BUILD_FOLDER;
  return output_of("export PATH=" + build + "/app:" + build + "/ecs_emulator:$PATH; " + command);
}

/// Files whose names a shell takes apart unless they are quoted.
struct AwkwardFolder : StateFolder {
  [[nodiscard]] std::string operator/(const std::string& name) const {
    return StateFolder::operator/("it's here/" + name);
  }
  std::string with(const std::string& name, const std::string& text) const {
    return StateFolder::with("it's here/" + name, text);
  }
};

class HintTyped final : public Keyboard {
 public:
  explicit HintTyped(std::deque<std::string> lines) : lines_(std::move(lines)) {}
  std::optional<std::string> line() override {
    if (lines_.empty()) return std::nullopt;
    std::string line = std::move(lines_.front());
    lines_.pop_front();
    return line;
  }
  [[nodiscard]] bool ended() const override { return lines_.empty(); }

 private:
  std::deque<std::string> lines_;
};

Ran run_typed(const std::vector<std::string>& words, std::deque<std::string> lines) {
  std::ostringstream out, messages;
  ConsoleOptions options;
  options.keyboard = std::make_shared<HintTyped>(std::move(lines));
  const int code = run_program(words, out, messages, options);
  return {code, out.str(), messages.str()};
}

TEST_CASE("commands that name files: a new model, new parameters, a memory dump") {
  const AwkwardFolder folder;
  const std::string data = folder.with("a b.csv", measured_x(cyclic_x)), model = folder / "model.toml";
  const std::string machine = folder.with("machine.toml", content_of("samples/single_axis/machine.toml"));
  const Ran made = ran({"model", "new", model, data, "--machine", machine});
  const Ran parameters = ran({"params", "new", "--machine", machine, "-o", folder / "p.toml"});
  const Ran dumped = ran({"memory", "dump", "-o", folder / "unit.ecsdump", "--active", "--link", "emulator"});
  for (const Ran* said : {&made, &parameters, &dumped}) {
    REQUIRE_MESSAGE(said->code == 0, said->messages);
    const auto commands = commands_in(said->all());
    REQUIRE_MESSAGE(commands.size() == 1, said->all());
    const Output output = pasted(commands.front());
    const int code = output.status / 256;  // params check finds what is still to be set
    CHECK_MESSAGE((code == 0 || (said == &parameters && code == 1)), commands.front() << "\n" << output.text);
  }
  CHECK(contains(commands_in(made.out).front(), "--machine"));
}

TEST_CASE("the command that leaves outliers out names their file and rows") {
  const AwkwardFolder folder;
  std::string text = "axis,x_mm,sense,reading,approach,run\n";
  for (int run = 1; run <= 5; ++run)
    for (const int approach : {1, -1})
      for (int k = 0; k < 6; ++k)
        text +=
            fmt::format("X,{},EX,{:.2f},{},{}\n", 50 * k,
                        0.1 * ((7 * k + 3 * run + approach) % 5) + (run == 2 && k == 3 && approach > 0 ? 40.0 : 0.0),
                        approach, run);
  const Ran stats = ran({"laser", "stats", folder.with("x axis.csv", text)});
  REQUIRE(stats.code == 0);
  const auto commands = commands_in(stats.out);
  REQUIRE_MESSAGE(commands.size() == 1, stats.out);
  CHECK(contains(commands.front(), "--exclude-row 16"));
  const Output output = pasted(commands.front());
  CHECK_MESSAGE(output.status == 0, output.text);
  CHECK(contains(output.text, "1 of 60 readings left out"));
}

TEST_CASE("the command that ends an output names the link that it went over") {
  const AwkwardFolder folder;
  const std::string machine = folder.with("machine.toml", content_of("samples/mill/machine.toml"));
  (void)folder.with("errors.toml", content_of("samples/mill/errors.toml"));
  const Ran put = ran({"utility", "output", "X", "5", "--link", "emulator:" + machine});
  REQUIRE_MESSAGE(put.code == 0, put.messages);
  const auto commands = commands_in(put.all());
  REQUIRE(commands.size() == 1);
  CHECK(contains(commands.front(), "--link"));
  const Output output = pasted(commands.front());
  CHECK_MESSAGE(output.status == 0, output.text);
}

TEST_CASE("the command that goes on with a capture, when it is left and when it is begun again") {
  const AwkwardFolder folder;
  (void)folder.with("notes.txt", "");
  const std::string out = folder / "x.csv";
  const std::vector<std::string> words{"laser",  "capture", "--axis", "X",  "--sense",        "EX",
                                       "--from", "0",       "--to",   "50", "--step",         "50",
                                       "--runs", "1",       "-o",     out,  "--min-interval", "0"};
  const Ran stopped = run_typed(words, {"0.5", "q"});
  CHECK(stopped.code == 1);
  const auto left = commands_in(stopped.all());
  REQUIRE_MESSAGE(left.size() == 1, stopped.all());
  CHECK(commands_in(ran(words).messages) == left);
  const std::string parted = output_of("printf '%s\\n' " + left.front()).text;  // as a shell parts it
  std::vector<std::string> again;
  for (const std::string_view word : lines_of(parted))
    if (!word.empty()) again.emplace_back(word);
  REQUIRE(again.front() == "ecs");
  again.erase(again.begin());
  const Ran gone_on = run_typed(again, {"0.1", "0.2", "0.3"});
  CHECK_MESSAGE(gone_on.code == 0, gone_on.all());
  CHECK(contains(gone_on.out, "4 readings of 4 targets"));
}

}  // namespace
}  // namespace ecs::app
