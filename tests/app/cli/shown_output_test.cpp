// What reaches the terminal holds no control characters.
#include <sstream>

#include "app/cli/console.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {
namespace {

TEST_CASE("results, notes, warnings and problems are printed without control characters") {
  std::ostringstream out, messages;
  Console console(out, messages);
  console.answer("name \x1B]0;owned\x07", "");
  console.print("\x1B[31m");
  console.note("\x1B[1m");
  console.warn("\xFF");
  console.show({ProblemKind::link, "\x9B", "file\x1B", 1, 2, {}});
  CHECK((out.str() + messages.str()).find_first_of("\x1B\x07\xFF\x9B") == std::string::npos);
}

TEST_CASE("a line of a message with a name of megabytes in it is cut, and its length is told") {
  std::ostringstream out, messages;
  Console console(out, messages);
  console.show({ProblemKind::refused, "machine " + std::string(3'000'000, 'N') + "\nsecond line", {}, 0, 0, {}});
  CHECK(messages.str().size() < 5'000);
  CHECK(contains(messages.str(), "(cut: 3000008 bytes)\nsecond line\n"));
}

}  // namespace
}  // namespace ecs::app
