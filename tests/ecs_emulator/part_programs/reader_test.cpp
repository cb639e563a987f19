#include "ecs_emulator/part_programs/reader.hpp"

#include <fmt/format.h>
#include <rapidcheck.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "ecs_emulator/part_programs/interpreter.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

const ProgramRange kRange{std::array{-500.0, 25.0}, std::array{-400.0, 25.0}, std::array{-300.0, 25.0}};

std::vector<ProgramStep> steps_of(const std::string& text) {
  const auto program = must(parse_program(text, "p.nc"));
  std::vector<ProgramStep> steps;
  ProgramInterpreter blocks(program, {0.0, 0.0, 0.0}, kRange,
                            [](int line, const std::string& message) { FAIL(line << ": " << message); });
  while (auto step = blocks.next()) steps.push_back(*step);
  return steps;
}

/// Everything that is wrong with a program, as text; empty: nothing.
std::string wrong_with(const std::string& text) {
  const auto program = parse_program(text, "p.nc");
  if (!program) return to_text(program.error());
  const auto summary = checked_program(*program, {0.0, 0.0, 0.0}, kRange);
  return summary ? "" : to_text(summary.error());
}

}  // namespace

TEST_CASE("CRLF, lower case, tabs, a byte order mark, blanks in words and comments change nothing") {
  const auto plain = steps_of("G90G01X-10.5F200\nM08\n");
  for (const char* other :
       {"\xef\xbb\xbf%\r\n> g90 g01\tx-10.5f200 ;there\r\nm8\r\n%\r\n",
        "N10 (to the mark) G90 G1 X -10.5 F+200.\rN20M08", ">G90G01X-10.50(;)F200\n\n;nothing\n>M08"}) {
    const auto steps = steps_of(other);
    REQUIRE(steps.size() == plain.size());
    CHECK(steps[0].motion->to_mm == plain[0].motion->to_mm);
    CHECK(steps[0].motion->feed_mm_min == 200.0);
    CHECK(steps[1].trigger == ProgramTrigger::reading);
  }
}

TEST_CASE("loops in loops run as often as their numbers multiply") {
  const auto steps = steps_of("G00\n$REP 3\n$REP 4\nX-1G91\n$END\nX4\n$END\nX-2");
  CHECK(steps.size() == 1 + 3 * 5 + 1);
  CHECK(steps.back().motion->to_mm[0] == -2.0);
}

TEST_CASE("G91 holds for its own block at any place in it, and until G90") {
  const auto steps = steps_of("G00X-5\nX-50.0G91\nX-50.0\nX-7G90");
  CHECK(steps[1].motion->to_mm[0] == -55.0);
  CHECK(steps[2].motion->to_mm[0] == -105.0);
  CHECK(steps[3].motion->to_mm[0] == -7.0);
}

TEST_CASE("incremental steps add up to what a hand would write") {
  const auto steps = steps_of("G01F100\n$REP 1000\nX-0.1G91\n$END");
  CHECK(steps[3].motion->to_mm[0] == -0.3);
  CHECK(steps.back().motion->to_mm[0] == -100.0);
}

TEST_CASE("after a rapid, a block with a coordinate and a feed moves at that feed, and so do those that follow") {
  const auto steps = steps_of("G00X5\nX0F2000\nX-10\nG00X5\nF100\nX4");
  CHECK(steps[0].motion->feed_mm_min == 0.0);
  CHECK(steps[0].exact_stop);
  CHECK(steps[1].motion->feed_mm_min == 2000.0);
  CHECK(!steps[1].exact_stop);
  CHECK(steps[2].motion->feed_mm_min == 2000.0);
  CHECK(steps[5].motion->feed_mm_min == 0.0);  // a feed alone starts no feed motion
}

TEST_CASE("a second M08 without M09 is a missed trigger") {
  const auto program = must(parse_program("M08\nM08\nM09\nM08\n", "p.nc"));
  const auto summary = must(checked_program(program, {}, kRange));
  CHECK(summary.readings == 2);
  CHECK(summary.missed_lines == std::vector<int>{2});
}

TEST_CASE("M30 ends the program inside a loop too") { CHECK(steps_of("$REP 5\nM08\nM30\n$END\nM09").size() == 2); }

TEST_CASE("G04 takes its seconds from H, P or X") {
  for (const char* text : {"G04H2.5", "G04P2.5", "X2.5G04", "g4 x2.5"}) CHECK(steps_of(text)[0].dwell_s == 2.5);
}

TEST_CASE("a centre and a radius make the same arc, the negative radius the longer way round") {
  const auto centre = must(steps_of("G17G02X-20Y-20I0J-20F100")[0].motion->arc);
  const auto radius = must(steps_of("G17G02X-20Y-20R-20F100")[0].motion->arc);
  CHECK(radius.centre_mm[0] == Approx(centre.centre_mm[0]).epsilon(1e-12));
  CHECK(radius.centre_mm[1] == Approx(centre.centre_mm[1]));
  const auto shorter = steps_of("G17G02X-20Y-20R20F100")[0].motion->arc;
  CHECK(shorter->centre_mm[0] == Approx(-20.0));
  CHECK(shorter->centre_mm[1] == Approx(0.0));
}

TEST_CASE("planes turn as ISO 6983 says: G02 clockwise seen from the positive end of the third axis") {
  // From the origin a quarter circle, clockwise: first the second axis rises where the centre lies along the first.
  for (const auto& [plane, centre, u, v] :
       {std::tuple("G17", "I-10", 0, 1), {"G18", "K-10", 2, 0}, {"G19", "J-10", 1, 2}}) {
    const auto piece =
        *steps_of(fmt::format("{}G02F100{}{}{}-10{}-10", plane, centre, "", "XYZ"[u], "XYZ"[v]))[0].motion;
    REQUIRE(piece.arc);
    const Arc arc = arc_between({0.0, 0.0, 0.0}, piece.to_mm, *piece.arc);
    CHECK(arc.sweep_rad == Approx(-1.5707963267948966));
    CHECK(arc.direction(0.0)[static_cast<std::size_t>(v)] == Approx(-1.0));
  }
}

TEST_CASE("every error is reported at once with its line and column") {
  const std::string all =
      wrong_with("G00X-5\nG77\nX1.2.3\nQ5\nG00G01X1\n$REP 0\n$END\n$END\nX1X2\nG04\nM77(open\n$REPEAT\n");
  check_holds(all, {"p.nc:2:1: G77: unknown", "p.nc:3:1: X: expected a number such as", "p.nc:4:1: Q5: unknown word",
                    "p.nc:5:4: G01: a second motion", "p.nc:6:1: $REP: expected a whole number",
                    "p.nc:8:1: $END: expected a $REP", "p.nc:9:3: X2: a second value",
                    "p.nc:10:1: G04: expected its time", "p.nc:11:4: comment: expected a \")\"", "p.nc:12:1:"});
}

TEST_CASE("what would go wrong while running is found before, once for each line") {
  const std::string all = wrong_with(
      "X1\n"        // no motion word
      "G01X-1\n"    // no feed
      "G00X-600\n"  // beyond the travel
      "F100\n"
      "G90G17G02X0Y0Z-5I1\n"              // helix
      "G02X0Y0\n"                         // no centre
      "G90G00X-200Y0\nG02X-100Y0I50.1\n"  // radii
      "$REP 3\nG91G00Y-390\n$END\n"       // beyond in the second pass
      "G90G00X0Y0\nG02X0Y0I-260F100\n");  // the far side of a circle
  check_holds(
      all, {"p.nc:1: expected G00", "p.nc:2: expected a feed",
            "p.nc:3: X: goes to -600 mm; the axis can go from -500 to 25 mm", "p.nc:5: arc: expected X and Y only",
            "p.nc:6: arc: expected its centre", "p.nc:8: arc: its start lies 50.1000 mm", "p.nc:10: Y: goes to -780 mm",
            "p.nc:13: X: goes to -520 mm"});
  CHECK(contains(wrong_with("G01F100X-1\nG02X-1R5"), "full circle"));
  CHECK(contains(wrong_with("G01F100X-1\nG02X-11R4"), "cannot span"));
  CHECK(contains(wrong_with("G01F100X-1I5"), "only G02 and G03"));
  CHECK(contains(wrong_with("M03"), "spindle speed"));
  CHECK(contains(wrong_with("   \n;nothing\n"), "found no block"));
}

TEST_CASE("a program of endless loops is refused, in bounded time") {
  CHECK(contains(wrong_with("$REP 10000000\n$REP 10000000\n$END\n$END"), "more than 10000000 blocks"));
  std::string deep;
  for (int i = 0; i < 20; ++i) deep += "$REP 2\n";
  for (int i = 0; i < 20; ++i) deep += "$END\n";
  CHECK(contains(wrong_with(deep), "at most 16 nested loops"));
}

TEST_CASE("any text is either a program that ends or problems with lines") {
  using namespace std::string_view_literals;
  const auto words = split(
      "$REP 3|$REP 9999999|$END|$|G00|G1|G02|G03|G04H1|G18|G90|G91|X-5|Y1e9|I-5|K2|R5|R-|F100|F|M08|M09|M30|X|--|.|"
      "9999999999999999999|(|)|;|>|%|\n|\r\n|\t| |\xff|\0"sv,
      '|');
  CHECK(rc::check("mutated words", [&] {
    std::string text;
    const auto count = *rc::gen::inRange(0, 60);
    for (int i = 0; i < count; ++i) {
      if (*rc::gen::inRange(0, 12) == 0)
        text += *rc::gen::arbitrary<std::string>();
      else
        text.append(*rc::gen::elementOf(words)).append(*rc::gen::inRange(0, 3) == 0 ? "\n" : "");
    }
    const auto program = parse_program(text, "p.nc");
    if (!program) {
      RC_ASSERT(program.error().line > 0);
      RC_ASSERT(!program.error().message.empty());
      return;
    }
    const auto summary = checked_program(*program, {}, kRange);
    if (!summary) RC_ASSERT(summary.error().line > 0);
    if (summary) RC_ASSERT(summary->blocks <= kProgramBlocks);
  }));
}

TEST_CASE(
    "the program of appendix B with any bytes changed is still either a program that ends or problems with lines") {
  const auto whole = must(read_file("samples/mill/appendix_b.nc"));
  const ProgramRange range{std::array{-5000.0, 25.0}, std::nullopt, std::nullopt};
  CHECK(rc::check("changed bytes", [&] {
    std::string text = whole;
    const auto count = *rc::gen::inRange(0, 8);
    for (int i = 0; i < count; ++i)
      text[*rc::gen::inRange<std::size_t>(0, text.size())] = static_cast<char>(*rc::gen::inRange(0, 256) - 128);
    const auto program = parse_program(text, "p.nc");
    const auto summary = program ? checked_program(*program, {}, range) : tl::unexpected(program.error());
    if (!summary) RC_ASSERT(summary.error().line > 0);
    if (summary) RC_ASSERT(summary->blocks <= kProgramBlocks);
    if (count == 0) RC_ASSERT(summary->readings == 504);
  }));
}
