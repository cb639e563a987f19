#include "model/planning/next_measurement.hpp"

#include <numbers>

#include "base/moved_targets.hpp"
#include "model/planning/questions.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// A line at one feed that shows a backlash, and what is proposed after it.
struct AfterBacklash {
  Observations data;
  NextMeasurement next;
};
AfterBacklash after_backlash(bool even_targets) {
  auto set = session(
      {}, [](const Reading& r) { return 1.0 * d(r); }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  if (even_targets)
    for (Reading& r : set.readings) r.position_mm[0] = 25.0 * std::round(r.position_mm[0] / 25.0);
  Observations data = observations_of(set, straight(), mill());
  const auto found = must(diagnose(straight(), data));
  NextMeasurement next = next_measurement(straight(), data, found);
  REQUIRE_FALSE(next.proposals.empty());
  return {std::move(data), std::move(next)};
}

}  // namespace

TEST_CASE("a polarity of the map and a gain of minus one are the same: reported, not measured") {
  Model model = straight();
  model.map = wavy_map();
  auto set = measured({}, kNoise_um,
                      [&](const Reading& r) { return -2.0 * laser::compensation_at(model.map->tables[0], p(r)); });
  const Observations data = observations_of(set, model, mill());
  auto found = must(diagnose(model, data));
  std::erase_if(found.candidates,
                [](const Candidate& c) { return c.effect.id != map_polarity && c.effect.id != map_gain; });
  const NextMeasurement next = next_measurement(model, data, found);
  CHECK(next.rivals.size() >= 2);
  CHECK(next.proposals.empty());
  check_holds(only(next.notes), {"contribute equally"});
}

TEST_CASE("proposals stay inside the travel with their overrun, or inside what was measured") {
  auto set = session(
      {}, [](const Reading& r) { return 1.0 * d(r); }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  const Model model = straight();
  for (const bool with_machine : {true, false}) {
    const Observations data = observations_of(set, model, with_machine ? std::optional(mill()) : std::nullopt);
    const auto found = must(diagnose(model, data));
    const NextMeasurement next = next_measurement(model, data, found);
    REQUIRE_FALSE(next.proposals.empty());
    double least = 0.0, greatest = 1000.0;
    if (!with_machine) {
      const auto ends = std::minmax_element(set.readings.begin(), set.readings.end(),
                                            [](const auto& a, const auto& b) { return p(a) < p(b); });
      least = p(*ends.first);
      greatest = p(*ends.second);
    }
    for (const MeasurementProposal& proposal : next.proposals) {
      CHECK(proposal.targets_mm.front() - proposal.overrun_mm >= least - 1e-9);
      CHECK(proposal.targets_mm.back() + proposal.overrun_mm <= greatest + 1e-9);
      CHECK(proposal.first_run == 4);
    }
  }
}

TEST_CASE("three readings, no machine, no times, no approach: an answer without a proposal beyond what was measured") {
  auto set = measured({.targets = 3, .runs = 1, .both_ways = false}, kNoise_um, nothing);
  for (auto& r : set.readings) {
    r.time_s.reset();
    r.sensors_degC.clear();
    r.approach = Approach::unknown;
  }
  const Model model = straight();
  const Observations data = observations_of(set, model, std::nullopt);
  const auto found = must(diagnose(model, data));
  const NextMeasurement next = next_measurement(model, data, found);
  CHECK_FALSE(next.notes.empty());
  for (const MeasurementProposal& proposal : next.proposals)
    for (const double target : proposal.targets_mm) {
      CHECK(target >= p(set.readings.front()));
      CHECK(target <= p(set.readings.back()));
    }
  CHECK_FALSE(next_measurement(model, Observations{}, Diagnosis{}).notes.empty());
}

TEST_CASE("a model with too few readings says what it could not have seen, and what would show it") {
  const Plan plan{.step_mm = 190.0, .targets = 6, .runs = 1, .both_ways = false};
  auto set = session(
      plan, [](const Reading& r) { return 9.0 * p(r) / 1000.0; }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  const Model model = straight();
  const Observations data = observations_of(set, model, mill());
  const auto found = must(diagnose(model, data));
  REQUIRE(found.verdict == Verdict::cannot_tell);
  const NextMeasurement next = next_measurement(model, data, found);
  CHECK(next.rivals.size() >= 2);
  REQUIRE_FALSE(next.proposals.empty());
  CHECK(next.proposals.front().separation_sigma >= 3.0);
}

TEST_CASE(
    "after readings at one target the first proposal is the line over the travel; without a travel a note says so") {
  auto set = measured({}, kNoise_um, nothing);
  const double target_mm = p(set.readings.front());
  std::erase_if(set.readings, [&](const Reading& r) { return p(r) != target_mm; });
  Model model;
  model.effects = {effect(offset, Axis::X, Sense::EX)};
  for (const bool with_machine : {true, false}) {
    const Observations data = observations_of(set, model, with_machine ? std::optional(mill()) : std::nullopt);
    const NextMeasurement next = next_measurement(model, data, must(diagnose(model, data)));
    if (!with_machine) {
      CHECK(std::ranges::any_of(next.notes, [](const auto& note) { return contains(note, "are at one target"); }));
      continue;
    }
    REQUIRE_FALSE(next.proposals.empty());
    const MeasurementProposal& first = next.proposals.front();
    CHECK(first.targets_mm.size() >= 5);
    CHECK(first.targets_mm.back() - first.targets_mm.front() > 900.0);
    CHECK(contains(first.sentence, "Measure X positions over the travel: 7 targets"));
    CHECK(contains(first.tells, "errors that depend on position"));
  }
}

TEST_CASE("an adequate model with many readings asks for nothing") {
  auto set = measured({}, kNoise_um, [](const Reading& r) { return 9.0 * p(r) / 1000.0; });
  for (auto& r : set.readings) {
    r.time_s.reset();
    r.sensors_degC.clear();
  }
  params::Machine one = mill("TX");
  one.axes[1].reset();
  one.axes[2].reset();
  const Model model = straight();
  const Observations data = observations_of(set, model, one);
  const auto found = must(diagnose(model, data));
  REQUIRE(found.verdict == Verdict::adequate);
  const NextMeasurement next = next_measurement(model, data, found);
  REQUIRE_FALSE(next.notes.empty());
  CAPTURE(next.notes.front());
  const auto names = [&](const char* name) {
    return std::find(next.rivals.begin(), next.rivals.end(), name) != next.rivals.end();
  };
  CHECK(names("cosine:X:EX"));  // beside a scale it is never seen
  CHECK_FALSE(names("backlash:X:EX"));
}

TEST_CASE("a proposal says what it tells, how surely and how long it takes, then what to do") {
  const NextMeasurement next = after_backlash(true).next;
  for (const MeasurementProposal& one : next.proposals) {
    CAPTURE(one.tells);
    CAPTURE(one.sentence);
    CHECK(contains(one.tells, " sigma, "));
    CHECK(contains(one.tells, std::to_string(std::lround(one.minutes)) + " min including set-up"));
    CHECK(one.sentence.starts_with("Measure X positions "));
    CHECK(contains(one.sentence, "off equal steps"));
    for (std::size_t i = 1; i + 1 < one.targets_mm.size(); ++i)
      CHECK(10.0 * one.targets_mm[i] == Approx(std::round(10.0 * one.targets_mm[i])));
  }
}

TEST_CASE("where one cause is proved and nothing else fits, nothing is in doubt; a tie is in doubt") {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::missing_effect;
  Candidate proved;
  proved.effect = effect(backlash, Axis::X, Sense::EX);
  proved.named = true;
  proved.e_value = 1e6;
  diagnosis.candidates = {proved};
  CHECK(nothing_in_doubt(diagnosis));
  diagnosis.candidates[0].rivals = {effect(servo_lag, Axis::X, Sense::EX)};
  CHECK_FALSE(nothing_in_doubt(diagnosis));
  diagnosis.candidates[0].set = {{"backlash:X:EX", 1.0, "backlash:X:EX"}};  // as good a fit, but improbable
  CHECK(nothing_in_doubt(diagnosis));
  diagnosis.candidates[0] = proved;
  diagnosis.candidates[0].parameters_set["period_mm"] = {8.0, 16.0};
  CHECK_FALSE(nothing_in_doubt(diagnosis));
  diagnosis.candidates[0] = proved;
  diagnosis.candidates[0].e_value = 20.0;
  CHECK_FALSE(nothing_in_doubt(diagnosis));
  diagnosis.candidates[0] = proved;
  diagnosis.verdict = Verdict::adequate;
  CHECK_FALSE(nothing_in_doubt(diagnosis));
}

TEST_CASE("after a proof, compensation is advised only for a cause that the unit can compensate") {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::missing_effect;
  Candidate proved;
  proved.named = true;
  proved.e_value = 1e6;
  const auto advice = [&](const EffectInstance& cause) {
    proved.effect = cause;
    diagnosis.candidates = {proved};
    const NextMeasurement next = planned_next(straight(), Observations{}, diagnosis);
    REQUIRE(next.notes.size() == 1);
    CHECK(next.notes[0] == diagnosis.candidates[0].next_measurement);
    return next.notes[0];
  };
  CHECK(contains(advice(effect(backlash, Axis::X, Sense::EX)), "compensate, and repeat the same measurement"));
  const std::string cosine_advice = advice(effect(cosine, Axis::X, Sense::EX));
  CHECK_FALSE(contains(cosine_advice, "compensate, and measure"));
  CHECK(contains(cosine_advice, "cannot compensate it (an error of the measurement: align the beam)"));
}

TEST_CASE("what an answer says of the next measurement is what is proposed first, or that nothing is in doubt") {
  auto set = session(
      {}, [](const Reading& r) { return 1.0 * d(r); }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  const Model model = straight();
  const Observations data = observations_of(set, model, mill());
  auto found = must(diagnose(model, data));
  REQUIRE_FALSE(found.candidates.front().rivals.empty());
  const NextMeasurement next = planned_next(model, data, found);
  REQUIRE_FALSE(next.proposals.empty());
  CHECK(found.candidates.front().next_measurement == next.proposals.front().sentence);
  Candidate& proved = found.candidates.front();
  proved.rivals.clear();
  proved.parameters_set.clear();
  proved.e_value = 1e6;
  const NextMeasurement settled = planned_next(model, data, found);
  CHECK(settled.proposals.empty());
  CHECK(found.candidates.front().next_measurement == only(settled.notes));
}

TEST_CASE(
    "a run is proposed for the periods that even targets cannot distinguish, also where the overrun moves the ends") {
  auto set = measured({}, kNoise_um, [](const Reading&) { return 0.0; });
  for (Reading& r : set.readings) {
    r.position_mm[0] = 25.0 * std::round(p(r) / 25.0);
    r.error += 5.0 * std::sin(2.0 * std::numbers::pi * p(r) / 170.0);
  }
  const Observations data = observations_of(set, straight(), mill());
  auto found = must(diagnose(straight(), data));
  REQUIRE(found.verdict == Verdict::missing_effect);
  CHECK_MESSAGE(contains(found.headline, "Periods shorter than 50 mm along X look like longer ones"), found.headline);
  const Candidate& wave = found.candidates.front();
  CHECK(wave.parameters_set.at("period_mm").front() == wave.parameters.front().value);
  const NextMeasurement next = planned_next(straight(), data, found);
  REQUIRE(next.rivals.size() == 3);
  CHECK(next.rivals.front() == "cyclic:X:EX at 170");
  REQUIRE_FALSE(next.proposals.empty());
  CHECK(next.proposals.front().separation_sigma >= kSeparates);
  CHECK_FALSE(even_step_mm(next.proposals.front().targets_mm));
  CHECK(found.candidates.front().next_measurement == next.proposals.front().sentence);
}

TEST_CASE("alternatives that the model keeps are undecided, and the run that separates them is proposed") {
  auto set = session(
      {}, [](const Reading& r) { return 1.0 * d(r); }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  model.effects.back().tied_with = "servo_lag:X:EX";
  const Observations data = observations_of(set, model, mill());
  auto found = must(diagnose(model, data));
  REQUIRE(found.verdict == Verdict::adequate);
  CHECK_MESSAGE(
      contains(found.headline, " not distinguish causes listed in the model: backlash:X:EX or servo_lag:X:EX."),
      found.headline);
  const NextMeasurement next = planned_next(model, data, found);
  CHECK(next.rivals == std::vector<std::string>{"backlash:X:EX", "servo_lag:X:EX"});
  REQUIRE_FALSE(next.proposals.empty());
  CHECK(next.proposals.front().separation_sigma >= kSeparates);
}

TEST_CASE("proposed targets lie off equal steps where the present ones do not") {
  const NextMeasurement next = after_backlash(true).next;
  for (const MeasurementProposal& proposal : next.proposals) {
    CAPTURE(proposal.condition);
    CHECK(!even_step_mm(proposal.targets_mm));
    CHECK(std::is_sorted(proposal.targets_mm.begin(), proposal.targets_mm.end()));
  }
}

TEST_CASE("proposed targets are not whole screw pitches apart where the present ones are, in uneven steps too") {
  auto set = session(
      {}, [](const Reading& r) { return 1.0 * d(r); }, [](Reading& r) { r.feed_mm_min = 2000.0; });
  for (Reading& r : set.readings) r.position_mm[0] = 10.0 * std::round(r.position_mm[0] / 10.0);
  const Observations data = observations_of(set, straight(), mill());
  REQUIRE(mill().axes[0]->screw_pitch_mm == 10.0);
  const NextMeasurement next = next_measurement(straight(), data, must(diagnose(straight(), data)));
  REQUIRE_FALSE(next.proposals.empty());
  for (const MeasurementProposal& one : next.proposals)
    CHECK(std::ranges::any_of(one.targets_mm, [&](double target_mm) {
      return std::abs(std::remainder(target_mm - one.targets_mm.front(), 10.0)) > 0.5;
    }));
}

TEST_CASE("structure that no effect explains: the run that shows on which variable it depends") {
  const auto set = measured({.runs = 5}, kNoise_um, [](const Reading& r) { return r.run == 3 ? 2.0 : 0.0; });
  const Model model = straight();
  const Observations data = observations_of(set, model, mill());
  const auto found = must(diagnose(model, data));
  REQUIRE(found.verdict == Verdict::unexplained_structure);
  const NextMeasurement next = next_measurement(model, data, found);
  CHECK(std::find(next.rivals.begin(), next.rivals.end(), "run") != next.rivals.end());
  CHECK_FALSE(next.notes.empty());
  REQUIRE(next.proposals.size() == 1);  // what a bad run does next time nothing foretells: once more as it is
  CHECK(contains(next.proposals.front().tells, "repeats"));
  CHECK(next.proposals.front().bidirectional);
  CHECK(next.proposals.front().targets_mm.size() == 41);
}

TEST_CASE("a target list is a plan to check") {
  auto [data, next] = after_backlash(false);
  const auto two_feeds = std::find_if(next.proposals.begin(), next.proposals.end(),
                                      [](const auto& each) { return each.second_feed_mm_min.has_value(); });
  REQUIRE(two_feeds != next.proposals.end());
  two_feeds->bidirectional = true;
  const auto plan = must(laser::parse_measurement_set(target_list(*two_feeds), "targets.csv"));
  Model both = straight();
  both.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  both.effects.push_back(effect(servo_lag, Axis::X, Sense::EX));
  CHECK(must(check_plan(both, observations_of(plan, both, mill()), kNoise_um)).determines);
  CHECK_FALSE(must(check_plan(both, data, kNoise_um)).determines);
}

namespace {

/// Two formulas that are the same in these data: one by the position, one by a column of the file's own.
NextMeasurement next_of_two_formulas(const std::function<double(double p_mm)>& column) {
  Model model = straight();
  for (const char* formula : {"a*(x_mm/1000)^2", "a*u^2"}) {
    EffectInstance one{.id = effect_named("user"),
                       .name = formula,
                       .formulas = {{Sense::EX, formula}},
                       .user = {{"a", "", {}, {}, {}, {}}}};
    model.candidates.push_back(one);
  }
  auto set = measured({}, kNoise_um, [](const Reading& r) { return 40.0 * std::pow(p(r) / 1000.0, 2); });
  for (Reading& r : set.readings) r.extras["u"] = column(p(r));
  const Observations data = observations_of(set, model, mill());
  Diagnosis found;
  found.verdict = Verdict::missing_effect;
  for (const EffectInstance& one : model.candidates) {
    Candidate candidate;
    candidate.effect = one;
    candidate.effect.fitted["a"] = 40.0;
    found.candidates.push_back(candidate);
  }
  found.candidates[0].named = true;
  found.candidates[0].indistinguishable_from = {to_text(model.candidates[1])};
  return next_measurement(model, data, found);
}

}  // namespace

TEST_CASE("two formulas that are the same function are not separated by a column that follows the position") {
  const NextMeasurement next = next_of_two_formulas([](double p_mm) { return p_mm / 1000.0; });
  CHECK(next.proposals.empty());
  REQUIRE(next.notes.size() == 2);
  CHECK(contains(next.notes[0], "column u, which follows x_mm in these data"));
  CHECK(contains(next.notes[1], "contribute equally"));
}

TEST_CASE("a formula with a column of which a new run says nothing is not weighed, and named") {
  const NextMeasurement next =
      next_of_two_formulas([](double p_mm) { return p_mm / 1000.0 + 0.01 * std::sin(p_mm / 90.0); });
  CHECK(next.rivals.size() == 2);
  CHECK(next.proposals.empty());
  CHECK(contains(only(next.notes), "user:a*u^2 reads column u: its value in a new run is not known"));
}

TEST_CASE("formulas with a free period are weighed at the period that was found") {
  Model model = straight();
  auto set = measured({}, kNoise_um, [](const Reading& r) { return 2.0 * std::sin(p(r) / 11.0); });
  Diagnosis found;
  found.verdict = Verdict::missing_effect;
  for (const double start : {60.0, 80.0}) {  // two names and two starts for one function
    Candidate candidate;
    candidate.effect.id = effect_named("user");
    candidate.effect.name = "from " + std::to_string(static_cast<int>(start));
    candidate.effect.formulas = {{Sense::EX, "a*sin(2*pi*x_mm/P)"}};
    candidate.effect.user = {{"a", "", {}, {}, {}, {}}, {"P", "mm", {}, start, {}, {}}};
    candidate.effect.fitted = {{"a", 2.0}, {"P", 22.0 * 3.14159265358979}};
    found.candidates.push_back(candidate);
  }
  found.candidates[0].named = true;
  found.candidates[0].indistinguishable_from = {to_text(found.candidates[1].effect)};
  const NextMeasurement next = next_measurement(model, observations_of(set, model, mill()), found);
  CHECK(next.proposals.empty());
  CHECK(contains(only(next.notes), "contribute equally"));
}

TEST_CASE(
    "which sensor a drift follows late: no idle change of feed is proposed, and the wait for steady temperatures "
    "stated") {
  auto set = session(
      {.runs = 4}, [](const Reading& r) { return 1.5 * (r.sensors_degC.at("t_spindle_degC") - 20.0); },
      [](Reading& r) {
        r.feed_mm_min = 300.0;  // a faster run would save minutes
        r.sensors_degC["t_spindle_degC"] = 20.0 + *r.time_s / 600.0;
        r.sensors_degC["t_air_degC"] = 20.0 + *r.time_s / 900.0;
      });
  const Observations data = observations_of(set, straight(), mill());
  Diagnosis found;
  found.verdict = Verdict::missing_effect;
  for (const auto& [sensor, lag_s] : {std::pair{"t_spindle_degC", 0.0}, std::pair{"t_air_degC", 800.0}}) {
    Candidate candidate;
    candidate.effect = effect(thermal_drift, Axis::X, Sense::EX);
    candidate.effect.sensor = sensor;
    if (lag_s > 0.0) candidate.effect.fitted = {{"lag_s", lag_s}};
    candidate.named = found.candidates.empty();
    found.candidates.push_back(candidate);
  }
  found.candidates[0].standing = Standing::proved;
  found.candidates[0].rivals = {found.candidates[1].effect};
  found.candidates[0].indistinguishable_from = {to_text(found.candidates[1].effect)};
  const NextMeasurement next = next_measurement(straight(), data, found);
  REQUIRE_FALSE(next.proposals.empty());
  for (const MeasurementProposal& one : next.proposals) {
    CHECK_FALSE(contains(one.condition, "feed"));
    CHECK_FALSE(one.short_overrun);
    CHECK(contains(one.sentence, "keep the machine in one state for 40 min"));
  }
}
