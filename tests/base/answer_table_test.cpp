// Tables of answers: text and JSON from the same columns.
#include "base/answer_table.hpp"

#include <limits>

#include <doctest/doctest.h>

namespace ecs {
namespace {

struct Stop {
  std::string axis;
  std::optional<double> error_um;
  bool referenced = false;
};

const AnswerTable<Stop>& stops() {
  static const AnswerTable<Stop> table(
      "{error:>8}  {axis:<4} {letters}",
      {{"axis", "axis", [](const Stop& s) { return word_cell(s.axis); }},
       {"error", "error", [](const Stop& s) { return number_cell(s.error_um, 2); }},
       {"referenced", "", [](const Stop& s) { return yes_cell(s.referenced, "yes", "no"); }},
       {"letters", "letters", [](const Stop& s) { return shown_cell(std::to_string(s.axis.size())); }}});
  return table;
}

}  // namespace

TEST_CASE("a table's text follows its layout, with a dash where there is no number") {
  CHECK(stops().text(std::vector<Stop>{{"X", 1.234, true}, {"Y", {}, false}}) ==
        "   error  axis letters\n"
        "    1.23  X    1\n"
        "       -  Y    1\n");
}

TEST_CASE(
    "a table's JSON has the keys in the order of the columns, null for no number, and nothing that is only shown") {
  CHECK(one_line(stops().array(std::vector<Stop>{{"X", 1.234, true}, {"Y", {}, false}})) ==
        R"([{"axis":"X","error":1.234,"referenced":true},{"axis":"Y","error":null,"referenced":false}])");
  CHECK(one_line(stops().array(std::vector<Stop>{})) == "[]");
}

TEST_CASE("a number that is not finite is null in JSON") {
  CHECK(one_line(stops().object({"X", std::numeric_limits<double>::quiet_NaN(), false})["error"]) == "null");
}

}  // namespace ecs
