// Files: read whole, replaced whole, or a problem that says which file and why.
#include "base/file.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/folder.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
namespace fs = std::filesystem;

namespace {

std::size_t files_in(const Folder& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()));
}

/// An environment variable for the length of one test.
struct Variable {
  std::string name;
  std::string before;
  bool was_set;
  Variable(const char* variable, const char* value) : name(variable) {
    const char* old = std::getenv(variable);
    was_set = old != nullptr;
    if (was_set) before = old;
    if (value == nullptr)
      ::unsetenv(variable);
    else
      ::setenv(variable, value, 1);
  }
  ~Variable() {
    if (was_set)
      ::setenv(name.c_str(), before.c_str(), 1);
    else
      ::unsetenv(name.c_str());
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
};

}  // namespace

TEST_CASE("what is written is read, zero bytes and line ends included") {
  const Folder folder;
  const fs::path file = folder.path / "a.bin";
  for (const std::string& content : {std::string(), std::string("a\r\n\0b", 5), std::string(300'000, 'x')}) {
    REQUIRE(write_file(file, content));
    CHECK(*read_file(file) == content);
    CHECK(files_in(folder) == 1);
  }
}

TEST_CASE("a file is replaced, and readable by others as the mask of the user says") {
  const Folder folder;
  const fs::path file = folder.path / "a.txt";
  REQUIRE(write_file(file, "old and longer"));
  REQUIRE(write_file(file, "new"));
  CHECK(*read_file(file) == "new");
  std::ofstream(folder.path / "plain") << "x";
  CHECK(fs::status(file).permissions() == fs::status(folder.path / "plain").permissions());
}

TEST_CASE(
    "a program killed while it replaces a file leaves that file whole, and beside it none that the next write keeps") {
  const Folder folder;
  const int nameless = ::open(folder.path.c_str(), O_TMPFILE | O_WRONLY, 0600);
  SKIP_UNLESS(nameless >= 0, "this file system has no files without a name");
  ::close(nameless);
  constexpr std::size_t kBytes = 1 << 20;
  const fs::path file = folder.path / "a.bin";
  REQUIRE(write_file(file, std::string(kBytes, 'a')));
  for (int turn = 0; turn < 20; ++turn) {
    const pid_t writer = ::fork();
    if (writer == 0)
      for (char letter = 'a';; letter = letter == 'z' ? 'a' : static_cast<char>(letter + 1))
        if (!write_file(file, std::string(kBytes, letter))) ::_exit(1);
    ::usleep(static_cast<useconds_t>(1'000 + 700 * turn));
    REQUIRE(::kill(writer, SIGKILL) == 0);
    int status = 0;
    REQUIRE(::waitpid(writer, &status, 0) == writer);
    CHECK(WIFSIGNALED(status));
    CHECK(files_in(folder) <= 2);
    const std::string content = must(read_file(file));
    CHECK(content == std::string(kBytes, content.front()));
    REQUIRE(write_file(file, content));
    CHECK(files_in(folder) == 1);
  }
}

TEST_CASE(
    "what a killed program has left in the place of the new file is no obstacle, also where it cannot be removed") {
  const Folder folder;
  REQUIRE(write_file(folder.path / "a.txt", "old"));
  std::ofstream(folder.path / ".a.txt.ecs-new") << "left";
  REQUIRE(write_file(folder.path / "a.txt", "new"));
  CHECK(*read_file(folder.path / "a.txt") == "new");
  CHECK(files_in(folder) == 1);
  fs::create_directory(folder.path / ".a.txt.ecs-new");
  REQUIRE(write_file(folder.path / "a.txt", "newer"));
  CHECK(*read_file(folder.path / "a.txt") == "newer");
  CHECK(files_in(folder) == 2);
}

TEST_CASE("programs that write one file at once leave one of their contents, whole, and nothing beside it") {
  const Folder folder;
  constexpr std::size_t kBytes = 1 << 16;
  const fs::path file = folder.path / "a.bin";
  std::vector<pid_t> writers;
  for (const char letter : {'a', 'b', 'c'}) {
    writers.push_back(::fork());
    if (writers.back() != 0) continue;
    for (int i = 0; i < 40; ++i)
      if (!write_file(file, std::string(kBytes, letter))) ::_exit(1);
    ::_exit(0);
  }
  for (const pid_t writer : writers) {
    int status = 1;
    REQUIRE(::waitpid(writer, &status, 0) == writer);
    CHECK(status == 0);
  }
  const std::string content = must(read_file(file));
  CHECK(content == std::string(kBytes, content.front()));
  CHECK(files_in(folder) == 1);
}

TEST_CASE("a folder that does not exist cannot be written to") {
  const Folder folder;
  const auto written = must_fail(write_file(folder.path / "no" / "a.txt", "x"));
  CHECK(written.kind == ProblemKind::output);
  CHECK(written.file == (folder.path / "no" / "a.txt").string());
}

TEST_CASE("writing over a folder fails and leaves nothing beside it") {
  const Folder folder;
  fs::create_directories(folder.path / "d" / "inside");
  CHECK(must_fail(write_file(folder.path / "d", "x")).kind == ProblemKind::output);
  CHECK(files_in(folder) == 1);
  CHECK(fs::exists(folder.path / "d" / "inside"));
}

TEST_CASE("in a folder without write permission the old file stays unchanged") {
  const Folder folder;
  REQUIRE(write_file(folder.path / "a.txt", "old"));
  fs::permissions(folder.path, fs::perms(0555));
  const OrdinaryUser user;
  CHECK(!write_file(folder.path / "a.txt", "new"));
  CHECK(*read_file(folder.path / "a.txt") == "old");
}

TEST_CASE("a file system that cannot be written to is an output problem") {
  CHECK(must_fail(write_file("/proc/ecs_test", "x")).kind == ProblemKind::output);
}

TEST_CASE("a path that is not a file is a bad input with the file's name") {
  const Folder folder;
  const auto missing = must_fail(read_file(folder.path / "missing"));
  CHECK(missing.kind == ProblemKind::bad_input);
  CHECK(to_text(missing) == (folder.path / "missing").string() + ": no such file");
  CHECK(read_file(folder.path).error().message == "expected a file, found a directory");
  for (const char* name : {"b.csv", "a.csv", ".hidden"}) CHECK(write_file(folder.path / name, "1").has_value());
  CHECK(read_file(folder.path).error().message ==
        "expected a file, found a directory; it contains a.csv, b.csv: give a file, as in " +
            (folder.path / "a.csv").string());
}

TEST_CASE("a file above 256 MiB is not read, nor one that never ends") {
  const Folder folder;
  const fs::path file = folder.path / "huge";
  std::ofstream(file) << "x";
  fs::resize_file(file, (256ull << 20) + 1);  // sparse
  CHECK(read_file(file).error().message == "larger than 256 MiB: not read");
  CHECK(read_file("/dev/zero").error().message == "larger than 256 MiB: not read");
}

TEST_CASE("the digests are those of their standards") {
  // FIPS 180-4 example, and the check value of CRC-32/ISO-HDLC
  CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const std::string digits = "123456789";
  CHECK(crc32_of({reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()}) == 0xCBF43926);
}

TEST_CASE("the state folder follows ECS_STATE_DIR, then XDG_STATE_HOME, then HOME") {
  const Folder folder;
  const std::string root = folder.path.string();
  {
    const Variable own("ECS_STATE_DIR", (root + "/own").c_str());
    CHECK(*state_folder() == root + "/own");
    CHECK(fs::is_directory(root + "/own"));
  }
  const Variable own("ECS_STATE_DIR", nullptr);
  {
    const Variable xdg("XDG_STATE_HOME", (root + "/xdg").c_str());
    CHECK(*state_folder() == root + "/xdg/ecs");
  }
  const Variable xdg("XDG_STATE_HOME", nullptr);
  {
    const Variable home("HOME", root.c_str());
    CHECK(*state_folder() == root + "/.local/state/ecs");
  }
  const Variable home("HOME", nullptr);
  CHECK(state_folder().error().kind == ProblemKind::output);
}

TEST_CASE("a symbolic link stays a link, and the file behind it keeps its mode") {
  const Folder folder;
  REQUIRE(write_file(folder.path / "target.txt", "old"));
  std::filesystem::permissions(folder.path / "target.txt", std::filesystem::perms(0640));
  std::filesystem::create_symlink("target.txt", folder.path / "link.txt");
  REQUIRE(write_file(folder.path / "link.txt", "new"));
  CHECK(std::filesystem::is_symlink(folder.path / "link.txt"));
  CHECK(read_file(folder.path / "target.txt").value() == "new");
  CHECK(std::filesystem::status(folder.path / "target.txt").permissions() == std::filesystem::perms(0640));
}

TEST_CASE("a link to a file that is not there yet stays a link, and the file is made where it leads") {
  const Folder folder;
  fs::create_directory(folder.path / "deep");
  fs::create_symlink("deep/second", folder.path / "first");
  fs::create_symlink("target.txt", folder.path / "deep" / "second");
  CHECK(led_to(folder.path / "first") == fs::canonical(folder.path) / "deep" / "target.txt");
  REQUIRE(write_file(folder.path / "first", "new"));
  CHECK(fs::is_symlink(folder.path / "first"));
  CHECK(fs::is_symlink(folder.path / "deep" / "second"));
  CHECK(read_file(folder.path / "deep" / "target.txt").value() == "new");
  CHECK(led_to(folder.path / "first") == fs::canonical(folder.path) / "deep" / "target.txt");
  CHECK(led_to(folder.path / "plain") == folder.path / "plain");
}

TEST_CASE("a link into a missing folder, or a ring of links, is an output problem") {
  const Folder folder;
  fs::create_symlink("none/target.txt", folder.path / "link");
  CHECK(!write_file(folder.path / "link", "new"));
  CHECK(fs::is_symlink(folder.path / "link"));
  fs::create_symlink("b", folder.path / "a");
  fs::create_symlink("a", folder.path / "b");
  CHECK(led_to(folder.path / "a") == folder.path / "a");
}

TEST_CASE("a FIFO is written into, not replaced") {
  const Folder folder;
  const auto fifo = folder.path / "fifo";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  const int reader = ::open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(write_file(fifo, "through"));
  char text[16] = {};
  CHECK(::read(reader, text, sizeof text) == 7);
  ::close(reader);
  CHECK(std::filesystem::is_fifo(fifo));
}

TEST_CASE("a serial line given as a file is refused; it is not waited for") {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(master >= 0);
  REQUIRE(::grantpt(master) == 0);
  REQUIRE(::unlockpt(master) == 0);
  CHECK(contains(to_text(must_fail(read_file(::ptsname(master)))), "expected a file, found a serial line or terminal"));
  ::close(master);
}

TEST_CASE("would_overwrite() spares nothing but regular files with content that are not one's own") {
  const Folder folder;
  const std::string file = folder.with("a.csv", "x");
  CHECK(would_overwrite(file));
  CHECK_FALSE(would_overwrite(file, {file}));
  CHECK_FALSE(would_overwrite(folder.with("empty.csv", "")));
  CHECK_FALSE(would_overwrite((folder.path / "none.csv").string()));
  CHECK_FALSE(would_overwrite("/dev/null"));
  CHECK_FALSE(would_overwrite(folder.path.string()));
}
