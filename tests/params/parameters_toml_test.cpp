#include "params/parameters_toml.hpp"

#include <array>

#include "core/memory_image.hpp"
#include "tests/params/support/random_parameters.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::params;

namespace {

Result<ParametersFile> parsed(std::string_view text) { return parse_parameters(text, "unit.toml"); }

bool lists(const std::vector<std::string>& keys, std::string_view key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// "line:column: start of the message" of every problem.
std::vector<std::string> places(const Problem& problem) {
  std::vector<std::string> found;
  const auto note = [&](const Problem& p) {
    found.push_back(std::to_string(p.line) + ":" + std::to_string(p.column) + ": " + p.message);
  };
  note(problem);
  for (const Problem& other : problem.also) note(other);
  return found;
}

}  // namespace

TEST_CASE("parameters written to TOML and read back are the same to the last bit, with their identity") {
  CHECK(rc::check([] {
    const UnitParameters original = random_parameters();
    const Identity identity{*rc::gen::element<std::string>("", "mill \"A\"\\B", "Fräse\n2\t"), "0017"};
    const auto back = parsed(parameters_toml(original, identity));
    RC_ASSERT(back.has_value());
    RC_ASSERT(same_bits(back->parameters, original));
    RC_ASSERT(back->identity == identity);
  }));
}

TEST_CASE("a file of all present axes leaves nothing to defaults") {
  CHECK(must(parsed(parameters_toml(UnitParameters{}))).defaulted.empty());
}

TEST_CASE("TOML to the unit's bytes and back is the same TOML") {
  CHECK(rc::check([] {
    UnitParameters original = random_parameters();
    std::copy_n("TXYZ", 4, original.configuration.begin());
    std::array<std::uint8_t, kParameterBytes> block{};
    encode_parameters(original, block);
    const auto decoded = decode_parameters(block);
    RC_ASSERT(decoded.has_value());
    RC_ASSERT(parameters_toml(*decoded) == parameters_toml(original));
  }));
}

TEST_CASE("a short file takes the defaults for the rest and says which") {
  const auto file = must(read_parameters("tests/data/params/mill_unit.toml"));
  CHECK(file.identity.machine == "moving column mill");
  CHECK(file.identity.serial_number == "MCM-0107");
  const UnitParameters& p = file.parameters;
  CHECK(p.interpolation == Interpolation::nearest);
  CHECK(p.C0Y_um_per_m == 16.0);
  CHECK(p.B0Z_um_per_m == -38.8);
  CHECK(p.A0Z_um_per_m == -66.93);
  CHECK(p.measurement_lines_mm[0] == Vector3{0.0, -1400.0, 0.0});
  CHECK(p.axes[0].deadband_um == 4.0);
  CHECK(p.axes[0].datum.kind == DatumKind::siemens);
  CHECK(p.axes[0].datum.switch_finally_active);
  CHECK(p.axes[0].datum.approach_direction == Approach::forward);
  CHECK(p.axes[1] == AxisParameters{});
  CHECK(lists(file.defaulted, "axis.Y.deadband_um"));
  CHECK(lists(file.defaulted, "compensation.loop_period_us"));
  CHECK_FALSE(lists(file.defaulted, "axis.X.deadband_um"));
}

TEST_CASE("fields of absent axes are not missed, and their tables are left out of the file") {
  const auto file = must(parsed("[configuration]\nchain = \"TX\"\naxes = \"X\"\n"));
  CHECK(lists(file.defaulted, "axis.X.deadband_um"));
  CHECK_FALSE(lists(file.defaulted, "axis.Y.deadband_um"));
  const std::string text = parameters_toml(file.parameters);
  CHECK(contains(text, "[axis.X.datum]"));
  CHECK(!contains(text, "[axis.Y"));
}

TEST_CASE("an empty file is a set of defaults, and no sound file") {
  const auto file = must(parsed(""));
  CHECK(file.parameters == UnitParameters{});
  const auto expected = std::ranges::count_if(fields(), [](const Field& field) { return !field.may_be_absent; });
  CHECK(file.defaulted.size() == static_cast<std::size_t>(expected));
  CHECK(file.axes_without_keys.size() == kAxes);
  CHECK_FALSE(file.has_end);
}

TEST_CASE("a file cut off at any byte is known by its missing last line") {
  const std::string whole = parameters_toml(UnitParameters{}, {"mill", "17"});
  REQUIRE(parsed(whole)->has_end);
  CHECK(parsed(whole + " \r\n\n")->has_end);
  CHECK_FALSE(parsed(whole + "deadband_um = 3\n").has_value());
  CHECK_FALSE(parsed(whole + "# more\n")->has_end);
  for (std::size_t bytes = 0; bytes + 1 < whole.size(); ++bytes)
    if (const auto cut = parsed(whole.substr(0, bytes))) CHECK_FALSE(cut->has_end);
}

TEST_CASE("a present axis of which a file gives nothing is named") {
  const auto file = must(parsed("axis.Z.deadband_um = 7\n[axis.X.datum]\nnull_offset_mm = 1\n"));
  CHECK(file.axes_without_keys == std::vector<Axis>{Axis::Y});
  CHECK(parsed("axis.X.deadband_um = 1\n[configuration]\nchain = \"TX\"\naxes = \"X\"\n")->axes_without_keys.empty());
}

TEST_CASE("the written file explains each field with unit, range and default, and a vector is one entry") {
  const std::string text = parameters_toml(UnitParameters{});
  check_holds(
      text,
      {"# 100 to 20000 us; default 1000\nloop_period_us = 1000.0\n", "\nmeasurement_line_mm = { y = 0.0, z = 0.0 }\n",
       "\ntool_offset_mm = { x = 0.0, y = 0.0, z = 0.0 }\n", "\n[compensation.squareness]\n", "\n[axis.Z.datum]\n"});
}

TEST_CASE("tables may come in any order and keys may be dotted") {
  const auto file =
      must(parsed("axis.Z.deadband_um = 7\n[axis.X.datum]\nnull_offset_mm = 1\n[axis.X]\ndeadband_um = 3\n"));
  CHECK(file.parameters.axes[2].deadband_um == 7.0);
  CHECK(file.parameters.axes[0].deadband_um == 3.0);
  CHECK(file.parameters.axes[0].datum.null_offset_mm == 1.0);
}

TEST_CASE("every wrong value of a file is reported in one pass, in file order, with line and column") {
  const auto file = must_fail(read_parameters("tests/data/params/broken_values.toml"));
  CHECK(file.kind == ProblemKind::bad_input);
  CHECK(file.file == "tests/data/params/broken_values.toml");
  const auto found = places(file);
  const std::vector<std::string> expected{
      "2:11: identity.machine: expected a text in quotes, found 12",
      "5:9: configuration.chain: expected the letter T and one to three of X, Y, Z, each once, such as \"TXYZ\", found "
      "\"TXYX\"",
      "6:22: configuration.measurement_system: expected metric or imperial, found \"metrical\" (did you mean "
      "\"metric\"?)",
      "9:18: compensation.memory_modules: expected 1 to 5, found 6",
      "10:18: compensation.loop_period_us: expected 100 to 20000 us, found 50",
      "11:8: compensation.scpe: there is no such parameter (did you mean \"compensation.scope\"?); correct the name or "
      "remove it",
      "12:17: compensation.angular_scale: expected -10 to 10, found nan",
      "15:31: axis.X.position_scale_um_per_count: expected -1000 to 1000 um/count except 0, found 0",
      "16:15: axis.X.deadband_um: expected 0 to 10000 um, found \"two\"",
      "17:25: axis.X.compensation_polarity: expected -1 or 1, found 0",
      "18:29: axis.X.measurement_line_mm.x: there is no such parameter (did you mean "
      "\"axis.X.measurement_line_mm.y\"?); correct the name or remove it",
      "18:38: axis.X.measurement_line_mm.y: expected -100000 to 100000 mm, found inf",
      "21:25: axis.X.datum.switch_finally_active: expected true or false, found 1",
      "22:25: axis.X.datum.approach_speed_mm_min: expected above 0, up to 60000 mm/min, found 0",
      "24:1: axis.W: there is no such table (did you mean \"axis.X\"?); correct the name or remove it",
      "27:1: compensatoin: there is no such table (did you mean \"compensation\"?); correct the name or remove it"};
  CHECK(found == expected);
  if (found != expected)
    for (const auto& line : found) MESSAGE(line);
}

TEST_CASE("a file that is not TOML is refused at the place of the error") {
  const auto file = must_fail(read_parameters("tests/data/params/broken_syntax.toml"));
  CHECK(file.line == 3);
  CHECK(file.column > 0);
  for (const char* text : {"[", "a = ", "a = 1\na = 2\n", "\xff\xfe", "[axis.X]\n[axis.X]\n", "a = \"\\q\""})
    CHECK_MESSAGE(!parsed(text).has_value(), text);
}

TEST_CASE("tables where values belong, and values where tables belong, are refused") {
  for (const char* text : {"configuration = 3", "[compensation.scope]", "[[axis]]\nx = 1", "[axis.X]\ndatum = true",
                           "[compensation]\nscope = [1, 2]", "[compensation]\nscope = 1979-05-27",
                           "[compensation]\nscope = 2", "[axis.X]\nmeasurement_line_mm = 3.0", "\"axis.X\" = 3",
                           "[compensation]\nmemory_modules = 1.0", "[compensation]\nloop_period_us = true"})
    CHECK_MESSAGE(!parsed(text).has_value(), text);
}

TEST_CASE("a key nested without end is refused at its line instead of exhausting the stack") {
  for (const std::string part : {"a.", "[", "{a="}) {
    std::string text = "\nx";
    for (int i = 0; i < 300'000; ++i) text += part;
    CHECK(must_fail(parsed(text)).line == 2);
  }
  std::string deep;
  for (int i = 0; i < 2'000; ++i) deep += "a.";
  CHECK_FALSE(parsed("[" + deep + "a]\n" + deep + "a = 1\n").has_value());
}

TEST_CASE("a name in a file holds no control characters and no more than a name has") {
  CHECK(must(parsed("[identity]\nmachine = \"mill\\u001b[31m\"\n")).identity.machine == "mill?[31m");
  const auto endless = must_fail(parsed("[identity]\nmachine = \"" + std::string(3'000'000, 'N') + "\"\n"));
  CHECK(endless.line == 2);
  CHECK(endless.message == "identity.machine: expected at most 200 bytes, found 3000000");
}

TEST_CASE("a missing file is a problem that names it") {
  CHECK(contains(to_text(must_fail(read_parameters("tests/data/params/none.toml"))), "none.toml"));
}
