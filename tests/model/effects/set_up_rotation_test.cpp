// A plate set up turned: one angle for both senses, found with its size; beside the machine's own effects where one
// sense alone was measured.
#include "model/diagnosis/ladder.hpp"
#include "model/regression/candidates.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr double kTurn_um_per_m = -67.0;

/// Holes of a plate in the plane XY, turned; EX by X and EY by Y.
laser::MeasurementSet turned_plate(double noise_um) {
  laser::MeasurementSet set;
  std::mt19937_64 random(11);
  NormalDraws noise(0.0, noise_um);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 10; ++j)
      for (const Axis axis : {Axis::X, Axis::Y}) {
        Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                  .axis = axis,
                  .position_mm = {-300.0 + 53.0 * i + 2.0 * std::sin(7.0 * j),
                                  -280.0 + 61.0 * j + 2.0 * std::sin(5.0 * i), 0.0},
                  .sense = static_cast<Sense>(axis)};
        const double turned = axis == Axis::X ? -r.position_mm[1] : r.position_mm[0];
        r.error = 1.0 + kTurn_um_per_m * turned / 1000.0 + noise(random);
        set.readings.push_back(r);
      }
  return set;
}

Model base_of_both() {
  Model model = straight(Axis::X, Sense::EX);
  for (const EffectInstance& effect : straight(Axis::Y, Sense::EY).effects) model.effects.push_back(effect);
  return model;
}

EffectInstance rotation(Sense about) { return {.id = effect_named("set_up_rotation"), .sense = about}; }

std::vector<std::string> rotations_of(const laser::MeasurementSet& set) {
  std::vector<std::string> names;
  for (const EffectInstance& one : candidate_instances(observations_of(set, Model{}, mill())))
    if (one.id == effect_named("set_up_rotation")) names.push_back(to_text(one));
  return names;
}

}  // namespace

TEST_CASE("a rotation acts across its axis, right-handed, in the translations of its plane") {
  Model model;
  model.effects = {rotation(Sense::EA)};
  model.effects[0].parameters["um_per_m"] = 10.0;
  laser::MeasurementSet set;
  for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ, Sense::EA}) {
    Reading r{.row = static_cast<int>(set.readings.size()) + 1, .position_mm = {100.0, 200.0, 300.0}, .sense = sense};
    set.readings.push_back(r);
  }
  const Observations data = observations_of(set, model, std::nullopt);
  const auto values = must(predicted(model, data));
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double expected = data.sense[k] == Sense::EY ? -3.0 : data.sense[k] == Sense::EZ ? 2.0 : 0.0;
    CHECK(values[k] == Approx(expected));
  }
}

TEST_CASE("adding it to the model of a plate finds the angle by which the plate is turned") {
  const Model model = base_of_both();
  const auto request = must(parse_add_request("set_up_rotation"));
  const auto added =
      must(add_effect(model, observations_of(turned_plate(1.0), model, std::nullopt), request, "plate.csv"));
  CHECK(to_text(added.effect.effect) == "set_up_rotation:EC");
  const ParameterEstimate& angle = added.effect.parameters.at(0);
  REQUIRE(angle.sigma);
  CHECK(*angle.sigma < 1.0);
  CHECK(std::abs(angle.value - kTurn_um_per_m) < 4.0 * *angle.sigma);
  CHECK(added.rms_after_um < 1.2);
}

TEST_CASE("one rotation is named for a turned plate, not a slope in each sense") {
  const auto set = turned_plate(1.0);
  const Diagnosis diagnosis = diagnosed(base_of_both(), set);
  CHECK(diagnosis.verdict == Verdict::missing_effect);
  REQUIRE(!diagnosis.candidates.empty());
  CHECK(to_text(diagnosis.candidates[0].effect) == "set_up_rotation:EC");
  CHECK(std::count_if(diagnosis.candidates.begin(), diagnosis.candidates.end(),
                      [](const Candidate& one) { return one.named; }) == 1);
}

TEST_CASE("with one sense alone the machine's effect comes first and the rotation beside it") {
  laser::MeasurementSet one_sense = turned_plate(1.0);
  std::erase_if(one_sense.readings, [](const Reading& r) { return r.sense != Sense::EX; });
  const Diagnosis diagnosis = diagnosed(straight(Axis::X, Sense::EX), one_sense);
  REQUIRE(!diagnosis.candidates.empty());
  const Candidate& first = diagnosis.candidates[0];
  CHECK(to_text(first.effect) != "set_up_rotation:EC");
  const auto& group = first.indistinguishable_from;
  CHECK(std::find(group.begin(), group.end(), "set_up_rotation:EC") != group.end());
}

TEST_CASE("a rotation is sought once for both senses, where a cross coordinate varies") {
  CHECK(rotations_of(turned_plate(1.0)) == std::vector<std::string>{"set_up_rotation:EC"});
  Plan along;
  CHECK(rotations_of(measured(along, 0.5, nothing)).empty());
  along.sense = Sense::EY;
  CHECK(rotations_of(measured(along, 0.5, nothing)) == std::vector<std::string>{"set_up_rotation:EC"});
  along.sense = Sense::EZ;
  CHECK(rotations_of(measured(along, 0.5, nothing)) == std::vector<std::string>{"set_up_rotation:EB"});
}

TEST_CASE("a model file names the rotation by its code, and refuses another") {
  const auto model = must(parse_model("[[effect]]\nid = \"set_up_rotation\"\ncode = \"EB\"\n", "model.toml", "."));
  CHECK(model.effects.at(0) == rotation(Sense::EB));
  CHECK(must(parse_model(to_toml(model), "model.toml", ".")).effects == model.effects);
  for (const char* code : {"", "code = \"EX\"\n", "code = \"ECX\"\n"}) {
    const auto bad =
        must_fail(parse_model(std::string("[[effect]]\nid = \"set_up_rotation\"\n") + code, "model.toml", "."));
    CHECK(contains(to_text(bad), "EA, EB or EC"));
  }
}

TEST_CASE("a turned plate is one cause beside a free wave of the model, no slope in either sense") {
  laser::MeasurementSet set = turned_plate(1.0);
  for (Reading& r : set.readings)
    if (r.sense == Sense::EX) r.error += 4.0 * std::sin(r.position_mm[0] / 97.0 * 6.2831853);
  Model model = base_of_both();
  model.effects.push_back(effect(effects::cyclic, Axis::X, Sense::EX));
  const Diagnosis found = diagnosed(model, set);
  CHECK(found.verdict == Verdict::missing_effect);
  std::vector<std::string> names;
  for (const Candidate& candidate : found.candidates) {
    if (!candidate.named) continue;
    names.push_back(to_text(candidate.effect));
    names.insert(names.end(), candidate.indistinguishable_from.begin(), candidate.indistinguishable_from.end());
    CHECK(names.size() == 1 + candidate.indistinguishable_from.size());  // one cause only
  }
  CHECK(std::find(names.begin(), names.end(), to_text(rotation(Sense::EC))) != names.end());
}
