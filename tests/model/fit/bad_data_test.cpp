// Data as they should not be: too few, constant, missing, spoiled, absurd. A clear answer each time, never a crash,
// never a confident wrong name.
#include "model/fit/compare.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using enum Verdict;
using Set = laser::MeasurementSet;

namespace {

double ramp(const Reading& r) { return 3.0 + 9.0 * p(r) / 1000.0; }
double lost_motion_of_two(const Reading& r) { return d(r); }

Plan plan(int targets, int runs, bool both_ways = true) {
  return {.targets = targets, .runs = runs, .both_ways = both_ways};
}

/// Every number of the answer is one.
void check_finite(const Diagnosis& found) {
  CHECK(std::isfinite(found.rms_um));
  CHECK(std::isfinite(found.rms_after_um));
  CHECK(std::isfinite(found.noise.noise_um));
  for (const Candidate& c : found.candidates) {
    CHECK(std::isfinite(c.rms_after_um));
    CHECK((c.false_naming >= 0.0 && c.false_naming <= 1.0));
    for (const auto& rms : {c.held_out_rms_um, c.held_out_rms_before_um}) CHECK((!rms || std::isfinite(*rms)));
    for (const ParameterEstimate& parameter : c.parameters) CHECK(std::isfinite(parameter.value));
    CHECK(!contains(c.because, "nan"));
  }
}

Diagnosis answer(const Model& model, const Set& set) {
  auto result = must(diagnose(model, observations_of(set, model, mill())));
  check_finite(result);
  return result;
}

void check_nothing_named(const Diagnosis& found) {
  CHECK(found.verdict != missing_effect);
  for (const Candidate& c : found.candidates) CHECK_FALSE(c.named);
}

/// Whatever is named stands for a true cause.
void check_only(const Diagnosis& found, const std::vector<std::string>& true_places) {
  for (const Candidate& c : found.candidates) {
    if (!c.in_answer()) continue;
    const bool right =
        std::any_of(true_places.begin(), true_places.end(), [&](const auto& t) { return stands_for(c, t); });
    CHECK_MESSAGE(right, "named ", to_text(c.effect));
  }
}

void check_found(const Diagnosis& found, const std::string& true_place) {
  CHECK((found.verdict == missing_effect || found.verdict == likely_effect));
  CHECK((!found.candidates.empty() && found.candidates.front().in_answer()));
  check_only(found, {true_place});
}

using Made = std::function<Set(unsigned seed)>;

void noise_alone(const Made& made, unsigned seeds = 3, const Model& model = straight()) {
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Diagnosis found = answer(model, made(seed));
    CHECK_MESSAGE(found.verdict == adequate, (found.notes.empty() ? "" : found.notes.back()));
  }
}
void is_found(const std::string& place, const Made& made, unsigned seeds = 3, const Model& model = straight()) {
  for (unsigned seed = 1; seed <= seeds; ++seed) check_found(answer(model, made(seed)), place);
}

Set with_each(Set set, const std::function<void(Reading&)>& change) {
  for (Reading& r : set.readings) change(r);
  return set;
}

/// About one reading in `every` off by `size_um`, either way.
Set spoiled(Set set, double size_um, unsigned seed, unsigned every = 100) {
  std::mt19937_64 random(seed + 1000);
  for (Reading& r : set.readings)
    if (random() % every == 0) r.error += (random() % 2 == 0 ? 1.0 : -1.0) * size_um;
  return set;
}

Set numbered(Set set) {
  int row = 0;
  for (Reading& r : set.readings) r.row = ++row;
  return set;
}

Set rounded(Set set, double step_um) {
  for (Reading& r : set.readings) r.error = std::round(r.error / step_um) * step_um;
  return set;
}

}  // namespace

TEST_CASE("a set without readings is refused with a message") {
  CHECK(contains(must_fail(diagnose(straight(), observations_of({}, straight(), mill()))).message, "no readings"));
  CHECK_FALSE(fit(straight(), observations_of({}, straight(), mill())));
}

TEST_CASE("one to six readings name no cause") {
  for (int n = 1; n <= 6; ++n)
    for (unsigned seed = 1; seed <= 4; ++seed) {
      check_nothing_named(answer(straight(), measured(plan(n, 1, false), kNoise_um, ramp, seed)));
      check_nothing_named(answer(straight(), measured(plan(n, 1), kNoise_um, nothing, seed)));
    }
}

TEST_CASE("a backlash in four readings is not claimed to be anything else") {
  for (int n = 2; n <= 5; ++n)
    for (unsigned seed = 1; seed <= 4; ++seed)
      check_only(answer(straight(), measured(plan(n, 1), kNoise_um, lost_motion_of_two, seed)), {"backlash:X:EX"});
}

TEST_CASE("without repeats noise is still noise, and a backlash still a backlash") {
  noise_alone([](unsigned seed) { return measured(plan(41, 1), kNoise_um, ramp, seed); });
  noise_alone([](unsigned seed) { return measured(plan(41, 1, false), kNoise_um, ramp, seed); });
  is_found("backlash:X:EX", [](unsigned seed) { return measured(plan(41, 1), kNoise_um, lost_motion_of_two, seed); });
}

TEST_CASE("a step in one run in one direction is a step or nothing") {
  for (unsigned seed = 1; seed <= 4; ++seed)
    check_only(answer(straight(), measured(
                                      plan(41, 1, false), kNoise_um,
                                      [](const Reading& r) { return p(r) > 430.0 ? 2.5 : 0.0; }, seed)),
               {"step:X:EX"});
}

TEST_CASE("columns that never change explain nothing and change nothing") {
  const auto constant = [](Set set) {
    return with_each(std::move(set), [](Reading& r) {
      r.feed_mm_min = 1000.0;
      r.load_kg = 50.0;
      r.pressure_hPa = 1013.25;
      r.humidity_pct = 50.0;
      r.travel_since_reversal_mm = 10.0;
      r.sensors_degC = {{"t_material_degC", 20.0}, {"t_spindle_degC", 31.0}};
      r.time_s = 5.0;
      r.extras["k"] = 1.0;
    });
  };
  noise_alone([&](unsigned seed) { return constant(measured(plan(31, 3), kNoise_um, ramp, seed)); });
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Diagnosis found = answer(straight(), constant(measured(plan(31, 3), kNoise_um, lost_motion_of_two, seed)));
    check_found(found, "backlash:X:EX");
    CHECK(stands_for(found.candidates.front(), "servo_lag:X:EX"));  // at one feed nobody can tell
  }
}

TEST_CASE("with all temperatures equal an expansion is one group with a scale") {
  Model model;
  model.effects = {effect(offset, Axis::X, Sense::EX)};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Set set = with_each(measured(plan(31, 3), kNoise_um, ramp, seed),
                              [](Reading& r) { r.sensors_degC["t_material_degC"] = 23.0; });
    const Diagnosis found = answer(model, set);
    check_found(found, "scale:X:EX");
    CHECK(stands_for(found.candidates.front(), "thermal_scale:X:EX"));
  }
  noise_alone([](unsigned seed) {
    return with_each(measured(plan(31, 3), kNoise_um, ramp, seed),
                     [](Reading& r) { r.sensors_degC["t_material_degC"] = 23.0; });
  });
}

TEST_CASE("cells of a sensor that are missing in half the rows do not make noise a cause") {
  noise_alone([](unsigned seed) {
    int k = 0;
    return with_each(measured(plan(31, 3), kNoise_um, ramp, seed), [&](Reading& r) {
      if (++k % 2 == 0) r.sensors_degC.clear();
      if (k % 3 == 0) r.time_s.reset();
    });
  });
}

TEST_CASE("a model whose terms are the same twice still finds what is missing, and says which terms collide") {
  Model model = straight();
  model.effects.push_back(model.effects[1]);
  model.effects.push_back(model.effects[0]);
  model.effects.push_back(effect(thermal_scale, Axis::X, Sense::EX));
  const auto at_one_temperature = [](Set set) {
    return with_each(std::move(set), [](Reading& r) { r.sensors_degC["t_material_degC"] = 22.0; });
  };
  noise_alone([&](unsigned seed) { return at_one_temperature(measured(plan(31, 3), kNoise_um, ramp, seed)); }, 2,
              model);
  is_found(
      "backlash:X:EX",
      [&](unsigned seed) { return at_one_temperature(measured(plan(31, 3), kNoise_um, lost_motion_of_two, seed)); }, 2,
      model);
  const Set set = at_one_temperature(measured(plan(31, 3), kNoise_um, ramp, 1));
  const auto fitted = must(fit(model, observations_of(set, model, mill())));
  CHECK_FALSE(fitted.undetermined.empty());
  CHECK(std::isfinite(fitted.rms_um));
}

TEST_CASE("a model of another axis leaves the measured axis to be found") {
  const Model model = straight(Axis::Y, Sense::EY);
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const auto found =
        must(diagnose(model, observations_of(measured(plan(31, 3), kNoise_um, ramp, seed), model, mill())));
    CHECK(found.verdict == missing_effect);
    check_only(found, {"offset:X:EX", "scale:X:EX"});
  }
}

TEST_CASE("one outlier in a hundred readings is listed and does not change the verdict") {
  for (const double size_um : {8.0, 100.0})
    for (unsigned seed = 1; seed <= 2; ++seed) {
      const Set noise = spoiled(measured({}, kNoise_um, ramp, seed), size_um, seed);
      const Diagnosis blank = answer(straight(), noise);
      CHECK(blank.verdict == adequate);
      CHECK_FALSE(blank.outliers.empty());
      for (const int row : blank.outliers)
        CHECK(std::abs(noise.readings[static_cast<std::size_t>(row - 1)].error -
                       ramp(noise.readings[static_cast<std::size_t>(row - 1)])) > 3.0 * kNoise_um);
      check_found(answer(straight(), spoiled(measured({}, kNoise_um, lost_motion_of_two, seed), size_um, seed)),
                  "backlash:X:EX");
    }
}

TEST_CASE("one bad run is no effect of the machine") {
  for (const int bad : {1, 2, 3})
    for (const double height_um : {1.0, 5.0}) {
      const Diagnosis found =
          answer(straight(), measured(
                                 {}, kNoise_um, [&](const Reading& r) { return r.run == bad ? height_um : 0.0; },
                                 static_cast<unsigned>(bad)));
      CHECK(found.verdict == unexplained_structure);
      CHECK(
          std::any_of(found.where.begin(), found.where.end(), [](const Dependence& w) { return w.variable == "run"; }));
    }
}

TEST_CASE("a run noisier than the others names nothing") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Set set = measured(plan(31, 4), kNoise_um, ramp, seed);
    std::mt19937_64 random(seed + 500);
    NormalDraws normal;
    for (Reading& r : set.readings)
      if (r.run == 2) r.error += 5.0 * normal(random);
    check_nothing_named(answer(straight(), set));
  }
}

TEST_CASE("readings that are all the same are adequate, without division by zero") {
  for (const double value : {0.0, 5.0, -1e6}) {
    const Diagnosis found = answer(straight(), measured({}, 0.0, [&](const Reading&) { return value; }));
    CHECK(found.verdict == adequate);
    CHECK(found.rms_um < 1e-9 * std::max(1.0, std::abs(value)));
  }
}

TEST_CASE("data without noise get an answer") {
  noise_alone([](unsigned seed) { return measured({}, 0.0, ramp, seed); }, 1);
  noise_alone([](unsigned seed) { return measured(plan(41, 1), 0.0, ramp, seed); }, 1);
  is_found(
      "backlash:X:EX", [](unsigned seed) { return measured({}, 0.0, lost_motion_of_two, seed); }, 1);
}

TEST_CASE("the size of the numbers does not matter") {
  for (const double size : {1e-9, 1e12}) {
    const auto scaled = [&](const Truth& truth, unsigned seed) {
      return with_each(measured(plan(31, 3), kNoise_um, truth, seed), [&](Reading& r) { r.error *= size; });
    };
    noise_alone([&](unsigned seed) { return scaled(ramp, seed); }, 2);
    is_found(
        "backlash:X:EX", [&](unsigned seed) { return scaled(lost_motion_of_two, seed); }, 2);
  }
  noise_alone(
      [](unsigned seed) {
        return with_each(measured(plan(31, 3), kNoise_um, nothing, seed), [](Reading& r) { r.position_mm[0] *= 1e9; });
      },
      2);
}

TEST_CASE("one approach, or none known, names no effect of approach") {
  noise_alone([](unsigned seed) { return measured(plan(41, 3, false), kNoise_um, ramp, seed); });
  is_found(
      "step:X:EX",
      [](unsigned seed) {
        return measured(
            plan(41, 3, false), kNoise_um, [](const Reading& r) { return p(r) > 430.0 ? 2.5 : 0.0; }, seed);
      },
      2);
  for (unsigned seed = 1; seed <= 3; ++seed)
    check_nothing_named(answer(straight(), with_each(measured(plan(41, 3), kNoise_um, lost_motion_of_two, seed),
                                                     [](Reading& r) { r.approach = Approach::unknown; })));
}

TEST_CASE("one or two targets measured many times get an answer") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    check_nothing_named(answer(straight(), measured(plan(1, 20), kNoise_um, nothing, seed)));
    check_nothing_named(answer(straight(), measured(plan(2, 20), kNoise_um, ramp, seed)));
  }
}

TEST_CASE("senses of very unequal noise get an answer") {
  Model model = straight();
  model.effects.push_back(effect(offset, Axis::X, Sense::EY));
  model.effects.push_back(effect(scale, Axis::X, Sense::EY));
  const auto both = [](double fine_um, double coarse_um, const Truth& in_ex, const Truth& in_ey, unsigned seed) {
    Plan fine = plan(31, 3), coarse = plan(31, 3);
    coarse.sense = Sense::EY;
    Set set = measured(fine, fine_um, in_ex, seed);
    measure(set, coarse, coarse_um, in_ey, seed + 100);
    return set;
  };
  noise_alone([&](unsigned seed) { return both(0.1, 20.0, nothing, nothing, seed); }, 2, model);
  noise_alone([&](unsigned seed) { return both(1e-4, 100.0, nothing, nothing, seed); }, 2, model);
  is_found(
      "backlash:X:EY",
      [&](unsigned seed) {
        return both(
            0.1, 20.0, nothing, [](const Reading& r) { return 60.0 * d(r); }, seed);
      },
      2, model);
}

TEST_CASE("readings rounded coarsely: noise stays noise where it is larger than half a step") {
  noise_alone([](unsigned seed) { return rounded(measured({}, 0.5, ramp, seed), 1.0); });
  noise_alone([](unsigned seed) {
    return rounded(measured(
                       {}, 0.1, [](const Reading&) { return 0.2; }, seed),
                   1.0);
  });
}

TEST_CASE("odd clocks, run numbers and sensors get an answer") {
  noise_alone(
      [](unsigned seed) {
        return with_each(measured(plan(31, 3), kNoise_um, ramp, seed), [](Reading& r) { r.time_s = -*r.time_s; });
      },
      2);
  noise_alone(
      [](unsigned seed) {
        return with_each(measured(plan(31, 3), kNoise_um, ramp, seed), [](Reading& r) { r.run *= -1000000; });
      },
      2);
  noise_alone(
      [](unsigned seed) {
        std::mt19937_64 random(seed + 70);
        NormalDraws normal;
        return with_each(measured(plan(31, 3), kNoise_um, ramp, seed),
                         [&](Reading& r) { r.sensors_degC["t_material_degC"] = 1e6 * normal(random); });
      },
      2);
  noise_alone(
      [](unsigned seed) {
        std::mt19937_64 random(seed + 80);
        NormalDraws normal;
        std::vector<double> degC(12, 20.0);
        return with_each(measured(plan(31, 3), kNoise_um, ramp, seed), [&](Reading& r) {
          for (std::size_t s = 0; s < degC.size(); ++s)
            r.sensors_degC["t_s" + std::to_string(s) + "_degC"] = degC[s] += 0.05 * normal(random);
        });
      },
      2);
}

TEST_CASE("noise of other shapes is noise: heavy tails, bounded, growing with position, wandering") {
  const auto with_noise = [](unsigned seed, const std::function<double(std::mt19937_64&, const Reading&)>& noise) {
    std::mt19937_64 random(seed + 40);
    return with_each(measured(plan(31, 3), 0.0, ramp, seed), [&](Reading& r) { r.error += noise(random, r); });
  };
  noise_alone([&](unsigned seed) {
    NormalDraws normal;
    ChiSquaredDraws squares(2.0);
    return with_noise(
        seed, [&](auto& random, const auto&) { return 0.3 * normal(random) / std::sqrt(squares(random) / 2.0); });
  });
  noise_alone([&](unsigned seed) {
    UniformDraws even(-1.0, 1.0);
    return with_noise(seed, [&](auto& random, const auto&) { return even(random); });
  });
  noise_alone([&](unsigned seed) {
    NormalDraws normal;
    return with_noise(seed, [&](auto& random, const auto& r) { return (0.05 + 2.0 * p(r) / 1000.0) * normal(random); });
  });
  noise_alone([&](unsigned seed) {
    NormalDraws normal;
    double turbulence = 0.0;
    return with_noise(seed, [&](auto& random, const auto&) {
      turbulence = 0.7 * turbulence + 0.3 * normal(random);
      return turbulence + 0.1 * normal(random);
    });
  });
}

TEST_CASE("a measurement that ends half way back gets an answer") {
  noise_alone([](unsigned seed) {
    Set set = measured(plan(31, 3), kNoise_um, ramp, seed);
    std::erase_if(set.readings, [](const auto& r) { return r.approach == Approach::reverse && p(r) > 400.0; });
    return numbered(std::move(set));
  });
}

TEST_CASE("wrong names in the data and in the model are refused with their place") {
  const auto data =
      must_fail(laser::parse_measurement_set("axis,sense,reading,x_mm\nQ,EX,1.0,0\nX,EQ,1.0,0\n", "line.csv"));
  CHECK(data.line == 2);
  CHECK(data.also.size() == 1);
  const auto model = must_fail(parse_model(
      "[[effect]]\nid = \"scale\"\naxis = \"Q\"\nsense = \"EX\"\n[[effect]]\nid = \"skale\"\naxis = \"X\"\n",
      "model.toml", "."));
  CHECK(model.line >= 1);
  check_holds(to_text(model), {"Q", "skale"});
}

TEST_CASE("fit and compare answer on every kind of bad data that diagnose answers on") {
  for (const Set& set : {measured(plan(1, 1, false), kNoise_um, ramp), measured(plan(1, 20), kNoise_um, nothing),
                         measured({}, 0.0, nothing), spoiled(measured({}, kNoise_um, ramp), 1e12, 1)}) {
    const Observations data = observations_of(set, straight(), mill());
    const auto fitted = must(fit(straight(), data));
    CHECK(std::isfinite(fitted.rms_um));
    for (const EffectFit& one : fitted.effects)
      for (const ParameterEstimate& parameter : one.parameters) CHECK(std::isfinite(parameter.value));
    const Comparison seen = compare(fitted, data);
    CHECK(std::isfinite(seen.rms_um));
    CHECK(std::isfinite(seen.noise.noise_um));
  }
}
