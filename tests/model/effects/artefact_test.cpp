// Square and straight edge: what changes its sign when they are turned over is theirs.
#include "model/planning/next_measurement.hpp"
#include "model/regression/needs.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// EX along Y against a square: two runs as it is, and, if so asked, as many turned over with another zero.
laser::MeasurementSet against_square(bool both_sides, double angle_um_per_m, double form_um, double machine_um_per_m,
                                     double zero_um = 0.0) {
  laser::MeasurementSet set;
  for (const double side : both_sides ? std::vector<double>{1.0, -1.0} : std::vector<double>{1.0}) {
    const std::size_t before = set.readings.size();
    measure(
        set, {.axis = Axis::Y, .sense = Sense::EX, .runs = 2}, kNoise_um,
        [&](const Reading& r) {
          const double u = p(r, Axis::Y) / 1000.0;
          return 3.0 + machine_um_per_m * u + side * (zero_um + angle_um_per_m * u + form_um * 4.0 * u * (1.0 - u));
        },
        side > 0.0 ? 1 : 2);
    for (std::size_t k = before; k < set.readings.size(); ++k) {
      set.readings[k].extras["reversed"] = side > 0.0 ? 0.0 : 1.0;
      if (side < 0.0) set.readings[k].run += 2;
    }
  }
  return set;
}

const Candidate* named(const Diagnosis& diagnosis, const std::string& name) {
  for (const Candidate& candidate : diagnosis.candidates)
    if (candidate.named && to_text(candidate.effect) == name) return &candidate;
  return nullptr;
}

}  // namespace

TEST_CASE("a square that was turned over shows its own angle error beside the machine's") {
  const Diagnosis diagnosis = diagnosed(straight(Axis::Y, Sense::EX), against_square(true, 8.0, 0.0, 20.0));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(count_named(diagnosis) == 1);
  const Candidate* angle = named(diagnosis, "artefact_angle:Y:EX");
  REQUIRE(angle != nullptr);
  CHECK(angle->parameters.at(0).value == Approx(8.0).epsilon(0.05));
  CHECK_MESSAGE(diagnosis.headline.starts_with("Found: an error of 8"), diagnosis.headline);
}

TEST_CASE("that the zero moved when the square was turned over is no harm") {
  const Diagnosis diagnosis = diagnosed(straight(Axis::Y, Sense::EX), against_square(true, 8.0, 0.0, 20.0, 1.5));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  const Candidate* angle = named(diagnosis, "artefact_angle:Y:EX");
  REQUIRE(angle != nullptr);
  CHECK(angle->parameters.at(0).value == Approx(8.0).epsilon(0.05));
  CHECK(angle->parameters.at(1).value == Approx(1.5).epsilon(0.1));
}

TEST_CASE("a bent straight edge is no bent way") {
  const Diagnosis diagnosis = diagnosed(straight(Axis::Y, Sense::EX), against_square(true, 0.0, 5.0, 20.0));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(count_named(diagnosis) == 1);
  CHECK(named(diagnosis, "artefact_form:Y:EX") != nullptr);
}

TEST_CASE("a bent way stays the machine's when the edge was turned over") {
  laser::MeasurementSet set = against_square(true, 0.0, 0.0, 0.0);
  for (Reading& r : set.readings) {
    const double u = p(r, Axis::Y) / 1000.0;
    r.error += 5.0 * 4.0 * u * (1.0 - u);
  }
  const Diagnosis diagnosis = diagnosed(straight(Axis::Y, Sense::EX), set);
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  REQUIRE(count_named(diagnosis) == 1);
  CHECK(diagnosis.candidates.front().effect.id->id.substr(0, 8) != "artefact");
}

TEST_CASE("in one position the artefact cannot be told from the machine; turning it over is proposed") {
  const auto set = against_square(false, 8.0, 0.0, 20.0);
  const Model model = straight(Axis::Y, Sense::EX);
  const Observations data = observations_of(set, model, mill());
  auto diagnosis = must(diagnose(model, data));
  CHECK(count_named(diagnosis) == 0);
  const NextMeasurement next = planned_next(model, data, diagnosis);
  CHECK(std::find(next.rivals.begin(), next.rivals.end(), "artefact_angle:Y:EX") != next.rivals.end());
  const auto turned = std::find_if(next.proposals.begin(), next.proposals.end(),
                                   [](const MeasurementProposal& one) { return one.reversed == true; });
  REQUIRE(turned != next.proposals.end());
  CHECK(turned->condition == "with the square or straight edge turned over");
}

TEST_CASE("without the column a note names what cannot be tried, for readings across an axis only") {
  const auto notes_of = [](Axis axis) {
    const auto notes = untried_effects(observations_of(measured({.axis = axis}, kNoise_um, nothing), Model{}, mill()));
    return std::count(notes.begin(), notes.end(),
                      "artefact_angle and artefact_form cannot be tried: they need the column \"reversed\"");
  };
  CHECK(notes_of(Axis::Y) == 1);
  CHECK(notes_of(Axis::X) == 0);
}
