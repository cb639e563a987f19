// Records of answers: text and JSON from the same fields.
#include "base/answer_table.hpp"

#include <limits>

#include "tests/support/test.hpp"

namespace ecs {
namespace {

Cell stop_cell(const std::string& axis, const std::optional<double>& error_um, bool referenced) {
  return record_cell("{error:>8}  {axis:<4} {letters}\n", "axis"_is(axis), "error"_is(error_um, 2),
                     "referenced"_is(referenced, "yes", "no"), "letters"_shown(std::to_string(axis.size())));
}

Cell two_stops() {
  Cell list{Json::array(), "   error  axis letters\n"};
  list.add(stop_cell("X", 1.234, true));
  list.add(stop_cell("Y", {}, false));
  return list;
}

}  // namespace

TEST_CASE("a record's text follows its layout, with a dash where there is no number") {
  CHECK(two_stops().text ==
        "   error  axis letters\n"
        "    1.23  X    1\n"
        "       -  Y    1\n");
}

TEST_CASE("a record's JSON has the keys in the order of its fields, null for no number, and nothing only shown") {
  CHECK(one_line(two_stops().json) ==
        R"([{"axis":"X","error":1.234,"referenced":true},{"axis":"Y","error":null,"referenced":false}])");
}

TEST_CASE("a number that rounds to zero has no sign") {
  CHECK(number_cell(-1e-17, 2).text == "0.00");
  CHECK(number_cell(-0.0051, 2).text == "-0.01");
}

TEST_CASE("a number that is not finite is null in JSON") {
  CHECK(one_line(stop_cell("X", std::numeric_limits<double>::quiet_NaN(), false).json["error"]) == "null");
}

TEST_CASE("a field without a key gives the keys of its object to the record") {
  const Cell place = record_cell("", "axis"_is("X"), "sense"_is("EX"));
  CHECK(one_line(object_of(inlined(place), "rms_um"_is(0.5, 3))) == R"({"axis":"X","sense":"EX","rms_um":0.5})");
}

TEST_CASE("fields that are appended keep their order") {
  AnswerFields fields = described("axis"_is("X"));
  append(fields, "sense"_is("EX"), "runs"_is(5));
  CHECK(one_line(object_of(fields)) == R"({"axis":"X","sense":"EX","runs":5})");
}

TEST_CASE("a file that was written is named, one that was not is null") {
  CHECK(written_cell("map", "m.csv", "nothing written\n").text == "map written to m.csv\n");
  CHECK(written_cell("map", "m.csv").json == "m.csv");
  CHECK(written_cell("map", "", "nothing written\n").text == "nothing written\n");
  CHECK(written_cell("map", "").json.is_null());
}

TEST_CASE("paragraphs are a list in JSON; in the text long ones go on below the end of their beginning") {
  const std::string word(40, 'a');
  const Cell cell = paragraphs_cell({word + " " + word, "short"}, "note: ");
  CHECK(cell.json.size() == 2);
  CHECK(cell.text == "note: " + word + "\n      " + word + "\nnote: short\n");
}

TEST_CASE("the outcome of a finished write says so") {
  CHECK(finished_outcome_of(cell_of("sent")).finished);
  CHECK_FALSE(outcome_of(cell_of("sent")).finished);
}

}  // namespace ecs
