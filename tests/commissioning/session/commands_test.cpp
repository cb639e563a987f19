// What the screens did, as commands and as a script; words as a shell takes them.
#include "commissioning/session/commands.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/command_output.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

/// Each case begins with none and leaves none.
struct NoCommands {
  NoCommands() { forget_commands(); }
  ~NoCommands() { forget_commands(); }
  NoCommands(const NoCommands&) = delete;
  NoCommands& operator=(const NoCommands&) = delete;
};

std::string last_text() { return command_text(noted_commands().back()); }

TEST_CASE("words are quoted as a shell needs it") {
  const NoCommands none;
  note_command({"params", "set", "my mill.toml", "identity.machine=it's \"big\" $HOME `x` \\", "-o", "new.toml"});
  CHECK(last_text() == "ecs params set 'my mill.toml' 'identity.machine=it'\\''s \"big\" $HOME `x` \\' -o new.toml");
  note_command({"model", "add", "", "*"});
  CHECK(last_text() == "ecs model add '' '*'");
  note_remark("two\nlines");
  CHECK(last_text() == "# two\n# lines");
}

TEST_CASE("a shell takes every word as it was") {
  const NoCommands none;
  const Folder folder;
  std::string all;
  for (int c = 1; c < 256; ++c) all += static_cast<char>(c);
  NotedCommand command;
  command.words = {"printf", "%s", all};
  note(command);
  std::ofstream(folder.path / "script.sh", std::ios::binary) << script_of(noted_commands());
  REQUIRE(std::system(("cd " + folder.path.string() + " && sh script.sh > out").c_str()) == 0);
  std::ifstream out(folder.path / "out", std::ios::binary);
  CHECK(std::string(std::istreambuf_iterator<char>(out), {}) == all);
}

TEST_CASE("an arming code is never kept") {
  const NoCommands none;
  note_command({"unit", "arm", "--code", "271828", "--minutes", "10"});
  CHECK(last_text() == "ecs unit arm --minutes 10");
  note_command({"params", "send", "p.toml", "--arm-code", "271828"});
  CHECK(last_text() == "ecs params send p.toml");
  note_command({"params", "send", "p.toml", "--arm-code=271828"});
  CHECK(last_text() == "ecs params send p.toml");
  note_command({"model", "add", "m.toml", "angular", "--code", "ECX"});
  CHECK(last_text() == "ecs model add m.toml angular --code ECX");
}

TEST_CASE("a file written twice is overwritten the second time, unless the command reads it itself") {
  const NoCommands none;
  note_command({"memory", "dump", "-o", "unit.ecsdump"});
  CHECK(last_text() == "ecs memory dump -o unit.ecsdump");
  note_command({"memory", "dump", "-o", "unit.ecsdump"});
  CHECK(last_text() == "ecs memory dump -o unit.ecsdump --force");
  note_command({"params", "set", "p.toml", "a=1", "-o", "p.toml"});
  note_command({"params", "set", "p.toml", "a=2", "-o", "p.toml"});
  CHECK(last_text() == "ecs params set p.toml a=2 -o p.toml");
}

TEST_CASE("link and workshop of a script come from its environment, else they are those of the screens") {
  const NoCommands none;
  note_command({"params", "send", "p.toml", "--link", "tcp:a}b$c:502"});
  note_workshop("/tmp/shop", {"reference"});
  note_command({"monitor", "--link", "tcp:other:502"});
  const std::string script = script_of(noted_commands());
  check_holds(script, {": \"${LINK:=tcp:a\\}b\\$c:502}\"", "ecs params send p.toml --link \"$LINK\"\n",
                       "ecs-emulator workshop \"$WORKSHOP\" reference\n", "ecs monitor --link tcp:other:502\n"});
}

TEST_CASE("a script ends with the first command that fails, takes a comparison as it was, and overwrites no file") {
  const NoCommands none;
  const Folder folder;
  std::filesystem::create_directories(folder.path / "bin");
  std::ofstream(folder.path / "bin/ecs") << "#!/bin/sh\necho \"$*\" >> ../said\nexit ${2:-0}\n";
  std::filesystem::permissions(folder.path / "bin/ecs", std::filesystem::perms::owner_all);
  const auto run = [&] {
    std::ofstream(folder.path / "script.sh") << script_of(noted_commands());
    return std::system(("rm -rf " + folder.path.string() + "/run; cd " + folder.path.string() +
                        " && mkdir run && cd run && PATH=../bin:$PATH LINK= sh ../script.sh 2> ../errors")
                           .c_str());
  };
  note_file("out/recipe.toml", "first\nEND\n'$x'\n");
  note_command({"verify", "1"}, 1);
  note_file("out/recipe.toml", "second");
  note_command({"last"});
  CHECK(run() == 0);
  std::ifstream recipe(folder.path / "run/out/recipe.toml");
  CHECK(std::string(std::istreambuf_iterator<char>(recipe), {}) == "second\n");
  std::ifstream said(folder.path / "said");
  CHECK(std::string(std::istreambuf_iterator<char>(said), {}) == "verify 1\nlast\n");
  note_command({"fails", "3"});
  note_command({"never"});
  CHECK(run() != 0);
  std::ifstream then(folder.path / "said");
  CHECK(std::string(std::istreambuf_iterator<char>(then), {}).ends_with("fails 3\n"));
}

TEST_CASE("a copy overwrites no file either") {
  const NoCommands none;
  const Folder folder;
  const std::string from = folder.with("from", "new"), to = folder / "out/to";
  NotedCommand copy;
  copy.words = {"cp", "from", "out/to"};
  note(copy);
  std::ofstream(folder.path / "script.sh") << script_of(noted_commands());
  const std::string run = "cd " + folder.path.string() + " && sh script.sh 2> errors";
  REQUIRE(std::system(run.c_str()) == 0);
  CHECK(content_of(to) == "new");
  folder.with("from", "newer");
  CHECK(std::system(run.c_str()) != 0);
  CHECK(content_of(to) == "new");
}

TEST_CASE("paths below the working folder are named from there") {
  const std::string here = std::filesystem::current_path().string();
  CHECK(path_word(here + "/a/../b c.csv") == "b c.csv");
  CHECK(path_word("x/y.csv") == "x/y.csv");
  CHECK(path_word("/tmp/x.csv") == "/tmp/x.csv");
  CHECK(path_word(here + "x/y.csv") == here + "x/y.csv");
  CHECK(path_word("") == "");
}

TEST_CASE("a shell gives every word back as it was") {
  for (const std::string word :
       {"plain.csv", "a b", "it's", "$HOME `x` \"y\" \\ * ? ; & | < > ( ) ~ # !", "", "Maß.csv"})
    CHECK(output_of("printf %s " + shell_word(word)).text == word);
}

TEST_CASE("plain words stay unquoted, so that commands stay readable") {
  CHECK(shell_command({"ecs", "map", "send", "a/b-1.csv", "--link", "rtu:/dev/ttyUSB0:115200"}) ==
        "ecs map send a/b-1.csv --link rtu:/dev/ttyUSB0:115200");
  CHECK(shell_command({"ecs", "map", "show", "my map.csv"}) == "ecs map show 'my map.csv'");
}

}  // namespace
}  // namespace ecs::commissioning
