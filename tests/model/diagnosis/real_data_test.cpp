// Real measurements of tests/data/real and samples/real: what their fields say of them, the diagnosis says too.
#include <nlohmann/json.hpp>

#include "tests/model/support/real_sets.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using enum Verdict;

namespace {

/// A trigger point probed for 47 minutes while a printer is heated and cooled, sensors interpolated to the probings.
Set probing(const std::string& name) {
  const auto text = real_text("zprobe-thermal-drift/probe_accuracy_" + name + ".json");
  struct Temperatures {
    double t = 0.0, bed = 0.0, nozzle = 0.0, chamber = 0.0;
  };
  std::vector<Temperatures> warm;
  std::vector<std::pair<double, double>> probed;
  for (const std::string_view line : lines_of(text)) {
    if (trimmed(line).empty()) continue;
    const auto object = nlohmann::json::parse(line);
    if (object.contains("z"))
      probed.emplace_back(object["ts"], object["z"]);
    else
      warm.push_back({object["ts"], object["btemp"], object["etemp"], object["atherms"][0]["temp"]});
  }
  Set set;
  for (const auto& [t, z] : probed) {
    const auto after = std::find_if(warm.begin(), warm.end(), [at = t](const auto& w) { return w.t >= at; });
    if (after == warm.begin() || after == warm.end()) continue;
    const Temperatures &a = *(after - 1), &b = *after;
    const double part = (t - a.t) / (b.t - a.t);
    laser::Reading& r = added(set, Axis::Z, Sense::EZ, {}, 1000.0 * z);
    r.time_s = t - probed.front().first;
    r.sensors_degC = {{"t_bed_degC", std::lerp(a.bed, b.bed, part)},
                      {"t_nozzle_degC", std::lerp(a.nozzle, b.nozzle, part)},
                      {"t_chamber_degC", std::lerp(a.chamber, b.chamber, part)}};
  }
  return set;
}

}  // namespace

TEST_CASE("an interferometer after its ellipse correction: four periods in one fringe") {
  const auto text = real_text("interferometer-interpolation-error/X_Heydemann.csv");
  Set set;
  for (const std::string_view line : lines_of(text))
    if (const auto n = numbers_in(line); n.size() == 3)
      added(set, Axis::X, Sense::EX, {n[0], 0.0, 0.0}, n[2]);  // phase in degrees for a position
  const Diagnosis found = diagnosed_real("interferometer", offsets({{Axis::X, Sense::EX}}), set);
  CHECK(found.verdict == missing_effect);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(stands_for(found.candidates.front(), "cyclic:X:EX"));
  CHECK(found.candidates.front().parameters.front().value == Approx(90.0).epsilon(0.01));
}

TEST_CASE("a very good stage: no more than a wiggle of tens of nanometres") {
  const auto set = positioning_test("fat_sat");
  const Diagnosis found = diagnosed_real("fat_sat", straight(), set);
  for (const Candidate& c : found.candidates)
    if (c.named) CHECK(c.parameters.front().value < 0.02);
  CHECK(found.rms_um < 0.05);
}

TEST_CASE("a probe while a printer heats: the drift follows the temperatures, the bed's or the nozzle's first") {
  for (const char* name : {"GX-H12A", "GX-H8A", "N3F-H4NB", "superpinda"}) {
    const auto set = probing(name);
    const Diagnosis found = diagnosed_real(name, offsets({{Axis::Z, Sense::EZ}}), set);
    CHECK(found.verdict != adequate);
    REQUIRE_FALSE(found.candidates.empty());
    const auto best = std::min_element(found.candidates.begin(), found.candidates.end(),
                                       [](const auto& a, const auto& b) { return a.rms_after_um < b.rms_after_um; });
    CHECK(best->effect.id == thermal_drift);
    const bool heater = best->effect.sensor == "t_bed_degC" || best->effect.sensor == "t_nozzle_degC";
    CHECK(heater);
    CHECK(best->explained > 0.6);
  }
}
