// Sentences about a diagnosis: what the first line says, and that no sentence contradicts its own numbers; the remark
// on targets at equal steps.
#include "model/diagnosis/words.hpp"

#include "base/moved_targets.hpp"
#include "model/diagnosis/targets.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/model/support/sentences.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

ParameterEstimate estimate_of(std::string name, std::string unit, double value) {
  return {std::move(name), std::move(unit), value, {}, false, false};
}

EffectInstance screw_wave(double period_mm) {
  EffectInstance one = effect(effects::cyclic, Axis::X, Sense::EX);
  one.fitted["period_mm"] = period_mm;
  return one;
}

}  // namespace

TEST_CASE("a finding says cause, size and place; a period that is a pitch of the machine says so") {
  const Observations data = observations_of(measured({}, kNoise_um, nothing), Model{}, mill());
  EffectInstance wave = screw_wave(10.003);
  wave.approach = ApproachMode::forward;
  const std::vector<ParameterEstimate> parameters{estimate_of("period_mm", "mm", 10.003),
                                                  estimate_of("amplitude_um", "um", 6.83)};
  CHECK(finding_text(wave, parameters, data) ==
        "a periodic error of +-6.8 um in X positioning, period 10.00 mm, the pitch of the X screw, only when moving "
        "forward");
  std::vector<ParameterEstimate> known{estimate_of("period_mm", "mm", 9.95), estimate_of("amplitude_um", "um", 6.83)};
  known.front().sigma = 0.004;
  CHECK(finding_text(screw_wave(9.95), known, data) ==
        "a periodic error of +-6.8 um in X positioning, period 9.950 mm (certainly not the pitch of the X screw, 10 mm "
        "by "
        "the machine file: check this)");
  known.front().sigma = 0.02;
  CHECK(contains(finding_text(screw_wave(9.95), known, data), "9.950 mm, the pitch of the X screw"));
  const std::vector<ParameterEstimate> mostly_second{estimate_of("period_mm", "mm", 20.0),
                                                     estimate_of("amplitude_um", "um", 0.6),
                                                     estimate_of("amplitude2_um", "um", 4.1)};
  const std::string finding = finding_text(screw_wave(20.0), mostly_second, data);
  CHECK_MESSAGE(contains(finding, "+-4.1 um in X positioning, period 10.00 mm"), finding);
  CHECK(finding_text(effect(effects::backlash, Axis::X, Sense::EX), {estimate_of("um", "um", -5.17)}, data) ==
        "lost motion of -5.2 um at reversal in X positioning");
}

TEST_CASE("every effect of the library has a finding without holes") {
  const Observations data = observations_of(measured({}, kNoise_um, nothing), Model{}, mill());
  for (const model::EffectDefinition& definition : effect_library()) {
    EffectInstance one = effect(&definition, Axis::X, Sense::EX);
    one.name = "spindle";
    one.sensor = "t_spindle_degC";
    one.sensor2 = "t_bed_degC";
    if (definition.has_lever()) one.code = definition.place == Place::squareness ? Component::C0Y : Component::ECX;
    std::vector<ParameterEstimate> parameters;
    for (const model::ParameterDefinition& parameter : definition.parameters)
      parameters.push_back(estimate_of(std::string(parameter.name), std::string(parameter.unit), 12.34));
    const std::string text = finding_text(one, parameters, data);
    CAPTURE(text);
    CHECK(text.size() > 15);
    for (const char* hole : {"unknown amount", "  ", "{", "}", "nan"}) CHECK_FALSE(contains(text, hole));
  }
}

TEST_CASE("of several balls the finding says which one, and where") {
  EffectInstance ball;
  ball.id = effect_named("ball_on_table");
  ball.rotary = true;
  ball.ball = 2;
  Observations data;
  data.balls_mm = {{0.0, 0.0, 0.0}, {100.0, 50.5, -20.0}};
  check_holds(finding_text(ball, {estimate_of("x_um", "um", 12.0)}, data),
              {"an offset of ball 2 on the table (nominally at X 100, Y 50.5, Z -20 mm) by 12 um"});
  CHECK(ball_text(ball, data) == "ball 2 on the table (nominally at X 100, Y 50.5, Z -20 mm)");
  data.balls_mm.pop_back();
  ball.ball = 1;
  CHECK(ball_text(ball, data).empty());
  check_holds(finding_text(ball, {estimate_of("x_um", "um", 12.0)}, data),
              {"an offset of the ball on the table by 12"});
}

TEST_CASE("a size that the data do not determine is not told as a number") {
  const Observations data = observations_of(measured({}, kNoise_um, nothing), Model{}, mill());
  ParameterEstimate lost = estimate_of("um_per_m", "um/m", 39.0);
  lost.undetermined = true;
  CHECK(finding_text(effect(effects::scale, Axis::X, Sense::EX), {lost}, data) ==
        "a scale error of an undetermined amount in X positioning");
  ParameterEstimate square = estimate_of("k2", "um/m2", 12.0), cube = estimate_of("k3", "um/m3", -3.0);
  cube.sigma = 5.0;
  CHECK(finding_text(effect(effects::sag, Axis::X, Sense::EX), {square, cube}, data) ==
        "a bow in X positioning that grows with the extension as droop does, 12 um/m2");
  ParameterEstimate wave = estimate_of("amplitude_um", "um", 3.0);
  wave.undetermined = true;
  CHECK(finding_text(screw_wave(10.0), {estimate_of("period_mm", "mm", 10.0), wave}, data)
            .starts_with("a periodic error of an undetermined amount in X positioning, period 10.00 mm"));
}

TEST_CASE("an effect is undetermined where its sentence states no size") {
  ParameterEstimate size = estimate_of("c_um", "um", -5.3), length = estimate_of("u0_mm", "mm", 16.8);
  const EffectInstance spike = effect(effects::reversal_spike, Axis::Y, Sense::EY);
  length.sigma = 4.8;
  size.sigma = 2.1;
  CHECK_FALSE(is_undetermined(spike, {length, size}));
  size.sigma = 21.5;
  CHECK(is_undetermined(spike, {length, size}));
  size.sigma.reset();
  CHECK_FALSE(is_undetermined(spike, {length, size}));
  size.undetermined = true;
  CHECK(is_undetermined(spike, {length, size}));
  ParameterEstimate amplitude = estimate_of("amplitude_um", "um", 0.4), phase = estimate_of("phase_rad", "rad", 3.0);
  amplitude.sigma = 0.5;
  phase.sigma = 1.2;
  CHECK(is_undetermined(screw_wave(10.0), {estimate_of("period_mm", "mm", 10.0), amplitude, phase}));
  amplitude.sigma = 0.1;
  CHECK_FALSE(is_undetermined(screw_wave(10.0), {estimate_of("period_mm", "mm", 10.0), amplitude, phase}));
}

TEST_CASE("sizes in readings of a rotation are in um/m, of curves too") {
  const auto bow = [](const laser::Reading& r) { return 12.0 * std::sin(3.14159265358979 * p(r) / 1000.0); };
  const Diagnosis found = diagnosed(straight(Axis::X, Sense::EA), measured({.sense = Sense::EA}, kNoise_um, bow));
  REQUIRE_FALSE(found.candidates.empty());
  for (const Candidate& candidate : found.candidates)
    for (const ParameterEstimate& parameter : candidate.parameters)
      if (parameter.name == "rms_um" || parameter.name == "um" || parameter.name == "height_um")
        CHECK_MESSAGE(parameter.unit == "um/m", to_text(candidate.effect));
  CHECK_MESSAGE(!contains(found.headline, " um "), found.headline);
  for (const Dependence& one : found.where) CHECK_MESSAGE(!contains(one.looks_like, " um "), one.looks_like);
}

TEST_CASE("a bad run is the first thing that is said") {
  auto set = measured({.runs = 4}, kNoise_um, [](const laser::Reading& r) { return r.run == 2 ? 4.0 : 0.0; });
  for (laser::Reading& r : set.readings) r.sensors_degC.clear();
  const Diagnosis found = diagnosed(straight(), set);
  CHECK(found.verdict == Verdict::unexplained_structure);
  CHECK_MESSAGE(found.headline.starts_with("Run 2 lies +3.96 um from the other runs"), found.headline);
}

TEST_CASE("too few readings, or even targets without a pitch, are said in place of adequate") {
  Plan few{.targets = 2, .runs = 1};
  CHECK(contains(diagnosed(straight(), measured(few, kNoise_um, nothing)).headline, "too few to decide"));

  laser::MeasurementSet set = measured({}, kNoise_um, nothing);
  for (laser::Reading& r : set.readings) r.position_mm[0] = 25.0 * std::round(r.position_mm[0] / 25.0);
  const auto found = must(diagnose(straight(), observations_of(set, straight(), std::nullopt)));
  CHECK(found.verdict == Verdict::adequate);
  CHECK_MESSAGE(contains(found.headline, "Periods shorter than 50 mm along X cannot be detected"), found.headline);
  for (laser::Reading& r : set.readings) r.position_mm[0] = 100.0;
  CHECK(contains(diagnosed(straight(), set).headline, "All readings along X are at one target"));
}

TEST_CASE("two causes of which each needs the other are proved together") {
  const Diagnosis found = diagnosed(straight(), measured({}, kNoise_um, [](const laser::Reading& r) {
                                      return 1.5 * d(r) + 4.0 * std::sin(2.0 * 3.14159265358979 * p(r) / 90.0);
                                    }));
  REQUIRE(found.verdict == Verdict::missing_effect);
  check_sentences(found);
}

namespace {

laser::MeasurementSet line_at(const std::vector<double>& targets_mm, Axis axis = Axis::X) {
  laser::MeasurementSet set;
  for (const double target_mm : targets_mm) {
    laser::Reading r{.row = static_cast<int>(set.readings.size()) + 1, .axis = axis};
    r.position_mm[index_of(axis)] = target_mm;
    set.readings.push_back(r);
  }
  return set;
}

const std::vector<double> kEven{0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0};

}  // namespace

TEST_CASE("even targets call for a remark with the periods that they do not show") {
  const auto note = must(even_targets_note(observations_of(line_at(kEven), Model{}, std::nullopt)));
  CHECK(note.find("targets are equally spaced at 50 mm along X (EX): periods shorter than 100 mm cannot be "
                  "distinguished from longer ones") == 0);
  CHECK(!contains(note, "pitch"));
}

TEST_CASE("a pitch of the machine that even targets do not show is named") {
  params::Machine machine = mill();
  REQUIRE(machine.axes[0]);
  machine.axes[0]->screw_pitch_mm = 10.0;
  machine.axes[0]->scale_pitch_mm.reset();
  const auto note = must(even_targets_note(observations_of(line_at(kEven), Model{}, machine)));
  CHECK(contains(note, "longer ones, which hides the screw pitch of 10 mm"));
}

TEST_CASE("moved targets call for no remark, nor even ones that another run moved") {
  CHECK(!even_targets_note(observations_of(line_at(moved_targets(kEven)), Model{}, std::nullopt)));
  auto two_runs = line_at(kEven);
  for (const auto& r : line_at({17.3, 64.9, 121.1}).readings) two_runs.readings.push_back(r);
  CHECK(!even_targets_note(observations_of(two_runs, Model{}, std::nullopt)));
}

TEST_CASE("each axis whose targets are even is named once") {
  auto set = line_at(kEven);
  for (laser::Reading r : line_at({0.0, 20.0, 40.0, 60.0}, Axis::Y).readings)
    for (const Sense sense : {Sense::EX, Sense::EY}) {
      r.sense = sense;
      set.readings.push_back(r);
    }
  check_holds(must(even_targets_note(observations_of(set, Model{}, std::nullopt))),
              {"equally spaced at 50 mm along X (EX)",
               "; targets are equally spaced at 20 mm along Y (EX, EY): periods shorter than 40 mm"});
}

namespace {

/// Four runs both ways over a turn of C at twelve equal steps, in um/m.
Diagnosis turn_of_c(double waves_a_turn) {
  laser::MeasurementSet set =
      measured({.axis = Axis::Z, .sense = Sense::EC, .step_mm = 30.0, .targets = 12, .runs = 4}, kNoise_um, nothing);
  for (laser::Reading& r : set.readings) {
    r.rotary = true;
    r.angle_deg[2] = 30.0 * std::round(p(r, Axis::Z) / 30.0);
    r.position_mm = {};
    r.error += 5.0 * std::sin(waves_a_turn * r.angle_deg[2] * 3.14159265358979 / 180.0);
  }
  Model model;
  model.effects = {effect(effects::offset, Axis::Z, Sense::EC)};
  model.effects.front().rotary = true;
  return must(diagnose(model, observations_of(set, model, std::nullopt)));
}

}  // namespace

TEST_CASE("equal steps of a rotary axis hide waves: an answer without a cause says so") {
  for (const double waves : {0.0, 12.0}) {
    const Diagnosis found = turn_of_c(waves);
    CHECK(found.verdict == Verdict::adequate);
    CHECK(found.headline ==
          "No further effect is detected: the residual of the model is noise. Periods shorter than 60 deg about C "
          "cannot be detected: the targets are equally spaced at 30 deg, where a wave with N periods per turn looks "
          "like one with 12 - N periods, and a wave with 12 periods does not show.");
  }
}

TEST_CASE("one or two waves a turn come first, beside those that equal steps do not distinguish from them") {
  for (const auto& [waves, words] : {std::pair(1.0, "one turn, or 11 or 13 waves"),
                                     {11.0, "one turn, or 11 or 13 waves"},
                                     {10.0, "1/2 turn, or 10 or 14 waves"}}) {
    const Diagnosis found = turn_of_c(waves);
    REQUIRE(found.verdict == Verdict::missing_effect);
    CHECK_MESSAGE(contains(found.headline, std::string(words) + " per turn, which fit equally well"), found.headline);
    CHECK(contains(found.candidates.front().next_measurement, "C again at targets displaced from equal steps"));
  }
}

TEST_CASE("waves of one period in both directions are named as one cause, with both sizes") {
  const Diagnosis found = diagnosed(straight(), measured({}, kNoise_um, [](const laser::Reading& r) {
                                      return 2.0 * d(r) * (1.0 + std::sin(2.0 * 3.14159265358979 * p(r) / 10.0));
                                    }));
  REQUIRE(found.verdict == Verdict::missing_effect);
  check_holds(found.headline,
              {"period 10.00 mm, the pitch of the X screw, only when moving", ", and of +-2.0 um only when",
               "one cause that differs between the directions", "cyclic:X:EX, forward"});
  CHECK_MESSAGE(!contains(found.headline, "cannot distinguish"), found.headline);
}

TEST_CASE("a drift that begins in the last run is named in place of the run") {
  const auto late = [](const laser::Reading& r) { return 0.003 * std::max(0.0, r.time_s.value_or(0.0) - 4200.0); };
  laser::MeasurementSet set = measured({.runs = 5}, kNoise_um, late);
  for (laser::Reading& r : set.readings) r.sensors_degC.clear();
  const Diagnosis found = diagnosed(straight(), set);
  CHECK_MESSAGE(!contains(found.headline, "differs from the other runs"), found.headline);
  CHECK_MESSAGE(found.headline.starts_with("Readings drift by +"), found.headline);
}

TEST_CASE("of a proved drift whose sensor is open every sensor is a rival, and the answer says so") {
  const auto drift = [](const laser::Reading& r) { return 4.0 * std::sin(r.time_s.value_or(0.0) / 700.0); };
  std::size_t open = 0;
  for (const double off : {0.0, 0.02, 0.05, 0.1}) {
    laser::MeasurementSet set = measured({.runs = 5}, kNoise_um, drift);
    std::size_t number = 0;
    for (laser::Reading& r : set.readings) {
      const double degC = 20.0 + std::sin(r.time_s.value_or(0.0) / 700.0);
      const double wrong = off * std::sin(1.7 * static_cast<double>(number++));
      r.sensors_degC = {{"t_bed_degC", degC}, {"t_spindle_degC", degC + wrong}};
    }
    const Diagnosis found = diagnosed(straight(), set);
    REQUIRE_FALSE(found.candidates.empty());
    const Candidate& first = found.candidates.front();
    REQUIRE(first.named);
    REQUIRE(first.effect.id == effects::thermal_drift);
    for (const SetMember& member : first.set)
      CHECK((member.place == place_text(first.effect) || member.name != to_text(first.effect) ||
             std::ranges::any_of(first.rivals,
                                 [&](const EffectInstance& one) { return place_text(one) == member.place; })));
    if (first.open_rivals().empty()) continue;
    ++open;
    check_holds(found.headline, {"The thermal drift is proved, but not which sensor it follows.", ", or with t_"});
    CHECK_MESSAGE(!contains(found.headline, "cannot distinguish"), found.headline);
  }
  CHECK(open > 0);
}

TEST_CASE("effects on which no reading depends are named with what is missing") {
  Model model = straight();
  model.effects.push_back(effect(effects::offset, Axis::X, Sense::EX));
  model.effects.back().line = 99;
  model.effects.push_back(effect(effects::scale, Axis::Y, Sense::EY));
  const Diagnosis found = diagnosed(model, measured({}, kNoise_um, nothing));
  REQUIRE(found.notes.size() > 1);
  CHECK(found.notes[0] == "offset:X:EX:99: acts on none of these readings: EX was measured along X in 1 line");
  CHECK(found.notes[1] == "scale:Y:EY: acts on none of these readings: none is of EY");
}

TEST_CASE("targets that are whole screw pitches apart hide the error of one turn, though their steps are uneven") {
  laser::MeasurementSet set = measured({.step_mm = 60.0, .targets = 15}, kNoise_um, nothing);
  CHECK_FALSE(contains(diagnosed(straight(), set).headline, "whole screw pitches"));
  for (Reading& r : set.readings) r.position_mm[0] = 10.0 * std::round(p(r) / 10.0);
  const std::string headline = diagnosed(straight(), set).headline;
  CHECK_MESSAGE(contains(headline, "All targets along X are whole screw pitches (10 mm) apart"), headline);
}

TEST_CASE("a measured line of which the model has no effect comes first") {
  const auto steep = [](const Reading& r) { return 30.0 + 20.0 * p(r) / 1000.0; };
  laser::MeasurementSet set = measured({.sense = Sense::EY}, kNoise_um, steep);
  const std::string missing = "The model has no effect, not even an offset, of EY along X: `ecs model new`";
  CHECK(diagnosed(straight(), set).headline.starts_with(missing));
  measure(set, {}, kNoise_um, steep);
  CHECK(diagnosed(straight(), set).headline.starts_with(missing));
  CHECK_FALSE(contains(diagnosed(straight(), measured({}, kNoise_um, steep)).headline, "not even an offset"));
}

TEST_CASE("readings in um and in um/m have a residual and a noise each") {
  laser::MeasurementSet set = measured({}, kNoise_um, nothing);
  measure(set, {.sense = Sense::EB}, 10.0 * kNoise_um, nothing, 2);
  Model model = straight();
  model.effects.push_back(effect(effects::offset, Axis::X, Sense::EB));
  const Diagnosis found = diagnosed(model, set);
  CHECK(found.noise.unit == kBothUnits);
  CHECK(found.rms_by_unit.um == Approx(kNoise_um).epsilon(0.1));
  CHECK(found.rms_by_unit.um_per_m == Approx(10.0 * kNoise_um).epsilon(0.1));
  CHECK(found.noise.by_unit.um == Approx(kNoise_um).epsilon(0.15));
  CHECK(found.noise.by_unit.um_per_m == Approx(10.0 * kNoise_um).epsilon(0.15));
}

TEST_CASE("of a pitch and five times the pitch, which even targets do not distinguish, the pitch comes first") {
  laser::MeasurementSet set = measured({}, kNoise_um, nothing);
  for (laser::Reading& r : set.readings) {
    r.position_mm[0] = 25.0 * std::round(r.position_mm[0] / 25.0);
    r.error += 4.0 * std::sin(2.0 * 3.14159265358979 * p(r) / 10.0 + 0.8);
  }
  const Diagnosis found = diagnosed(straight(), set);
  CHECK_MESSAGE(contains(found.headline, "10.00 mm, the pitch of the X screw, or a different period"), found.headline);
}
