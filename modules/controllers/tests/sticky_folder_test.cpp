// Files of an export beside files of somebody else.
#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

#include "modules/controllers/tests/output_files.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

TEST_CASE("a file of another user in a sticky folder fails in the middle, and the files before it are restored") {
  SKIP_UNLESS(::geteuid() == 0, "only root can own files for two users");
  const Folder folder;
  ::chmod((folder / "").c_str(), 01777);
  (void)folder.with("x.comp", "old x");
  REQUIRE(::chown((folder / "x.comp").c_str(), 65534, 65534) == 0);
  (void)folder.with("z.comp", "old z");  // root's: it can be read, not replaced
  {
    const OrdinaryUser user;
    const auto written = must_fail(write_together(three(folder)));
    CHECK(written.file == folder / "z.comp");
    CHECK(written.message ==
          "cannot write: Operation not permitted; the previous files were restored: no file has changed");
  }
  CHECK(content_of(folder / "x.comp") == "old x");
  CHECK_FALSE(std::filesystem::exists(folder / "y.comp"));
  CHECK(content_of(folder / "z.comp") == "old z");
  CHECK(entries_in(folder) == 2);
}

}  // namespace
}  // namespace ecs::commissioning
