// Words as a shell takes them.
#include "commissioning/session/commands.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::commissioning;

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
