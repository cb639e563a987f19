// Sets of tests/data/made_up that show one fault each: what is right of them stands in their README.
#include "laser/import/import.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

struct MadeUpSet {
  Model model;
  Observations data;
};

MadeUpSet made_up(const std::string& name) {
  const std::string path = "tests/data/made_up/" + name;
  const auto model = must(read_model(path + ".toml"));
  return {model, observations_of(must(laser::read_any(path + ".csv", {})).set, model, std::nullopt)};
}

Diagnosis diagnosis_of(const std::string& name) {
  const MadeUpSet set = made_up(name);
  return must(diagnose(set.model, set.data));
}

std::vector<Candidate> named_in(const Diagnosis& diagnosis) {
  std::vector<Candidate> named;
  for (const Candidate& candidate : diagnosis.candidates)
    if (candidate.named) named.push_back(candidate);
  return named;
}

double parameter(const Candidate& candidate, std::string_view name) {
  for (const ParameterEstimate& one : candidate.parameters)
    if (one.name == name) return one.value;
  return kNotMeasured;
}

}  // namespace

TEST_CASE("two waves at one place are reported each with its own numbers") {
  const std::vector<Candidate> named = named_in(diagnosis_of("two_periods"));
  REQUIRE(named.size() == 2);
  CHECK(parameter(named[0], "period_mm") == Approx(0.25).epsilon(1e-4));
  CHECK(parameter(named[0], "amplitude_um") == Approx(20.0).epsilon(0.01));
  CHECK(parameter(named[1], "period_mm") == Approx(0.25 / 3.0).epsilon(1e-4));
  CHECK(parameter(named[1], "amplitude_um") == Approx(1.1).epsilon(0.05));
}

TEST_CASE("no wave is longer than half a plate, and its turn is reported in its size") {
  const Diagnosis found = diagnosis_of("plate");
  const std::vector<Candidate> named = named_in(found);
  REQUIRE_FALSE(named.empty());
  CHECK(std::abs(parameter(named.front(), "um_per_m")) == Approx(65.0).epsilon(0.15));
  for (const Candidate& candidate : found.candidates)
    if (candidate.effect.traits().periodic) CHECK(parameter(candidate, "period_mm") <= 320.0);
}

TEST_CASE("readings that are wrong together at an edge are outliers, each told, and do not bend the slope") {
  const MadeUpSet set = made_up("edge_outliers");
  const auto fitted = must(fit(set.model, set.data));
  CHECK(fitted.outliers.size() == 13);
  for (const ParameterEstimate& one : fitted.effects.at(1).parameters) CHECK(std::abs(one.value) < 40.0);
  CHECK(diagnosis_of("edge_outliers").outliers.size() == 13);
}

TEST_CASE("a twist is no noise where nothing is repeated") {
  const Diagnosis found = diagnosis_of("twisted_mesh");
  CHECK(found.noise.noise_um == Approx(35.0).epsilon(0.1));
  CHECK(found.verdict != Verdict::adequate);
  REQUIRE_FALSE(found.where.empty());
  CHECK(found.where.front().variable == "x_mm*y_mm");
}

TEST_CASE("an effect is proved at one target too, by blocks of readings") {
  const Diagnosis found = diagnosis_of("one_target");
  CHECK(found.verdict == Verdict::missing_effect);
  const std::vector<Candidate> named = named_in(found);
  CHECK(to_text(only(named).effect) == "thermal_drift:Z:EZ");
  CHECK(parameter(named[0], "um_per_degC") == Approx(6.0).epsilon(0.01));
}

TEST_CASE("two zeros of lines measured once are likely, with what is not excluded and what would decide") {
  const Diagnosis found = diagnosis_of("two_zeros");
  CHECK(found.verdict == Verdict::likely_effect);
  REQUIRE(found.candidates.size() >= 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const Candidate& candidate = found.candidates[i];
    CHECK(candidate.standing == Standing::likely);
    CHECK_FALSE(candidate.named);
    CHECK(contains(candidate.but, "no line was measured twice"));
    CHECK(contains(candidate.decide, "Measure the same lines again"));
  }
  CHECK(to_text(found.candidates[0].effect) == "offset:Y:EY");
  CHECK(parameter(found.candidates[0], "um") == Approx(-17.0).epsilon(0.05));
  CHECK(to_text(found.candidates[1].effect) == "offset:X:EX");
  CHECK(parameter(found.candidates[1], "um") == Approx(10.0).epsilon(0.05));
  CHECK_MESSAGE(found.headline.starts_with("Probably a shift of "), found.headline);
  CHECK(!contains(found.headline, "no effects of the library"));
  CHECK(found.rms_after_um == Approx(3.8).epsilon(0.1));  // both together leave the noise
  REQUIRE(found.add);
  CHECK(found.add->effects == std::vector<std::string>{"offset:Y:EY", "offset:X:EX"});
  CHECK(found.add->held_out_rms_before_um == Approx(found.rms_um).epsilon(0.05));
  CHECK(found.add->held_out_rms_um == Approx(3.8).epsilon(0.1));
}

TEST_CASE("a model whose wave and curve cancel each other beyond the readings is not adequate") {
  const Diagnosis found = diagnosis_of("wave_against_curve");
  CHECK(found.verdict == Verdict::cannot_tell);
  CHECK_MESSAGE(contains(found.headline, "progressive:X:EX and cyclic:X:EX, which cancel each other"), found.headline);
  CHECK(!contains(found.headline, "adequate"));
}

TEST_CASE("a head that bends is never adequate: repeats show that what is left is no noise") {
  const auto model = read_model("tests/data/made_up/bending_head.toml");
  const auto machine = params::read_machine("tests/data/made_up/head_machine.toml");
  laser::ImportOptions options;
  options.takes_rotary = true;
  const auto readings = must(laser::read_any("tests/data/made_up/bending_head.csv", options));
  REQUIRE(model);
  REQUIRE(machine);
  const auto found = must(diagnose(*model, observations_of(readings.set, *model, machine->machine)));
  CHECK(found.noise.from_repeats);
  CHECK(found.noise.noise_um == Approx(8.0).epsilon(0.25));  // 27 of 75 readings repeat a pose
  CHECK(found.verdict != Verdict::adequate);
  CHECK(!contains(found.headline, "adequate"));
}

TEST_CASE("five targets are enough for a likely curve, with what they cannot tell and what would decide") {
  const Diagnosis found = diagnosis_of("five_targets");
  CHECK(found.verdict == Verdict::likely_effect);
  REQUIRE(!found.candidates.empty());
  const Candidate& curve = found.candidates.front();
  CHECK(to_text(curve.effect) == "progressive:X:EX");
  CHECK(curve.standing == Standing::likely);
  CHECK(contains(curve.but, "errors of single targets"));
  CHECK(contains(curve.decide, "between the present ones"));
}

TEST_CASE("a wave that is read at 100 Hz has its name beside noise that lasts for a tenth of a second") {
  const Diagnosis found = diagnosis_of("scan_with_time");
  CHECK(found.verdict == Verdict::missing_effect);
  const std::vector<Candidate> named = named_in(found);
  REQUIRE_FALSE(named.empty());
  CHECK(to_text(named[0].effect) == "cyclic:X:EX");
  CHECK(parameter(named[0], "period_mm") == Approx(0.25).epsilon(1e-3));
  CHECK(parameter(named[0], "amplitude_um") == Approx(20.6).epsilon(0.01));
  CHECK(found.noise.noise_um == Approx(0.6).epsilon(0.2));
}
