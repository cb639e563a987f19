// Text: cutting, numbers, the word that was probably meant, sentences in lines, and what a terminal may see.
#include "base/text.hpp"

#include <chrono>
#include <clocale>
#include <limits>

#include <rapidcheck.h>

#include "base/json.hpp"
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

TEST_CASE("whole numbers are decimal or hexadecimal, of 32 bits") {
  CHECK(whole_number("4096", "length") == 4096U);
  CHECK(whole_number(" 0x1000 ", "length") == 4096U);
  CHECK(whole_number("0XfF", "length") == 255U);
  CHECK(whole_number("4294967295", "length") == 4294967295U);
}

TEST_CASE("anything else is a usage problem that names the value and its text") {
  for (const char* text : {"", "0x", "-1", "1.5", "4294967296", "0x100000000", "12 34", "ten"}) {
    const auto number = must_fail(whole_number(text, "length"));
    CHECK(number.kind == ProblemKind::usage);
    CHECK(number.message ==
          "length: expected a whole number such as 4096 or 0x1000, got \"" + std::string(text) + "\"");
  }
}

TEST_CASE("a cell has three decimals, or a dash where there is no value") {
  CHECK(cell_text(1.23456) == "1.235");
  CHECK(cell_text(std::nullopt) == "-");
}

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

TEST_CASE("letters of every language, tabs and line ends stay") {
  for (const char* text : {"plain", "Müller & Söhne, 5 µm\tΔ\n", "工作機械", "\xF0\x9F\x94\xA7"})
    CHECK(shown(text) == text);
}

TEST_CASE("control characters of a terminal become question marks") {
  CHECK(shown("a\x1B[2Jb") == "a?[2Jb");
  CHECK(shown("\x07\x08\r\x7F") == "????");
  CHECK(shown("\xC2\x9B"
              "31m") == "?31m");                    // CSI as one character
  CHECK(shown("map\xE2\x80\xAEvsc") == "map?vsc");  // right-to-left override
  CHECK(shown(std::string_view("a\0b", 3)) == "a?b");
}

TEST_CASE("bytes that are no UTF-8 become question marks, one each") {
  CHECK(shown("\xFF") == "?");
  CHECK(shown("\xC0\x9B") == "??");  // overlong escape
  CHECK(shown("\xE0\x80\x9B") == "???");
  CHECK(shown("\xED\xA0\x80") == "???");       // surrogate
  CHECK(shown("\xF4\x90\x80\x80") == "????");  // above U+10FFFF
  CHECK(shown("ab\xC3") == "ab?");
}

TEST_CASE("JSON on a terminal holds no control character, and means the same") {
  const std::string name = "a\x1B[2J\x7F\xC2\x9B\xE2\x80\xAEµ\n";
  const std::string line = one_line(Json(name));
  CHECK(line == "\"a\\u001b[2J\\u007f\\u009b\\u202eµ\\n\"");
  CHECK(Json::parse(line).get<std::string>() == name);
}

TEST_CASE("a line that is too long is cut between characters, and says so") {
  CHECK(cut_line("short", 5) == "short");
  CHECK(cut_line("aµb", 2) == "a… (cut: 4 bytes)");
  CHECK(cut_line(std::string(3'000'000, 'N'), 4).size() < 40);
}

TEST_CASE("whatever the bytes, what is shown holds no control character and stays as it is when shown again") {
  CHECK(rc::check([](const std::string& bytes) {
    const std::string once = shown(bytes);
    for (const char c : once) {
      const auto byte = static_cast<unsigned char>(c);
      RC_ASSERT(byte >= 0x20 || c == '\n' || c == '\t');
      RC_ASSERT(byte != 0x7F);
    }
    RC_ASSERT(shown(once) == once);
    // what is left is UTF-8: strict JSON takes it
    RC_ASSERT(Json(once).dump().size() >= 2);
  }));
}
