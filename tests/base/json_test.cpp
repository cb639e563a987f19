// JSON of answers: unknown values are null, problems keep their place.
#include "base/json.hpp"

#include <limits>

#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("a number that is not finite is null") {
  CHECK(number_or_null(1.5) == 1.5);
  CHECK(number_or_null(std::numeric_limits<double>::quiet_NaN()).is_null());
  CHECK(number_or_null(std::numeric_limits<double>::infinity()).is_null());
  CHECK(number_or_null(std::optional<double>{}).is_null());
  CHECK(number_or_null(std::optional<double>{2.0}) == 2.0);
}

TEST_CASE("an empty text is null") {
  CHECK(text_or_null("").is_null());
  CHECK(text_or_null("a") == "a");
}

TEST_CASE("a problem gives message and place, null where there is none, and the problems beside it") {
  Problem problem{ProblemKind::bad_input, "expected 1", "a.csv", 4, 0, {}};
  problem.also.push_back({ProblemKind::bad_input, "expected 2", "a.csv", 5, 6, {}});
  const Json json = problem_json(problem);
  CHECK(json["message"] == "expected 1");
  CHECK(json["file"] == "a.csv");
  CHECK(json["line"] == 4);
  CHECK(json["column"].is_null());
  CHECK(json["also"][0]["column"] == 6);
  CHECK_FALSE(only(json["also"]).contains("also"));
}

TEST_CASE("one line of JSON keeps the order of its keys and replaces bytes that are not UTF-8") {
  Json json;
  json["z"] = 1;
  json["a"] = "x\xFFy";
  CHECK(one_line(json) == "{\"z\":1,\"a\":\"x\xEF\xBF\xBDy\"}");
}

TEST_CASE("JSON of a file that is deeper than any of ECS is none, whatever its size") {
  CHECK(json_in(std::string(40'000'000, '[')).is_discarded());
  CHECK(json_in("{\"a\":" + std::string(101, '[') + std::string(101, ']') + "}").is_discarded());
  CHECK(json_in("{\"a\":\"" + std::string(200, '[') + "\\\"[\"}").is_object());
  CHECK(json_in("[[1],[2]]").is_array());
  CHECK(json_in("{").is_discarded());
}

TEST_CASE("addresses have six hexadecimal digits") {
  CHECK(hex_address(0x10) == "0x000010");
  CHECK(hex_address(0x100000) == "0x100000");
}
