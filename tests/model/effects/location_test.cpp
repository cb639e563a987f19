// Location errors of rotary axes and error motions in readings of a ball: what the model says of them against exact
// matrices (tests/support/exact_joints.hpp), and what it finds in such readings.
#include "model/diagnosis/ladder.hpp"
#include "model/diagnosis/words.hpp"
#include "model/regression/candidates.hpp"
#include "tests/model/support/turning_machine.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// Only where the ball is and lost motion: what a user has who thinks the axis lines to be in place.
Model without_locations(Model model) {
  std::erase_if(model.effects, [](const EffectInstance& one) { return one.definition().place == Place::location; });
  return model;
}

Diagnosis found_in(const laser::MeasurementSet& set, const TurningMachine& made, const Model& model) {
  return must(diagnose(model, observations_of(set, model, made.machine)));
}

const Candidate* named_candidate(const Diagnosis& found) {
  for (const Candidate& one : found.candidates)
    if (one.named) return &one;
  return nullptr;
}

}  // namespace

TEST_CASE("every error of the rotary axes reaches a reading as exact matrices say") {
  for (const bool on_workpiece : {false, true})
    for (const std::size_t axis : {0U, 2U})
      for (std::size_t s = 0; s < 6; ++s) {
        CAPTURE(axis);
        CAPTURE(s);
        TurningMachine made = trunnion();
        constexpr double kSmall = 0.5;  // um, um/m: second order stays below 1e-6 um
        made.exact.location[axis][s] = kSmall;
        const laser::MeasurementSet set = ball_set(made, {Eigen::Vector3d::Zero(), 0.0, on_workpiece});
        const Observations data = observations_of(set, Model{}, made.machine);
        REQUIRE(data.through_chain.size() == data.size());
        double worst = 0.0, size = 0.0;
        for (std::size_t k = 0; k < data.size(); ++k) {
          const double expected = kSmall * data.share_of(k, static_cast<Axis>(axis), static_cast<Sense>(s));
          worst = std::max(worst, std::abs(expected - data.reading[k]));
          size = std::max(size, std::abs(expected));
        }
        CHECK(worst < 2e-6);
        CHECK(size > 0.01);
      }
}

TEST_CASE("a ball off its place turns with the workpiece") {
  const TurningMachine made = trunnion();
  const laser::MeasurementSet set = ball_set(made, {{12.0, -7.0, 5.0}});
  const Model model = usual_model(set, made.machine);
  const auto fitted = must(fit(model, observations_of(set, model, made.machine)));
  CHECK(fitted.rms_um < 1e-6);
  const auto& place = fitted.effects.front().parameters;
  REQUIRE(place.size() == 3);
  CHECK(place[0].value == Approx(12.0));
  CHECK(place[1].value == Approx(-7.0));
  CHECK(place[2].value == Approx(5.0));
}

TEST_CASE("a hidden location error is named, fitted, and what looks like it is said") {
  struct Case {
    std::size_t axis, letter;
    const char* name;
    double size;
  };
  for (const Case& one : {Case{2, 0, "location:C:XOC", 6.0}, Case{2, 4, "location:C:BOC", 25.0},
                          Case{0, 1, "location:A:YOA", 5.0}, Case{0, 5, "location:A:COA", -30.0}}) {
    CAPTURE(one.name);
    TurningMachine made = trunnion();
    made.exact.location[one.axis][one.letter] = one.size;
    const laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.6}, 11);
    const Diagnosis found = found_in(set, made, without_locations(usual_model(set, made.machine)));
    CHECK(found.verdict == Verdict::missing_effect);
    const Candidate* named = named_candidate(found);
    REQUIRE(named != nullptr);
    CHECK(to_text(named->effect) == one.name);
    CHECK(named->parameters.front().value == Approx(one.size).epsilon(0.15));
    CHECK(named->parameters.front().unit == (one.letter < 3 ? "um" : "um/m"));
  }
}

TEST_CASE("at one angle of the other axis, places of both axis lines and the zero of the probe are one group") {
  TurningMachine made = trunnion();
  made.exact.location[2][1] = 7.0;  // YOC
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.5}, 12);
  std::erase_if(set.readings, [](const Reading& r) { return r.axis != Axis::Z || r.angle_deg[0] != 0.0; });
  const Diagnosis found = found_in(set, made, without_locations(usual_model(set, made.machine)));
  const Candidate* named = named_candidate(found);
  REQUIRE(named != nullptr);
  CHECK(to_text(named->effect) == "location:C:YOC");
  std::vector<std::string> rivals;
  for (const EffectInstance& rival : named->rivals) rivals.push_back(to_text(rival));
  CHECK(std::find(rivals.begin(), rivals.end(), "location:A:YOA") != rivals.end());
  CHECK(std::find_if(rivals.begin(), rivals.end(),
                     [](const std::string& rival) { return rival.starts_with("offset:"); }) != rivals.end());
}

TEST_CASE("a sound machine with a ball off its place is adequate") {
  const TurningMachine made = trunnion();
  const laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.6}, 13);
  CHECK(found_in(set, made, usual_model(set, made.machine)).verdict == Verdict::adequate);
}

TEST_CASE("a model begins with the location errors that the readings show, and fits all of them at once") {
  TurningMachine made = trunnion();
  const std::vector<std::pair<std::string, double>> true_errors{
      {"location:A:YOA", 6.0}, {"location:A:ZOA", -9.0}, {"location:A:BOA", 14.0}, {"location:A:COA", -7.0},
      {"location:C:XOC", 8.0}, {"location:C:YOC", -5.5}, {"location:C:AOC", 18.0}, {"location:C:BOC", -12.0}};
  for (const auto& [name, size] : true_errors)
    made.exact.location[static_cast<std::size_t>(name[9] - 'A')][std::string("XYZABC").find(name[11])] = size;
  const laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.6}, 15);
  const Model model = usual_model(set, made.machine);
  CHECK(found_in(set, made, model).verdict == Verdict::adequate);
  const auto fitted = must(fit(model, observations_of(set, model, made.machine)));
  for (const auto& true_error : true_errors) {
    const std::string& name = true_error.first;
    const double size = true_error.second;
    CAPTURE(name);
    const auto one = std::find_if(fitted.effects.begin(), fitted.effects.end(),
                                  [&](const EffectFit& effect) { return to_text(effect.effect) == name; });
    REQUIRE(one != fitted.effects.end());
    const ParameterEstimate& value = one->parameters.front();
    REQUIRE(value.sigma);
    CHECK(std::abs(value.value - size) < 3.0 * *value.sigma);
    CHECK(*value.sigma < 1.0);
  }
}

TEST_CASE("what does the same as a location error of the model is kept as its alternative") {
  const TurningMachine made = trunnion();
  const auto alternatives_of = [&](const laser::MeasurementSet& set, const std::string& name) {
    const Model model = usual_model(set, made.machine);
    for (const EffectInstance& one : model.effects)
      if (to_text(one) == name) return one.tied_with;
    return std::string("not in the model");
  };
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.5}, 12);
  CHECK(alternatives_of(set, "location:C:XOC").starts_with("offset:"));
  CHECK(alternatives_of(set, "location:C:YOC") == "");
  CHECK(alternatives_of(set, "location:C:COC") == "not in the model");  // another place of the ball does the same
  std::erase_if(set.readings, [](const Reading& r) { return r.axis != Axis::Z || r.angle_deg[0] != 0.0; });
  CHECK(contains(alternatives_of(set, "location:C:YOC"), "location:A:YOA"));
}

TEST_CASE("each of two balls has a place of its own, and the errors of the axes are those of both") {
  TurningMachine made = trunnion();
  made.exact.location[2][4] = -12.0;  // BOC
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.4}, 17);
  const laser::MeasurementSet second = ball_set(made, {{-20.0, 6.0, 11.0}, 0.4, false, {655.0, 380.0, -380.0}}, 18);
  const double later_s = *set.readings.back().time_s;
  for (Reading r : second.readings) {
    r.time_s = *r.time_s + later_s;
    r.row += static_cast<int>(set.readings.size());
    set.readings.push_back(r);
  }
  const Model model = usual_model(set, made.machine);
  CHECK(to_text(model.effects[0]) == "ball_on_table");
  CHECK(to_text(model.effects[1]) == "ball_on_table:2");
  CHECK(found_in(set, made, model).verdict == Verdict::adequate);
  const auto fitted = must(fit(model, observations_of(set, model, made.machine)));
  CHECK(fitted.effects[0].parameters[0].value == Approx(14.0).epsilon(0.05));
  CHECK(fitted.effects[1].parameters[0].value == Approx(-20.0).epsilon(0.05));
  const std::string text = to_toml(model);
  CHECK(contains(text, "ball = 2"));
  CHECK(parse_model(text, "model.toml", {})->effects == model.effects);
  CHECK(!parse_model("[[effect]]\nid = \"ball_on_table\"\nball = 0\n", "m.toml", {}));
  CHECK(!parse_model("[[effect]]\nid = \"scale\"\naxis = \"X\"\nball = 2\n", "m.toml", {}));
  CHECK(parse_add_request("ball_on_table:2")->ball == 2);
}

TEST_CASE("a ball that was set up again has a position of its own in each set-up, if each has the poses for one") {
  TurningMachine made = trunnion();
  made.exact.location[2][4] = -12.0;  // BOC
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.4}, 17);
  const std::size_t first = set.readings.size();
  const double later_s = *set.readings.back().time_s;
  for (Reading r : ball_set(made, {{94.0, -9.0, 43.0}, 0.4}, 18).readings) {
    r.time_s = *r.time_s + later_s;
    r.row += static_cast<int>(first);
    set.readings.push_back(r);
  }
  CHECK(found_in(set, made, usual_model(set, made.machine)).verdict != Verdict::adequate);
  for (std::size_t i = 0; i < set.readings.size(); ++i) set.readings[i].extras["set_up"] = i < first ? 1.0 : 2.0;
  const Model model = usual_model(set, made.machine);
  CHECK(found_in(set, made, model).verdict == Verdict::adequate);
  const Observations data = observations_of(set, model, made.machine);
  const auto fitted = must(fit(model, data));
  REQUIRE(to_text(fitted.effects[1].effect) == "ball_on_table:2");
  CHECK(fitted.effects[1].parameters[0].value - fitted.effects[0].parameters[0].value == Approx(80.0).epsilon(0.02));
  CHECK(fitted.effects[1].parameters[2].value - fitted.effects[0].parameters[2].value == Approx(40.0).epsilon(0.04));
  CHECK(contains(ball_text(fitted.effects[1].effect, data), ", set-up 2)"));
  for (std::size_t i = first; i < set.readings.size(); ++i) set.readings[i].extras["set_up"] = i == first ? 2.0 : 1.0;
  CHECK(observations_of(set, model, made.machine).balls_mm.size() == 1);
}

TEST_CASE("two balls in one run, from the same angles, are followed") {
  const TurningMachine made = trunnion();
  laser::MeasurementSet set;
  for (const Vector3& place : {Vector3{600.0, 420.0, -400.0}, Vector3{655.0, 380.0, -380.0}})
    for (Reading r : ball_set(made, {{0.0, 0.0, 0.0}, 0.4, false, place}, 21).readings) {
      if (r.axis != Axis::Z || r.approach != Approach::forward || r.angle_deg[0] != 0.0) continue;
      r.run = 1;
      r.row = static_cast<int>(set.readings.size()) + 1;
      r.time_s = r.row;
      set.readings.push_back(r);
    }
  const Observations data = observations_of(set, Model{}, made.machine);
  CHECK(data.not_followed == "");
  CHECK(data.balls_mm.size() == 2);
  TurningMachine other = made;
  other.machine.rotary[2]->pivot_mm[0] += 30.0;
  CHECK(observations_of(set, Model{}, other.machine).not_followed != "");
}

TEST_CASE("readings that do not follow a ball with the pivots given are not taken") {
  const TurningMachine made = trunnion();
  TurningMachine other = made;
  other.machine.rotary[0]->pivot_mm[2] += 4.0;
  const laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.4}, 19);
  CHECK(observations_of(set, Model{}, made.machine).not_followed == "");
  CHECK(observations_of(set, Model{}, made.machine).balls_mm.size() == 1);
  const std::string why = observations_of(set, Model{}, other.machine).not_followed;
  check_holds(why, {"the linear axes did not follow a ball", "pivot_mm"});
  laser::MeasurementSet other_sign = set;
  for (Reading& r : other_sign.readings) r.angle_deg[2] = r.angle_deg[2] == 0.0 ? 0.0 : 360.0 - r.angle_deg[2];
  CHECK(!observations_of(other_sign, Model{}, made.machine).not_followed.empty());
}

TEST_CASE("of a location error that the readings do not tell from another, the size that this stands for is known") {
  TurningMachine made = trunnion();
  made.exact.location[2][1] = 7.0;  // YOC
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.3}, 20);
  CHECK(exchangeable_locations(observations_of(set, Model{}, made.machine), usual_model(set, made.machine).effects)
            .empty());
  std::erase_if(set.readings, [](const Reading& r) { return r.axis != Axis::Z || r.angle_deg[0] != 0.0; });
  const Model model = usual_model(set, made.machine);
  const Observations data = observations_of(set, model, made.machine);
  const auto fitted = must(fit(model, data));
  double stands_for_um = 0.0;
  for (const Exchangeable& one : exchangeable_locations(data, with_values(model, fitted).effects))
    if (to_text(one.effect) == "location:A:YOA") stands_for_um = one.stands_for;
  CHECK(stands_for_um == Approx(7.0).epsilon(0.1));
  CHECK(exchangeable_locations(data, model.effects).size() >= 2);  // YOA and BOA, of which BOA acts as BOC
}

TEST_CASE("an axis that stands at several angles has lost motion in the model too") {
  const TurningMachine made = trunnion();
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.3}, 21);
  std::erase_if(set.readings, [](const Reading& r) { return r.axis != Axis::Z; });
  const Model model = usual_model(set, made.machine);
  CHECK(std::any_of(model.effects.begin(), model.effects.end(),
                    [](const EffectInstance& one) { return to_text(one) == "backlash:A:EA"; }));
}

TEST_CASE("angles that the machine does not have are no readings of it") {
  TurningMachine made = trunnion();
  const laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.3}, 22);
  made.machine.rotary[0]->travel_deg = {-90.0, 30.0};
  CHECK(observations_of(set, Model{}, made.machine).not_followed.find("A at -96 deg is beyond its travel") == 0);
}

TEST_CASE("no wave of a rotary axis is longer than a turn") {
  const TurningMachine made = trunnion();
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.3}, 23);
  const Observations data = observations_of(set, Model{}, made.machine);
  for (std::size_t k = 0; k < data.size(); ++k)
    set.readings[data.file_order[k]].error += 0.5 * data.position_mm[k][0] * data.share_of(k, Axis::X, Sense::EA);
  const Diagnosis found = found_in(set, made, usual_model(set, made.machine));
  bool any = false;
  for (const Candidate& one : found.candidates)
    for (const ParameterEstimate& parameter : one.parameters)
      if (parameter.name == "period_mm") {
        CHECK(parameter.value <= 360.0);
        any = true;
      }
  CHECK(any);
}

TEST_CASE("a standing axis keeps the lost motion with which it came to its angle") {
  TurningMachine made = trunnion();
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.3}, 16);
  Observations data = observations_of(set, Model{}, made.machine);
  bool came_back = false;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.axis[k] == Axis::X) continue;
    const int side = data.approach_of(k, Axis::X);
    CHECK(side == (data.position_mm[k][0] == 0.0 ? 1 : -1));  // A 0 first, then down to -60
    came_back = came_back || side < 0;
  }
  CHECK(came_back);
  for (std::size_t k = 0; k < data.size(); ++k)
    set.readings[data.file_order[k]].error +=
        20.0 / 2.0 * data.approach_of(k, Axis::X) * data.share_of(k, Axis::X, Sense::EA);
  const Model model = usual_model(set, made.machine);
  data = observations_of(set, model, made.machine);
  const auto fitted = must(fit(model, data));
  CHECK(fitted.rms_um == Approx(0.3).epsilon(0.15));
  for (const EffectFit& one : fitted.effects)
    if (to_text(one.effect) == "backlash:A:EA") CHECK(one.parameters.front().value == Approx(20.0).epsilon(0.05));
}

TEST_CASE("an eccentric encoder is a wave of one turn in the positioning, seen through the radius of the ball") {
  TurningMachine made = trunnion();
  laser::MeasurementSet set = ball_set(made, {{14.0, -9.0, 3.0}, 0.5}, 14);
  const Observations data = observations_of(set, Model{}, made.machine);
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double wave = 40.0 * std::sin(data.position_mm[k][2] * std::numbers::pi / 180.0 + 0.7);
    set.readings[data.file_order[k]].error += wave * data.share_of(k, Axis::Z, Sense::EC);
  }
  const Diagnosis found = found_in(set, made, usual_model(set, made.machine));
  const Candidate* named = named_candidate(found);
  REQUIRE(named != nullptr);
  CHECK(to_text(named->effect) == "cyclic:C:EC");
  CHECK(found.verdict == Verdict::missing_effect);
}

TEST_CASE("a model file holds location errors by their code, directions in um/m") {
  const auto read =
      must(parse_model("[[effect]]\nid = \"location\"\naxis = \"C\"\ncode = \"XOC\"\nparameters = { um = 3.5 }\n\n"
                       "[[effect]]\nid = \"location\"\ncode = \"BOC\"\nfitted = { um_per_m = -12 }\n\n"
                       "[[effect]]\nid = \"ball_on_table\"\n",
                       "model.toml", {}));
  CHECK(to_text(read.effects[0]) == "location:C:XOC");
  CHECK(to_text(read.effects[1]) == "location:C:BOC");
  const std::string text = to_toml(read);
  CHECK(contains(text, "um_per_m = -12"));
  CHECK(parse_model(text, "model.toml", {})->effects == read.effects);
  for (const char* wrong : {"code = \"XXC\"", "axis = \"A\"\ncode = \"XOC\"", "code = \"ECX\""}) {
    const auto refused =
        must_fail(parse_model(std::string("[[effect]]\nid = \"location\"\n") + wrong + "\n", "m.toml", {}));
    CHECK(contains(refused.message, "such as XOC"));
  }
}

namespace {

/// Scale of X, Y, Z, then C0Y, B0Z, A0Z [um/m].
using LinearErrors = std::array<double, 6>;

/// A ball probed at five angles of B and four of C, by exact matrices; `at_tip`: the columns hold the tool centre
/// point.
laser::MeasurementSet head_set(const LinearErrors& errors, bool at_tip, double noise_um = 0.0) {
  TurningMachine made = head();
  std::mt19937_64 random(3);
  NormalDraws normal;
  const Eigen::Vector3d at(468.8, 323.6, -859.0);
  const ecs::test::ExactMachine ideal = made.exact;
  laser::MeasurementSet set;
  int run = 0;
  for (const double c : {0.0, 90.0, 180.0, 270.0})
    for (const double b : {0.0, 45.0, -45.0, 90.0, -90.0}) {
      const Angles angles{0.0, b, c};
      const Eigen::Vector3d p = at - exact_pose(ideal, {}, angles).translation();
      for (std::size_t l = 0; l < 3; ++l)
        made.exact.values.curve[l][l] = errors[l] * p[static_cast<Eigen::Index>(l)] / 1000.0;
      for (std::size_t q = 0; q < 3; ++q) made.exact.values.squareness[kCurves + q] = errors[3 + q];
      const Vector3 e = exact_tool_error(made.exact, {p.x(), p.y(), p.z()}, angles).error_um;
      ++run;
      for (std::size_t d = 0; d < 3; ++d) {
        Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                  .axis = Axis::Y,
                  .rotary = true,
                  .position_mm = at_tip ? Vector3{at.x(), at.y(), at.z()} : Vector3{p.x(), p.y(), p.z()},
                  .angle_deg = angles,
                  .sense = static_cast<Sense>(d),
                  .error = e[d] + noise_um * normal(random),
                  .approach = Approach::unknown};
        if (at_tip) r.extras["at_tip"] = 1.0;
        set.readings.push_back(r);
      }
    }
  return set;
}

Model of_artefacts(std::initializer_list<const char*> ids) {
  Model model;
  for (const char* const id : ids) {
    EffectInstance one;
    one.id = effect_named(id);
    one.rotary = true;
    model.effects.push_back(one);
  }
  return model;
}

}  // namespace

TEST_CASE("where the control shows the tool centre point, the linear axes stand as exact matrices say") {
  const TurningMachine made = head();
  const Observations by_axes = observations_of(head_set({}, false), Model{}, made.machine);
  const Observations by_tip = observations_of(head_set({}, true), Model{}, made.machine);
  REQUIRE(by_axes.place_mm.size() == by_tip.place_mm.size());
  CHECK(by_tip.not_followed == "");
  for (std::size_t k = 0; k < by_axes.size(); ++k)
    for (std::size_t d = 0; d < kAxes; ++d) CHECK(by_tip.place_mm[k][d] == Approx(by_axes.place_mm[k][d]));
  CHECK(by_tip.through_chain.back().of_axis == by_axes.through_chain.back().of_axis);
}

TEST_CASE("scale and squareness of the linear axes come back from a ball under a head, as exact matrices made them") {
  const LinearErrors errors{40.0, -25.0, 30.0, 15.0, -20.0, 35.0};
  const TurningMachine made = head();
  const Model model = of_artefacts({"ball_on_table", "linear_axes"});
  const auto fitted = must(fit(model, observations_of(head_set(errors, true), model, made.machine)));
  CHECK(fitted.rms_um < 1e-3);  // second order
  for (std::size_t i = 0; i < errors.size(); ++i)
    CHECK(fitted.effects[1].parameters[i].value == Approx(errors[i]).epsilon(1e-3));
}

TEST_CASE("a head that bends follows sine and cosine of its tilting angle, in the frame that C turns") {
  const TurningMachine made = head();
  laser::MeasurementSet set = head_set({}, true, 1.0);
  for (Reading& r : set.readings) {
    const double b = r.angle_deg[1] * std::numbers::pi / 180.0, c = r.angle_deg[2] * std::numbers::pi / 180.0;
    const double along = 60.0 * std::sin(b), up = -40.0 * (1.0 - std::cos(b));  // X of the part that C turns, Z
    r.error += r.sense == Sense::EX ? along * std::cos(c) : r.sense == Sense::EY ? along * std::sin(c) : up;
  }
  const Model model = of_artefacts({"ball_on_table", "head_bending"});
  const auto fitted = must(fit(model, observations_of(set, model, made.machine)));
  CHECK(fitted.rms_um < 1.3);
  CHECK(fitted.effects[1].parameters[0].value == Approx(60.0).epsilon(0.03));
  CHECK(fitted.effects[1].parameters[5].value == Approx(-40.0).epsilon(0.05));
}

TEST_CASE("scale and squareness of the linear axes reach a reading through every chain as exact matrices say") {
  const LinearErrors errors{40.0, -25.0, 30.0, 15.0, -20.0, 35.0};
  const params::MachineRotaryAxis a{{-100.0, 100.0}, {1.0, 0.0, 0.0}, {600.0, 300.0, -560.0}};
  const params::MachineRotaryAxis b{{-100.0, 100.0}, {0.0, 1.0, 0.0}, {0.7, 26.7, 309.0}};
  const params::MachineRotaryAxis c{{-360.0, 360.0}, {0.0, 0.0, 1.0}, {605.0, 298.0, -500.0}};
  for (TurningMachine made :
       {TurningMachine("XYACTZ", {{'A', a}, {'C', c}}), TurningMachine("XYCTZB", {{'C', c}, {'B', b}}),
        TurningMachine("TXYZCB", {{'C', c}, {'B', b}}), TurningMachine("CXTYZB", {{'C', c}, {'B', b}})}) {
    CAPTURE(made.exact.configuration);
    std::mt19937_64 random(7);
    UniformDraws draw(-1.0, 1.0);
    laser::MeasurementSet set;
    std::vector<double> expected;
    for (int k = 0; k < 20; ++k) {
      const Vector3 p{500.0 + 300.0 * draw(random), 300.0 * draw(random), -400.0 + 200.0 * draw(random)};
      Angles angles{90.0 * draw(random), 90.0 * draw(random), 180.0 * draw(random)};
      for (std::size_t r = 0; r < kAxes; ++r)
        if (!made.machine.rotary[r]) angles[r] = 0.0;
      for (std::size_t l = 0; l < kAxes; ++l) made.exact.values.curve[l][l] = errors[l] * p[l] / 1000.0;
      for (std::size_t q = 0; q < kAxes; ++q) made.exact.values.squareness[kCurves + q] = errors[3 + q];
      const Vector3 e = exact_tool_error(made.exact, p, angles).error_um;
      for (std::size_t d = 0; d < kAxes; ++d) {
        Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                  .axis = Axis::Z,
                  .rotary = true,
                  .position_mm = p,
                  .angle_deg = angles,
                  .sense = static_cast<Sense>(d)};
        r.extras["on_workpiece"] = 1.0;
        set.readings.push_back(r);
        expected.push_back(e[d]);
      }
    }
    const Observations data = observations_of(set, Model{}, made.machine);
    REQUIRE(data.through_chain.size() == expected.size());
    for (std::size_t k = 0; k < data.size(); ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < errors.size(); ++i) sum += errors[i] * data.through_chain[k].of_linear[i];
      CHECK(sum == Approx(expected[data.file_order[k]]).epsilon(1e-3).scale(1.0));
    }
  }
}

TEST_CASE("squareness on a machine of table C and head B is found as that, not as waves of the rotary axes") {
  TurningMachine made("XYCTZB", {{'C', {{0.0, 360.0}, {0.0, 0.0, 1.0}, {605.0, 298.0, -500.0}}},
                                 {'B', {{-100.0, 100.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 309.0}}}});
  std::mt19937_64 random(17);
  NormalDraws noise(0.0, 0.6);
  const Eigen::Vector3d at = exact_pose(made.exact, {800.0, 340.0, -450.0}, {}).translation();
  laser::MeasurementSet set;
  int run = 0;
  for (const double b : {0.0, 30.0, -30.0, 60.0, -60.0})
    for (int i = 0; i < 12; ++i) {
      const Angles angles{0.0, b, 30.0 * i};
      const Eigen::Matrix3d bed = bed_of(made.exact, angles);
      const Eigen::Vector3d p = bed.transpose() * (at - exact_pose(made.exact, {}, angles).translation());
      ecs::test::ExactMachine leaning = made.exact;
      leaning.values.squareness[kCurves] = 60.0;  // C0Y
      const Vector3 e = exact_tool_error(leaning, {p.x(), p.y(), p.z()}, angles).error_um;
      const Eigen::Vector3d read = bed.transpose() * Eigen::Vector3d(e[0], e[1], e[2]);
      ++run;
      for (int d = 0; d < 3; ++d)
        set.readings.push_back({.row = static_cast<int>(set.readings.size()) + 1,
                                .axis = Axis::Z,
                                .rotary = true,
                                .position_mm = {p.x(), p.y(), p.z()},
                                .angle_deg = angles,
                                .sense = static_cast<Sense>(d),
                                .error = read[d] + noise(random),
                                .approach = Approach::forward,
                                .time_s = 5.0 * run});
    }
  const Diagnosis found = found_in(set, made, usual_model(set, made.machine));
  REQUIRE_FALSE(found.candidates.empty());
  const Candidate& first = found.candidates.front();
  INFO(found.headline);
  CHECK(to_text(first.effect) == "linear_axes");
  CHECK(first.in_answer());
  CHECK(contains(found.headline, "squareness C0Y of X and Y"));
}

TEST_CASE(
    "a tilting axis whose scale is wrong is found as that; of an axis read over less than its turn there is none") {
  TurningMachine made = head();
  laser::MeasurementSet set = head_set({}, true, 1.0);
  Model model = usual_model(set, made.machine);
  const Observations data = observations_of(set, model, made.machine);
  const auto all = candidate_instances(data);
  const auto names = [&](const char* name) {
    return std::ranges::count_if(all, [&](const EffectInstance& one) { return to_text(one) == name; });
  };
  CHECK(names("tilt_scale:B:EB") == 1);
  CHECK(names("tilt_scale:C:EC") == 0);
  for (std::size_t k = 0; k < data.size(); ++k)
    set.readings[data.file_order[k]].error += 4.0 * data.position_mm[k][1] * data.share_of(k, Axis::Y, Sense::EB);
  model.effects.push_back(effect(effect_named("tilt_scale"), Axis::Y, Sense::EB));
  model.effects.back().rotary = true;
  const auto fitted = must(fit(model, observations_of(set, model, made.machine)));
  CHECK(fitted.effects.back().parameters.front().value == Approx(4.0).epsilon(0.05));
  CHECK(fitted.effects.back().parameters.front().unit == "um/m/deg");
}

TEST_CASE("an angle that is not the same again after a whole turn is a wrong ratio; one that is, is a wave") {
  const auto found_with = [](double um_per_degree, double wave_um, int last = 24, double tooth_um = 0.0) {
    laser::MeasurementSet set;
    std::mt19937_64 random(9);
    NormalDraws noise(0.0, 1.0);
    for (int run = 1; run <= 3; ++run)
      for (const bool forward : {true, false})
        for (int k = 0; k <= last; ++k) {
          const double c_deg = 15.0 * (forward ? k : last - k);
          set.readings.push_back({.row = static_cast<int>(set.readings.size()) + 1,
                                  .axis = Axis::Z,
                                  .rotary = true,
                                  .angle_deg = {0.0, 0.0, c_deg},
                                  .sense = Sense::EC,
                                  .error = um_per_degree * c_deg +
                                           wave_um * std::sin(c_deg * std::numbers::pi / 180.0) +
                                           (std::abs(c_deg - 225.0) < 20.0 ? tooth_um : 0.0) + noise(random),
                                  .approach = forward ? Approach::forward : Approach::reverse,
                                  .run = run});
        }
    const Model model = usual_model(set);
    const Diagnosis found = must(diagnose(model, observations_of(set, model, std::nullopt)));
    std::map<std::string, double> named;
    for (const Candidate& one : found.candidates)
      if (one.in_answer()) named[to_text(one.effect)] = one.parameters.front().value;
    return named;
  };
  const auto both = found_with(40.0 / 360.0, 10.0);
  REQUIRE(both.size() == 2);
  CHECK(both.at("tilt_scale:C:EC") == Approx(40.0 / 360.0).epsilon(0.03));
  CHECK(both.contains("cyclic:C:EC"));
  const auto wave = found_with(0.0, 10.0);
  REQUIRE(wave.size() == 1);
  CHECK(wave.contains("cyclic:C:EC"));
  const auto open = found_with(40.0 / 360.0, 10.0, 23);
  REQUIRE(open.size() == 2);
  CHECK(open.at("tilt_scale:C:EC") == Approx(40.0 / 360.0).epsilon(0.03));
  for (const double tooth_um : {-6.0, 6.0, 15.0})
    CHECK_FALSE(found_with(0.0, 10.0, 23, tooth_um).contains("tilt_scale:C:EC"));

  EffectInstance scale = effect(effect_named("tilt_scale"), Axis::Z, Sense::EC);
  scale.rotary = true;
  params::Machine machine = trunnion().machine;
  for (auto& axis : machine.rotary)
    if (axis) axis->resolution_deg = 0.001;
  CHECK_FALSE(is_carried(scale, machine));
  CHECK(contains(how_compensated(scale, machine), "correct its ratio in the control"));
  machine.rotary[2]->travel_deg = {-100.0, 100.0};
  CHECK(is_carried(scale, machine));
}

TEST_CASE(
    "bending in the frame of the machine and in proportion to the tool's length are told from that in the head's") {
  const TurningMachine made = head();
  laser::MeasurementSet set = head_set({}, false, 0.5);
  const auto shorter = set.readings;
  for (Reading r : shorter) {  // the same poses with a second tool
    r.row = static_cast<int>(set.readings.size()) + 1;
    r.extras["tool_z_mm"] = -150.0;
    set.readings.push_back(r);
  }
  for (Reading& r : set.readings) {
    const double b = r.angle_deg[1] * std::numbers::pi / 180.0, c = r.angle_deg[2] * std::numbers::pi / 180.0;
    const double of_tool = (r.extras.contains("tool_z_mm") ? 0.15 : 0.0) * 200.0 * std::sin(b);
    if (r.sense == Sense::EX) r.error += 50.0 * std::sin(b) + of_tool * std::cos(c);
    if (r.sense == Sense::EY) r.error += of_tool * std::sin(c);
  }
  const Model model = of_artefacts({"ball_on_table", "machine_bending", "tool_bending", "head_bending"});
  const auto fitted = must(fit(model, observations_of(set, model, made.machine)));
  CHECK(fitted.effects[1].parameters[0].value == Approx(50.0).epsilon(0.05));
  CHECK(fitted.effects[2].parameters[0].value == Approx(200.0).epsilon(0.05));
  CHECK(std::abs(fitted.effects[3].parameters[0].value) < 2.0);
}

TEST_CASE(
    "linear axes are tried on every chain, bending where a rotary axis carries the tool, neither in a new model") {
  const auto has = [](const std::vector<EffectInstance>& all, const char* id) {
    return std::any_of(all.begin(), all.end(), [&](const EffectInstance& one) { return to_text(one) == id; });
  };
  const Observations under_head = observations_of(head_set({}, true), Model{}, head().machine);
  const TurningMachine table = trunnion();
  const Observations on_table = observations_of(ball_set(table, {{14.0, -9.0, 3.0}, 0.6}, 13), Model{}, table.machine);
  for (const char* const id : {"linear_axes", "head_bending", "machine_bending"}) {
    CHECK(has(candidate_instances(under_head), id));
    CHECK(has(candidate_instances(on_table), id) == (std::string_view(id) == "linear_axes"));
    CHECK_FALSE(has(usual_effects(under_head), id));
  }
  CHECK_FALSE(has(candidate_instances(under_head), "tool_bending"));  // one length of tool
}
