// Text: cutting, numbers, and the word that was probably meant.
#include "base/text.hpp"

#include <chrono>
#include <clocale>
#include <limits>

#include <rapidcheck.h>

#include "tests/support/test.hpp"

using namespace ecs;
using Fields = std::vector<std::string_view>;

TEST_CASE("trimming takes blanks, tabs and line ends from both ends only") {
  CHECK(trimmed(" \t a b \r\n") == "a b");
  CHECK(trimmed("") == "");
  CHECK(trimmed(" \n ") == "");
  const std::string_view blanks = " \t ";
  CHECK(trimmed(blanks).data() == blanks.data());
}

TEST_CASE("lower case is that of ASCII, other bytes stay") { CHECK(lower("ECX Ü_9") == "ecx Ü_9"); }

TEST_CASE("splitting keeps empty fields") {
  CHECK(split("a,,b", ',') == Fields{"a", "", "b"});
  CHECK(split("", ',') == Fields{""});
  CHECK(split(",", ',') == Fields{"", ""});
}

TEST_CASE("splitting and joining give the text back") {
  CHECK(rc::check([](const std::string& text) {
    std::string joined;
    const auto fields = split(text, ';');
    for (std::size_t i = 0; i < fields.size(); ++i) joined += (i > 0 ? ";" : "") + std::string(fields[i]);
    RC_ASSERT(joined == text);
  }));
}

TEST_CASE("LF, CRLF and CR end lines, the last line needs no end") {
  CHECK(lines_of("a\nb\r\nc\rd") == Fields{"a", "b", "c", "d"});
  CHECK(lines_of("a\n\nb\n") == Fields{"a", "", "b"});
  CHECK(lines_of("").empty());
  CHECK(lines_of("\n") == Fields{""});
}

TEST_CASE("a number is the whole text, finite and decimal") {
  CHECK(number_in(" -38.8 ") == -38.8);
  CHECK(number_in("+1e-3") == 0.001);
  CHECK(number_in(".5") == 0.5);
  for (const char* wrong :
       {"", " ", "+", "-", "1,5", "1 2", "0x10", "nan", "inf", "-inf", "1e400", "+-1", "++1", "12mm"})
    CHECK_MESSAGE(!number_in(wrong), wrong);
}

TEST_CASE("an assignment in a formula is distinguished from comparisons") {
  for (const char* formula : {"a=5", "a = 5", "a += 1", "sin(a=1)", "a==b=c", "=", "a="})
    CHECK_MESSAGE(assigns(formula), formula);
  for (const char* formula : {"", "a", "a == b", "a<=b", "a >= b", "a!=b", "a == b ? c != d : e <= f"})
    CHECK_MESSAGE(!assigns(formula), formula);
}

TEST_CASE("numbers do not depend on the locale") {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) MESSAGE("de_DE is not installed: tested in " << before);
  CHECK(number_in("1.5") == 1.5);
  CHECK(shortest(1.5) == "1.5");
  std::setlocale(LC_ALL, before.c_str());
}

TEST_CASE("an integer is the whole text and fits") {
  CHECK(integer_in(" +42 ") == 42);
  CHECK(integer_in("-9223372036854775808") == std::numeric_limits<long long>::min());
  for (const char* wrong : {"", "1.0", "9223372036854775808", "0x1", "1e3", "five"})
    CHECK_MESSAGE(!integer_in(wrong), wrong);
}

TEST_CASE("the shortest decimal is short and reads back as the same number") {
  CHECK(shortest(0.1) == "0.1");
  CHECK(shortest(-38.8) == "-38.8");
  CHECK(shortest(1e-7) == "1e-07");
  CHECK(shortest(100.0) == "100");
  CHECK(rc::check([](double value) {
    RC_PRE(std::isfinite(value));
    RC_ASSERT(number_in(shortest(value)) == value);
  }));
}

TEST_CASE("the nearest word is a likely typing error, or there is none") {
  const std::vector<std::string> words{"deadband_um", "loop_period_us", "scope"};
  CHECK(nearest_word("deadban_um", words) == "deadband_um");
  CHECK(nearest_word("Scope", words) == "scope");
  CHECK(nearest_word("scoop", words) == "");  // two of five letters
  CHECK(nearest_word("interpolation", words) == "");
  CHECK(nearest_word("scope", {}) == "");
}

TEST_CASE("a word of three million characters is compared with none that is shorter by far") {
  const auto begun = std::chrono::steady_clock::now();
  CHECK(nearest_word(std::string(3'000'000, 'x'), std::vector<std::string>(200, "axis.X.deadband_um")).empty());
  CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(1));
}
