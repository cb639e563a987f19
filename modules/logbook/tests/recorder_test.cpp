// What is written without being asked: kept open in a burst, one file afterwards.
#include "modules/logbook/recorder.hpp"

#include "base/file.hpp"
#include "modules/logbook/store.hpp"
#include "modules/logbook/tests/logbook_folder.hpp"
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

}  // namespace
}  // namespace ecs::commissioning
