// Where readings come from, and what a plan says of them.
#include <fstream>

#include <doctest/doctest.h>

#include "commissioning/measurements/table.hpp"
#include "modules/capture/capture_source.hpp"
#include "tests/support/folder.hpp"

namespace ecs::commissioning {
namespace {

TEST_CASE("the number of a display is the last one of its line") {
  CHECK(last_number_in("X -50.0012 mm") == -50.0012);
  CHECK(last_number_in("12 3.5um") == 3.5);
  CHECK(!last_number_in("no signal").has_value());
  CHECK(!last_number_in("").has_value());
}

TEST_CASE("a display that writes continuously is followed: its last complete line counts") {
  const Folder folder;
  const std::string file = folder.with("log.txt", "1\n2\n3\n4.5");
  auto source = following_source(file);
  REQUIRE(source);
  (*source)->ask(0.0);
  const Shown shown = (*source)->shown(0.1);
  REQUIRE(shown.kind == Shown::Kind::value);
  CHECK(shown.value == 3.0);
  std::ofstream(file, std::ios::app) << "6\n";
  CHECK((*source)->shown(0.2).value == 4.56);
}

TEST_CASE("a command is asked for what its display shows") {
  const auto source = command_source("echo shows 7.25 um");
  CHECK(source->shown(0.0).value == 7.25);
  CHECK(command_source("false")->shown(0.0).kind == Shown::Kind::none);
}

TEST_CASE("the default slope follows the kind of measurement") {
  const auto plan = parse_plan(
      "[[measure]]\nname = \"a\"\naxis = \"X\"\nsense = \"EX\"\n[[measure]]\nname = \"b\"\naxis = \"X\"\nsense = "
      "\"EY\"\n"
      "[[measure]]\nname = \"c\"\naxis = \"X\"\nsense = \"EC\"\n"
      "[[measure]]\nname = \"d\"\naxis = \"Y\"\nsense = \"EX\"\ninstrument = \"square\"\n",
      "plan.toml");
  REQUIRE(plan);
  CHECK((*plan)[0].slope == laser::SlopeMethod::none);
  CHECK((*plan)[1].slope == laser::SlopeMethod::least_squares);
  CHECK((*plan)[2].slope == laser::SlopeMethod::none);
  CHECK((*plan)[3].slope == laser::SlopeMethod::none);
}

}  // namespace
}  // namespace ecs::commissioning
