// Constants of measured lines: the readout is set to zero again when the optics move from one line to the next.
#include <map>
#include <set>

#include "model/diagnosis/ladder.hpp"
#include "model/fit/compiled_model.hpp"
#include "model/fit/model_file.hpp"
#include "model/regression/candidates.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr double kPeriod_mm = 10.0;

double pitch_wave(const Reading& r) {
  if (r.axis != Axis::Y || r.sense != Sense::EY) return 0.0;
  return 1.8 * std::sin(2.0 * std::numbers::pi * p(r, Axis::Y) / kPeriod_mm);
}

/// EX and EY along X and Y, each line with its own zero, and a pitch wave in EYY.
laser::MeasurementSet four_lines(const std::map<std::pair<Axis, Sense>, double>& zeros) {
  laser::MeasurementSet set;
  unsigned seed = 1;
  for (const Axis axis : {Axis::X, Axis::Y})
    for (const Sense sense : {Sense::EX, Sense::EY})
      measure(
          set, {.axis = axis, .sense = sense, .step_mm = 20.0, .targets = 31}, kNoise_um,
          [&](const Reading& r) {
            return pitch_wave(r) + zeros.at({axis, sense});
          },
          ++seed);
  return set;
}

std::vector<std::string> names_of(const std::vector<EffectInstance>& effects) {
  std::vector<std::string> names;
  for (const EffectInstance& one : effects) names.push_back(to_text(one));
  return names;
}

std::vector<std::string> answer_to(const laser::MeasurementSet& set) {
  std::vector<std::string> names;
  for (const Candidate& one : diagnosed(usual_model(set, mill()), set).candidates)
    if (one.in_answer()) names.push_back(to_text(one.effect));
  return names;
}

}  // namespace

TEST_CASE("a new model has an offset for each line of a sense, and a wave is found beside lines of any zero") {
  const std::map<std::pair<Axis, Sense>, double> zeros{{{Axis::X, Sense::EX}, 2.0},
                                                       {{Axis::X, Sense::EY}, -12.0},
                                                       {{Axis::Y, Sense::EX}, 9.0},
                                                       {{Axis::Y, Sense::EY}, -3.0}};
  const laser::MeasurementSet set = four_lines(zeros);
  const auto names = names_of(usual_effects(observations_of(set, Model{}, mill())));
  for (const char* name : {"offset:X:EX", "offset:Y:EX:1", "offset:X:EY:1", "offset:Y:EY"})
    CHECK(std::ranges::count(names, name) == 1);
  CHECK(answer_to(set) == std::vector<std::string>{"cyclic:Y:EY"});
}

TEST_CASE("an offset acts on all readings of a sense, with a line on those along its axis, whatever its axis is") {
  const laser::MeasurementSet set = four_lines({{{Axis::X, Sense::EX}, 2.0},
                                                {{Axis::X, Sense::EY}, 0.0},
                                                {{Axis::Y, Sense::EX}, 9.0},
                                                {{Axis::Y, Sense::EY}, 0.0}});
  Model model;
  model.effects = {effect(ecs::model::test::effects::offset, Axis::X, Sense::EX),
                   effect(ecs::model::test::effects::offset, Axis::Y, Sense::EX)};
  model.effects[1].line = 1;
  const Fit fitted = must(fit(model, observations_of(set, model, mill())));
  CHECK(fitted.effects[0].parameters.front().value == Approx(2.0).epsilon(0.03));
  CHECK(fitted.effects[1].parameters.front().value == Approx(7.0).epsilon(0.03));
}

TEST_CASE("two lines at unlike zeros are a shift of the second one or a squareness, in one answer") {
  laser::MeasurementSet set;
  measure(set, {.targets = 21}, kNoise_um, nothing, 3);
  measure(
      set, {.targets = 21, .parked_mm = {0.0, 400.0, 0.0}}, kNoise_um, [](const Reading&) { return 8.0; }, 4);
  const Model model = usual_model(set, mill());
  CHECK(std::ranges::count(names_of(model.effects), "offset:X:EX:2") == 0);  // one set-up, as far as the file says
  const Diagnosis found = diagnosed(model, set);
  REQUIRE_FALSE(found.candidates.empty());
  std::set<std::string> group{to_text(found.candidates.front().effect)};
  for (const EffectInstance& rival : found.candidates.front().rivals) group.insert(to_text(rival));
  CHECK(group.contains("offset:X:EX:2"));
  CHECK(group.contains("squareness:Y:C0Y"));

  for (Reading& r : set.readings) r.extras["set_up"] = r.position_mm[1] > 0.0 ? 2.0 : 1.0;
  const Model own_zeros = usual_model(set, mill());
  CHECK(std::ranges::count(names_of(own_zeros.effects), "offset:X:EX:2") == 1);
  CHECK(diagnosed(own_zeros, set).verdict == Verdict::adequate);
}

TEST_CASE("the offset of a numbered line is written to a model file and read again; the rows of a grid have one zero") {
  Model model = straight();
  model.effects.push_back(effect(ecs::model::test::effects::offset, Axis::X, Sense::EX));
  model.effects.back().line = 3;
  const std::string text = to_toml(model);
  CHECK(contains(text, "line = 3"));
  CHECK(must(parse_model(text, "model.toml", "")).effects.back() == model.effects.back());
  CHECK(must(parse_add_request("offset:X:EX:3")).line == 3);
  const auto refused =
      parse_model("[[effect]]\nid = \"offset\"\naxis = \"X\"\nsense = \"EX\"\nline = 0\n", "m.toml", "");
  CHECK(contains(must_fail(refused).message, "offset: expected line = 1, 2"));
  laser::MeasurementSet grid;
  for (int y = 0; y < 9; ++y)
    measure(grid, {.targets = 9, .runs = 1, .both_ways = false, .parked_mm = {0.0, 50.0 * y, 0.0}}, kNoise_um, nothing);
  const Observations data = observations_of(grid, Model{}, mill());
  CHECK(std::ranges::all_of(data.line, [](int line) { return line == 1; }));
}

namespace {

/// Three runs of EX along X, then three more in another session, with a zero of their own.
laser::MeasurementSet two_sessions(double pause_s, double zero_um, const Truth& truth) {
  laser::MeasurementSet set = measured({.targets = 21}, kNoise_um, nothing, 1);
  laser::MeasurementSet later = measured({.targets = 21}, kNoise_um, nothing, 2);
  const double last_s = *set.readings.back().time_s;
  for (Reading& r : later.readings) {
    r.row += static_cast<int>(later.readings.size());
    r.run += 3;
    *r.time_s += last_s + pause_s;
    r.error += zero_um;
    set.readings.push_back(r);
  }
  for (Reading& r : set.readings) r.error += truth(r);
  return set;
}

constexpr double kLongPause_s = 14400.0, kShortPause_s = 200.0;

std::set<std::string> first_group(const laser::MeasurementSet& set) {
  const Diagnosis found = diagnosed(usual_model(set, mill()), set);
  std::set<std::string> names;
  if (found.candidates.empty() || !found.candidates.front().in_answer()) return names;
  names.insert(to_text(found.candidates.front().effect));
  for (const EffectInstance& rival : found.candidates.front().rivals) names.insert(to_text(rival));
  return names;
}

}  // namespace

TEST_CASE(
    "a session begins after a pause longer than the session before it, or in another file, with two runs or more") {
  const auto sessions = [](const laser::MeasurementSet& set) {
    const Observations data = observations_of(set, Model{}, mill());
    const auto found = data.sessions.find({Axis::X, Sense::EX});
    return found == data.sessions.end() ? std::vector<int>() : found->second;
  };
  CHECK(sessions(two_sessions(kLongPause_s, 3.0, nothing)) == std::vector<int>{4});
  laser::MeasurementSet short_pause = two_sessions(kShortPause_s, 3.0, nothing);
  CHECK(sessions(short_pause).empty());
  for (std::size_t k = 0; k < short_pause.readings.size(); ++k)  // the second half is of another file
    short_pause.readings[k].line = 2 + static_cast<int>(k % (short_pause.readings.size() / 2));
  CHECK(sessions(short_pause) == std::vector<int>{4});
  laser::MeasurementSet single = two_sessions(kLongPause_s, 3.0, nothing);
  std::erase_if(single.readings, [](const Reading& r) { return r.run > 4; });
  CHECK(sessions(single).empty());
}

TEST_CASE("a zero that was set again between two sessions is named before a drift over the pause") {
  const auto zero = first_group(two_sessions(kLongPause_s, 3.0, nothing));
  CHECK(zero.contains("offset:X:EX:run4"));
  constexpr double kHour_s = 3600.0;
  const auto drift =
      first_group(two_sessions(kLongPause_s, 0.0, [](const Reading& r) { return 2.0 * *r.time_s / kHour_s; }));
  CHECK_FALSE(drift.contains("offset:X:EX:run4"));
  CHECK(first_group(two_sessions(kLongPause_s, 0.0, nothing)).empty());
}

TEST_CASE("the zero of a session is written to a model file and read again, and no map holds it") {
  Model model = straight();
  model.effects.push_back(effect(ecs::model::test::effects::offset, Axis::X, Sense::EX));
  model.effects.back().from_run = 4;
  model.effects.back().fitted["um"] = 3.0;
  const std::string text = to_toml(model);
  CHECK(contains(text, "run = 4"));
  CHECK(must(parse_model(text, "model.toml", "")).effects.back() == model.effects.back());
  CHECK(must(parse_add_request("offset:X:EX:run4")).from_run == 4);
  CHECK(contains(must_fail(parse_add_request("offset:X:EX:run0")).message, "expected EFFECT"));
  model.effects.erase(model.effects.begin(), model.effects.end() - 1);
  const CompiledModel map = must(compiled(model, mill(), 100.0));
  CHECK(map.map.tables.empty());
  REQUIRE(map.not_carried.size() == 1);
  CHECK(contains(map.not_carried.front(), "not an error of the machine"));
}

TEST_CASE("slopes of single straightness lines are named as such, not as an angle of the carriage, and are in no map") {
  const std::map<double, double> slope_um_per_m{{0.0, 4.0}, {150.0, -9.0}, {300.0, 16.0}};
  laser::MeasurementSet set;
  for (const auto& [z_mm, slope] : slope_um_per_m) {
    laser::MeasurementSet line;
    measure(
        line, {.axis = Axis::X, .sense = Sense::EY, .step_mm = 40.0, .targets = 17, .runs = 2}, kNoise_um,
        [&](const Reading& r) { return slope * p(r) / 1000.0 + 2.0 * std::sin(p(r) / 170.0); },
        static_cast<unsigned>(z_mm) + 1);
    for (Reading& r : line.readings) {
      r.position_mm[2] = z_mm;
      set.readings.push_back(r);
    }
  }
  Model model = usual_model(set, mill());
  model.effects.push_back(effect(effect_named("progressive"), Axis::X, Sense::EY));
  const Diagnosis found = diagnosed(model, set);
  CAPTURE(found.headline);
  std::set<std::string> names;
  for (const Candidate& one : found.candidates)
    if (one.in_answer()) {
      names.insert(to_text(one.effect));
      CHECK_FALSE(is_carried(one.effect, mill()));
    }
  CHECK(names == std::set<std::string>{"scale:X:EY:2", "scale:X:EY:3"});
  CHECK(contains(found.headline, "in line 2"));
}
