// Sentences in lines of 80 columns.
#include "base/text.hpp"
#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("a line is as full as 80 columns allow, and never fuller") {
  const std::string word(19, 'a');
  CHECK(paragraph(word + " " + word + " " + word + " " + word + " b") ==
        word + " " + word + " " + word + " " + word + "\nb\n");
  CHECK(paragraph(std::string(80, 'a') + " b") == std::string(80, 'a') + "\nb\n");
}

TEST_CASE("the first line and the others have indents of their own") {
  const std::string word(50, 'a');
  CHECK(paragraph(word + " " + word, 2, 4) == "  " + word + "\n    " + word + "\n");
  CHECK(paragraph_after("name  ", word + " " + word) == "name  " + word + "\n      " + word + "\n");
  CHECK(paragraph_after("name", "") == "name\n");
}

TEST_CASE("a word longer than a line stays in one piece") {
  const std::string word(100, 'a');
  CHECK(paragraph("b " + word + " c") == "b\n" + word + "\nc\n");
}

TEST_CASE("columns count characters, not bytes") {
  CHECK(columns_of("\xC2\xB5m") == 2);
  CHECK(padded("\xC2\xB5m", 4) == "\xC2\xB5m  ");
  CHECK(padded("long", 2) == "long");
}
