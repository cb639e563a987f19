// Files of an export: written together or not at all, also beside files of somebody else.
#include <filesystem>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "modules/controllers/export.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

std::vector<OutputFile> three(const Folder& folder) {
  return {{folder / "x.comp", "new x"}, {folder / "y.comp", "new y"}, {folder / "z.comp", "new z"}};
}

std::size_t entries_in(const Folder& folder) {
  const std::filesystem::directory_iterator all(folder / "");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

TEST_CASE("several files are written together, and each says whether it replaced one") {
  const Folder folder;
  (void)folder.with("y.comp", "old y");
  ::chmod((folder / "y.comp").c_str(), 0640);
  const auto written = must(write_together(three(folder)));
  CHECK(content_of(folder / "x.comp") == "new x");
  CHECK(content_of(folder / "y.comp") == "new y");
  CHECK(entries_in(folder) == 3);
  CHECK(written_files_cell(written).text == "written: " + (folder / "x.comp") + "\nreplaced: " + (folder / "y.comp") +
                                                "\nwritten: " + (folder / "z.comp") + "\n");
  struct stat now {};
  REQUIRE(::stat((folder / "y.comp").c_str(), &now) == 0);
  CHECK((now.st_mode & 07777) == 0640);
}

/// As a logbook sees them; with `replaces`, as a repetition from it does, which writes nothing.
class Seen final : public FileWatch {
 public:
  explicit Seen(bool replaces) : replaces_(replaces) {}
  [[nodiscard]] bool replaces_disc() const override { return replaces_; }
  [[nodiscard]] Result<std::string> content(const std::filesystem::path&) override {
    return problem(ProblemKind::bad_input, "none");
  }
  void was_read(const std::filesystem::path&, std::string_view) override {}
  void was_written(const std::filesystem::path& path, std::string_view content) override {
    written += path.filename().string() + ": " + std::string(content) + "\n";
  }
  std::string written;

 private:
  bool replaces_;
};

TEST_CASE("who watches the files sees them by their names, and writes them in place of the disc") {
  for (const bool replaces : {false, true}) {
    const Folder folder;
    Seen seen(replaces);
    REQUIRE(write_together(three(folder)));
    CHECK(seen.written == "x.comp: new x\ny.comp: new y\nz.comp: new z\n");
    CHECK(entries_in(folder) == (replaces ? 0 : 3));
  }
}

TEST_CASE("where one of the names is a folder, no file is changed") {
  const Folder folder;
  (void)folder.with("x.comp", "old x");
  (void)folder.with("z.comp/inside", "a folder stands there");
  const auto written = must_fail(write_together(three(folder)));
  CHECK(written.kind == ProblemKind::output);
  CHECK(written.file == folder / "z.comp");
  CHECK(written.message == "cannot write: a folder of that name exists; no file was changed");
  CHECK(content_of(folder / "x.comp") == "old x");
  CHECK_FALSE(std::filesystem::exists(folder / "y.comp"));
  CHECK(entries_in(folder) == 2);
}

TEST_CASE("two names that lead to one file are refused, and a link stays a link") {
  const Folder folder;
  (void)folder.with("real", "old");
  std::filesystem::create_symlink(folder / "real", folder / "x.comp");
  CHECK(write_together(three(folder)));
  CHECK(content_of(folder / "real") == "new x");
  CHECK(std::filesystem::is_symlink(folder / "x.comp"));
  std::filesystem::remove(folder / "z.comp");
  std::filesystem::create_symlink(folder / "real", folder / "z.comp");
  const auto twice = must_fail(write_together({{folder / "x.comp", "1"}, {folder / "z.comp", "2"}}));
  CHECK(contains(twice.message, "leads to the same file; no file was changed"));
  CHECK(content_of(folder / "real") == "new x");
}

TEST_CASE("a link to a file that is not there yet stays a link, and its target is counted as that file") {
  const Folder folder;
  std::filesystem::create_symlink("later", folder / "x.comp");
  REQUIRE(write_together(three(folder)));
  CHECK(std::filesystem::is_symlink(folder / "x.comp"));
  CHECK(content_of(folder / "later") == "new x");
  std::filesystem::create_symlink("nowhere", folder / "a");
  std::filesystem::create_symlink("nowhere", folder / "b");
  const auto twice = must_fail(write_together({{folder / "a", "1"}, {folder / "b", "2"}}));
  CHECK(contains(twice.message, "leads to the same file; no file was changed"));
  CHECK_FALSE(std::filesystem::exists(folder / "nowhere"));
}

TEST_CASE("a link and the file it leads to are one file, whichever comes first") {
  const Folder folder;
  (void)folder.with("real", "old");
  std::filesystem::create_symlink("real", folder / "link");
  CHECK_FALSE(write_together({{folder / "real", "1"}, {folder / "link", "2"}}));
  CHECK_FALSE(write_together({{folder / "link", "1"}, {folder / "./real", "2"}}));
  CHECK(content_of(folder / "real") == "old");
}

TEST_CASE("in a folder that may not be written, nothing is changed") {
  const Folder folder;
  (void)folder.with("x.comp", "old x");
  ::chmod((folder / "").c_str(), 0555);
  const OrdinaryUser user;
  CHECK(must_fail(write_together(three(folder))).message == "cannot write: Permission denied; no file was changed");
  CHECK(content_of(folder / "x.comp") == "old x");
}

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
