// `ecs log` and what verbs write into the logbook by themselves.
#include <chrono>

#include <sys/stat.h>
#include <unistd.h>

#include "base/file.hpp"
#include "commissioning/link/choice.hpp"
#include "commissioning/logbook/store.hpp"
#include "tests/support/logbook_folder.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using commissioning::Logbook;
using commissioning::LogRecord;

/// A lathe whose unit may be any: its parameters name no serial number.
struct LoggedLathe {
  LogbookFolder folder;
  std::string params = folder.with("p.toml", short_lathe(""));
  std::string data = folder.with("exx.csv", lathe_readings("# machine: short lathe\n"));
  std::string map = folder / "map.csv";
  [[nodiscard]] Ran build() const { return ran({"map", "build", data, "--params", params, "-o", map}); }
  [[nodiscard]] std::string book() const { return (folder.path / "logbooks" / "short-lathe.ecslog").string(); }
};

std::vector<std::string> kinds_in(const nlohmann::json& list) {
  std::vector<std::string> kinds;
  for (const auto& entry : list["entries"]) kinds.push_back(entry["kind"]);
  return kinds;
}

TEST_CASE("a map that is built brings its measurement and itself into the logbook, said once") {
  const LoggedLathe lathe;
  const Ran built = lathe.build();
  REQUIRE(built.code == 0);
  CHECK(contains(built.messages, "a logbook of short lathe was begun"));
  const Ran list = ran({"log", "list", "--json"});
  REQUIRE(list.code == 0);
  const auto j = list.json();
  CHECK(kinds_in(j) == std::vector<std::string>{"measurement", "map"});
  const auto& entry = j["entries"][1];
  CHECK(entry["number"] == 2);
  CHECK(entry["operator"] == "Jo Fitter");
  CHECK(entry["previous"] == j["entries"][0]["hash"]);
  CHECK(entry["hash"].get<std::string>().size() == 64);
  CHECK(contains(entry["summary"].get<std::string>(), "map.csv"));
  CHECK(entry["time"].get<std::string>().size() == 20);
  const Ran again = ran({"params", "set", lathe.params, "axis.X.deadband_um=3", "-o", lathe.folder / "new.toml"});
  CHECK_FALSE(contains(again.messages, "was begun"));
}

TEST_CASE("exports, and bytes written into a unit's memory, are entries of their own kind") {
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  const Ran exported = ran({"export", "linuxcnc", lathe.map, "--params", lathe.params, "-o", lathe.folder / "tables"});
  CAPTURE(exported.messages);
  REQUIRE(exported.code == 0);
  CHECK(kinds_in(ran({"log", "list", "--json"}).json()).back() == "export");
  const auto machine = sample_machine();
  REQUIRE(machine);
  const Ran written =
      ran({"memory", "write", "0x048000", "702A4E75", "--yes", "--link", "emulator:" + machine->string()});
  CAPTURE(written.messages);
  REQUIRE(written.code == 0);
  const auto entries = ran({"log", "list", "--json"}).json()["entries"];  // of the logbook written last
  REQUIRE(entries.size() == 1);
  CHECK(entries[0]["kind"] == "memory write");
  CHECK(contains(entries[0]["summary"].get<std::string>(), "4 bytes written from 0x048000 on"));
  CHECK(ran({"log", "verify"}).code == 0);
  CHECK(ran({"log", "export", "--entry", "1", "--files", lathe.folder / "files", "-o", lathe.folder / "log.jsonl"})
            .code == 0);
}

TEST_CASE("what only shows something is not logged, nor is what failed") {
  const LoggedLathe lathe;
  REQUIRE(ran({"laser", "stats", lathe.data}).code <= 1);
  REQUIRE(ran({"laser", "import", lathe.data}).code == 0);
  CHECK(ran({"map", "build", lathe.data, "--params", lathe.folder / "none.toml", "-o", lathe.map}).code == 3);
  CHECK_FALSE(std::filesystem::exists(lathe.book()));
}

TEST_CASE("nothing is written where the setting says off, or where nothing names a machine") {
  {
    const LogbookFolder folder("off");
    const std::string params = folder.with("p.toml", short_lathe(""));
    REQUIRE(ran({"params", "set", params, "axis.X.deadband_um=3", "-o", folder / "new.toml"}).code == 0);
    CHECK_FALSE(std::filesystem::exists(folder / "state/logbooks"));
    CHECK(ran({"log", "list"}).code == 2);
  }
  const LogbookFolder folder;
  const std::string data = folder.with("exx.csv", lathe_readings());
  const Ran r = ran({"laser", "import", data, "-o", folder / "out.csv"});
  CHECK(r.code == 0);
  CHECK_FALSE(std::filesystem::exists(folder / "logbooks"));
  const Ran none = ran({"log", "list"});
  CHECK(none.code == 3);
  CHECK(contains(none.messages, "no logbook yet"));
}

TEST_CASE("where the logbook cannot be written the verb does its work and says so once") {
  SKIP_UNLESS(::geteuid() == 0, "needs root, to become an ordinary user");
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  ::chmod(lathe.folder.path.c_str(), 0777);
  ::chmod((lathe.folder / "logbooks").c_str(), 0555);
  ::chmod(lathe.book().c_str(), 0444);
  {
    const OrdinaryUser somebody;
    const Ran r = ran({"params", "set", lathe.params, "axis.X.deadband_um=3", "-o", lathe.folder / "new.toml"});
    CHECK(r.code == 0);
    CHECK(contains(r.messages, "not in the logbook"));
    CHECK(std::filesystem::exists(lathe.folder / "new.toml"));
    const Ran next = ran({"params", "set", lathe.params, "axis.X.deadband_um=4", "-o", lathe.folder / "newer.toml"});
    CHECK(next.code == 0);
    CHECK_FALSE(contains(next.messages, "not in the logbook"));
    CHECK(ran({"log", "verify"}).code == 0);
  }
  ::chmod((lathe.folder / "logbooks").c_str(), 0755);
}

TEST_CASE("the map in the unit is derived again from the raw readings, bit for bit") {
  const auto machine = sample_machine();
  REQUIRE(machine);
  const LoggedLathe lathe;
  const std::string link = "emulator:" + machine->string();
  REQUIRE(ran({"laser", "import", lathe.data, "-o", lathe.folder / "imported.csv"}).code == 0);
  REQUIRE(ran({"map", "build", lathe.folder / "imported.csv", "--params", lathe.params, "-o", lathe.map, "--params-out",
               lathe.folder / "out.toml"})
              .code == 0);
  CHECK(ran({"log", "replay"}).code == 1);  // nothing is active yet
  const Ran sent =
      ran({"map", "send", lathe.map, "--params", lathe.folder / "out.toml", "--link", link, "--other-machine"});
  CAPTURE(sent.all());
  REQUIRE(sent.code == 0);
  const auto list = ran({"log", "list", "--json"}).json();
  const auto kinds = kinds_in(list);
  REQUIRE(kinds.size() >= 4);
  CHECK(std::vector<std::string>(kinds.end() - 2, kinds.end()) == std::vector<std::string>{"transfer", "activation"});
  // The files on the disc do not matter: they change, and go.
  std::filesystem::remove(lathe.data);
  lathe.folder.with("imported.csv", "nothing");
  const Ran replay = ran({"log", "replay", "--json"});
  CAPTURE(replay.all());
  REQUIRE(replay.code == 0);
  const auto j = replay.json();
  CHECK(j["same"] == true);
  CHECK(j["map_sha256"] == j["active_sha256"]);
  CHECK(j["map_sha256"].get<std::string>().size() == 64);
  CHECK(j["derived"].size() == 3);  // the import, the map, its parameters
  bool raw = false;
  for (const auto& one : j["raw"]) raw = raw || contains(one["name"].get<std::string>(), "exx.csv");
  CHECK(raw);
  CHECK_FALSE(std::filesystem::exists(lathe.data));
  CHECK(ran({"log", "replay", "--unit", "--link", link}).code == 0);
  CHECK(ran({"log", "verify"}).code == 0);
  SUBCASE("and another one is not") {
    REQUIRE(ran({"map", "send", lathe.map, "--params", lathe.params, "--link", link, "--other-machine"}).code <= 1);
    REQUIRE(
        ran({"params", "set", lathe.folder / "out.toml", "axis.X.deadband_um=7", "-o", lathe.folder / "7.toml"}).code ==
        0);
    REQUIRE(
        ran({"map", "send", lathe.map, "--params", lathe.folder / "7.toml", "--link", link, "--other-machine"}).code ==
        0);
    REQUIRE(ran({"log", "replay"}).code == 0);
    REQUIRE(ran({"map", "send", lathe.map, "--params", lathe.folder / "out.toml", "--link", link, "--other-machine"})
                .code == 0);
    const auto after = ran({"log", "list", "--json", "--last", "1"}).json();
    CHECK(after["entries"][0]["kind"] == "rollback");
  }
}

TEST_CASE("neither an arming code nor a token is in the logbook") {
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  (void)ran({"params", "receive", "-o", lathe.folder / "r.toml", "--link", "tcp:127.0.0.1:1"});
  const Ran out = ran({"log", "export", "-o", lathe.folder / "log.jsonl"});
  REQUIRE(out.code == 0);
  CHECK_FALSE(contains(content_of(lathe.folder / "log.jsonl"), "arm-code"));
  CHECK(count_of(content_of(lathe.folder / "log.jsonl"), '\n') == 2);
}

TEST_CASE("a changed entry is named, and the command ends with 1") {
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  CHECK(ran({"log", "verify"}).code == 0);
  std::string bytes = content_of(lathe.book());
  const std::size_t at = bytes.find("Jo Fitter");
  REQUIRE(at != std::string::npos);
  bytes[at] = 'M';
  std::ofstream(lathe.book(), std::ios::binary) << bytes;
  const Ran found = ran({"log", "verify", "--json"});
  CHECK(found.code == 1);
  CHECK(found.json()["whole"] == false);
  CHECK(found.json()["first"].is_number());
}

TEST_CASE("the files of an entry come out as they were") {
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  const std::string folder = lathe.folder / "entry1";
  REQUIRE(ran({"log", "export", "--entry", "1", "--files", folder}).code == 0);
  CHECK(content_of(folder + "/1_exx.csv") == content_of(lathe.data));
  CHECK(ran({"log", "export", "--entry", "1", "--files", folder}).code == 2);
  CHECK(contains(ran({"log", "show", "2"}).out, "ecs map build"));
}

TEST_CASE("a logbook of another machine is told") {
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  const Ran other = ran({"log", "list", "--log", lathe.book(), "--machine", "mill"});
  CHECK(other.code == 3);
  CHECK(contains(other.messages, "is the logbook of short lathe"));
  CHECK(ran({"log", "list", "--machine", lathe.params}).code == 0);
  CHECK(ran({"log", "list", "--log", lathe.params}).code == 3);
}

TEST_CASE("an instrument that a measurement names stands in its entry, with whether its certificate covers the day") {
  const LogbookFolder folder;
  const std::string params = folder.with("p.toml", short_lathe(""));
  const std::string data = folder.with(
      "exx.csv", lathe_readings("# machine: short lathe\n# instrument: XL-80\n# instrument_serial_number: L42\n# "
                                "calibration_certificate: C-7\n# calibration_date: 2020-01-10\n# "
                                "calibration_interval_days: 365\n"));
  REQUIRE(ran({"map", "build", data, "--params", params, "-o", folder / "map.csv"}).code == 0);
  const auto entry = ran({"log", "list", "--json"}).json()["entries"][0];
  CHECK(entry["instrument"]["name"] == "XL-80");
  CHECK(entry["instrument"]["serial_number"] == "L42");
  CHECK(entry["instrument"]["calibration_certificate"] == "C-7");
  CHECK(entry["instrument"]["valid_until"] == "2021-01-09");
  CHECK(entry["instrument"]["calibrated"] == false);
}

/// A map of the lathe with this slope, as logged on a day.
void add_map(Logbook& book, const std::string& time, double um_per_mm) {
  std::string csv = "# machine: short lathe\naxis,sense,approach,p_mm,value_um\n";
  for (const int approach : {1, -1})
    for (int x = -200; x <= 0; x += 50) csv += fmt::format("X,EX,{},{},{}\n", approach, x, -um_per_mm * x);
  LogRecord record;
  record.kind = "map";
  record.machine = "short lathe";
  record.time = time;
  record.files.push_back({"output", "map.csv", std::make_shared<const std::string>(csv)});
  record.files.push_back({"input", "p.toml", std::make_shared<const std::string>(short_lathe(""))});
  REQUIRE(book.append(record));
}

void add_diagnosis(Logbook& book, const std::string& time, const std::string& answer) {
  LogRecord record;
  record.kind = "diagnosis";
  record.machine = "short lathe";
  record.time = time;
  record.content = "{\"answer\":" + answer + "}";
  REQUIRE(book.append(record));
}

TEST_CASE("two years side by side: what curves, causes and volume have become") {
  const LogbookFolder folder;
  auto book = Logbook::open(folder / "lathe.ecslog");
  REQUIRE(book);
  add_map(*book, "2025-03-12T10:00:00Z", 0.1);
  add_diagnosis(
      *book, "2025-03-12T11:00:00Z",
      R"({"candidates":[{"name":"scale:X:EX","named":true,"parameters":{"um_per_m":100.0}},{"name":"offset:X:EX","named":false}]})");
  add_map(*book, "2026-03-10T10:00:00Z", 0.15);
  add_diagnosis(
      *book, "2026-03-10T11:00:00Z",
      R"({"candidates":[{"name":"scale:X:EX","named":true,"parameters":{"um_per_m":150.0}},{"name":"backlash:X:EX","named":true,"parameters":{"um":3.0}}]})");
  const auto begun = std::chrono::steady_clock::now();
  const Ran r = ran({"log", "compare", "2025-03-12", "2026-03-12", "--log", folder / "lathe.ecslog", "--json"});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  CAPTURE(r.all());
  REQUIRE(r.code == 0);
  MESSAGE("compared in ", seconds, " s");
  const auto j = r.json();
  REQUIRE(j["curves"].size() >= 1);
  CHECK(j["curves"][0]["component"] == "EXX");
  CHECK(j["curves"][0]["largest_from"] == doctest::Approx(20.0));
  CHECK(j["curves"][0]["largest_to"] == doctest::Approx(30.0));
  CHECK(j["curves"][0]["largest_change"] == doctest::Approx(10.0));
  REQUIRE(j["causes"].size() == 2);
  CHECK(j["causes"][0]["from"] == "um_per_m 100");
  CHECK(j["causes"][0]["to"] == "um_per_m 150");
  CHECK(j["causes"][1]["name"] == "backlash:X:EX");
  CHECK(j["causes"][1]["from"].is_null());
  CHECK(ran({"log", "compare", "yesterday", "2026-03-12", "--log", folder / "lathe.ecslog"}).code == 2);
}

}  // namespace
}  // namespace ecs::app
