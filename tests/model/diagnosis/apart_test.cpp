// Lines that no effects explain are judged apart: the others are judged as if they had been measured alone.
#include <numbers>

#include "model/diagnosis/check.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// Its period grows along the travel: no effect of the library.
double chirp(const Reading& r) {
  const double u = p(r, Axis::Z) / 1000.0;
  return 12.0 * std::sin(2.0 * std::numbers::pi * (u + 7.0 * u * u));
}

/// A line along X in Z, one along Z in Z: both are of the sense EZ.
struct TwoLines {
  Model model = straight(Axis::X, Sense::EZ);
  laser::MeasurementSet alone, together;

  explicit TwoLines(const Truth& truth, unsigned seed = 1, const Truth& other = chirp) {
    measure(alone, {.axis = Axis::X, .sense = Sense::EZ, .step_mm = 40.0, .targets = 24}, kNoise_um, truth, seed);
    together = alone;
    measure(together, {.axis = Axis::Z, .sense = Sense::EZ, .step_mm = 24.0, .targets = 41}, kNoise_um, other,
            seed + 100);
    for (const EffectInstance& one : straight(Axis::Z, Sense::EZ).effects) model.effects.push_back(one);
  }
};

std::vector<std::string> names_in_answer(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const Candidate& one : diagnosis.candidates)
    if (one.in_answer()) names.push_back(fmt::format("{} {}", name_of(one.standing), place_text(one.effect)));
  return names;
}

}  // namespace

TEST_CASE("a shape of one line that is in no library hides no cause on another line") {
  const std::vector<std::pair<std::string, Truth>> causes{
      {"backlash", [](const Reading& r) { return 0.2 * d(r); }},
      {"wave of the pitch", [](const Reading& r) { return 0.3 * std::sin(2.0 * std::numbers::pi * p(r) / 10.0); }},
      {"wave beside a lost motion",
       [](const Reading& r) { return 0.3 * std::sin(2.0 * std::numbers::pi * p(r) / 90.0) + 0.25 * d(r); }},
      {"step", [](const Reading& r) { return p(r) > 430.0 ? 1.2 : 0.0; }},
      {"curve", [](const Reading& r) { return 0.8 * std::sin(std::numbers::pi * p(r) / 700.0); }}};
  for (const auto& one : causes) {
    CAPTURE(one.first);
    const TwoLines lines(one.second);
    const Diagnosis alone = diagnosed(straight(Axis::X, Sense::EZ), lines.alone);
    const Diagnosis together = diagnosed(lines.model, lines.together);
    CAPTURE(alone.headline);
    CAPTURE(together.headline);
    REQUIRE_FALSE(names_in_answer(alone).empty());
    CHECK(names_in_answer(together) == names_in_answer(alone));
    CHECK(together.verdict == Verdict::unexplained_structure);
    CHECK(together.apart == std::vector<std::string>{"Z:EZ"});
    CHECK(contains(together.headline, "EZ along Z: this line is judged apart from the others"));
  }
}

TEST_CASE("where all lines are explained, or no other line shows a cause, none is judged apart") {
  const TwoLines both([](const Reading& r) { return 0.3 * d(r); }, 2, [](const Reading& r) { return 0.4 * d(r); });
  const Diagnosis explained = diagnosed(both.model, both.together);
  CHECK(explained.verdict == Verdict::missing_effect);
  CHECK(explained.apart.empty());
  const TwoLines one(nothing, 3);
  const Diagnosis structure = diagnosed(one.model, one.together);
  CHECK(structure.verdict == Verdict::unexplained_structure);
  CHECK(names_in_answer(structure).empty());
  CHECK(structure.apart.empty());
}

TEST_CASE("the check recomputes the evidence on the readings of which it is") {
  const TwoLines lines([](const Reading& r) { return 0.2 * d(r); }, 4);
  const Observations data = observations_of(lines.together, lines.model, mill());
  const Diagnosis found = diagnose(lines.model, data).value();
  REQUIRE(found.apart.size() == 1);
  Claim claim{found.observations, found.rms_um, found.rms_after_um, found.candidates_tried, false,
              found.own_terms,    found.apart,  found.candidates};
  CHECK(checked(lines.model, data, claim).value().holds());
  claim.apart.clear();
  CHECK_FALSE(checked(lines.model, data, claim).value().holds());
  claim.apart = found.apart;
  claim.candidates.front().apart = "Y:EY";
  const Check elsewhere = checked(lines.model, data, claim).value();
  REQUIRE(elsewhere.objections.size() == 1);
  CHECK(contains(elsewhere.objections.front(), "is judged on Y:EY, which is not among the lines judged apart"));
}
