#include "commissioning/measurements/table.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

/// One run each way at 0, 500 and 1000 mm: slope · x + bow at the middle, ± reversal/2.
std::string line_of(const std::string& sense, double slope_um_per_m, double bow_um, double reversal_um,
                    int compensated) {
  std::string text = "axis,sense,x_mm,reading,approach,compensated\n";
  for (const int approach : {1, -1})
    for (const double x : {0.0, 500.0, 1000.0})
      text += fmt::format("X,{},{},{},{},{}\n", sense, x,
                          slope_um_per_m * x / 1000.0 + (x == 500.0 ? bow_um : 0.0) + approach * reversal_um / 2.0,
                          approach, compensated);
  return text;
}

const char* const kPlan = R"(
[[measure]]
name = "EXX"
axis = "X"
sense = "EX"
published_before = 40.0
published_after = 14.0
instrument = "linear"
from_mm = 0.0
[[measure]]
name = "EYX"
axis = "X"
sense = "EY"
slope = "end_points"
)";

struct Workshop {
  Folder folder;
  std::string plan = folder.with("plan.toml", kPlan);
  Workshop(double exx_after, double eyx_slope) {
    (void)folder.with("before/EXX.csv", line_of("EX", 36.0, 0.0, 4.0, 0));
    (void)folder.with("after/EXX.csv", line_of("EX", exx_after, 0.0, 4.0, 1));
    (void)folder.with("before/EYX.csv", line_of("EY", eyx_slope, 10.0, 0.0, 0));
    (void)folder.with("after/EYX.csv", line_of("EY", -eyx_slope, 5.0, 0.0, 1));
  }
  [[nodiscard]] Ran table(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"laser", "table", plan, "--before", folder / "before", "--after", folder / "after"};
    words.insert(words.end(), more.begin(), more.end());
    return ran(words);
  }
};

TEST_CASE("the band of positioning keeps its slope, that of straightness loses it") {
  const Workshop w(6.0, 100.0);
  const Ran r = w.table({"--json"});
  CHECK(r.code == 0);
  const auto rows = r.json()["rows"];
  REQUIRE(rows.size() == 2);
  CHECK(rows[0]["before"]["band"] == Approx(40.0));
  CHECK(rows[0]["after"]["band"] == Approx(10.0));
  CHECK(rows[0]["ratio"] == Approx(4.0));
  CHECK(rows[0]["published_after"] == Approx(14.0));
  CHECK(rows[1]["before"]["band"] == Approx(10.0));
  CHECK(rows[1]["after"]["band"] == Approx(5.0));
  CHECK(rows[1]["before"]["slope_removed_per_m"] == Approx(100.0));
  CHECK(rows[1]["published_after"].is_null());
}

TEST_CASE("a band above the published one is marked and ends with 1") {
  const Workshop w(11.0, 0.0);
  const Ran r = w.table();
  CHECK(r.code == 1);
  CHECK(r.out.find("40.0->15.0") != std::string::npos);
  CHECK(r.out.find('!') < r.out.find("\nEYX"));
  CHECK(w.table({"--json"}).json()["rows"][0]["exceeds_published"] == true);
}

TEST_CASE("a missing file leaves its row in the table and ends with 3") {
  const Workshop w(6.0, 0.0);
  std::filesystem::remove(w.folder / "after/EYX.csv");
  const Ran r = w.table({"--json"});
  CHECK(r.code == 3);
  CHECK(r.json()["rows"][1]["after"].is_null());
  CHECK(r.json()["rows"][1]["before"]["band"] == Approx(10.0));
  CHECK(r.json()["rows"][1]["problems"].size() == 1);
}

TEST_CASE("readings of another sense are a problem of their row, which says what there is") {
  const Workshop w(6.0, 0.0);
  (void)w.folder.with("after/EYX.csv", line_of("EZ", 0.0, 1.0, 0.0, 1));
  const Ran r = w.table();
  CHECK(r.code == 3);
  CHECK(r.out.find("expected one line of EY along X, with compensation, found EZ along X") != std::string::npos);
}

TEST_CASE("exchanged folders are noticed by the column compensated") {
  const Workshop w(6.0, 0.0);
  const Ran r = ran({"laser", "table", w.plan, "--before", w.folder / "after", "--after", w.folder / "before"});
  CHECK(r.code == 3);
  CHECK(r.out.find("without compensation, found EX along X at Y 0, Z 0, compensated yes") != std::string::npos);
}

TEST_CASE("the table fits 80 columns and says how the band is defined") {
  const Workshop w(6.0, 0.0);
  const std::string text = w.table().out;
  CHECK(text.find("largest minus smallest of all readings") != std::string::npos);
  for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    CHECK(end - at <= 80);
}

TEST_CASE("each row gets a plot of before and after on one scale") {
  const Workshop w(6.0, 0.0);
  const auto j = w.table({"--plots", w.folder / "plots", "--png", "--json"}).json();
  REQUIRE(j["plots"].size() == 4);
  CHECK(content_of(j["plots"][0]).find("<svg") != std::string::npos);
  CHECK(content_of(j["plots"][1]).substr(1, 3) == "PNG");
}

TEST_CASE("every wrong entry of a plan is reported at once, with its line") {
  const auto plan = parse_plan(
      "[[measure]]\nname = \"a/b\"\naxis = \"W\"\nsense = \"EX\"\n[[measure]]\nname = \"x\"\naxis = \"X\"\nsense = "
      "\"E\"\n"
      "slope = \"steep\"\nphase = \"later\"\npublished_after = -1.0\n",
      "plan.toml");
  REQUIRE_FALSE(plan);
  CHECK(plan.error().also.size() == 5);
  CHECK(plan.error().line > 0);
  CHECK_FALSE(parse_plan("name = \"nothing to measure\"\n", "plan.toml"));
  CHECK_FALSE(parse_plan("[[measure]\n", "plan.toml"));
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

TEST_CASE("the plans of the samples can be read") {
  for (const char* machine : {"mill", "lathe", "machining_centre"}) {
    const std::string path = std::string("samples/") + machine + "/plan.toml";
    CAPTURE(path);
    CHECK(read_plan(path));
  }
}

}  // namespace
}  // namespace ecs::app
