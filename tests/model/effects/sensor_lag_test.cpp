// Effects of temperature that follow their sensor late: what they follow, model files, fits, and when a lag is claimed.
#include <cmath>

#include "model/data/sensor_history.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/fit.hpp"
#include "model/fit/model_file.hpp"
#include "model/regression/candidates.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

constexpr const char* kSpindle = "t_spindle_degC";

/// A spindle that turns for 40 minutes and cools down.
double spindle_degC(double t_s) {
  constexpr double kOff_s = 2400.0, kTau_s = 1000.0, kRise_degC = 8.0;
  const double warm = -kRise_degC * std::expm1(-std::min(t_s, kOff_s) / kTau_s);
  return 20.0 + (t_s < kOff_s ? warm : warm * std::exp(-(t_s - kOff_s) / kTau_s));
}

/// Four runs of a line in a little more than an hour. @param noise_degC  of the sensor
laser::MeasurementSet hour_of_spindle(unsigned seed = 1, double noise_degC = 0.0) {
  auto set = measured({.targets = 41, .runs = 4}, kNoise_um, nothing, seed);
  std::mt19937_64 random(seed + 1000);
  NormalDraws noise(0.0, 1.0);
  for (Reading& r : set.readings) r.sensors_degC = {{kSpindle, spindle_degC(*r.time_s) + noise_degC * noise(random)}};
  return set;
}

/// What follows the spindle with this time constant, with the same sensor, read without its noise.
std::vector<double> following(laser::MeasurementSet set, double lag_s) {
  for (Reading& r : set.readings) r.sensors_degC[kSpindle] = spindle_degC(*r.time_s);
  const Observations data = observations_of(set, Model{}, mill());
  const std::vector<double> late = followed_degC(data, kSpindle, lag_s);
  std::vector<double> by_row(late.size());
  for (std::size_t k = 0; k < late.size(); ++k) by_row[data.file_order[k]] = late[k];
  return by_row;
}

/// Readings that drift with the spindle.
laser::MeasurementSet drifting(double lag_s, unsigned seed = 1, double noise_degC = 0.0, double um_per_degC = 2.0) {
  auto set = hour_of_spindle(seed, noise_degC);
  const std::vector<double> late = following(set, lag_s);
  for (std::size_t k = 0; k < late.size(); ++k) set.readings[k].error += um_per_degC * (late[k] - late.front());
  return set;
}

EffectInstance drift_with_spindle() {
  EffectInstance drift = effect(thermal_drift, Axis::X, Sense::EX);
  drift.sensor = kSpindle;
  return drift;
}

const Candidate* named_drift(const Diagnosis& diagnosis) {
  for (const Candidate& one : diagnosis.candidates)
    if (one.in_answer() && one.effect.id == thermal_drift) return &one;
  return nullptr;
}

std::optional<double> lag_of(const Candidate& candidate) {
  for (const ParameterEstimate& one : candidate.parameters)
    if (one.name == kLag) return one.value;
  return std::nullopt;
}

}  // namespace

TEST_CASE("what follows a sensor late is a low-pass that begins in a steady state, at any times of the readings") {
  constexpr double kLag_s = 300.0, kRamp_degC_per_s = 0.01;
  laser::MeasurementSet set;
  for (const double t : {50.0, 51.0, 90.0, 400.0, 410.0, 2000.0, 9000.0}) {
    Reading r{.row = static_cast<int>(set.readings.size()) + 1, .axis = Axis::X, .sense = Sense::EX};
    r.time_s = t;
    r.sensors_degC[kSpindle] = 20.0 + kRamp_degC_per_s * (t - 50.0);
    set.readings.push_back(r);
  }
  const Observations data = observations_of(set, Model{}, mill());
  const std::vector<double> late = followed_degC(data, kSpindle, kLag_s);
  for (std::size_t k = 0; k < late.size(); ++k) {
    const double t = data.time_s[k];
    CHECK(late[k] == Approx(20.0 + kRamp_degC_per_s * (t + kLag_s * std::expm1(-t / kLag_s))));
  }
  CHECK(followed_degC(data, kSpindle, 0.0) == data.sensors_degC.at(kSpindle));
}

TEST_CASE("a part of the readings follows what was measured between them too") {
  const Observations all = observations_of(drifting(600.0), Model{}, mill());
  std::vector<std::size_t> late_half;
  for (std::size_t k = all.size() / 2; k < all.size(); k += 3) late_half.push_back(k);
  const std::vector<double> of_all = followed_degC(all, kSpindle, 600.0);
  const std::vector<double> of_part = followed_degC(subset(all, late_half), kSpindle, 600.0);
  for (std::size_t i = 0; i < late_half.size(); ++i) CHECK(of_part[i] == of_all[late_half[i]]);
}

TEST_CASE("runs that all begin at the same time are followed each by its own clock, from its own first reading") {
  auto set = hour_of_spindle();
  std::map<int, double> begin_s;
  for (const Reading& r : set.readings) begin_s.try_emplace(r.run, *r.time_s);
  for (Reading& r : set.readings) {
    *r.time_s -= begin_s.at(r.run);
    r.sensors_degC[kSpindle] = 20.0 + 5.0 * r.run;  // steady in each run
  }
  const Observations data = observations_of(set, Model{}, mill());
  CHECK(followed_degC(data, kSpindle, 900.0) == data.sensors_degC.at(kSpindle));
}

TEST_CASE("runs that overlap in time have clocks of their own: another run's temperature is no noise of the sensor") {
  auto set = hour_of_spindle();
  std::map<int, double> begin_s;
  for (const Reading& r : set.readings) begin_s.try_emplace(r.run, *r.time_s);
  for (Reading& r : set.readings) {
    *r.time_s += 7.0 * r.run - begin_s.at(r.run);  // readings left out: no run begins at 0
    r.sensors_degC[kSpindle] = 20.0 + 5.0 * r.run + 0.001 * *r.time_s;
  }
  const Observations data = observations_of(set, Model{}, mill());
  CHECK(followed_degC(data, kSpindle, 0.0) == data.sensors_degC.at(kSpindle));
  const std::vector<double> late = followed_degC(data, kSpindle, 900.0);
  for (std::size_t k = 0; k < data.size(); ++k) CHECK(std::abs(late[k] - data.sensors_degC.at(kSpindle)[k]) < 1.0);
}

namespace {

/// Two days of two runs each, the clock from 0 on each; the second day is 5 degC warmer.
/// @param late_s  by which the clock of the second day is read later
laser::MeasurementSet two_days(double late_s) {
  auto set = hour_of_spindle();
  const auto second_day = std::ranges::find(set.readings, 3, &Reading::run);
  const double begin_s = *second_day->time_s - *set.readings.front().time_s;
  for (Reading& r : set.readings) {
    const bool second = r.run > 2;
    if (second) r.time_s = *r.time_s + late_s - begin_s;
    r.sensors_degC[kSpindle] = (second ? 25.0 : 20.0) + 0.001 * *r.time_s;
  }
  return set;
}

}  // namespace

TEST_CASE("where the clock restarts each day, the readings of a day follow one another and no others") {
  for (const double late_s : {0.0, 7.0}) {
    const Observations data = observations_of(two_days(late_s), Model{}, mill());
    CHECK(std::ranges::is_sorted(data.run));
    for (std::size_t k = 0; k < data.size(); ++k) CHECK(data.history->clock[k] == (data.run[k] > 2 ? 1 : 0));
    CHECK(data.history->without_noise.empty());  // the other day's temperature is no noise of the sensor
    CHECK(followed_degC(data, kSpindle, 0.0) == data.sensors_degC.at(kSpindle));
  }
  CHECK(std::ranges::max(observations_of(hour_of_spindle(), Model{}, mill()).history->clock) == 0);
}

TEST_CASE("passes in one direction, then those in the other, are on one clock") {
  auto set = hour_of_spindle();
  const double hour_s = 3600.0;
  for (Reading& r : set.readings)
    if (r.approach == Approach::reverse) r.time_s = *r.time_s + 10.0 * hour_s;
  const Observations data = observations_of(set, Model{}, mill());
  CHECK(std::ranges::is_sorted(data.time_s));
  CHECK(std::ranges::max(data.history->clock) == 0);
}

TEST_CASE("a model file without a lag has none, and is written without; below 0 it is refused") {
  const std::string text =
      "[[effect]]\nid = \"thermal_drift\"\naxis = \"X\"\nsense = \"EX\"\nsensor = \"t_spindle_degC\"\n";
  const auto read = [&](const std::string& more) { return parse_model(text + more, "model.toml", {}); };
  const Model at_once = must(read("fitted = { um_per_degC = 2.0 }\n"));
  CHECK(at_once.effects.front().parameters.at(std::string(kLag)) == 0.0);
  CHECK_FALSE(contains(to_toml(at_once), "lag_s"));
  const Observations data = observations_of(drifting(0.0), at_once, mill());
  const std::vector<double> values = must(predicted(at_once, data));
  const std::vector<double>& degC = data.sensors_degC.at(kSpindle);
  for (std::size_t k = 0; k < data.size(); ++k) CHECK(values[k] == 2.0 * (degC[k] - degC.front()));
  CHECK(must(predicted(must(read("parameters = { lag_s = 0.0 }\nfitted = { um_per_degC = 2.0 }\n")), data)) == values);
  const Model late = must(read("parameters = { lag_s = 600.0 }\nfitted = { um_per_degC = 2.0 }\n"));
  CHECK(must(predicted(late, data)).back() > values.back() + 1.0);  // the spindle cools, the structure is still warm
  CHECK(contains(to_toml(late), "lag_s = 600"));
  CHECK(contains(must_fail(read("parameters = { lag_s = -1.0 }\n")).message, "lag_s: expected 0 or more, got -1"));
}

TEST_CASE("a fit keeps a lag that is given and finds one that is free") {
  const auto set = drifting(900.0);
  Model model = straight();
  model.effects.push_back(drift_with_spindle());
  const auto fitted_to = [&](const Model& one) { return must(fit(one, observations_of(set, one, mill()))); };
  CHECK(fitted_to(model).rms_um > 3.0 * kNoise_um);
  model.effects.back().parameters[std::string(kLag)] = 900.0;
  CHECK(fitted_to(model).rms_um < 1.1 * kNoise_um);
  model.effects.back().parameters.clear();
  model.effects.back().fitted[std::string(kLag)] = 200.0;
  const Fit free = fitted_to(model);
  CHECK(free.rms_um < 1.1 * kNoise_um);
  for (const ParameterEstimate& one : free.effects.back().parameters) {
    REQUIRE(one.sigma);
    CHECK(std::abs(one.value - (one.name == kLag ? 900.0 : 2.0)) < 4.0 * *one.sigma);
  }
}

TEST_CASE("a drift that follows its sensor late is named with its time constant, one that follows at once without") {
  for (const double noise_degC : {0.0, 0.02}) {
    const auto late_set = drifting(900.0, 3, noise_degC);
    const Diagnosis late = diagnosed(straight(), late_set);
    CHECK(late.verdict == Verdict::missing_effect);
    const Candidate* found = named_drift(late);
    REQUIRE(found != nullptr);
    CHECK(must(lag_of(*found)) == Approx(900.0).epsilon(0.1));
    CHECK(
        contains(finding_text(found->effect, found->parameters, observations_of(late_set, straight(), mill())),
                 "with the spindle temperature, equal at every position, following it with a time constant of 15 min"));
    CHECK(std::ranges::count_if(late.candidates, [](const Candidate& one) { return one.effect.id == thermal_drift; }) ==
          1);
  }
  const Diagnosis at_once = diagnosed(straight(), drifting(0.0, 3));
  REQUIRE(named_drift(at_once) != nullptr);
  CHECK_FALSE(lag_of(*named_drift(at_once)));
}

TEST_CASE("an added drift keeps the lag that was found, and a model file gives it back") {
  const auto set = drifting(900.0);
  const Model before = straight();
  const Observations data = observations_of(set, before, mill());
  AddRequest request;
  request.id = thermal_drift;
  const Added added = must(add_effect(before, data, request, "spindle.csv"));
  CHECK(added.model.effects.back().fitted.at(std::string(kLag)) == Approx(900.0).epsilon(0.1));
  CHECK(must(parse_model(to_toml(added.model), "model.toml", {})).effects == added.model.effects);
}

TEST_CASE("a lag is tried only where the temperature changes while it is measured") {
  const auto lags_tried = [](const laser::MeasurementSet& set) {
    const auto all = candidate_instances(observations_of(set, Model{}, mill()));
    return std::ranges::count_if(all, [](const EffectInstance& one) {
      return one.traits().has_lag && !one.parameters.contains(std::string(kLag));
    });
  };
  CHECK(lags_tried(hour_of_spindle()) == 1);
  auto steady = hour_of_spindle();
  for (Reading& r : steady.readings) r.sensors_degC[kSpindle] = 20.0 + 0.001 * r.run;
  CHECK(lags_tried(steady) == 0);
  auto without_times = hour_of_spindle();
  for (Reading& r : without_times.readings) r.time_s.reset();
  CHECK(lags_tried(without_times) == 0);
}

TEST_CASE("of noise beside a warming sensor nothing is named, and of drifts at once no lag is claimed") {
  int named = 0, lags = 0;
  constexpr unsigned kSets = 12;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    named += diagnosed(straight(), hour_of_spindle(seed, 0.02)).verdict == Verdict::adequate ? 0 : 1;
    const Diagnosis at_once = diagnosed(straight(), drifting(0.0, seed, 0.02));
    const Candidate* drift = named_drift(at_once);
    lags += drift != nullptr && lag_of(*drift) ? 1 : 0;
  }
  CHECK(named == 0);
  CHECK(lags == 0);
}

TEST_CASE("the course of a noisy sensor is known better than any of its readings, and so is its noise") {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto set = hour_of_spindle(seed, 0.1);
    const Observations data = observations_of(set, Model{}, mill());
    const CourseWithoutNoise& course = data.history->without_noise.at(kSpindle);
    CHECK(course.noise_degC == Approx(0.1).epsilon(0.15));
    double squares = 0.0, stated = 0.0, readings = 0.0;
    for (std::size_t k = 0; k < data.size(); ++k) {
      const double off = course.degC[k] - spindle_degC(data.time_s[k] + *set.readings.front().time_s);
      squares += off * off;
      stated += course.sd_degC[k] * course.sd_degC[k];
      readings += 1.0;
    }
    CHECK(std::sqrt(squares / readings) < 0.04);
    CHECK(squares / stated < 2.0);  // the stated standard deviation agrees with the true error
    CHECK(squares / stated > 0.3);
  }
}

TEST_CASE("of a sensor with steps of 0.1 degC the course between the steps is known to a hundredth or two") {
  auto set = hour_of_spindle();
  for (Reading& r : set.readings) r.sensors_degC[kSpindle] = std::round(10.0 * r.sensors_degC[kSpindle]) / 10.0;
  const Observations data = observations_of(set, Model{}, mill());
  const std::vector<double> course = followed_degC(data, kSpindle, 0.0);
  double squares = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double off = course[k] - spindle_degC(data.time_s[k] + *set.readings.front().time_s);
    squares += off * off / static_cast<double>(data.size());
  }
  CHECK(std::sqrt(squares) < 0.02);  // the steps themselves are 0.029 degC off
}

TEST_CASE("the readings of a good sensor, and of one whose temperature takes no course, are left as they are") {
  auto steady = hour_of_spindle();
  std::mt19937_64 random(5);
  NormalDraws noise(0.0, 0.1);
  for (Reading& r : steady.readings) r.sensors_degC[kSpindle] = 20.0 + noise(random);
  auto noted = hour_of_spindle();  // by a person, once a run
  for (Reading& r : noted.readings) r.sensors_degC[kSpindle] = 20.0 + 1.5 * r.run;
  for (const auto& set : {hour_of_spindle(1, 0.01), steady, noted}) {
    const Observations data = observations_of(set, Model{}, mill());
    CHECK(data.history->without_noise.empty());
    CHECK(followed_degC(data, kSpindle, 0.0) == data.sensors_degC.at(kSpindle));
  }
}

TEST_CASE("a drift is named with its lag, or without one, although its sensor scatters by 0.1 degC") {
  constexpr double kUmPerDegC = 8.0;
  for (const double lag_s : {0.0, 900.0})
    for (const unsigned seed : {1U, 2U, 3U, 4U}) {
      const auto set = drifting(lag_s, seed, 0.1, kUmPerDegC);
      const Diagnosis found = diagnosed(straight(), set);
      const Candidate* const drift = named_drift(found);
      REQUIRE(drift != nullptr);
      if (lag_s == 0.0)
        CHECK_FALSE(lag_of(*drift));
      else
        CHECK(must(lag_of(*drift)) == Approx(lag_s).epsilon(0.1));
      CHECK(drift->parameters.back().value == Approx(kUmPerDegC).epsilon(0.02));
      CHECK(std::ranges::any_of(found.notes, [](const std::string& note) {
        return note.starts_with("t_spindle_degC (") && contains(note, "noisy or coarse");
      }));
    }
}
