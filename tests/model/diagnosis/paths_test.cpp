// Causes found on circles and diagonals, alone and beside lines.
#include "model/fit/compare.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/regression/candidates.hpp"
#include "tests/model/support/made_paths.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

laser::MeasurementSet circle_of(const MachineErrors& errors, const CircleMade& made = {}) {
  laser::MeasurementSet set = set_of_circle(made_circle(errors, made));
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  return set;
}

/// By the model that is started with.
Diagnosis of_new_model(const laser::MeasurementSet& set) {
  Model model;
  const Observations data = observations_of(set, model, mill());
  model.effects = usual_effects(data);
  return diagnose(model, data).value();
}

std::string first_named(const Diagnosis& diagnosis) {
  REQUIRE_FALSE(diagnosis.candidates.empty());
  REQUIRE(diagnosis.candidates.front().named);
  return to_text(diagnosis.candidates.front().effect);
}

double value_named(const Diagnosis& diagnosis, std::string_view name) {
  for (const ParameterEstimate& one : diagnosis.candidates.front().parameters)
    if (one.name == name) return one.value;
  return 0.0;
}

}  // namespace

TEST_CASE("a circle of a healthy machine leaves noise, and its new model holds nothing") {
  const laser::MeasurementSet set = circle_of([](const PathPlace&) { return Vector3{}; });
  CHECK(usual_effects(observations_of(set, Model{}, mill())).empty());
  const Diagnosis diagnosis = of_new_model(set);
  CHECK(diagnosis.verdict == Verdict::adequate);
  CHECK(diagnosis.observations == 720);
  CHECK(diagnosis.noise.noise_um == Approx(0.2).epsilon(0.1));
}

TEST_CASE("lost motion of 2 um is named on a circle, with its size") {
  const Diagnosis diagnosis = of_new_model(circle_of([](const PathPlace& at) {
    return Vector3{0.0, 1.0 * at.motion[1], 0.0};
  }));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "backlash:Y:EY");
  CHECK(value_named(diagnosis, "um") == Approx(2.0).epsilon(0.05));
}

namespace {

/// What friction leaves of Y in a circle of 100 mm at 2000 mm/min: the slide stands for 70 ms, `size_um` behind at the
/// end of that, then a loop of 26 /s pulls it up, with a pole of 100 /s beside it; 1.08 of that behind at most. Lost
/// motion comes when it moves.
double held_by_friction_um(const PathPlace& at, double size_um, double lost_um = 0.0) {
  constexpr double kStands_s = 0.07, kSlow_s = 0.038, kFast_s = 0.010;
  const double travelled = 1.0 + at.motion[1] * (at.position_mm[1] - 300.0) / 100.0;
  const double since_s = 100.0 * std::acos(std::clamp(1.0 - travelled, -1.0, 1.0)) / (2000.0 / 60.0);
  const double free_s = since_s - kStands_s;
  const double fast = -(2.0 / kStands_s + 1.0 / kSlow_s) / (1.0 / kFast_s - 1.0 / kSlow_s);  // goes on as it did
  const double left = free_s < 0.0 ? std::pow(since_s / kStands_s, 2)
                                   : (1.0 - fast) * std::exp(-free_s / kSlow_s) + fast * std::exp(-free_s / kFast_s);
  return at.motion[1] * ((free_s < 0.0 ? -0.5 : 0.5) * lost_um - size_um * left);
}

}  // namespace

TEST_CASE("friction of an axis is named on a circle, with how far and how long it holds the axis back") {
  const CircleMade made{.readings = 360, .noise_um = 0.5};
  const Diagnosis diagnosis = of_new_model(circle_of(
      [](const PathPlace& at) {
        return Vector3{0.0, held_by_friction_um(at, 12.0), 0.0};
      },
      made));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "friction:Y:EY");
  CHECK(value_named(diagnosis, "c_um") == Approx(13.0).epsilon(0.1));
  CHECK(value_named(diagnosis, "stands_ms") == Approx(70.0).epsilon(0.15));
  CHECK(std::count_if(diagnosis.candidates.begin(), diagnosis.candidates.end(),
                      [](const Candidate& one) { return one.named; }) == 1);
}

TEST_CASE("lost motion that comes when friction lets the axis go is named beside friction, and no spike") {
  const CircleMade made{.readings = 720, .noise_um = 0.3};
  for (const double size_um : {2.0, 12.0}) {
    const Diagnosis diagnosis = of_new_model(circle_of(
        [&](const PathPlace& at) {
          return Vector3{0.0, held_by_friction_um(at, size_um, 5.0), 0.0};
        },
        made));
    CHECK(diagnosis.verdict == Verdict::missing_effect);
    std::vector<std::string> named;
    for (const Candidate& one : diagnosis.candidates)
      if (one.named) named.push_back(to_text(one.effect));
    std::sort(named.begin(), named.end());
    CHECK(named == std::vector<std::string>{"backlash:Y:EY", "friction:Y:EY"});
  }
}

TEST_CASE("a spike that dies away from the reversal on is not told as friction") {
  const CircleMade made{.readings = 360, .noise_um = 0.3};
  const Diagnosis diagnosis = of_new_model(circle_of(
      [](const PathPlace& at) {
        const double travelled_mm = 100.0 + at.motion[1] * (at.position_mm[1] - 300.0);
        return Vector3{0.0, 6.0 * at.motion[1] * std::exp(-travelled_mm / 0.5), 0.0};
      },
      made));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "reversal_spike:Y:EY");
}

TEST_CASE("squareness is named on a circle, with its sign") {
  const Diagnosis diagnosis = of_new_model(circle_of([](const PathPlace& at) {
    return Vector3{-0.020 * at.position_mm[1], 0.0, 0.0};
  }));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "squareness:Y:C0Y");
  CHECK(value_named(diagnosis, "um_per_m") == Approx(20.0).epsilon(0.05));
}

TEST_CASE("unlike scales are a group on a circle: one longer is the other shorter") {
  const Diagnosis diagnosis = of_new_model(circle_of([](const PathPlace& at) {
    return Vector3{0.015 * at.position_mm[0], 0.0, 0.0};
  }));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "scale:X:EX");
  const auto& alike = diagnosis.candidates.front().indistinguishable_from;
  CHECK(alike == std::vector<std::string>{"scale:Y:EY"});  // no misaligned laser: no line was measured
  CHECK(std::ranges::any_of(diagnosis.notes,
                            [](const std::string& note) { return contains(note, "on a circle their difference"); }));
  CHECK_MESSAGE(contains(diagnosis.headline, " of -15 um/m (scale:Y:EY, "), diagnosis.headline);  // with its size
}

TEST_CASE("a line keeps its effect and the circle adds the one that only it shows") {
  const auto lost_um = [](int motion) { return 0.8 * motion; };
  Plan plan;
  laser::MeasurementSet set =
      measured(plan, 0.2, [&](const Reading& r) { return lost_um(static_cast<int>(r.approach)); });
  for (Reading& reading : set.readings) reading.time_s.reset();
  for (Reading& reading : circle_of([&](const PathPlace& at) {
                            return Vector3{lost_um(at.motion[0]) - 0.020 * at.position_mm[1], 0.0, 0.0};
                          }).readings)
    set.readings.push_back(reading);
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  Model model;
  const Observations data = observations_of(set, model, mill());
  model.effects = usual_effects(data);
  REQUIRE(model.effects.size() == 3);
  CHECK(to_text(model.effects.back()) == "backlash:X:EX");
  const Diagnosis diagnosis = diagnose(model, data).value();
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "squareness:Y:C0Y");
  const Fit fit = model::fit(model, data).value();
  CHECK(fit.effects.back().readings == data.size());
  CHECK(fit.effects.back().parameters.front().value == Approx(1.6).epsilon(0.1));
  const Comparison comparison = compare(fit, data);
  CHECK(comparison.directions.front().path.empty());
  CHECK(comparison.directions.back().path == "circle XY");
  CHECK(comparison.directions.back().axes == "XY");
}

TEST_CASE("squareness of two axes on four body diagonals is named, or told as one of a group") {
  const Diagnosis diagnosis = of_new_model(made_diagonals(
      [](const PathPlace& at) {
        return Vector3{-0.030 * at.position_mm[1], 0.0, 0.0};
      },
      0.3));
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  CHECK(first_named(diagnosis) == "squareness:Y:C0Y");
  CHECK(value_named(diagnosis, "um_per_m") == Approx(30.0).epsilon(0.1));
}

TEST_CASE("readings of diagonals alone let no line be planned, and it says so") {
  Model model;
  const Observations data =
      observations_of(made_diagonals([](const PathPlace&) { return Vector3{}; }, 0.3), model, mill());
  const Diagnosis diagnosis = diagnose(model, data).value();
  const NextMeasurement next = next_measurement(model, data, diagnosis);
  CHECK(next.proposals.empty());
  CHECK(contains(only(next.notes), "measure a line along each axis"));
}

TEST_CASE("an angle that lines show is a candidate beside a single diagonal too") {
  laser::MeasurementSet lines;
  for (const double z : {0.0, 300.0}) measure(lines, {.parked_mm = {0.0, 0.0, z}}, 0.3, nothing);
  laser::MeasurementSet set = made_diagonals([](const PathPlace&) { return Vector3{}; }, 0.3);
  set.readings.resize(66);  // of three runs both ways
  set.readings.insert(set.readings.end(), lines.readings.begin(), lines.readings.end());
  const auto candidates = candidate_instances(observations_of(set, Model{}, mill()));
  const auto has = [&](const char* name) {
    return std::ranges::any_of(candidates, [&](const auto& one) { return to_text(one) == name; });
  };
  CHECK(has("angular:X:EBX"));        // by its lever along Z
  CHECK_FALSE(has("angular:X:ECX"));  // on both lines without a lever
}
