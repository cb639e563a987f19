// What a file does not say, asked field by field: the options of `laser import`.
#include "tests/screens/support/laser_screen.hpp"

namespace ecs::app {
namespace {

std::size_t field_named(const std::string& name) {
  const auto& fields = answer_fields();
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.name == name; });
  REQUIRE(found != fields.end());
  return static_cast<std::size_t>(found - fields.begin());
}

TEST_CASE("every answer is kept as it was given") {
  ImportArguments answers;
  for (const commissioning::AnswerField& field : answer_fields()) {
    const std::string value = !field.choices.empty()                                   ? field.choices.back()
                              : field.kind == commissioning::AnswerField::Kind::number ? "3"
                                                                                       : "some";
    set_answer(answers, field.name, value);
    CHECK_MESSAGE(given_answers(answers).at(field.name) == value, field.name);
  }
  CHECK(answers.channels == "some");
  CHECK(answers.environment == "some");
  CHECK(answers.at_rest_mm == 3.0);
  CHECK(answers.average);
}

TEST_CASE("the form asks for the channels of a log and its environment, and refuses what is no number") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("log.txt", "nothing that is known\n")});
  driver.type("\n");
  driver.press(Key::Name::down, static_cast<int>(field_named("at-rest")));
  driver.type("still\n");
  CHECK(contains(driver.seen(), "at-rest: expected a number, found \"still\""));
  CHECK(contains(driver.seen(), "channels"));
  driver.press(Key::Name::backspace, 5);
  driver.type("0.01\n");
  REQUIRE(driver.settled());
  CHECK(driver.controller().choices().files.front().answers.at_rest_mm == 0.01);
}

TEST_CASE("the extent of a line is shown in whole millimetres at least") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("x.csv",
                                 "axis,sense,x_mm,y_mm,z_mm,reading\nX,EX,-3712.53,0,0,0\nX,EX,-2000.5,0,0,1\n"
                                 "X,EX,-157.25,0,0,1\n")});
  driver.type("2");
  CHECK(contains(driver.seen(), "-3713..-157"));
}

}  // namespace
}  // namespace ecs::app
