// Several causes at once in readings of a ball under a head: what is named, and what is told to be the same.
#include <functional>
#include <numbers>
#include <set>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/stepwise.hpp"
#include "model/planning/next_measurement.hpp"
#include "model/planning/questions.hpp"
#include "tests/model/support/searching.hpp"
#include "tests/model/support/turning_machine.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// C over a turn at B 0 and 45, B from -90 to 90 at C 0 and 90, there and back, twice; with each of these tools.
laser::MeasurementSet sweeps_under_head(std::initializer_list<double> tools_mm) {
  laser::MeasurementSet set;
  double time_s = 0.0;
  const auto take = [&](Axis axis, double b, double c, double tool_mm, Approach approach, int run) {
    time_s += 5.0;
    for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ}) {
      Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                .axis = axis,
                .rotary = true,
                .position_mm = {300.0, 250.0, -400.0},
                .angle_deg = {0.0, b, c},
                .sense = sense,
                .approach = approach,
                .run = run,
                .time_s = time_s};
      r.extras = {{"at_tip", 1.0}, {"tool_z_mm", -tool_mm}};
      set.readings.push_back(r);
    }
  };
  for (const double tool_mm : tools_mm)
    for (const int run : {1, 2})
      for (const Approach approach : {Approach::forward, Approach::reverse})
        for (const double parked : {0.0, 1.0})
          for (int i = 0; i < 12; ++i) {
            const int j = approach == Approach::forward ? i : 11 - i;
            take(Axis::Z, 45.0 * parked, 30.0 * j, tool_mm, approach, run);
            take(Axis::Y, -90.0 + 180.0 / 11.0 * j, 90.0 * parked, tool_mm, approach, run);
          }
  std::ranges::stable_sort(set.readings, {}, [](const Reading& r) { return r.axis; });
  return set;
}

/// What a reading shows of the hidden causes.
using Errors = std::function<double(const Observations&, std::size_t)>;

double b_of(const Observations& data, std::size_t k) { return data.position_mm[k][1] * std::numbers::pi / 180.0; }
double in_head(const Observations& data, std::size_t k, Sense along) { return data.share_of(k, Axis::Y, along); }
double in_machine(const Observations& data, std::size_t k, Axis along) {
  return -data.through_chain[k].of_workpiece[index_of(along)];
}

struct FoundUnderHead {
  Model model;
  Observations data;
  Diagnosis diagnosis;
  std::set<std::string> named;
};

/// A table C under a head B.
TurningMachine table_under_head() {
  return {"XYCTZB",
          {{'B', {{-100.0, 100.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 300.0}}},
           {'C', {{0.0, 360.0}, {0.0, 0.0, 1.0}, {200.0, 150.0, 500.0}}}}};
}

FoundUnderHead found_with(laser::MeasurementSet set, const Errors& errors, TurningMachine made = head()) {
  for (auto& axis : made.machine.axes) axis->travel_mm = {-1500.0, 1500.0};
  std::mt19937_64 random(5);
  NormalDraws normal(0.0, 0.5);
  const Observations plan = observations_of(set, Model{}, made.machine);
  for (std::size_t k = 0; k < plan.size(); ++k)
    set.readings[plan.file_order[k]].error = errors(plan, k) + normal(random);
  FoundUnderHead found;
  found.model = usual_model(set, made.machine);
  found.data = observations_of(set, found.model, made.machine);
  found.diagnosis = must(diagnose(found.model, found.data));
  for (const Candidate& one : found.diagnosis.candidates)
    if (one.in_answer()) found.named.insert(to_text(one.effect));
  return found;
}

}  // namespace

TEST_CASE("four causes under a head are named in one answer, and no wave of the tilting axis stands for bending") {
  const FoundUnderHead found =
      found_with(sweeps_under_head({150.0, 250.0}), [](const Observations& data, std::size_t k) {
        const double b = b_of(data, k), c = data.position_mm[k][2] * std::numbers::pi / 180.0;
        return in_head(data, k, Sense::EX) * (2.0 * std::sin(b) + 18.0 * (1.0 - std::cos(b))) +
               data.share_of(k, Axis::Y, Sense::EB) * 0.5 * data.position_mm[k][1] +
               data.share_of(k, Axis::Z, Sense::EZ) * 5.0 * std::sin(c + 0.4) +
               data.through_chain[k].of_linear[1] * 34.0;
      });
  INFO(found.diagnosis.headline);
  CHECK(found.diagnosis.verdict == Verdict::missing_effect);
  CHECK(found.named == std::set<std::string>{"cyclic:C:EZ", "head_bending", "linear_axes", "tilt_scale:B:EB"});
}

TEST_CASE("a shift of the tilting axis is tried as a wave of two turns or more only, also as the double of another") {
  const FoundUnderHead found = found_with(sweeps_under_head({150.0}), [](const Observations& data, std::size_t k) {
    const double b = b_of(data, k);
    return in_head(data, k, Sense::EX) * (4.0 * std::sin(2.0 * b) + 15.0 * std::sin(b));
  });
  INFO(found.diagnosis.headline);
  for (const Candidate& one : found.diagnosis.candidates) {
    if (!one.effect.definition().traits.periodic || one.effect.axis != Axis::Y || is_rotation(*one.effect.sense))
      continue;
    CAPTURE(to_text(one.effect));
    for (const ParameterEstimate& parameter : one.parameters)
      if (parameter.name == "period_mm") CHECK(parameter.value < 181.0);
  }
}

TEST_CASE("of bending along several directions, the part that may be another effect is told, and a set to part them") {
  FoundUnderHead found = found_with(sweeps_under_head({150.0}), [](const Observations& data, std::size_t k) {
    const double s = std::sin(b_of(data, k)), c = 1.0 - std::cos(b_of(data, k));
    return in_machine(data, k, Axis::Y) * (15.0 * s + 18.0 * c) + in_head(data, k, Sense::EX) * (10.0 * s - 4.0 * c);
  });
  INFO(found.diagnosis.headline);
  CHECK(found.diagnosis.verdict == Verdict::missing_effect);
  CHECK(found.named.contains("machine_bending"));
  std::set<std::string> told = found.named;
  for (const Candidate& one : found.diagnosis.candidates) {
    if (!one.in_answer()) continue;
    told.insert(one.indistinguishable_from.begin(), one.indistinguishable_from.end());
    for (const RivalOfPart& rival : one.in_part) told.insert(to_text(rival.other));
  }
  CHECK(told.contains("head_bending"));
  CHECK(told.contains("tool_bending"));
  CHECK_FALSE(nothing_in_doubt(found.diagnosis));
  const NextMeasurement next = planned_next(found.model, found.data, found.diagnosis);
  REQUIRE_FALSE(next.proposals.empty());
  CHECK(next.proposals.front().separation_sigma > kSeparates);
  check_holds(next.proposals.front().sentence, {"tool that is 100 mm longer"});
}

TEST_CASE("bending of a head along one direction beside a squareness is not named as bending of head and machine") {
  const FoundUnderHead found =
      found_with(sweeps_under_head({150.0, 250.0}), [](const Observations& data, std::size_t k) {
        const double s = std::sin(b_of(data, k)), c = 1.0 - std::cos(b_of(data, k));
        return in_head(data, k, Sense::EX) * (11.0 * s + 16.0 * c) - data.through_chain[k].of_linear[4] * 32.0;
      });
  INFO(found.diagnosis.headline);
  CHECK(found.named == std::set<std::string>{"head_bending", "linear_axes"});
}

TEST_CASE(
    "a cause whose rival needs another direction of the other cause has it told, and a place of the ball parts them") {
  // B0Z by the lever from tool to pivot is the bending along X with 1 - cos b: the rest is in proportion to the tool
  constexpr double kB0Z_um_per_m = -137.0, kPivot_m = 0.3;
  FoundUnderHead found = found_with(
      sweeps_under_head({150.0, 250.0}),
      [](const Observations& data, std::size_t k) {
        const double s = std::sin(b_of(data, k)), c = 1.0 - std::cos(b_of(data, k));
        return in_head(data, k, Sense::EX) * (-36.0 * s + kB0Z_um_per_m * kPivot_m * c) +
               data.through_chain[k].of_linear[4] * kB0Z_um_per_m;
      },
      table_under_head());
  INFO(found.diagnosis.headline);
  std::set<std::string> told = found.named;
  for (const Candidate& one : found.diagnosis.candidates)
    if (one.in_answer()) told.insert(one.indistinguishable_from.begin(), one.indistinguishable_from.end());
  CHECK(told == std::set<std::string>{"head_bending", "linear_axes", "tool_bending"});
  const NextMeasurement next = planned_next(found.model, found.data, found.diagnosis);
  CHECK(std::set<std::string>(next.rivals.begin(), next.rivals.end()) ==
        std::set<std::string>{"linear_axes", "tool_bending"});
  REQUIRE_FALSE(next.proposals.empty());
  CHECK(next.proposals.front().separation_sigma > kSeparates);
  check_holds(next.proposals.front().condition, {"second place", "along Z only"});
}

TEST_CASE("of all sets of effects along directions the best is found, as fits of each of them say") {
  const FoundUnderHead made =
      found_with(sweeps_under_head({150.0, 250.0}), [](const Observations& data, std::size_t k) {
        const double s = std::sin(b_of(data, k)), c = 1.0 - std::cos(b_of(data, k));
        return in_machine(data, k, Axis::X) * 12.0 * s + in_head(data, k, Sense::EX) * 16.0 * c -
               data.through_chain[k].of_linear[4] * 32.0;
      });
  const Regressors regressors(made.data);
  const NoiseModel noise = plain_noise(made.data, 0.5);
  const Whitener whitener(made.data, noise, std::vector<bool>(made.data.size(), false));
  Eigen::MatrixXd base(static_cast<Eigen::Index>(made.data.size()), 0);
  for (const EffectInstance& one : made.model.effects) base = ecs::beside(base, regressors.columns(one, 0.0).of);
  std::vector<EffectInstance> candidates(2);
  candidates[0].id = effect_named("machine_bending");
  candidates[1].id = effect_named("linear_axes");
  for (EffectInstance& one : candidates) one.rotary = true;
  const Eigen::VectorXd target = Eigen::Map<const Eigen::VectorXd>(made.data.reading.data(), base.rows());
  const Search search(regressors, whitener, base, target, candidates);
  const Space& alone = search.alone().space;
  const std::vector<DirectionSet> sets = direction_sets(search, alone, 2);
  REQUIRE(sets.size() == 4);  // none, either, both
  for (const DirectionSet& set : sets)
    CHECK(set.gain == Approx(alone.chi2() - search.solution(set.chosen).space.chi2()).epsilon(1e-6));
  double best = 0.0;
  for (const auto& of_first : candidates[0].definition().column_sets)
    for (const auto& of_second : candidates[1].definition().column_sets) {
      const auto free = static_cast<double>(of_first.size() + of_second.size());
      const Choice first{0, 0.0, of_first, 0.0, 0.0, of_first.size()},
          second{1, 0.0, of_second, 0.0, 0.0, of_second.size()};
      const double gain = alone.chi2() - search.solution({first, second}).space.chi2();
      best = std::max(best, gain - free * search.families()[0].ln_readings - search.families()[0].shape_cost -
                                search.families()[1].shape_cost);
    }
  CHECK(sets.front().chosen.size() == 2);
  CHECK(sets.front().score() == Approx(best).epsilon(1e-6));
}

TEST_CASE("with two lengths of tool, bending of the machine, of the head and of the tool are named each") {
  const FoundUnderHead found =
      found_with(sweeps_under_head({150.0, 250.0}), [](const Observations& data, std::size_t k) {
        const double s = std::sin(b_of(data, k)), c = 1.0 - std::cos(b_of(data, k));
        const double length_m = std::abs(data.extras.at("tool_z_mm")[k]) / 1000.0;
        return in_machine(data, k, Axis::X) * (11.0 * s + 12.0 * c) +
               in_head(data, k, Sense::EX) * (-13.0 * s + (30.0 * s + 95.0 * c) * length_m);
      });
  INFO(found.diagnosis.headline);
  CHECK(found.named.contains("tool_bending"));
  CHECK(found.named.contains("machine_bending"));
  std::set<std::string> told = found.named;
  for (const Candidate& one : found.diagnosis.candidates)
    for (const RivalOfPart& rival : one.in_part) told.insert(to_text(rival.other));
  CHECK(told.contains("head_bending"));  // along X of the head it does what bending along Z does, of head or machine
}
