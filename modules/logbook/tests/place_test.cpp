// Which logbook an entry goes to, and whose a file is.
#include "modules/logbook/place.hpp"

#include "tests/support/folder.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

void begin(const std::filesystem::path& path, const LogOwner& owner) {
  auto book = Logbook::open(path);
  REQUIRE(book);
  LogRecord record;
  record.kind = "report";
  record.machine = owner.machine;
  record.serial_number = owner.serial_number;
  REQUIRE(book->append(record));
}

std::string chosen(const LogbookSetting& setting, const LogOwner& owner) {
  const auto path = logbook_of(setting, owner);
  REQUIRE(path);
  return *path ? (*path)->filename().string() : "none";
}

TEST_CASE("parameters, machine files, maps and measurement sets say whose they are") {
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

}  // namespace
}  // namespace ecs::commissioning
