// What is told of what is left: each class by made data that show it, and withheld where they cannot.
#include "model/diagnosis/left.hpp"

#include <numbers>

#include "model/diagnosis/ladder.hpp"
#include "model/regression/candidates.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr Plan kLine{.from_mm = -400.0, .step_mm = 40.0, .targets = 21, .runs = 5};
constexpr double kLoads_kg[] = {200.0, 0.0, 400.0, 100.0, 300.0};
double load_of(const Reading& r) { return kLoads_kg[(r.run - 1) % 5]; }
double loaded(const Reading& r) { return (load_of(r) - 200.0) / 100.0; }
/// Another value at every target.
double rough(double place) {
  const double shuffled = 43758.5453 * std::sin(12.9898 * std::round(place / 40.0) + 4.1);
  return 5.0 * (shuffled - std::floor(shuffled) - 0.5);
}
double about_middle(const Reading& r) { return p(r) / 400.0; }

struct Told {
  laser::MeasurementSet set;
  Model model;
  Diagnosis diagnosis;

  /// @param more  effects beside offset, slope and backlash
  explicit Told(laser::MeasurementSet readings, const std::vector<EffectInstance>& more = {})
      : set(std::move(readings)) {
    model.effects = usual_effects(data());
    model.effects.insert(model.effects.end(), more.begin(), more.end());
    diagnosis = diagnose(model, data(), {.noise_replicates = 60}).value();
  }
  explicit Told(const Truth& truth, const Plan& plan = kLine)
      : Told(session(plan, truth, [](Reading& r) { r.load_kg = load_of(r); })) {}
  [[nodiscard]] Observations data() const { return observations_of(set, model, mill()); }
  /// "" where it is withheld or not asked.
  [[nodiscard]] std::string of(const std::string& property) const {
    for (const LeftProperty& one : diagnosis.left)
      if (one.property == property) return one.is;
    return "";
  }
  [[nodiscard]] std::string measure(const std::string& property) const {
    for (const LeftProperty& one : diagnosis.left)
      if (one.property == property) return one.measure;
    return "";
  }
};

EffectInstance own(const std::string& formula, double k) {
  EffectInstance effect{.id = effect_named("user"), .name = "own"};
  effect.formulas = {{Sense::EX, formula}};
  effect.user = {{"k", "um", k, {}, {}, {}}};
  return effect;
}
double fast(const Reading& r) { return std::sin(p(r) * p(r) / 700.0); }

}  // namespace

TEST_CASE("what is left is the same in both directions, opposite in them, or in one only") {
  CHECK(Told([](const Reading& r) { return rough(p(r)); }).of("direction") == "even");
  CHECK(Told([](const Reading& r) { return d(r) * rough(p(r)); }).of("direction") == "odd");
  CHECK(Told([](const Reading& r) { return d(r) > 0.0 ? 2.0 * rough(p(r)) : 0.0; }).of("direction") == "forward");
  const Told mixed([](const Reading& r) { return rough(p(r)) + d(r) * rough(p(r) + 4000.0); });
  CHECK_FALSE(mixed.diagnosis.left.empty());
  CHECK(mixed.of("direction").empty());
  const Told one_way([](const Reading& r) { return rough(p(r)); },
                     {.from_mm = -400.0, .step_mm = 40.0, .targets = 21, .runs = 5, .both_ways = false});
  CHECK(one_way.of("direction").empty());
  CHECK(contains(one_way.measure("direction"), "both directions"));
}

TEST_CASE("what is left is odd or even about the middle, or the same everywhere") {
  CHECK(Told([](const Reading& r) { return 1.5 * loaded(r) * std::sin(2.0 * about_middle(r)); }).of("position") ==
        "odd");
  CHECK(Told([](const Reading& r) { return 1.5 * loaded(r) * std::cos(3.0 * about_middle(r)); }).of("position") ==
        "even");
  CHECK(Told([](const Reading& r) { return loaded(r) * d(r); }).of("position") == "constant");
  CHECK(Told([](const Reading& r) { return rough(p(r)); }).of("position").empty());
}

TEST_CASE("what is left stays with the machine or moves with the workpiece where set-ups differ") {
  const auto in_set_ups = [](bool moves) {
    auto set = measured({.step_mm = 40.0, .targets = 15, .runs = 4}, 0.0, nothing);
    std::mt19937_64 random(3);
    NormalDraws noise(0.0, kNoise_um);
    for (Reading& r : set.readings) {
      const double place = 40.0 * std::round(p(r) / 40.0), begin = 120.0 * (r.run - 1);
      r.position_mm[0] = place + begin;
      r.extras["set_up"] = r.run;
      r.error = rough(moves ? place : place + begin) + noise(random);
    }
    return Told(set);
  };
  CHECK(in_set_ups(true).of("frame") == "workpiece");
  CHECK(in_set_ups(false).of("frame") == "machine");
  const Told once([](const Reading& r) { return rough(p(r)); });
  CHECK(once.of("frame").empty());
  CHECK(contains(once.measure("frame"), "with the optics set up elsewhere along the axis"));
}

TEST_CASE("what is left changes with a column, or with none") {
  CHECK(Told([](const Reading& r) { return loaded(r) * d(r); }).of("growth") == "load_kg");
  CHECK(Told([](const Reading& r) { return (*r.time_s / 1500.0 - 1.0) * rough(p(r)); }).of("growth") == "time_s");
  const Told same([](const Reading& r) { return d(r) * rough(p(r)); });
  CHECK(same.of("growth") == "none");
  CHECK(same.of("session") == "none");
}

TEST_CASE("a column that changes next to nothing is not told, though its smooth functions have fewer free sizes") {
  constexpr Plan kLong{.from_mm = -2000.0, .step_mm = 50.0, .targets = 81};
  const Told same(session(
      kLong, [](const Reading& r) { return 5.0 * std::sin(14.0 * std::pow(p(r) / 2000.0, 2)); }, [](Reading&) {}));
  CHECK(same.of("direction") == "even");
  CHECK(same.of("growth") == "none");
  CHECK(same.of("session") == "none");
}

TEST_CASE("columns that change together are not told apart, and the answer says so") {
  const Told alike(session(
      kLine, [](const Reading& r) { return 1.5 * loaded(r) * d(r); },
      [](Reading& r) {
        r.load_kg = load_of(r);
        r.humidity_pct = 40.0 + 0.05 * load_of(r);
      }));
  CHECK(alike.of("growth").empty());
  CHECK(alike.of("direction") == "odd");
  CHECK(alike.of("excitation") == "poor");
  CHECK(contains(alike.measure("growth"), "humidity_pct"));
}

TEST_CASE("runs of their own zero are told, two runs alone are not") {
  const auto zeros = [](const Reading& r) { return r.run == 1 || r.run == 4 ? 1.5 : r.run == 2 ? -1.0 : 0.0; };
  const auto no_load = [](Reading&) {};
  CHECK(Told(session(kLine, zeros, no_load)).of("session") == "run");
  CHECK(Told(session({.from_mm = -400.0, .step_mm = 40.0, .targets = 21, .runs = 2}, zeros, no_load)).of("session") !=
        "none");
}

TEST_CASE("a sensor whose clock is off is told with the delay") {
  const auto degC = [](double time_s) { return 20.0 + 2.0 * std::sin(time_s / 300.0); };
  EffectInstance drift = effect(effects::thermal_drift, Axis::X, Sense::EX);
  drift.sensor = "t_bed_degC";
  const auto delayed = [&](double delay_s) {
    return Told(session(
                    kLine, [&](const Reading& r) { return 4.0 * (degC(*r.time_s - delay_s) - 20.0); },
                    [&](Reading& r) { r.sensors_degC["t_bed_degC"] = degC(*r.time_s); }),
                {drift});
  };
  const Told late = delayed(60.0);
  CHECK(late.of("clock") == "t_bed_degC");
  CHECK(delayed(0.0).diagnosis.left.empty());
}

TEST_CASE("a term of the model with the wrong sign or in another unit is told") {
  const auto held = [](double truth) {
    return Told(session(
                    kLine, [&](const Reading& r) { return truth * fast(r); }, [](Reading&) {}),
                {own("k * sin(x_mm * x_mm / 700)", 3.0)});
  };
  CHECK(held(-3.0).of("sign") == "user:own");
  CHECK(held(3.0 * 25.4).of("arithmetic") == "25.4");
  CHECK(held(3.0 * 1.7).of("sign").empty());
  CHECK(held(3.0 * 1.7).of("arithmetic").empty());
  CHECK(held(3.0).diagnosis.left.empty());
}

TEST_CASE("readings in steps so coarse that their rounding is left are told") {
  auto coarse = measured(kLine, 0.02, [](const Reading& r) { return 9.3 * about_middle(r); });
  for (Reading& r : coarse.readings) r.error = std::round(r.error / 2.0) * 2.0;
  CHECK(Told(coarse).of("instrument") == "steps");
}

TEST_CASE("nothing is told of noise") {
  for (unsigned seed = 1; seed <= 15; ++seed)
    CHECK(Told(measured(kLine, kNoise_um, nothing, seed)).diagnosis.left.empty());
}

TEST_CASE("of mixtures only what makes nearly all of them is told") {
  for (unsigned seed = 1; seed <= 24; ++seed) {
    std::mt19937_64 random(seed);
    const auto part = [&] { return static_cast<double>(random() % 1000) / 999.0; };
    const double angle = 0.5 * std::numbers::pi * part(), changing = part() > 0.5 ? 1.0 : 0.0;
    const Told told([&](const Reading& r) {
      const double place = p(r) + 40.0 * seed;
      return (changing > 0.0 ? loaded(r) : 1.4) *
             (std::cos(angle) * rough(place) + std::sin(angle) * d(r) * rough(place + 4000.0));
    });
    if (told.diagnosis.left.empty()) continue;
    CAPTURE(seed);
    const std::string direction = told.of("direction"), growth = told.of("growth");
    if (direction == "even") CHECK(std::cos(angle) * std::cos(angle) > 0.85);
    if (direction == "odd") CHECK(std::sin(angle) * std::sin(angle) > 0.85);
    CHECK(direction != "forward");
    CHECK(direction != "reverse");
    CHECK((growth.empty() || growth == (changing > 0.0 ? "load_kg" : "none")));
  }
}

TEST_CASE("the formula of what is left is added, lowers the error, and is taken back") {
  const Told told([](const Reading& r) { return 1.5 * loaded(r) * d(r) * about_middle(r); });
  REQUIRE(told.diagnosis.formula);
  const ProposedFormula& formula = *told.diagnosis.formula;
  CHECK(formula.effect.user.size() == 1);
  CHECK(contains(formula.effect.formulas.front().text, "approach * ((load_kg - 200)"));
  CHECK(formula.held_out_rms_um < 0.5 * formula.held_out_rms_before_um);
  const Added added = add_effect(told.model, told.data(), request_of(formula.effect), "data").value();
  CHECK(added.rms_after_um == Approx(formula.rms_after_um).epsilon(0.02));
  CHECK(added.rms_after_um < 0.5 * added.rms_before_um);
  const Model read = parse_model(to_toml(added.model), "model", {}).value();
  CHECK(read.effects.back().formulas == formula.effect.formulas);
  CHECK(undo(added.model)->effects.size() == told.model.effects.size());
}
