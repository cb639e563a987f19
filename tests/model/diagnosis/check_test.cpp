// A diagnosis checked without the search: a true one holds, a changed one is found.
#include "model/diagnosis/check.hpp"

#include <numbers>

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/normal_matrix.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// A diagnosis of one line, and what it claims.
struct Diagnosed {
  Model model = straight();
  Observations data;
  Claim claim;
  Verdict verdict = Verdict::adequate;

  explicit Diagnosed(const Truth& truth, Model of = straight(), const Plan& line = {})
      : model(std::move(of)), data(observations_of(measured(line, kNoise_um, truth), model, mill())) {
    const Diagnosis found = diagnose(model, data, {.noise_replicates = 100}).value();
    claim = {found.observations, found.rms_um, found.rms_after_um, found.candidates_tried, false,
             found.own_terms,    found.apart,  found.candidates};
    verdict = found.verdict;
  }
  [[nodiscard]] Check checked_as(const Claim& other) const { return checked(model, data, other).value(); }
};

double backlash_and_wave(const Reading& r) { return 1.0 * d(r) + 1.5 * std::sin(2.0 * std::numbers::pi * p(r) / 90.0); }

bool differs(const Check& check, const std::string& name) {
  return std::any_of(check.numbers.begin(), check.numbers.end(),
                     [&](const CheckedNumber& one) { return one.name == name && !one.holds; });
}

std::vector<std::string> differing(const Check& check) {
  std::vector<std::string> names = check.objections;
  for (const CheckedNumber& one : check.numbers)
    if (!one.holds) names.push_back(one.name);
  return names;
}

}  // namespace

TEST_CASE("a diagnosis holds on its own data, whether it names one cause, two or none") {
  const auto none = std::vector<std::string>();
  const Diagnosed one([](const Reading& r) { return 1.0 * d(r); });
  CHECK(differing(one.checked_as(one.claim)) == none);
  const Diagnosed two(backlash_and_wave);
  REQUIRE(std::count_if(two.claim.candidates.begin(), two.claim.candidates.end(),
                        [](const Candidate& candidate) { return candidate.named; }) == 2);
  CHECK(differing(two.checked_as(two.claim)) == none);
  const Diagnosed noise(nothing);
  CHECK(differing(noise.checked_as(noise.claim)) == none);
}

TEST_CASE("a lost motion beside drifts that a zero of each pass replaces is weighed in the check as in the diagnosis") {
  const Eigen::MatrixXd zeros_um = ecs::test::normal_matrix(3, 2, 1);
  const Diagnosed found([&](const Reading& r) { return 1.2 * d(r) + zeros_um(r.run, d(r) > 0.0 ? 1 : 0); }, straight(),
                        {.targets = 29, .runs = 2});
  REQUIRE(found.verdict == Verdict::likely_effect);
  CHECK(differing(found.checked_as(found.claim)).empty());
}

TEST_CASE("a diagnosis of a model with a free wave holds at the place that the wave has beside the cause") {
  Model model = straight();
  model.effects.push_back(effect(effects::cyclic, Axis::X, Sense::EX));
  const Diagnosed found(backlash_and_wave, model);
  REQUIRE(found.claim.own_terms.size() == 1);
  REQUIRE(found.claim.candidates.front().named);
  CHECK(differing(found.checked_as(found.claim)).empty());
  Claim moved = found.claim;
  moved.own_terms.clear();
  CHECK(!found.checked_as(moved).holds());
}

TEST_CASE("a diagnosis that explains only part holds, and one of more readings than are searched") {
  // another value at every target, from the digits of its place
  const auto rough = [](const Reading& r) { return std::sin(7919.0 * p(r)) + 5.0 * d(r); };
  const Diagnosed part(rough);
  CHECK(part.verdict == Verdict::partly_explained);
  REQUIRE(part.claim.candidates.front().named);
  CHECK(differing(part.checked_as(part.claim)).empty());
  const Diagnosed many([](const Reading& r) { return 1.0 * d(r); }, straight(), {.targets = 80, .runs = 30});
  REQUIRE(many.data.size() > DiagnoseOptions{}.largest_search);
  REQUIRE(many.claim.candidates.front().named);
  CHECK(differing(many.checked_as(many.claim)).empty());
}

TEST_CASE("a diagnosis that names a fault of the map holds, and one that names a candidate of the user") {
  Model mapped = straight();
  mapped.map.emplace();
  laser::MapTable table{Component::EXX, Approach::unknown, {}, {}};
  for (int i = 0; i <= 20; ++i) {
    table.position_mm.push_back(50.0 * i);
    table.compensation.push_back(4.0 * std::sin(table.position_mm.back() / 90.0));
  }
  mapped.map->tables.push_back(table);
  const Diagnosed fault([&](const Reading& r) { return -2.0 * laser::compensation_at(table, p(r)); }, mapped);
  REQUIRE(fault.claim.candidates.front().named);
  CHECK(fault.claim.candidates.front().effect.definition().id == "map_polarity");
  CHECK(differing(fault.checked_as(fault.claim)).empty());

  Model own = straight();
  EffectInstance user;
  user.id = effect_named("user");
  user.name = "bent rail";
  user.formulas = {{Sense::EX, "k * sin(x_mm / 37)"}};
  user.user = {{"k", "um", {}, {}, {}, {}}};
  own.candidates.push_back(user);
  const Diagnosed bent([](const Reading& r) { return 1.5 * std::sin(p(r) / 37.0); }, own);
  REQUIRE(bent.claim.candidates.front().named);
  CHECK(differing(bent.checked_as(bent.claim)).empty());
}

TEST_CASE("a changed number is found, each by its name") {
  const Diagnosed found([](const Reading& r) { return 1.0 * d(r); });
  REQUIRE(found.claim.candidates.front().named);
  REQUIRE(found.claim.candidates.front().e_value);
  const auto with = [&](auto change) {
    Claim changed = found.claim;
    change(changed, changed.candidates.front());
    return found.checked_as(changed);
  };
  const std::string name = to_text(found.claim.candidates.front().effect) + " ";
  CHECK(differs(with([](Claim& claim, Candidate&) { claim.rms_um *= 1.001; }), "rms_um"));
  CHECK(differs(with([](Claim& claim, Candidate&) { claim.rms_after_um *= 0.999; }), "rms_after_um"));
  CHECK(differs(with([](Claim& claim, Candidate&) { ++claim.observations; }), "observations"));
  CHECK(differs(with([](Claim& claim, Candidate&) { claim.candidates_tried = 1; }), "candidates_tried"));
  CHECK(differs(with([](Claim&, Candidate& first) { first.explained += 0.001; }), name + "explained"));
  CHECK(differs(with([](Claim&, Candidate& first) { first.rms_after_um *= 0.99; }), name + "rms_after_um"));
  CHECK(differs(with([](Claim&, Candidate& first) { *first.held_out_rms_um *= 0.99; }), name + "held_out_rms_um"));
  CHECK(differs(with([](Claim&, Candidate& first) { *first.e_value = std::pow(*first.e_value, 1.1); }),
                name + "e_value"));
  CHECK(differs(with([](Claim&, Candidate& first) { first.e_value.reset(); }), name + "e_value"));
  CHECK(differs(with([](Claim&, Candidate& first) { first.parameters.front().value *= 1.1; }),
                name + found.claim.candidates.front().parameters.front().name));
}

TEST_CASE("another effect in the place of the one named is found, and one that no data show") {
  const Diagnosed found([](const Reading& r) { return 1.0 * d(r); });
  Claim swapped = found.claim;
  swapped.candidates.front().effect = effect(effects::step, Axis::X, Sense::EX);
  swapped.candidates.front().tried_at = {500.0, {0}};
  CHECK(differs(found.checked_as(swapped), "step:X:EX explained"));
  swapped.candidates.front().effect = effect(effects::step, Axis::Y, Sense::EX);
  const Check check = found.checked_as(swapped);
  CHECK(!check.holds());
  CHECK(only(check.objections) == "step:Y:EX is not a candidate for these data");
}

TEST_CASE("other readings are found, and none are refused") {
  const Diagnosed found([](const Reading& r) { return 1.0 * d(r); });
  const Observations other = observations_of(measured(
                                                 {}, kNoise_um, [](const Reading& r) { return 1.0 * d(r); }, 2),
                                             found.model, mill());
  CHECK(differs(checked(found.model, other, found.claim).value(), "rms_um"));
  CHECK(!checked(found.model, Observations{}, found.claim));
}
