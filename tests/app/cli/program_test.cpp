// How a command line is answered: exit codes, JSON, messages.
#include "app/cli/program.hpp"

#include <csignal>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/interrupt.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

bool one_object(const std::string& text) {
  const auto parsed = nlohmann::json::parse(text, nullptr, false);
  return parsed.is_object() && std::count(text.begin(), text.end(), '\n') == 1;
}

TEST_CASE("the program alone lists its verbs and names the link, and does nothing else") {
  const Ran plain = ran({});
  CHECK(plain.code == 0);
  for (const char* verb : {"params send", "monitor", "utility datum record", "memory show", "batch", "doctor"})
    CHECK(plain.out.find(verb) != std::string::npos);
  CHECK(plain.out.find("Link: ") != std::string::npos);
  const Ran json = ran({"--json"});
  CHECK(one_object(json.out));
  CHECK(json.json()["verbs"].size() > 20);
}

TEST_CASE("a clone that was moved after it was built finds its own sample machine and emulator") {
  const Folder clone;
  const std::filesystem::path built(ECS_BUILD_FOLDER), build = std::filesystem::path(clone / "build/release");
  std::filesystem::create_directories(build / "app");
  std::filesystem::create_directories(build / "ecs_emulator");
  std::filesystem::create_directories(clone / "samples");
  std::filesystem::copy_file(built / "app/ecs", build / "app/ecs");
  std::filesystem::create_symlink(built / "ecs_emulator/ecs-emulator", build / "ecs_emulator/ecs-emulator");
  std::filesystem::copy("samples/mill", clone / "samples/mill");
  const Output said = output_of((build / "app/ecs").string() + " utility status");
  CHECK(said.status == 0);
  CHECK_MESSAGE(contains(said.text, clone / "samples/mill/machine.toml"), said.text);
}

using cli::Nothing;

/// Exit code of a program whose verb ends well after SIGINT has come.
int exit_code_after_signal(bool finished) {
  const pid_t child = ::fork();
  if (child == 0) {
    catch_signals();
    ::raise(SIGINT);
    const Action done = finished
                            ? action(
                                  "work", "ends its work", "ecs work",
                                  +[](VerbContext&, const Nothing&) -> Result<Outcome> {
                                    return Outcome{"done\n", "{}", kDone, true};
                                  })
                            : action(
                                  "work", "looks on", "ecs work", +[](VerbContext&, const Nothing&) -> Result<Outcome> {
                                    return Outcome{"seen\n", "{}", kDone, false};
                                  });
    std::ostringstream out, messages;
    ::_exit(run_command_line({{}, {&done}}, {"work"}, out, messages));
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  return WEXITSTATUS(status);
}

TEST_CASE(
    "a signal that came when everything was done does not make the exit code, one that cut something short does") {
  CHECK(exit_code_after_signal(true) == 0);
  CHECK(exit_code_after_signal(false) == 128 + SIGINT);
}

TEST_CASE("ecs --help shows every verb with its help, and the options") {
  const Ran r = ran({"--help"});
  CHECK(r.code == 0);
  const nlohmann::json verbs = ran({"--json"}).json()["verbs"];
  for (const auto& entry : verbs) CHECK(r.out.find("  " + entry["verb"].get<std::string>()) != std::string::npos);
  for (const char* part : {"--link", "--json", "ecs FILE..."}) CHECK(r.out.find(part) != std::string::npos);
}

TEST_CASE("a misspelt verb is a usage error that names the nearest one") {
  const Ran r = ran({"parms"});
  CHECK(r.code == 2);
  CHECK(r.out.empty());
  CHECK(r.messages.find("did you mean \"params\"") != std::string::npos);
  const Ran deep = ran({"utility", "datum", "recrod", "X"});
  CHECK(deep.code == 2);
  CHECK(deep.messages.find("\"record\"") != std::string::npos);
}

TEST_CASE("a menu without a verb, an unknown option and a missing argument are usage errors, in JSON too") {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"params"},
                                             {"params", "check"},
                                             {"params", "check", "a", "--nonsense"},
                                             {"utility", "position", "X", "inf"},
                                             {"utility", "position", "X", "nan"},
                                             {"utility", "mode", "sleep"},
                                             {"memory", "read", "0x10", "four"},
                                             {"memory", "read", "0xFFFFFF", "2"},
                                             {"utility", "output", "X", "5", "--relay"},
                                             {"utility", "output"},
                                             {"memory", "write", "0x48000", "4E7", "--yes"},
                                             {"params", "show"},
                                             {"memory", "show"},
                                             {"batch", "plan.toml", "--link", "emulator"},
                                             {"monitor", "--link", "carrier pigeon"}}) {
    CAPTURE(words.front());
    CHECK(ran(words).code == 2);
    std::vector<std::string> with_json = words;
    with_json.push_back("--json");
    const Ran r = ran(with_json);
    CHECK(r.code == 2);
    REQUIRE(one_object(r.out));
    CHECK(r.json()["error"]["message"].is_string());
    CHECK(r.json()["error"]["file"].is_null());
    CHECK(r.json()["error"]["line"].is_null());
  }
}

TEST_CASE("an option without its value and a value out of range are reported as such, not as a misspelling") {
  const Ran alone = ran({"laser", "process", "a.csv", "--smooth"});
  CHECK(alone.code == 2);
  CHECK(alone.messages.find("--smooth needs a value (NUMBER)") != std::string::npos);
  const Ran negative = ran({"utility", "mode", "compensate", "--wait", "-1"});
  CHECK(negative.code == 2);
  CHECK(negative.messages.find("got -1") != std::string::npos);
  CHECK(negative.messages.find("e+308") == std::string::npos);
  const Ran word = ran({"memory", "dump", "-o"});
  CHECK(word.messages.find("-o needs a value after it") != std::string::npos);
  for (const Ran& r : {alone, negative, word}) CHECK(r.messages.find("did you mean") == std::string::npos);
  CHECK(ran({"utility", "mode", "compensate", "--wiat", "1"}).messages.find("did you mean \"--wait\"") !=
        std::string::npos);
}

TEST_CASE("help fits 80 columns but for the examples, and shows the defaults") {
  const nlohmann::json verbs = ran({"--json"}).json()["verbs"];
  for (const auto& entry : verbs) {
    std::vector<std::string> words;
    std::istringstream name(entry["verb"].get<std::string>());
    for (std::string word; name >> word;) words.push_back(word);
    words.push_back("--help");
    CAPTURE(entry["verb"]);
    const std::string help = ran(words).out;
    std::istringstream lines(help.substr(0, help.find("Example:")));
    for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 80);
  }
  CHECK(ran({"monitor", "--help"}).out.find("INTEGER=500") != std::string::npos);
}

TEST_CASE("a menu alone says that it needs a verb, with --json too; an address with too many fields is refused") {
  CHECK(ran({"params", "--json"}).json()["error"]["message"].get<std::string>().find("needs a verb") !=
        std::string::npos);
  CHECK(ran({"monitor", "--link", "tcp:h:502:1:7"}).messages.find("too many fields") != std::string::npos);
}

TEST_CASE("memory outside the address map is refused alike for reading and writing, before any link is opened") {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"memory", "read", "0x900000", "4"},
                                             {"memory", "read", "0x04FFFF", "2"},
                                             {"memory", "write", "0x900000", "00", "--yes"}}) {
    const Ran r = ran(words);
    CHECK(r.code == 1);
    CHECK(r.messages.find("the unit has no memory there; it has EPROM 0x000000 to 0x00FFFF") != std::string::npos);
  }
}

TEST_CASE("a writing verb that is refused before its link is opened still says EMULATOR") {
  const Ran r = ran({"memory", "write", "0x48000", "00", "--link", "emulator:samples/mill/machine.toml"});
  CHECK(r.code == 2);
  CHECK(r.messages.starts_with("EMULATOR: "));
  CHECK_FALSE(ran({"memory", "write", "0x48000", "00", "--link", "tcp:h:502"}).messages.starts_with("EMULATOR"));
}

TEST_CASE("a record that cannot be written is reported before the link is opened") {
  const Ran r = ran({"monitor", "--record", "/no/such/folder/x.csv", "--link", "rtu:/dev/no-such-port:9600"});
  CHECK(r.code == 5);
  const Folder folder;
  CHECK(ran({"monitor", "--record", folder / ".", "--link", "rtu:/dev/no-such-port:9600"}).code == 5);
}

TEST_CASE("a monitor without a unit leaves the former record as it was, and nothing beside it") {
  const Folder folder;
  const std::string record = folder.with("m.csv", "former\n");
  CHECK(ran({"monitor", "--record", record, "--force", "--link", "rtu:/dev/no-such-port:9600"}).code == 4);
  CHECK(content_of(record) == "former\n");
  CHECK_FALSE(std::filesystem::exists(record + ".part"));
}

TEST_CASE("a transfer of no bytes is refused with the number that is allowed") {
  const Folder folder;
  const std::string empty = folder.with("empty.bin", "");
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"memory", "read", "0x100000", "0"}, {"memory", "write", "0x48000", "--file", empty, "--yes"}}) {
    const Ran r = ran(words);
    CHECK(r.code == 2);
    CHECK(r.messages.find("expected at least 1 byte, got 0") != std::string::npos);
  }
}

TEST_CASE("every verb explains itself with an example") {
  const auto verbs = ran({"--json"}).json()["verbs"];
  for (const auto& entry : verbs) {
    std::vector<std::string> words;
    std::istringstream text(entry["verb"].get<std::string>());
    for (std::string word; text >> word;) words.push_back(word);
    words.push_back("--help");
    const Ran r = ran(words);
    CAPTURE(entry["verb"]);
    CHECK(r.code == 0);
    CHECK(r.out.find("Example:\n  ecs " + entry["verb"].get<std::string>()) != std::string::npos);
  }
}

TEST_CASE("a missing file is exit code 3 and named in the JSON error") {
  const Ran r = ran({"params", "check", "no/such/file.toml", "--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["error"]["file"] == "no/such/file.toml");
  CHECK(ran({"memory", "show", "no/such/file"}).code == 3);
  CHECK(ran({"utility", "status", "--from", "no/such/file"}).code == 3);
  CHECK(ran({"utility", "status", "--from", "", "--link", "tcp:127.0.0.1:1"}).code == 3);  // no unit is asked instead
  CHECK(ran({"utility", "datum", "show", "no/such/file"}).code == 3);
  CHECK(ran({"batch", "no/such/file"}).code == 3);
}

TEST_CASE("what moves, runs or overwrites asks for --yes before any link is opened") {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"utility", "output", "X", "5", "--relay"},
                                             {"utility", "run", "0x48000"},
                                             {"memory", "write", "0x48000", "4E75"}}) {
    const Ran r = ran(words);
    CHECK(r.code == 2);
    CHECK(r.messages.find("--yes") != std::string::npos);
  }
}

TEST_CASE("a port that does not exist is exit code 4") {
  const Ran r = ran({"monitor", "--count", "1", "--link", "rtu:/dev/no-such-port:9600", "--json"});
  CHECK(r.code == 4);
  REQUIRE(one_object(r.out));
  CHECK(r.json()["link"] == "rtu:/dev/no-such-port:9600:8N1:1");
  CHECK(r.json()["error"]["message"].get<std::string>().find("no such port") != std::string::npos);
}

TEST_CASE("stdout that cannot be written is exit code 5") {
  std::ofstream full("/dev/full");
  REQUIRE(full);
  std::ostringstream messages;
  CHECK(run_program({"--version"}, full, messages) == 5);
}

TEST_CASE("a reader that closes the pipe ends a verb quietly, as the shell expects it") {
  const StateFolder folder;
  const std::string ecs = std::string(ECS_BUILD_FOLDER) + "/app/ecs";
  for (const char* words : {"--help", "model effects --json", "monitor --count 0 --interval 1 --link emulator"}) {
    CAPTURE(words);
    const Output output =
        output_of("bash -c '{ sleep 0.3; " + ecs + " --quiet " + words + "; echo left with $? >&2; } | true'");
    CHECK(output.text == "left with 141\n");
  }
}

}  // namespace
}  // namespace ecs::app
