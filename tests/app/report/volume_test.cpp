// The volumetric figure of a report: predicted, beside what was achieved on lines.
#include <doctest/doctest.h>

#include "tests/app/support/report_folder.hpp"

namespace ecs::app {
namespace {

using doctest::Approx;

TEST_CASE("the report predicts the error vector in the volume from the map, before and after") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  const Ran r = c.report({"--json"});
  REQUIRE(r.code == 0);
  const auto volume = r.json()["volume"];
  // One axis of 1000 mm, 36 um/m from the reference point at 0: 21 places, rms 36 √(Σ i²/21)/20 = 21.04.
  CHECK(volume["from"] == "the map");
  CHECK(volume["places"] == 21);
  CHECK(volume["predicted_before"]["length"]["largest_um"].get<double>() == Approx(36.0));
  CHECK(volume["predicted_before"]["X"]["rms_um"].get<double>() == Approx(21.0428).epsilon(1e-4));
  CHECK(volume["predicted_after"]["length"]["largest_um"].get<double>() == Approx(0.0).epsilon(0.01));
  const std::string html = c.html();
  CHECK(contains(html, "<h2>Volumetric error, predicted</h2>"));
  CHECK(contains(html, "Predicted from the map: the largest error vector in the volume is 36.0\u202fµm before"));
  CHECK(contains(html,
                 "The unit puts out all that the map holds but 0.0\u202fµm (rms 0.0\u202fµm): that is interpolation"));
  CHECK(contains(html, "Nothing was measured across the volume"));
  CHECK(contains(html, "achieved after: largest band"));
  CHECK(contains(html, "8.0 (EXX)"));
  CHECK(fault_of(html) == "");
}

TEST_CASE("what lacks for the volumetric figure is named, as for other things") {
  const Commissioning c;
  REQUIRE(c.report().code == 0);
  CHECK(contains(c.html(), "Volumetric error, predicted: no error map was given."));
  CHECK(c.report({"--json"}).json()["volume"].is_null());
  c.add_machine();
  c.add_map();
  std::filesystem::remove(c.folder / "parameters.toml");
  REQUIRE(c.report().code == 0);
  CHECK(contains(c.html(), "Volumetric error, predicted: no parameters were given."));
}

TEST_CASE("a model that knows all that the map compensates predicts instead, and one that does not is left aside") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  const char* const effect =
      "[[effect]]\nid = \"scale\"\naxis = \"X\"\nsense = \"{}\"\n"
      "[[effect]]\nid = \"backlash\"\naxis = \"X\"\nsense = \"{}\"\n";
  (void)c.folder.with("model.toml", fmt::format(fmt::runtime(effect), "EX", "EX"));
  const auto volume = c.report({"--json"}).json()["volume"];
  CHECK(volume["from"] == "the error model");
  // Fitted: 36 um/m and a reversal of 4 um; the map takes the slope, the reversal stays: ±2 um from its mean.
  CHECK(volume["predicted_before"]["X"]["largest_um"].get<double>() == Approx(38.0).epsilon(0.01));
  CHECK(volume["predicted_after"]["X"]["largest_um"].get<double>() == Approx(2.0).epsilon(0.01));
  // What the model does not hold is said as it is of a map, and nothing is promised in bold.
  const std::string by_model = c.html();
  CHECK(contains(by_model, "The unit puts out all that the error model holds but 2.0"));
  CHECK(contains(by_model, "with the uncertainty of the map at most "));
  CHECK_FALSE(contains(by_model, "class=\"lead\">Predicted from"));
  CHECK_FALSE(contains(by_model, "<strong>2.0</strong>"));
  (void)c.folder.with("model.toml", fmt::format(fmt::runtime(effect), "EY", "EY"));
  CHECK(c.report({"--json"}).json()["volume"]["from"] == "the map");
  CHECK(contains(c.html(), "The error model was not used: it has no effect for EXX, which is compensated."));
}

TEST_CASE("components declared zero are counted in the sentence about the volume") {
  const Commissioning c;
  c.add_machine();
  c.add_map("# machine: bench\n# date: 2026-03-02\n# configuration: TXYZ\n# declared_zero: EYX not measured\n");
  REQUIRE(c.report().code == 0);
  CHECK(contains(c.html(), "declared zero (1 of 2 components: EYX) is zero within a standard uncertainty of 1"));
}

TEST_CASE("the date of a report is the last one of all that went into it") {
  const Commissioning c;
  c.add_machine();
  c.add_map();
  CHECK(c.report({"--json"}).json()["date"] == "2026-03-02");
  const Commissioning undated("");
  CHECK(contains(undated.report().messages, "the report has no date"));
}

TEST_CASE("a report that was there is replaced, and the answer says so") {
  const Commissioning c;
  CHECK(c.report({"--json"}).json()["replaced"] == false);
  CHECK(c.report({"--json"}).json()["replaced"] == true);
  CHECK(contains(c.report().out, "kB, replaced)"));
}

}  // namespace
}  // namespace ecs::app
