// A logbook that cannot be written. The screen LOGBOOK: entries, one of them whole, verification.
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "modules/logbook/replay.hpp"
#include "modules/logbook/tests/logbook_folder.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

/// A lathe whose unit may be any: its parameters name no serial number.
struct LoggedLathe {
  LogbookFolder folder;
  std::string params = folder.with("p.toml", short_lathe(""));
  std::string data = folder.with("exx.csv", lathe_readings("# machine: short lathe\n"));
  std::string map = folder / "map.csv";
  [[nodiscard]] Ran build() const { return ran({"map", "build", data, "--params", params, "-o", map}); }
  [[nodiscard]] std::string book() const { return (folder.path / "logbooks" / "short-lathe.ecslog").string(); }
};

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

TEST_CASE("the volume of a logged map is computed without a machine file that lies in the working folder") {
  const LoggedLathe lathe;
  REQUIRE(lathe.build().code == 0);
  (void)lathe.folder.with("machine.toml", "name = \"another machine\"\n");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(lathe.folder.path);
  const Ran compared = ran({"log", "compare", "2020-01-01", "2999-01-01"});
  std::filesystem::current_path(before);
  CHECK(compared.code == 0);
  CHECK_FALSE(contains(compared.all(), "2999-01-01: no volume"));
}

TEST_CASE("a model is made again where its file still exists, which stays as it is") {
  const LoggedLathe lathe;
  const std::string model = lathe.folder / "model.toml";
  const std::string data = lathe.folder.with("x axis.csv", lathe_readings("# machine: short lathe\n"));
  REQUIRE(ran({"model", "new", model, data}).code == 0);
  const std::string made = must(read_file(model));
  (void)lathe.folder.with("model.toml", "changed since then");
  const auto book = must(commissioning::Logbook::open_to_read(lathe.book()));
  commissioning::Derivation derivation(book, [](const auto& words) -> Result<std::string> {
    const Ran again = ran(words);
    return again.code == 0 ? Result<std::string>(again.out) : problem(ProblemKind::refused, "{}", again.messages);
  });
  CHECK(must(derivation.file(sha256_hex(made), "model.toml", 1'000)) == made);
  CHECK(contains(only(derivation.derived).verb, "'" + data + "'"));  // as a shell takes it
  CHECK(must(read_file(model)) == "changed since then");
}

TEST_CASE("a comparison of days uses the last diagnosis, and no model compare that an older logbook calls one") {
  using commissioning::Logbook, commissioning::LogRecord;
  const Folder folder;
  auto book = must(Logbook::open(folder / "a.ecslog"));
  for (const char* verb : {"model diagnose", "model compare"})
    REQUIRE(book.append(LogRecord{.kind = "diagnosis",
                                  .machine = "short lathe",
                                  .summary = verb,
                                  .content = fmt::format(R"({{"verb":"{}"}})", verb),
                                  .time = "2026-03-12T09:00:00Z"}));
  const auto days = must(commissioning::compared(book, "2026-03-12", "2026-03-13", {}));
  REQUIRE(days.states[1].diagnosis);
  CHECK(days.states[1].diagnosis->summary == "model diagnose");
}

}  // namespace

std::unique_ptr<Screen> logbook_screen();

namespace {

using namespace screen_test;

TEST_CASE("without a logbook the screen says how one begins") {
  const LogbookFolder folder;
  const auto screen = logbook_screen();
  CHECK(reads(picture(*screen), "No logbook yet. One is started when verbs or screens work on a machine."));
}

TEST_CASE("entries are listed, opened, checked, and new ones come on their own") {
  const LogbookFolder folder;
  const std::string params = folder.with("p.toml", short_lathe("MCM-0107"));
  const std::string data = folder.with("exx.csv", lathe_readings("# machine: short lathe\n"));
  REQUIRE(ran({"map", "build", data, "--params", params, "-o", folder / "map.csv"}).code == 0);
  const auto screen = logbook_screen();
  check_holds(picture(*screen),
              {"short lathe, serial number MCM-0107: 2 entries", "map build: map.csv", "exx.csv, input of entry 2"});
  check_holds(after(*screen, "\n"), {"ecs map build", "Jo Fitter"});
  (void)press(*screen, Key::Name::escape);
  check_holds(ran({"log", "show", "1"}).all(), {"exx.csv, input of entry 2 (map build: map.csv written)"});
  (void)letter(*screen, 'v');
  CHECK(until(*screen, [&] { return contains(picture(*screen), "2 entries: each agrees with its hash"); }));
  (void)press(*screen, Key::Name::escape);
  REQUIRE(ran({"params", "set", params, "axis.X.deadband_um=3", "-o", folder / "new.toml"}).code == 0);
  CHECK(until(*screen, [&] { return contains(picture(*screen), "params set: new.toml"); }));
  (void)letter(*screen, 'r');
  CHECK(until(*screen, [&] { return reads(picture(*screen), "no map became active"); }));
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
}

}  // namespace
}  // namespace ecs::app
