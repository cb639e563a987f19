#include "base/moved_targets.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/planning/questions.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// Deviation of the refractive index from that of 20 degC, 1013.25 hPa, 50 %RH in 1e-6: Edlén's formula made linear
/// there, good to a few percent here.
double air_ppm(const Reading& r) {
  return -0.93 * (r.sensors_degC.at("t_air_degC") - 20.0) + 0.27 * (*r.pressure_hPa - 1013.25) -
         0.0096 * (*r.humidity_pct - 50.0);
}
double degC(const Reading& r, const char* sensor = "t_material_degC") { return r.sensors_degC.at(sensor); }
bool first_optics(const Reading& r) {
  const auto set_up = r.extras.find("set_up");
  return set_up == r.extras.end() || set_up->second == 1.0;
}
double z_lever_m(const Reading& r) { return p(r, Axis::Z) / 1000.0; }
/// A roll of the X carriage, um/m: a bump in the guideway, without the mean and slope over 0 … 1000 mm that a line
/// alone cannot tell from an offset and a scale.
double roll(double x_mm) {
  const auto bump = [](double x) { return 16.0 * std::exp(-std::pow((x - 350.0) / 170.0, 2)); };
  static const auto line = [&] {
    double mean = 0.0, slope = 0.0;
    for (int i = 0; i <= 1000; ++i) {
      mean += bump(i) / 1001.0;
      slope += bump(i) * (i - 500.0) / (1001.0 * 1002.0 * 1000.0 / 12.0);
    }
    return std::pair{mean, slope};
  }();
  return bump(x_mm) - line.first - line.second * (x_mm - 500.0);
}

/// A measurement in which several causes look alike, and the truth about it.
struct Case {
  std::string truth_name;
  Model model;
  laser::MeasurementSet set;
  Truth truth;
};

Model offset_only(Axis axis = Axis::X, Sense sense = Sense::EX) {
  Model model;
  model.effects = {effect(offset, axis, sense)};
  return model;
}

Case case_of(const std::string& truth_name, const Model& model, const Plan& plan, const Truth& truth,
             const std::function<void(Reading&)>& conditions) {
  return {truth_name, model, session(plan, truth, conditions), truth};
}

/// Proved, or likely where the few readings of a proposal do not prove it on their own.
bool says_a_cause(const Diagnosis& found) {
  return found.verdict == Verdict::missing_effect || found.verdict == Verdict::likely_effect;
}

std::string group_of(const Diagnosis& found) {
  if (found.candidates.empty()) return "";
  std::string text = to_text(found.candidates.front().effect);
  for (const std::string& rival : found.candidates.front().indistinguishable_from) text += ", " + rival;
  return text;
}
std::size_t size_of_group(const Diagnosis& found) {
  return found.candidates.empty() ? 0 : 1 + found.candidates.front().indistinguishable_from.size();
}
bool in_group(const Diagnosis& found, const std::string& name) {
  return contains((", " + group_of(found) + ","), " " + name + ",");
}

/// The readings that following the proposal gives, after the present ones.
laser::MeasurementSet followed(const laser::MeasurementSet& present, const MeasurementProposal& proposal,
                               const Truth& truth) {
  laser::MeasurementSet all = present;
  const double start_s = *present.readings.back().time_s + 60.0 * (proposal.wait_minutes + proposal.set_up_minutes);
  std::mt19937_64 random(23);
  NormalDraws noise(0.0, kNoise_um);
  for (Reading r : target_set(proposal).readings) {
    *r.time_s += start_s;
    r.row = static_cast<int>(all.readings.size()) + 1;
    r.error = truth(r) + noise(random);
    all.readings.push_back(r);
  }
  return all;
}

/// χ² that a rival leaves above what the truth leaves.
double chi2_apart(const Model& model, const Observations& data, const EffectInstance& truth,
                  const EffectInstance& rival) {
  const auto chi2 = [&](const EffectInstance& added) {
    Model with = model;
    with.effects.push_back(added);
    FitOptions plain{.plain = true};
    const auto result = must(fit(with, data, plain));
    double sum = 0.0;
    for (const double r : result.residual) sum += r * r;
    return sum / (kNoise_um * kNoise_um);
  };
  return chi2(rival) - chi2(truth);
}

const EffectInstance* instance_of(const Diagnosis& found, const std::string& name) {
  for (const Candidate& candidate : found.candidates)
    if (to_text(candidate.effect) == name) return &candidate.effect;
  return nullptr;
}

/// Diagnose, follow the first proposal, join, diagnose again.
void check_case(const Case& one) {
  CAPTURE(one.truth_name);
  const auto machine = mill();
  const Observations data = observations_of(one.set, one.model, machine);
  const auto before = must(diagnose(one.model, data));
  CAPTURE(group_of(before));
  REQUIRE(in_group(before, one.truth_name));
  REQUIRE(size_of_group(before) >= 2);

  const NextMeasurement next = next_measurement(one.model, data, before);
  REQUIRE_MESSAGE(!next.proposals.empty(), (next.notes.empty() ? "" : next.notes.front()));
  const MeasurementProposal& first = next.proposals.front();
  CAPTURE(first.sentence);
  CHECK(first.separation_sigma >= 3.0);
  CHECK(first.minutes > 0.0);

  const auto joined = followed(one.set, first, one.truth);
  const Observations more = observations_of(joined, one.model, machine);
  const auto after = must(diagnose(one.model, more));
  CAPTURE(group_of(after));
  CHECK(says_a_cause(after));
  CHECK(in_group(after, one.truth_name));
  CHECK(size_of_group(after) < size_of_group(before));

  for (const PairSeparation& pair : first.pairs) {
    if (pair.truth.rfind(one.truth_name, 0) != 0 || pair.sigma < 5.0) continue;
    const EffectInstance* truth = instance_of(before, one.truth_name);
    const EffectInstance* rival = instance_of(before, pair.rival.substr(0, pair.rival.find(' ')));
    REQUIRE(truth != nullptr);
    REQUIRE(rival != nullptr);
    const double achieved = std::sqrt(
        std::max(0.0, chi2_apart(one.model, more, *truth, *rival) - chi2_apart(one.model, data, *truth, *rival)));
    CAPTURE(pair.rival);
    CAPTURE(pair.sigma);
    CAPTURE(achieved);
    CHECK(achieved < 1.5 * pair.sigma);
    CHECK(achieved > pair.sigma / 1.5);
  }
}

const auto kBare = [](Reading&) {};
const auto kWarmMaterial = [](Reading& r) { r.sensors_degC["t_material_degC"] = 22.0; };
const auto kOtherAir = [](Reading& r) {
  r.sensors_degC["t_air_degC"] = 22.0;
  r.pressure_hPa = 985.0;
  r.humidity_pct = 45.0;
};

}  // namespace

TEST_CASE("off equal steps are said to show short periods only where the targets lie on no coarse grid") {
  MeasurementProposal proposal{.targets_mm = {20.0, 80.0, 140.0, 200.0, 260.0, 320.0, 380.0, 430.0, 480.0}};
  CHECK_FALSE(contains(sentence_of(proposal), "off equal steps"));
  proposal.targets_mm = moved_targets({20.0, 80.0, 140.0, 200.0, 260.0, 320.0, 380.0, 440.0, 500.0});
  CHECK(contains(sentence_of(proposal), "off equal steps, so that a short period is not mistaken for a long one"));
}

TEST_CASE("scale, expansion or misalignment: one slope at one temperature") {
  check_case(case_of(
      "scale:X:EX", offset_only(), {}, [](const Reading& r) { return -9.0 * p(r) / 1000.0; }, kWarmMaterial));
  check_case(case_of(
      "thermal_scale:X:EX", offset_only(), {}, [](const Reading& r) { return -4.5 * (degC(r) - 20.0) * p(r) / 1000.0; },
      kWarmMaterial));
  check_case(case_of(
      "cosine:X:EX", offset_only(), {}, [](const Reading& r) { return first_optics(r) ? -9.0 * p(r) / 1000.0 : 0.0; },
      kBare));
  check_case(case_of(
      "scale:X:EX", offset_only(), {}, [](const Reading& r) { return -9.0 * p(r) / 1000.0; }, kBare));
}

TEST_CASE("followed step by step, the proposals leave the truth alone") {
  const auto check_chain = [](const std::string& name, const Truth& truth) {
    CAPTURE(name);
    Case one = case_of(name, offset_only(), {}, truth, kWarmMaterial);
    std::size_t size = 3;
    for (int step = 0; step < 4 && size > 1; ++step) {
      const Observations data = observations_of(one.set, one.model, mill());
      const auto found = must(diagnose(one.model, data));
      CAPTURE(group_of(found));
      CHECK(in_group(found, name));
      size = size_of_group(found);
      if (size == 1) break;
      const NextMeasurement next = next_measurement(one.model, data, found);
      REQUIRE_FALSE(next.proposals.empty());
      one.set = followed(one.set, next.proposals.front(), truth);
    }
    CHECK(size == 1);
  };
  check_chain("scale:X:EX", [](const Reading& r) { return -9.0 * p(r) / 1000.0; });
  check_chain("thermal_scale:X:EX", [](const Reading& r) { return -4.5 * (degC(r) - 20.0) * p(r) / 1000.0; });
  check_chain("cosine:X:EX", [](const Reading& r) { return first_optics(r) ? -9.0 * p(r) / 1000.0 : 0.0; });
}

TEST_CASE("air not corrected or a scale: one slope in one weather") {
  check_case(case_of(
      "air_refraction:X:EX", offset_only(), {}, [](const Reading& r) { return air_ppm(r) * p(r) / 1000.0; },
      kOtherAir));
  check_case(case_of(
      "scale:X:EX", offset_only(), {}, [](const Reading& r) { return -9.0 * p(r) / 1000.0; }, kOtherAir));
}

TEST_CASE("backlash or following error: two levels at one feed") {
  const auto feed = [](Reading& r) { r.feed_mm_min = 2000.0; };
  check_case(case_of(
      "backlash:X:EX", straight(), {}, [](const Reading& r) { return 1.0 * d(r); }, feed));
  check_case(case_of(
      "servo_lag:X:EX", straight(), {}, [](const Reading& r) { return 0.5 * *r.feed_mm_min / 1000.0 * d(r); }, feed));
}

TEST_CASE("offset or dead path: one shift in one weather") {
  Model model;
  model.effects = {effect(scale, Axis::X, Sense::EX)};
  check_case(case_of(
      "offset:X:EX", model, {}, [](const Reading&) { return 4.0; }, kOtherAir));
}

TEST_CASE("a dead path is named over four weathers; over two it is the offset of a run") {
  Model model;
  model.effects = {effect(scale, Axis::X, Sense::EX)};
  const Truth truth = [](const Reading& r) { return first_optics(r) ? 0.6 * air_ppm(r) : 0.0; };
  Case one = case_of("dead_path:X:EX", model, {}, truth, kOtherAir);
  const auto first = must(diagnose(model, observations_of(one.set, model, mill())));
  CHECK(in_group(first, "dead_path:X:EX"));
  const NextMeasurement next = next_measurement(model, observations_of(one.set, model, mill()), first);
  REQUIRE_FALSE(next.proposals.empty());
  MeasurementProposal proposal = next.proposals.front();
  proposal.new_set_up = false;
  proposal.set_up = 1;
  for (const double pressure_hPa : {1010.0, 1025.0, 1040.0}) {
    proposal.pressure_hPa = pressure_hPa;
    one.set = followed(one.set, proposal, truth);
    proposal.first_run += proposal.runs;
    const auto found = must(diagnose(model, observations_of(one.set, model, mill())));
    CAPTURE(group_of(found));
    CAPTURE(name_of(found.verdict));
    for (const std::string& note : found.notes) INFO(note);
    const bool is_named = says_a_cause(found) && in_group(found, "dead_path:X:EX");
    CHECK(is_named == (pressure_hPa > 1030.0));
  }
}

TEST_CASE("a roll through a lever or the guideway's own form: one line") {
  Plan plan{.sense = Sense::EY, .parked_mm = {0.0, 100.0, 400.0}};
  // E_Y of TXYZ contains −EAX·Z
  check_case(case_of(
      "angular:X:EAX", straight(Axis::X, Sense::EY), plan, [](const Reading& r) { return -roll(p(r)) * z_lever_m(r); },
      kBare));
  check_case(case_of(
      "progressive:X:EY", straight(Axis::X, Sense::EY), plan, [](const Reading& r) { return 0.4 * roll(p(r)); },
      kBare));
}

TEST_CASE("a wrong gain of the map or a scale: a straight map") {
  Model model = offset_only();
  laser::ErrorMap map;
  map.tables.push_back({Component::EXX, Approach::unknown, {-10.0, 1010.0}, {0.2, -20.2}});
  model.map = map;
  const auto on = [](Reading& r) { r.compensated = true; };
  for (const double gain : {1.3, 1.0}) {
    CAPTURE(gain);
    const double scale_um_per_m = gain == 1.0 ? 14.0 : 20.0;  // both leave -6 um/m behind the map
    const Truth truth = [=](const Reading& r) {
      return (scale_um_per_m - (*r.compensated ? 20.0 * gain : 0.0)) * p(r) / 1000.0;
    };
    const auto set = session({}, truth, on);
    const Observations data = observations_of(set, model, mill());
    const auto before = must(diagnose(model, data));
    REQUIRE(in_group(before, "scale:X:EX"));
    REQUIRE(in_group(before, "map_gain:X:EX"));
    const NextMeasurement next = next_measurement(model, data, before);
    REQUIRE_FALSE(next.proposals.empty());
    CHECK(contains(next.proposals.front().sentence, "with compensation switched off"));
    const auto both = followed(set, next.proposals.front(), truth);
    const auto after = must(diagnose(model, observations_of(both, model, mill())));
    CHECK(says_a_cause(after));
    CHECK(std::ranges::any_of(after.candidates, [](const Candidate& one) {
            return one.in_answer() && to_text(one.effect) == "map_gain:X:EX";
          }) == (gain != 1.0));
  }
}

TEST_CASE("warming up, creep or the spindle's growth: one short session") {
  Plan plan{.step_mm = 50.0, .targets = 21};
  const auto warming = [](Reading& r) { r.sensors_degC["t_spindle_degC"] = 20.0 + 1.5 * *r.time_s / 1800.0; };
  check_case(case_of(
      "time_drift:X:EX", straight(), plan, [](const Reading& r) { return 5.0 * *r.time_s / 1800.0; }, warming));
  check_case(case_of(
      "thermal_drift:X:EX", straight(), plan, [](const Reading& r) { return 3.0 * (degC(r, "t_spindle_degC") - 20.0); },
      warming));
}

TEST_CASE("warming up or creep: a session hardly longer than the time that warming takes") {
  Plan plan{.step_mm = 50.0, .targets = 21};
  check_case(case_of(
      "warm_up:X:EX", straight(), plan, [](const Reading& r) { return -2.6 * std::expm1(-*r.time_s / 1200.0); },
      kBare));
}

TEST_CASE("a weak backlash at one feed needs more runs to differ from a following error") {
  const auto feed = [](Reading& r) { r.feed_mm_min = 2000.0; };
  Plan plan{.step_mm = 50.0, .targets = 21};
  check_case(case_of(
      "backlash:X:EX", straight(), plan, [](const Reading& r) { return 0.2 * d(r); }, feed));
}

TEST_CASE("load or scale: one load") {
  const auto loaded = [](Reading& r) { r.load_kg = 200.0; };
  check_case(case_of(
      "load:X:EX", offset_only(), {}, [](const Reading& r) { return 0.03 * *r.load_kg * p(r) / 1000.0; }, loaded));
  check_case(case_of(
      "scale:X:EX", offset_only(), {}, [](const Reading& r) { return 6.0 * p(r) / 1000.0; }, loaded));
}
