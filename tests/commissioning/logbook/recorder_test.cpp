// What is written without being asked: kept open in a burst, one file afterwards.
#include "commissioning/logbook/recorder.hpp"

#include "commissioning/logbook/store.hpp"
#include "tests/support/logbook_folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

LogRecord about_the_lathe(const std::string& summary) {
  LogRecord record;
  record.kind = "test";
  record.machine = "short lathe";
  record.serial_number = "SL-1";
  record.summary = summary;
  return record;
}

TEST_CASE("a logbook stays open while entries come, and is one file when it rests") {
  const LogbookFolder folder;
  const std::string path = folder / "logbooks/short-lathe.ecslog";
  REQUIRE(record(about_the_lathe("first")));
  REQUIRE(record(about_the_lathe("second")));
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
  REQUIRE(record(about_the_lathe("first")));
  std::filesystem::remove_all(folder.path / "logbooks");
  REQUIRE(record(about_the_lathe("second")));
  close_logbooks();
  CHECK(Logbook::open_to_read(path)->verified().entries == 1);
}

TEST_CASE("two machines have a logbook each in the same burst") {
  const LogbookFolder folder;
  LogRecord other = about_the_lathe("of the other");
  other.machine = "long lathe";
  other.serial_number = "LL-1";
  REQUIRE(record(about_the_lathe("first")));
  REQUIRE(record(other));
  REQUIRE(record(about_the_lathe("second")));
  close_logbooks();
  CHECK(Logbook::open_to_read(folder / "logbooks/short-lathe.ecslog")->count() == 2U);
  CHECK(Logbook::open_to_read(folder / "logbooks/long-lathe.ecslog")->count() == 1U);
}

}  // namespace
}  // namespace ecs::commissioning
