// Problems: where, what, and all of them at once.
#include "base/result.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("a problem shows file, line and column as far as they are known") {
  CHECK(to_text({ProblemKind::bad_input, "expected a number", "x.csv", 41, 7, {}}) == "x.csv:41:7: expected a number");
  CHECK(to_text({ProblemKind::bad_input, "cut short", "x.csv", 41, 0, {}}) == "x.csv:41: cut short");
  CHECK(to_text({ProblemKind::bad_input, "no such file", "x.csv", 0, 0, {}}) == "x.csv: no such file");
  CHECK(to_text({ProblemKind::link, "no reply", "", 0, 0, {}}) == "no reply");
}

TEST_CASE("several problems are one, in their order, a line each") {
  const Problem one = folded({{ProblemKind::bad_input, "first", "f", 1, 0, {}},
                              {ProblemKind::usage, "second", "f", 2, 0, {}},
                              {ProblemKind::bad_input, "third", "f", 3, 0, {}}});
  CHECK(one.kind == ProblemKind::bad_input);
  CHECK(one.also.size() == 2);
  CHECK(to_text(one) == "f:1: first\nf:2: second\nf:3: third");
}

TEST_CASE("of very many problems the first are kept and the rest counted") {
  std::vector<Problem> problems;
  for (int line = 1; line <= 1000; ++line) problems.push_back({ProblemKind::bad_input, "wrong", "f", line, 0, {}});
  const Problem one = folded(std::move(problems));
  CHECK(one.also.size() == 200);
  CHECK(to_text(one.also.back()) == "f: 800 more problems of this file are not shown");
}

TEST_CASE("a problem that is found twice is said once") {
  const Problem wrong{ProblemKind::bad_input, "wrong", "f", 1, 0, {}},
      other{ProblemKind::bad_input, "other", "f", 1, 0, {}};
  CHECK(to_text(folded({wrong, other, wrong, other})) == "f:1: wrong\nf:1: other");
}

TEST_CASE("folding keeps problems that are folded already") {
  const Problem inner =
      folded({{ProblemKind::bad_input, "a", "", 0, 0, {}}, {ProblemKind::bad_input, "b", "", 0, 0, {}}});
  CHECK(to_text(folded({inner, {ProblemKind::bad_input, "c", "", 0, 0, {}}})) == "a\nb\nc");
}

TEST_CASE("a result is a value or a problem") {
  const Result<int> good = 5;
  const Result<int> bad = problem(ProblemKind::refused, "not square");
  const Result<int> placed = problem_at("m.toml", 3, 4, "unknown key");
  CHECK(*good == 5);
  CHECK(bad.error().kind == ProblemKind::refused);
  CHECK(to_text(placed.error()) == "m.toml:3:4: unknown key");
}
