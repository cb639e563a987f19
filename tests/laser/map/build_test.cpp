// From measured files to a map: what each component takes, and what is refused.
#include "laser/map/build.hpp"

#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;
namespace fs = std::filesystem;

namespace {

struct MapFolder : Folder {
  [[nodiscard]] fs::path write(const std::string& name, const std::string& text) const { return with(name, text); }
};

constexpr const char* kHeader = "axis,sense,x_mm,y_mm,z_mm,approach,run,reading\n";

/// Two runs each way of `error(position, approach)` along one axis.
template <class Error>
std::string runs(char axis, const std::string& sense, std::array<double, 3> parked, double first, double last,
                 double step, Error error, const std::string& metadata = "") {
  std::string text = metadata + kHeader;
  const auto a = static_cast<std::size_t>(axis - 'X');
  const auto targets = static_cast<int>(std::floor((last - first) / step + 1e-9)) + 1;
  for (int run = 1; run <= 2; ++run)
    for (const int d : {1, -1})
      for (int i = 0; i < targets; ++i) {
        const double p = first + i * step;
        std::array<double, 3> at = parked;
        at[a] = p;
        text += fmt::format("{},{},{},{},{},{},{},{}\n", axis, sense, at[0], at[1], at[2], d, run, error(p, d));
      }
  return text;
}

UnitParameters mill_parameters() {
  UnitParameters p;
  p.measurement_lines_mm[0] = {0.0, -1400.0, 0.0};
  p.axes[1].datum.reference_position_mm = -1400.0;
  return p;
}

MapRecipe recipe_of(std::vector<ComponentRecipe> components) {
  MapRecipe recipe;
  recipe.components = std::move(components);
  return recipe;
}

ComponentRecipe one(Component c, std::vector<fs::path> files) { return {.component = c, .files = std::move(files)}; }

auto built_of(Component c, std::vector<fs::path> files) {
  return build_map(recipe_of({one(c, std::move(files))}), mill_parameters());
}

}  // namespace

TEST_CASE("compensation is minus the error, forward and reverse apart, zero at the datum") {
  const MapFolder folder;
  const auto file = folder.write(
      "x.csv", runs('X', "EX", {0, -1400, 0}, -200, 0, 50, [](double p, int d) { return 5.0 + 0.02 * p + 1.5 * d; }));
  const auto built = must(built_of(Component::EXX, {file}));
  REQUIRE(built.map.tables.size() == 2);
  const MapTable& forward = built.map.tables[0];
  const MapTable& reverse = built.map.tables[1];
  CHECK(forward.approach == Approach::forward);
  CHECK(compensation_at(forward, -200.0) == Approx(4.0 - 1.5));  // error -4 + 1.5
  CHECK(compensation_at(reverse, -200.0) == Approx(4.0 + 1.5));
  CHECK(compensation_at(forward, 0.0) + compensation_at(reverse, 0.0) == Approx(0.0));
}

TEST_CASE("straightness loses its slope and the header says how much") {
  const MapFolder folder;
  const auto file =
      folder.write("yx.csv", runs('X', "EY", {0, -1400, 0}, -200, 0, 50, [](double p, int) { return 0.3 * p + 12.0; }));
  const auto built = must(built_of(Component::EYX, {file}));
  for (const double c : built.map.tables[0].compensation) CHECK(c == Approx(0.0).epsilon(1e-9));
  CHECK(built.outcomes[0].slope_um_per_m == Approx(300.0));
  CHECK(contains(built.map.header.processing.front(), "300.00 um/m removed by least_squares"));
}

TEST_CASE("yaw comes from two linear runs at two ram positions, in our signs") {
  // E_X = EBX · Z: at z = -1000 a yaw of +30 um/m shows as -30 um
  const MapFolder folder;
  const auto yaw = [](double p) { return -0.1 * p; };
  const auto in =
      folder.write("in.csv", runs('X', "EX", {0, -1400, 0}, -400, 0, 100, [](double p, int) { return 0.01 * p; }));
  const auto out = folder.write("out.csv", runs('X', "EX", {0, -1400, -1000}, -400, 0, 100,
                                                [&](double p, int) { return 0.01 * p + yaw(p) * -1.0; }));
  const auto built = must(built_of(Component::EBX, {in, out}));
  CHECK(compensation_at(built.map.tables[0], -300.0) == Approx(-30.0));
  CHECK(built.outcomes[0].band == Approx(40.0));
}

TEST_CASE("the same two runs cannot show another rotation") {
  const MapFolder folder;
  const auto in = folder.write("in.csv", runs('X', "EX", {0, -1400, 0}, -400, 0, 100, [](double, int) { return 0.0; }));
  const auto out =
      folder.write("out.csv", runs('X', "EX", {0, -1400, -1000}, -400, 0, 100, [](double, int) { return 1.0; }));
  CHECK(contains(must_fail(built_of(Component::ECX, {in, out})).message, "show EBX, not ECX"));
}

TEST_CASE("an indicator run along Y gives C0Y into the parameters") {
  const MapFolder folder;  // E_X = -C0Y · Y with C0Y = 16 um/m
  const auto file =
      folder.write("sq.csv", runs('Y', "EX", {0, 0, 0}, -1400, 0, 200, [](double p, int) { return -0.016 * p; }));
  const auto built = must(built_of(Component::C0Y, {file}));
  CHECK(built.parameters.C0Y_um_per_m == Approx(16.0));
  CHECK(built.map.tables.empty());
  CHECK(built.map.header.sources.front().component == "C0Y");
}

TEST_CASE("every file that is missing is named, also the second one of a component") {
  const auto built = built_of(Component::EBX, {"no_first.csv", "no_second.csv"});
  REQUIRE_FALSE(built);
  const std::string said = to_text(built.error());
  CHECK_MESSAGE(contains(said, "no_first.csv"), said);
  CHECK_MESSAGE(contains(said, "no_second.csv"), said);
}

TEST_CASE("a file of another sense is refused with what it holds") {
  const MapFolder folder;
  const auto file = folder.write("x.csv", runs('X', "EX", {0, -1400, 0}, -200, 0, 50, [](double, int) { return 0.0; }));
  const auto built = must_fail(built_of(Component::EYX, {file}));
  CHECK(contains(built.message, "expected readings of EY along X, found EX along X at Y -1400, Z 0"));
}

TEST_CASE("readings taken while compensating make no map") {
  const MapFolder folder;
  const auto file =
      folder.write("x.csv", "axis,sense,x_mm,y_mm,reading,compensated\nX,EX,0,-1400,1,1\nX,EX,-50,-1400,2,1\n");
  CHECK(contains(must_fail(built_of(Component::EXX, {file})).message, "compensation active"));
}

TEST_CASE("a curve off the measurement line of the parameters is refused") {
  const MapFolder folder;
  const auto file = folder.write("x.csv", runs('X', "EX", {0, 0, 0}, -200, 0, 50, [](double, int) { return 0.0; }));
  const auto built = must_fail(built_of(Component::EXX, {file}));
  CHECK(contains(built.message, "measured at Y 0, but the parameters' measurement line of X is at Y -1400"));
}

TEST_CASE("files of two machines do not make one map") {
  const MapFolder folder;
  const auto flat = [](double, int) { return 0.0; };
  const auto x = folder.write("x.csv", runs('X', "EX", {0, -1400, 0}, -200, 0, 50, flat, "# machine: mill A\n"));
  const auto y = folder.write("y.csv", runs('Y', "EY", {0, 0, 0}, -1400, 0, 200, flat, "# machine: mill B\n"));
  const auto built =
      must_fail(build_map(recipe_of({one(Component::EXX, {x}), one(Component::EYY, {y})}), mill_parameters()));
  CHECK(contains(built.message, "more than one machine"));
}

TEST_CASE("a component that the chain does not use is refused") {
  const MapFolder folder;
  const auto file = folder.write("z.csv", runs('Z', "EA", {0, -1400, 0}, -200, 0, 50, [](double, int) { return 0.0; }));
  CHECK(contains(must_fail(built_of(Component::EAZ, {file})).message, "does not use it"));
}

TEST_CASE("the files themselves suggest what they serve, and name what is left over") {
  const MapFolder folder;
  const auto flat = [](double, int) { return 0.0; };
  const std::vector<fs::path> files{
      folder.write("x.csv", runs('X', "EX", {0, -1400, 0}, -200, 0, 50, flat)),
      folder.write("x_out.csv", runs('X', "EX", {0, -1400, -1000}, -200, 0, 50, flat)),
      folder.write("sq.csv", runs('Y', "EX", {0, 0, 0}, -1400, 0, 200, flat, "# instrument: indicator on a square\n")),
      folder.write("yx_far.csv", runs('X', "EY", {0, 0, 0}, -200, 0, 50, flat))};
  const auto suggested = must(suggest_recipe(files, mill_parameters()));
  REQUIRE(suggested.recipe.components.size() == 3);
  CHECK(suggested.recipe.components[0].component == Component::EXX);
  CHECK(suggested.recipe.components[1].component == Component::EBX);
  CHECK(suggested.recipe.components[1].files.size() == 2);
  CHECK(suggested.recipe.components[2].component == Component::C0Y);
  REQUIRE(suggested.unused.size() == 1);
  CHECK(suggested.unused[0] ==
        "yx_far.csv (EY along X): it was measured at Y 0 (or the file does not state Y), the measurement line of X in "
        "the parameters is at Y -1400: "
        "give the place where it was measured (--parked), or measure a second line parallel to it");
}

TEST_CASE("a recipe reports every fault with its line") {
  const std::string text = to_text(
      must_fail(parse_map_recipe("colour = 1\n[[component]]\ncode = \"EXQ\"\nfiles = [\"a.csv\"]\n"
                                 "[[component]]\ncode = \"EXX\"\nfiles = []\n[[declared_zero]]\ncode = \"EXX\"\n",
                                 "r.toml", ".")));
  check_holds(text, {"r.toml:1", "found \"EXQ\"", "files: expected one file for EXX, found 0",
                     "EXX occurs twice in the recipe", "reason: state why"});
}

TEST_CASE("an angle is zero where its axis stood while the axes it levers were measured") {
  UnitParameters p = mill_parameters();
  p.measurement_lines_mm[1] = {-100.0, 0.0, 0.0};  // Y and Z were measured at X -100
  p.measurement_lines_mm[2] = {-100.0, -1400.0, 0.0};
  const MapFolder folder;
  const auto file =
      folder.write("roll.csv", runs('X', "EA", {0, -1400, 0}, -200, 0, 50, [](double x, int) { return 0.1 * x; }));
  const auto built = must(build_map(recipe_of({one(Component::EAX, {file})}), p));
  CHECK(compensation_at(built.map.tables[0], -100.0) == Approx(0.0));
  CHECK(compensation_at(built.map.tables[0], 0.0) == Approx(-10.0));
  p.measurement_lines_mm[2] = {-150.0, -1400.0, 0.0};
  CHECK(contains(must_fail(build_map(recipe_of({one(Component::EAX, {file})}), p)).message, "cannot be zero at both"));
}

TEST_CASE("for the printed equations, roll, pitch about Z and two squareness values change their sign") {
  UnitParameters p = mill_parameters();
  p.convention = Convention::as_printed;
  const MapFolder folder;
  const auto roll =
      folder.write("roll.csv", runs('X', "EA", {0, -1400, 0}, -200, 0, 50, [](double x, int) { return 0.1 * x; }));
  const auto square =
      folder.write("sq.csv", runs('Y', "EX", {0, 0, 0}, -1400, 0, 200, [](double y, int) { return -0.016 * y; }));
  const auto built = must(build_map(recipe_of({one(Component::EAX, {roll}), one(Component::C0Y, {square})}), p));
  CHECK(compensation_at(built.map.tables[0], -200.0) == Approx(-20.0));
  CHECK(built.parameters.C0Y_um_per_m == Approx(-16.0));
}

TEST_CASE("a run that is to be left out must be there") {
  const MapFolder folder;
  const auto file = folder.write("x.csv", runs('X', "EX", {0, -1400, 0}, -200, 0, 50, [](double, int) { return 0.0; }));
  ComponentRecipe recipe = one(Component::EXX, {file});
  recipe.exclude_runs = {2, 9};
  const auto built = must_fail(build_map(recipe_of({recipe}), mill_parameters()));
  CHECK(contains(built.message, "run 9 cannot be excluded: the file has runs 1, 2"));
}

/// Two runs that differ by 2 um, up and down from target to target.
std::string scattered_runs() {
  std::string text = kHeader;
  for (int run = 1; run <= 2; ++run)
    for (const int d : {1, -1})
      for (int i = 0; i < 40; ++i)
        text += fmt::format("X,EX,{},-1400,0,{},{},{}\n", 10 * i, d, run, (i + run) % 2 == 0 ? 1.0 : -1.0);
  return text;
}

TEST_CASE("the header states how certain the means are") {
  const MapFolder folder;
  const auto built =
      must(build_map(recipe_of({one(Component::EXX, {folder.write("x.csv", scattered_runs())})}), mill_parameters()));
  REQUIRE(built.map.header.uncertainty.size() == 1);
  const StatedUncertainty& u = built.map.header.uncertainty.front();
  CHECK(u.component == Component::EXX);
  CHECK(u.value == Approx(std::sqrt(40.0 / 34.0)).epsilon(0.02));  // σ² = 2 · 40/(40 − 6), of a mean of two half of it
  CHECK(u.pass == 0.0);
  CHECK(u.degrees_of_freedom == 2);
}

TEST_CASE("a curve that is shrunk loses what its repeats call scatter, and the header says so") {
  const MapFolder folder;
  MapRecipe recipe = recipe_of({one(Component::EXX, {folder.write("x.csv", scattered_runs())})});
  recipe.shrink = true;
  const auto built = must(build_map(recipe, mill_parameters()));
  CHECK(built.map.header.processing.front().starts_with("EXX shrunk according to its noise"));
}

TEST_CASE("a header that states an uncertainty wrongly is refused with what is expected") {
  for (const char* line : {"uncertainty: EXX", "uncertainty: EQX value=1 pass=0 degrees_of_freedom=2",
                           "uncertainty: EXX value=-1 pass=0 degrees_of_freedom=2",
                           "uncertainty: EXX value=a pass=0 degrees_of_freedom=2"}) {
    CHECK(contains(must_fail(parse_header(line, "m.csv")).message, "uncertainty: expected CODE value="));
  }
}
