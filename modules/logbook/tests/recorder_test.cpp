// Which logbook an entry goes to, and whose a file is. What is written without being asked: kept open in a burst, one
// file afterwards. The file of the measuring instrument, read and written.
#include "modules/logbook/recorder.hpp"

#include "base/file.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/store.hpp"
#include "modules/logbook/tests/logbook_folder.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

void begin(const std::filesystem::path& path, const LogOwner& owner) {
  auto book = must(Logbook::open(path));
  LogRecord record{.kind = "report", .machine = owner.machine, .serial_number = owner.serial_number};
  REQUIRE(book.append(record));
}

std::string chosen(const LogbookSetting& setting, const LogOwner& owner) {
  const auto path = must(logbook_of(setting, owner));
  return path ? path->filename().string() : "none";
}

TEST_CASE("parameters, machine files, maps and measurement files say whose they are") {
  CHECK(owner_in(short_lathe("MCM-0107")).machine == "short lathe");
  CHECK(owner_in(short_lathe("MCM-0107")).serial_number == "MCM-0107");
  CHECK(owner_in("name = \"mill\"\nconfiguration = \"TXYZ\"\n[axis.X]\ntravel_mm = [0.0, 1.0]\n").machine == "mill");
  CHECK(owner_in(lathe_readings("# machine: short lathe\n# serial_number: S1\n")).serial_number == "S1");
  CHECK(owner_in(lathe_readings()).machine.empty());
  CHECK(owner_in("name = \"model\"\n[[effect]]\nid = \"scale\"\n").machine.empty());
}

TEST_CASE("each machine has its own logbook, found by name and serial number") {
  const Folder folder;
  LogbookSetting setting;
  setting.folder = folder.path;
  CHECK(chosen(setting, {}) == "none");
  CHECK(chosen(setting, {"Moving column mill", ""}) == "moving-column-mill.ecslog");
  begin(folder / "moving-column-mill.ecslog", {"Moving column mill", "S1"});
  CHECK(chosen(setting, {"Moving column mill", "S1"}) == "moving-column-mill.ecslog");
  CHECK(chosen(setting, {"Moving column mill", ""}) == "moving-column-mill.ecslog");
  CHECK(chosen(setting, {"", "S1"}) == "moving-column-mill.ecslog");
  CHECK(chosen(setting, {"Moving column mill", "S2"}) == "moving-column-mill-s2.ecslog");
  CHECK(chosen(setting, {"lathe", "S1"}) == "lathe.ecslog");
}

TEST_CASE("a name that a unit's identity has cut is the same machine's") {
  const std::string name(60, 'm');
  CHECK(belongs({name, ""}, {name.substr(0, 40), ""}));
  CHECK_FALSE(belongs({name, ""}, {name.substr(0, 10), ""}));
  CHECK_FALSE(belongs({"mill", "S1"}, {"", ""}));
}

LogRecord about_the_lathe(const std::string& summary) {
  return {.kind = "test", .machine = "short lathe", .serial_number = "SL-1", .summary = summary};
}

TEST_CASE("a logbook stays open while entries come, and is one file when it rests") {
  const LogbookFolder folder;
  const std::string path = folder / "logbooks/short-lathe.ecslog";
  record(about_the_lathe("first"));
  record(about_the_lathe("second"));
  CHECK(std::filesystem::exists(path + "-wal"));
  close_logbooks(std::chrono::hours(1));
  CHECK(std::filesystem::exists(path + "-wal"));
  close_logbooks();
  CHECK_FALSE(std::filesystem::exists(path + "-wal"));
  CHECK(Logbook::open_to_read(path)->verified().entries == 2);
}

TEST_CASE("a logbook that is removed while it is open begins again where it was") {
  const LogbookFolder folder;
  const std::string path = folder / "logbooks/short-lathe.ecslog";
  record(about_the_lathe("first"));
  std::filesystem::remove_all(folder.path / "logbooks");
  record(about_the_lathe("second"));
  close_logbooks();
  CHECK(Logbook::open_to_read(path)->verified().entries == 1);
}

TEST_CASE("two machines have a logbook each in the same burst") {
  const LogbookFolder folder;
  LogRecord other = about_the_lathe("of the other");
  other.machine = "long lathe";
  other.serial_number = "LL-1";
  record(about_the_lathe("first"));
  record(other);
  record(about_the_lathe("second"));
  close_logbooks();
  CHECK(Logbook::open_to_read(folder / "logbooks/short-lathe.ecslog")->count() == 2U);
  CHECK(Logbook::open_to_read(folder / "logbooks/long-lathe.ecslog")->count() == 1U);
}

TEST_CASE("files are kept as they are on the disc, and one that cannot be read stays out") {
  const LogbookFolder folder;
  const std::string there = folder.with("there.txt", "as it is");
  LogRecord one = about_the_lathe("saved");
  one.files = seen_files({there, folder / "missing.txt", ""}, {there});
  one.files.push_back({"input", "in memory alone", std::make_shared<const std::string>("as it was")});
  record(one);
  const std::vector<LogFile> files =
      files_of(Logbook::open_to_read(folder / "logbooks/short-lathe.ecslog")->entry(1).value());
  REQUIRE(files.size() == 3);
  CHECK(files[0] == LogFile{"input", there, sha256_hex("as it is"), 8, true});
  CHECK(files[1].role == "output");
  CHECK(files[2] == LogFile{"input", "in memory alone", sha256_hex("as it was"), 9, true});
}

TEST_CASE("an instrument with any characters in its words is written and read again as the same") {
  for (const char* word : {"\n", "a\nb", "\t", "'", "\"", "\\", "\x01", "\xC2\xB5m", "'''\n\"\"\""}) {
    CAPTURE(word);
    Instrument instrument{.name = word, .serial_number = word, .calibration_interval_days = 365};
    CHECK(must(parse_instrument(to_toml(instrument), "instrument.toml")) == instrument);
  }
}

}  // namespace
}  // namespace ecs::commissioning
