// Who may write to a unit, as verbs see it: the code, the time, what was done.
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

/// Without $ECS_ARM_CODE, as long as it lives.
struct NoCodeKnown {
  NoCodeKnown() { ::unsetenv("ECS_ARM_CODE"); }
  NoCodeKnown(const NoCodeKnown&) = delete;
  NoCodeKnown& operator=(const NoCodeKnown&) = delete;
  ~NoCodeKnown() { ::setenv("ECS_ARM_CODE", kArmCode.c_str(), 1); }
};

/// A unit of one's own on a pseudo-terminal.
class AccessBench {
 public:
  AccessBench() {
    process_ = started({kEmulator, "serve", "--machine", "samples/mill/machine.toml", "--pty", folder / "line",
                        "--workshop", workshop(), "--mode", "integrate", "--arm-code", kArmCode},
                       folder / "ready.json");
    constexpr int kLooks = 400;
    for (int i = 0; i < kLooks && content_of(folder / "ready.json").empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }
  AccessBench(const AccessBench&) = delete;
  AccessBench& operator=(const AccessBench&) = delete;
  ~AccessBench() { end_process(process_, SIGTERM); }
  [[nodiscard]] Ran run(std::vector<std::string> words) const {
    words.insert(words.end(), {"--link", fmt::format("rtu:{}:115200", folder / "line")});
    return ran(words);
  }
  [[nodiscard]] std::string workshop() const { return folder / "shop"; }
  StateFolder folder;

 private:
  pid_t process_ = -1;
};

}  // namespace

TEST_CASE("a unit is read-only until the host is armed with its code, and switching off needs none") {
  const AccessBench bench;
  const NoCodeKnown none;
  CHECK(bench.run({"utility", "status"}).code == 0);
  CHECK(bench.run({"utility", "output", "--off"}).code == 0);
  CHECK(bench.run({"utility", "mode", "integrate"}).code == 0);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"utility", "position", "X", "1"},
                                                {"utility", "output", "X", "5", "--relay", "--yes"},
                                                {"utility", "reset"},
                                                {"utility", "ramtest"},
                                                {"utility", "run", "0x041000", "--yes"},
                                                {"memory", "write", "0x048000", "4E75", "--yes"},
                                                {"utility", "mode", "compensate"}}) {
    const Ran refused = bench.run(words);
    CHECK_MESSAGE(refused.code == 1, fmt::format("{}: {}", fmt::join(words, " "), refused.all()));
    CHECK(refused.all().find("read-only for this host until it is armed") != std::string::npos);
  }
  const Ran wrong = bench.run({"unit", "arm", "--code", "314159"});
  CHECK(wrong.code == 1);
  CHECK(wrong.all().find("this is not the code that the unit shows") != std::string::npos);
  Ran armed;
  for (int k = 0; k < 50 && (k == 0 || armed.code != 0); ++k) {  // a second of the unit's clock must pass
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    armed = bench.run({"unit", "arm", "--code", kArmCode, "--minutes", "5"});
  }
  CHECK_MESSAGE(armed.code == 0, armed.all());
  CHECK(bench.run({"utility", "position", "X", "1"}).code == 0);
  CHECK(bench.run({"memory", "write", "0x048000", "4E75", "--yes"}).code == 0);
  CHECK(bench.run({"unit", "disarm"}).code == 0);
  CHECK(bench.run({"utility", "position", "X", "2"}).code == 1);
  CHECK(bench.run({"utility", "position", "X", "2", "--arm-code", kArmCode}).code == 0);
}

TEST_CASE("a batch says before it sends that a unit would refuse") {
  const AccessBench bench;
  static_cast<void>(bench.folder.with("p.toml", content_of("tests/data/params/mill_unit.toml")));
  const std::string unit =
      fmt::format("[[unit]]\nlink = \"rtu:{}:115200\"\nparams = \"p.toml\"\n", bench.folder / "line");
  const std::string coded = bench.folder.with("coded.toml", unit + fmt::format("arm_code = \"{}\"\n", kArmCode));
  const std::string plain = bench.folder.with("plain.toml", unit);
  const NoCodeKnown none;
  constexpr const char* kWarning = "not armed and no arm_code is given";
  CHECK(ran({"batch", plain, "--dry-run"}).all().find(kWarning) != std::string::npos);
  CHECK(ran({"batch", coded, "--dry-run"}).all().find(kWarning) == std::string::npos);
}

TEST_CASE("the events of a unit name host, time and result, live, in a saved status and in a dump") {
  const AccessBench bench;
  REQUIRE(bench.run({"utility", "position", "X", "1"}).code == 0);
  CHECK(bench.run({"utility", "position", "X", "1e9"}).code == 1);
  const auto events = bench.run({"unit", "events", "--json"}).json()["events"];
  REQUIRE(events.size() == 3);
  CHECK(events[0]["what"] == "arm");
  CHECK(events[1]["what"] == "set axis position");
  CHECK(events[1]["arguments"] == "X 1 mm");
  CHECK(events[1]["result"] == "done");
  CHECK(events[1]["host"].get<std::string>().find('@') != std::string::npos);
  CHECK(events[1]["time"].get<std::string>().size() == 20);
  CHECK(events[2]["result"] == "refused");
  CHECK(events[2]["error"] == "bad argument");
  const std::string saved = bench.folder / "status.json";
  REQUIRE(bench.run({"utility", "status", "--save", saved}).code == 0);
  CHECK(ran({"utility", "status", "--from", saved, "--json"}).json()["events"] == events);
  const std::string dump = bench.folder / "unit.ecsdump";
  REQUIRE(bench.run({"memory", "dump", "--active", "-o", dump}).code == 0);
  CHECK(content_of(dump).find("set axis position") != std::string::npos);
}

TEST_CASE("the workshop tells the code that the unit shows") {
  const AccessBench bench;
  const std::string command =
      fmt::format("{} workshop {} arm-code | grep -q {}", kEmulator, bench.workshop(), kArmCode);
  CHECK(std::system(command.c_str()) == 0);
}

}  // namespace ecs::app
