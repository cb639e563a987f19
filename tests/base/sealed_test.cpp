// A sealed text opens to what it was, and nothing else opens.
#include "base/sealed.hpp"

#include <rapidcheck.h>

#include "tests/support/test.hpp"

TEST_CASE("a sealed text cannot be read by accident and opens to what it was") {
  const std::string sealed = ecs::sealed(R"({"effects": ["cyclic:X:EX"]})", "open with: ecs model reveal");
  CHECK(sealed.starts_with("# open with: ecs model reveal\n"));
  CHECK(!ecs::contains(sealed, "cyclic"));
  CHECK(ecs::unsealed(sealed, "truth.sealed").value() == R"({"effects": ["cyclic:X:EX"]})");
}

TEST_CASE("any text comes back, whatever bytes it has") {
  CHECK(rc::check(
      [](const std::string& text) { RC_ASSERT(ecs::unsealed(ecs::sealed(text, "h"), "f").value() == text); }));
}

TEST_CASE("what is cut or changed is refused with the file and the reason") {
  const std::string whole = ecs::sealed(std::string(1000, 'a') + "b", "h");
  for (std::size_t length = 0; length + 4 < whole.size(); ++length)
    CHECK_FALSE(ecs::unsealed(whole.substr(0, length), "truth.sealed").has_value());
  std::string changed = whole;
  changed[whole.size() - 4] = changed[whole.size() - 4] == 'A' ? 'B' : 'A';
  const auto refused = ecs::must_fail(ecs::unsealed(changed, "truth.sealed"));
  CHECK(refused.file == "truth.sealed");
  CHECK(ecs::contains(refused.message, "copy the file again"));
}
