// The verbs against a unit at the far end of a line: the bundled emulator, started as a user's `ecs` starts it.
#include <csignal>
#include <thread>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "commissioning/link/choice.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "commissioning/memory/dump.hpp"
#include "tests/support/emulator.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

const std::string kEcs = std::string(ECS_BUILD_FOLDER) + "/app/ecs";

/// An empty battery, no stored link, and parameters with a map for the sample mill.
struct EmulatorWorkspace {
  StateFolder folder;
  std::string params =
      folder.with("p.toml",
                  "[compensation]\nscope = \"linear\"\n[axis.Y.datum]\napproach_direction = \"reverse\"\n"
                  "[axis.X]\ntransducer = \"encoder\"\n[axis.Z]\ntransducer = \"encoder\"\n# end of parameters\n");
  std::string map = folder.with("map.csv",
                                "# machine: moving column mill\n# configuration: "
                                "TXYZ\naxis,sense,approach,p_mm,value_um\nX,EX,0,-4100,1\nX,EX,0,0,5\nY,EY,0,-1400,1\n"
                                "Y,EY,0,0,2\nZ,EZ,0,-1000,1\nZ,EZ,0,0,3\n");
};

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

TEST_CASE("parameters sent to the default link come back the same in a later run, and every message says EMULATOR") {
  const EmulatorWorkspace workspace;
  const Ran sent = ran({"params", "send", workspace.params});
  CHECK(sent.code == 0);
  CHECK(sent.out.starts_with("EMULATOR: "));
  std::istringstream messages(sent.messages);
  for (std::string line; std::getline(messages, line);) CHECK(line.starts_with("EMULATOR: "));
  CHECK(ran({"params", "diff", workspace.params, "unit"}).code == 0);
  const std::string back = workspace.folder / "back.toml";
  const Ran received = ran({"params", "receive", "-o", back, "--json"});
  CHECK(received.code == 0);
  CHECK(received.json()["link"].get<std::string>().starts_with("emulator:"));
  CHECK(received.json()["serial_number"] == "MCM-0107");
  CHECK(ran({"params", "diff", workspace.params, back}).code == 0);
}

TEST_CASE("a unit without parameters says so") {
  const EmulatorWorkspace workspace;
  const Ran r = ran({"params", "receive", "--json"});
  CHECK(r.code == 1);
  CHECK(r.json()["error"]["message"].get<std::string>().find("holds no parameters") != std::string::npos);
}

/// Another sample machine has another serial number: the lathe's unit is CH-0005.
constexpr const char* kOtherUnit = "[identity]\nserial_number = \"CH-0005\"\n";

TEST_CASE("parameters of another unit are refused and leave the unit unchanged, unless --other-machine is given") {
  const EmulatorWorkspace workspace;
  REQUIRE(ran({"params", "send", workspace.params}).code == 0);
  const std::string other = workspace.folder.with("other.toml", kOtherUnit + content_of(workspace.params));
  REQUIRE(ran({"params", "set", other, "axis.X.deadband_um=9"}).code == 0);
  const Ran refused = ran({"params", "send", other, "--json"});
  CHECK(refused.code == 1);
  CHECK(refused.json()["error"]["message"].get<std::string>().find("CH-0005") != std::string::npos);
  CHECK(ran({"params", "send", other, "--force"}).code == 1);
  CHECK(ran({"params", "diff", workspace.params, "unit"}).code == 0);
  CHECK(ran({"params", "send", other, "--other-machine"}).code == 0);
  CHECK(ran({"params", "diff", other, "unit"}).code == 0);
}

TEST_CASE("a batch leaves a unit alone whose parameters name another serial number, with a map and without") {
  const EmulatorWorkspace workspace;
  static_cast<void>(workspace.folder.with("other.toml", kOtherUnit + content_of(workspace.params)));
  const std::string unit = "[[unit]]\nlink = \"emulator\"\nparams = \"other.toml\"\n";
  const std::string plan = workspace.folder.with("plan.toml", unit + unit + "map = \"map.csv\"\n");
  const Ran r = ran({"batch", plan, "--json"});
  CHECK(r.code == 1);
  const nlohmann::json answer = r.json();
  for (const auto& report : answer["units"]) {
    CHECK(report["state"] == "skipped");
    CHECK(report["error"]["message"].get<std::string>().find("CH-0005") != std::string::npos);
  }
  CHECK(ran({"map", "send", workspace.map, "--params", workspace.folder / "other.toml"}).code == 1);
  CHECK(ran({"params", "receive"}).code == 1);  // still nothing in the unit
}

TEST_CASE("a dump of another unit, or with the map of another machine, is loaded only with --other-machine") {
  const EmulatorWorkspace workspace;
  REQUIRE(ran({"map", "send", workspace.map, "--params", workspace.params}).code == 0);
  const std::string file = workspace.folder / "unit.ecsdump";
  REQUIRE(ran({"memory", "dump", "--active", "-o", file}).code == 0);
  auto dump = read_dump(file);
  REQUIRE(dump);
  dump->serial_number = "CH-0005";
  const std::string foreign = workspace.folder.with("foreign.ecsdump", to_bytes(*dump));
  const Ran refused = ran({"memory", "load", foreign, "--yes", "--json"});
  CHECK(refused.code == 1);
  CHECK(refused.json()["error"]["message"].get<std::string>().find("CH-0005") != std::string::npos);
  CHECK(ran({"memory", "load", foreign, "--yes", "--other-machine"}).code == 0);

  const std::string map = workspace.folder.with("other.csv", "# serial_number: CH-0005\n" + content_of(workspace.map));
  REQUIRE(ran({"map", "send", map, "--params", workspace.params, "--other-machine"}).code == 0);
  REQUIRE(ran({"memory", "dump", "--active", "-o", file, "--force"}).code == 0);
  CHECK(ran({"memory", "load", file, "--yes"}).code == 1);
  CHECK(ran({"memory", "load", file, "--yes", "--other-machine"}).code == 0);
}

TEST_CASE(
    "a map without a header, or for another configuration, goes only with --other-machine, and then for this unit") {
  const EmulatorWorkspace workspace;
  const std::string content = content_of(workspace.map);
  const std::string bare = workspace.folder.with("bare.csv", content.substr(content.find("axis,")));
  const Ran refused = ran({"map", "send", bare, "--params", workspace.params, "--json"});
  CHECK(refused.code == 1);
  CHECK(refused.out.find("names neither machine nor serial number") != std::string::npos);
  REQUIRE(ran({"map", "send", workspace.map, "--params", workspace.params}).code == 0);
  std::string turned = content_of(workspace.params);
  turned = "[configuration]\nchain = \"XTYZ\"\n" + turned;
  const std::string params = workspace.folder.with("turned.toml", turned);
  const std::string map = workspace.folder.with(
      "turned.csv", "# serial_number: MCM-0107\n# configuration: XTYZ\n" + content.substr(content.find("axis,")));
  const Ran other = ran({"map", "send", map, "--params", params, "--json"});
  CHECK(other.code == 1);
  CHECK(other.out.find("configuration") != std::string::npos);
  REQUIRE(ran({"map", "send", map, "--params", params, "--other-machine"}).code == 0);
  const std::string file = workspace.folder / "unit.ecsdump";
  REQUIRE(ran({"memory", "dump", "--active", "-o", file}).code == 0);
  const auto identity = ran({"memory", "show", file, "--json"}).json()["images"][0]["identity"];
  CHECK(identity["serial_number"] == "MCM-0107");
  CHECK(identity["machine"] == "moving column mill");
}

TEST_CASE("an image of format 1 is shown, and loaded in format 2 for the unit that its header names") {
  const StateFolder folder;
  const std::string old = "tests/data/memory/mill_format_1.image";
  const auto shown = ran({"memory", "show", old, "--json"}).json()["images"][0];
  CHECK(shown["format"] == 1);
  CHECK(shown["identity"].is_null());
  CHECK(shown["sound"] == true);
  CHECK(shown["tables"].size() == 27);
  REQUIRE(ran({"memory", "load", old, "--yes"}).code == 0);
  const std::string file = folder / "unit.ecsdump";
  REQUIRE(ran({"memory", "dump", "--active", "-o", file}).code == 0);
  const auto now = ran({"memory", "show", file, "--json"}).json()["images"][0];
  CHECK(now["format"] == 2);
  CHECK(now["identity"]["serial_number"] == "MCM-0107");
  CHECK(now["identity"]["machine"] == "moving column mill");
  CHECK(now["tables"].size() == 27);
}

TEST_CASE("the same map again is not sent, and the answer says so") {
  const EmulatorWorkspace workspace;
  const auto first = ran({"map", "send", workspace.map, "--params", workspace.params, "--json"}).json();
  CHECK(first["already_held"] == false);
  const auto again = ran({"map", "send", workspace.map, "--params", workspace.params, "--json"}).json();
  CHECK(again["already_held"] == true);
  CHECK(again["bytes_sent"] == 0);
  CHECK(again["commit_sequence"] == first["commit_sequence"]);
}

TEST_CASE("parameters without the squareness that the unit's map was measured with are refused") {
  const EmulatorWorkspace workspace;
  const std::string map = workspace.folder.with(
      "square.csv", "# source: C0Y square.csv sha256=" + std::string(64, 'a') + "\n" + content_of(workspace.map));
  REQUIRE(ran({"params", "set", workspace.params, "compensation.squareness.C0Y_um_per_m=12"}).code == 0);
  REQUIRE(ran({"map", "send", map, "--params", workspace.params}).code == 0);
  REQUIRE(ran({"params", "set", workspace.params, "compensation.squareness.C0Y_um_per_m=0"}).code == 0);
  const Ran refused = ran({"params", "send", workspace.params, "--json"});
  CHECK(refused.code == 1);
  CHECK(refused.out.find("C0Y was measured for this map") != std::string::npos);
}

TEST_CASE("asking again for compensation follows the datuming that is under way") {
  const EmulatorWorkspace workspace;
  const auto unit = EmulatorProcess::start({kEmulator, "samples/mill/machine.toml", workspace.folder / "memory"});
  REQUIRE(unit);
  const std::string link = "rtu:" + (*unit)->pty() + ":115200";
  const std::string code = (*unit)->arm_code();
  REQUIRE(ran({"map", "send", workspace.map, "--params", workspace.params, "--link", link, "--arm-code", code}).code ==
          0);
  for (int i = 0; i < 2; ++i) {
    const Ran r = ran({"utility", "mode", "compensate", "--wait", "0.3", "--link", link, "--json"});
    CHECK(r.code == 1);
    CHECK(r.json()["mode"] == "datuming");
  }
}

TEST_CASE("a map that is new to the unit brings the reminder to check polarity, the same map again does not") {
  const EmulatorWorkspace workspace;
  const auto reminded = [&] {
    const Ran r = ran({"map", "send", workspace.map, "--params", workspace.params});
    CHECK(r.code == 0);
    return r.messages.find("before the first compensation") != std::string::npos;
  };
  CHECK(reminded());
  CHECK_FALSE(reminded());
}

TEST_CASE("bytes cannot be written into the active map nor beside it, a transfer writes there") {
  const EmulatorWorkspace workspace;
  REQUIRE(ran({"params", "send", workspace.params}).code == 0);
  const auto images = ran({"memory", "show", "--unit", "--json"}).json()["images"];
  const std::string active = images[0]["address"];
  for (const std::string& address : {active, std::string("0x100000"), std::string("0x200000")}) {
    const Ran refused = ran({"memory", "write", address, "00", "--yes"});
    CHECK(refused.code == 1);
    CHECK(refused.messages.find("use `params send`, `map send` or `memory load`") != std::string::npos);
  }
  CHECK(ran({"memory", "show", "--unit", "--json"}).json()["images"] == images);
  CHECK(ran({"memory", "write", "0x048000", "00", "--yes"}).code == 0);
}

TEST_CASE("a file that may not grow is a write error, and nothing is left beside it") {
  const Folder folder;
  const std::string script =
      fmt::format("cd '{}' && ulimit -f 0 && '{}' params new --machine '{}' -o new.toml 2>/dev/null", folder / ".",
                  kEcs, std::filesystem::absolute("samples/mill/machine.toml").string());
  const int status = std::system(script.c_str());
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 5);
  CHECK(std::filesystem::is_empty(folder / "."));
}

TEST_CASE("a map stays when parameters that it fits are sent, and is dropped only by --force when they do not") {
  const EmulatorWorkspace workspace;
  REQUIRE(ran({"map", "send", workspace.map, "--params", workspace.params}).code == 0);
  REQUIRE(ran({"params", "set", workspace.params, "axis.X.deadband_um=7"}).code == 0);
  CHECK(ran({"params", "send", workspace.params, "--json"}).json()["map_kept"] == true);
  CHECK(ran({"map", "verify", workspace.map, "--params", workspace.params}).code == 0);
  REQUIRE(ran({"params", "set", workspace.params, "compensation.scope=volumetric"}).code == 0);
  const Ran refused = ran({"params", "send", workspace.params, "--json"});
  CHECK(refused.code == 1);
  CHECK(refused.json()["error"]["also"].size() > 5);
  CHECK(ran({"memory", "show", "--unit", "--json"}).json()["images"][0]["tables"].size() == 3);
  CHECK(ran({"params", "send", workspace.params, "--force", "--json"}).json()["map_dropped"] == true);
  CHECK(ran({"memory", "show", "--unit", "--json"}).json()["images"][0]["tables"].empty());
}

TEST_CASE("parameters that must not meet a machine are refused before any link is opened") {
  const Folder folder;
  const std::string file =
      folder.with("p.toml", "[configuration]\nchain = \"TX\"\naxes = \"X\"\n[compensation]\nscope = \"planar\"\n");
  const Ran r = ran({"params", "send", file, "--link", "rtu:/dev/no-such-port:9600", "--json"});
  CHECK(r.code == 1);
  CHECK(r.json()["error"]["file"] == file);
  CHECK_FALSE(r.json().contains("link"));
}

TEST_CASE("a dump of the unit loads back into it, and compares equal in its image") {
  const EmulatorWorkspace workspace;
  REQUIRE(ran({"map", "send", workspace.map, "--params", workspace.params}).code == 0);
  const std::string before = workspace.folder / "before.ecsdump";
  const std::string after = workspace.folder / "after.ecsdump";
  REQUIRE(ran({"memory", "dump", "--active", "-o", before, "--json"}).code == 0);
  REQUIRE(ran({"params", "send", workspace.params}).code == 0);
  CHECK(ran({"memory", "load", before}).code == 2);
  CHECK(ran({"memory", "load", before, "--yes", "--json"}).json()["verified"] == true);
  REQUIRE(ran({"memory", "dump", "-o", after}).code == 0);
  const auto dump = read_dump(after);
  REQUIRE(dump);
  CHECK(dump->regions.size() == 5);
  CHECK(dump->damage.empty());
  const nlohmann::json compared = ran({"memory", "compare", before, after, "--json"}).json();
  for (const auto& difference : compared["differences"]) {
    const auto what = difference["what"].get<std::string>();
    CHECK_FALSE(what.starts_with("parameter"));
    CHECK_FALSE(what.starts_with("table"));
  }
}

TEST_CASE("memory is written and read, and where it is protected it is refused") {
  const EmulatorWorkspace workspace;
  CHECK(ran({"memory", "write", "0x048000", "4E75", "0x1234", "--yes", "--json"}).json()["length"] == 4);
  CHECK(ran({"memory", "write", "0x10", "00", "--yes"}).code == 1);
  const auto read = ran({"memory", "read", "0x0F0000", "0x80", "--json"}).json();
  CHECK(read["bytes"].get<std::string>().size() == 256);
  CHECK(ran({"memory", "read", "0x900000", "4"}).code != 0);
}

TEST_CASE("monitor answers one JSON object a line and records the samples") {
  const EmulatorWorkspace workspace;
  const std::string record = workspace.folder / "m.csv";
  const Ran r = ran({"monitor", "--count", "3", "--interval", "5", "--json", "--record", record});
  CHECK(r.code == 0);
  std::istringstream lines(r.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto sample = nlohmann::json::parse(line);
    CHECK(sample["axes"].size() == 3);
    CHECK(sample["axes"]["X"]["position_mm"].is_number());
    CHECK(sample["link"].is_string());
  }
  CHECK(count == 3);
  const std::string csv = content_of(record);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 10);
}

TEST_CASE("position, output and its end are carried out") {
  const EmulatorWorkspace workspace;
  CHECK(ran({"utility", "position", "X", "-38.8", "--json"}).json()["position_mm"] == -38.8);
  CHECK(ran({"utility", "output", "X", "5", "--relay", "--yes", "--json"}).json()["relay_closed"] == true);
  CHECK(ran({"utility", "output", "--off"}).code == 0);
  CHECK(ran({"utility", "ramtest", "--json"}).json()["passed"] == true);
  CHECK(ran({"utility", "clear"}).code == 0);
}

TEST_CASE("a unit that cannot compensate says why, and one that waits for its referencing says how far it is") {
  const EmulatorWorkspace workspace;
  const Ran empty = ran({"utility", "mode", "compensate", "--wait", "1", "--json"});
  CHECK(empty.code != 0);
  CHECK(empty.json()["error"]["message"].get<std::string>().find("no_map") != std::string::npos);
  REQUIRE(ran({"map", "send", workspace.map, "--params", workspace.params}).code == 0);
  const Ran waits = ran({"utility", "mode", "compensate", "--wait", "0.3", "--json"});
  CHECK(waits.code == 1);
  CHECK(waits.json()["mode"] == "datuming");
  CHECK(waits.json()["axes"]["X"]["datum_stage"] == "waiting");
}

TEST_CASE("a batch of one emulator and one wrong serial number sends to the first and skips the second") {
  const EmulatorWorkspace workspace;
  const std::string unit = "[[unit]]\nlink = \"emulator\"\nparams = \"p.toml\"\nmap = \"map.csv\"\nserial_number = ";
  const std::string plan = workspace.folder.with("plan.toml", unit + "\"MCM-0107\"\n" + unit + "\"other\"\n");
  const Ran dry = ran({"batch", plan, "--dry-run", "--json"});
  CHECK(dry.json()["units"][0]["state"] == "ready");
  CHECK(ran({"params", "receive"}).code == 1);  // still nothing in the unit
  const Ran r = ran({"batch", plan, "--json"});
  CHECK(r.code == 1);
  CHECK(r.json()["units"][0]["state"] == "sent");
  CHECK(r.json()["units"][1]["state"] == "skipped");
  CHECK(ran({"map", "verify", workspace.map, "--params", workspace.params}).code == 0);
}

TEST_CASE("the doctor finds nothing wrong with the bundled emulator, and stores a link that works") {
  const EmulatorWorkspace workspace;
  const Ran r = ran({"doctor", "--link", "emulator", "--save", "--json"});
  CHECK(r.code == 0);
  CHECK(r.json()["works"] == true);
  CHECK(r.json()["statistics"]["worst_round_trip_ms"].is_number());
  CHECK(chosen_link("")->origin == "configuration");
}

TEST_CASE("an interrupted program ends with 128 plus the signal and keeps what it recorded") {
  const EmulatorWorkspace workspace;
  const std::string output = workspace.folder / "out";
  const std::string record = workspace.folder / "m.csv";
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
  const EmulatorWorkspace workspace;
  const std::string output = workspace.folder / "out";
  const std::string record = workspace.folder.with("m.csv", "former\n");
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
  CHECK(again.messages.find("m.csv.part") != std::string::npos);
  CHECK(content_of(record + ".part") == part);
  std::filesystem::remove(record + ".part");
  CHECK(ran({"monitor", "--count", "2", "--interval", "5", "--record", record, "--force"}).code == 0);
  const std::string replaced = content_of(record);
  CHECK(std::count(replaced.begin(), replaced.end(), '\n') == 7);
  CHECK_FALSE(std::filesystem::exists(record + ".part"));
}

}  // namespace
}  // namespace ecs::app
