// A monitor that is interrupted or killed, its unit the bundled emulator.
#include <csignal>
#include <thread>

#include "commissioning/link/choice.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const std::string kEcs = std::string(ECS_BUILD_FOLDER) + "/app/ecs";

/// The real program with its own process, so that signals can be sent to it.
pid_t ecs_started(std::vector<std::string> words, const std::string& output) {
  words.insert(words.begin(), kEcs);
  return started(words, output);
}

int exit_code_of_child(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void wait_for_bytes(const std::string& file) {
  for (int i = 0; i < 200 && content_of(file).empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

TEST_CASE("an interrupted program ends with 128 plus the signal and keeps what it recorded") {
  const StateFolder folder;
  const std::string output = folder / "out";
  const std::string record = folder / "m.csv";
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t child = ecs_started({"monitor", "--json", "--interval", "20", "--record", record}, output);
    wait_for_bytes(output);
    ::kill(child, signal);
    CHECK(exit_code_of_child(child) == 128 + signal);
    CHECK(content_of(record).starts_with("time_s,"));
    std::filesystem::remove(record);
    std::filesystem::remove(output);
  }
}

TEST_CASE("a killed monitor leaves its record in FILE.part, and the former file is still there") {
  const StateFolder folder;
  const std::string output = folder / "out";
  const std::string record = folder.with("m.csv", "former\n");
  const pid_t child = ecs_started({"monitor", "--json", "--interval", "20", "--record", record, "--force"}, output);
  wait_for_bytes(record + ".part");
  for (int i = 0; i < 200 && std::filesystem::file_size(record + ".part") < 1000; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ::kill(child, SIGKILL);
  CHECK(exit_code_of_child(child) == -1);
  CHECK(content_of(record) == "former\n");
  const std::string part = content_of(record + ".part");
  CHECK(part.starts_with("time_s,"));
  CHECK(part.size() >= 1000);
  // the next one does not write over it
  const Ran again = ran({"monitor", "--count", "1", "--record", record, "--force"});
  CHECK(again.code == 5);
  CHECK(contains(again.messages, "m.csv.part"));
  CHECK(content_of(record + ".part") == part);
  std::filesystem::remove(record + ".part");
  CHECK(ran({"monitor", "--count", "2", "--interval", "5", "--record", record, "--force"}).code == 0);
  const std::string replaced = content_of(record);
  CHECK(std::count(replaced.begin(), replaced.end(), '\n') == 7);
  CHECK_FALSE(std::filesystem::exists(record + ".part"));
}

TEST_CASE("a stored link is used where none is given, and --link goes before it") {
  const Folder folder;
  ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
  CHECK(chosen_link("").value().origin == "default");
  REQUIRE(store_link("tcp:mill:502"));
  CHECK(to_text(must(chosen_link(""))) == "tcp:mill:502:1");
  CHECK(chosen_link("tcp:lathe:502")->origin == "--link");
  static_cast<void>(folder.with("config/ecs/config.toml", "link = 7\n"));
  CHECK(ran({"monitor", "--count", "1"}).code == 3);
  ::unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace ecs::app
