// Sets of a ball that are proposed after readings of a ball under a head, and what the next diagnosis makes of them.
#include <functional>
#include <numbers>
#include <set>

#include "model/planning/next_measurement.hpp"
#include "model/planning/questions.hpp"
#include "tests/model/support/turning_machine.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

constexpr double kTool_mm = 150.0;

/// A head with room around it.
TurningMachine roomy_head() {
  TurningMachine made = head();
  for (auto& axis : made.machine.axes) axis->travel_mm = {-1500.0, 1500.0};
  return made;
}

/// Error of the head where it bends along its own X by its weight and in proportion to the length of the tool.
double bent(const Reading& r, double head_um, double tool_um_per_m) {
  const double b = r.angle_deg[1] * std::numbers::pi / 180.0, c = r.angle_deg[2] * std::numbers::pi / 180.0;
  const auto tool = r.extras.find("tool_z_mm");
  const double length_m = tool == r.extras.end() ? 0.0 : std::abs(tool->second) / 1000.0;
  const double along = (head_um + tool_um_per_m * length_m) * std::sin(b);
  return r.sense == Sense::EX ? along * std::cos(c) : r.sense == Sense::EY ? along * std::sin(c) : 0.0;
}

/// Poses of a ball with the tool, as a person without a plan takes them: B at 0 and to one side, two angles of C.
laser::MeasurementSet first_set() {
  laser::MeasurementSet set;
  double time_s = 0.0;
  for (const double c : {0.0, 90.0, 180.0, 270.0})
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (int i = 0; i < 9; ++i) {
        time_s += 10.0;
        for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ}) {
          Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                    .axis = Axis::Y,
                    .rotary = true,
                    .position_mm = {300.0, 250.0, -400.0},
                    .angle_deg = {0.0, approach == Approach::forward ? -90.0 + 22.5 * i : 90.0 - 22.5 * i, c},
                    .sense = sense,
                    .approach = approach,
                    .time_s = time_s};
          r.extras = {{"at_tip", 1.0}, {"tool_z_mm", -kTool_mm}};
          set.readings.push_back(r);
        }
      }
  return set;
}

struct Asked {
  Model model;
  Observations data;
  Diagnosis found;
  NextMeasurement next;
};

Asked asked(const laser::MeasurementSet& set, const TurningMachine& made) {
  Asked all;
  all.model = usual_model(set, made.machine);
  all.data = observations_of(set, all.model, made.machine);
  all.found = must(diagnose(all.model, all.data));
  all.next = planned_next(all.model, all.data, all.found);
  return all;
}

const Candidate* first_named(const Diagnosis& found) {
  for (const Candidate& one : found.candidates)
    if (one.in_answer()) return &one;
  return nullptr;
}

/// The proposal, measured on a machine with these errors, behind the readings so far.
void measure(laser::MeasurementSet& set, const MeasurementProposal& proposal,
             const std::function<double(Reading)>& error) {
  const double later_s = set.readings.back().time_s.value();
  for (Reading r : target_set(proposal).readings) {
    r.row = static_cast<int>(set.readings.size()) + 1;
    r.time_s = *r.time_s + later_s;
    if (set.readings.front().extras.contains("at_tip")) r.extras.erase("at_tip");
    r.error = error(r);
    set.readings.push_back(r);
  }
}

/// X, Y, Z of the axes in place of the tool centre point.
laser::MeasurementSet by_axes(laser::MeasurementSet set, const TurningMachine& made) {
  const Observations data = observations_of(set, Model{}, made.machine);
  for (std::size_t k = 0; k < data.size(); ++k) {
    Reading& r = set.readings[data.file_order[k]];
    r.position_mm = data.place_mm[k];
    r.extras.erase("at_tip");
  }
  return set;
}

}  // namespace

TEST_CASE(
    "with one length of tool, bending of the head and in proportion to the tool are a group; a second tool parts "
    "them") {
  const TurningMachine made = roomy_head();
  std::mt19937_64 random(31);
  NormalDraws normal;
  for (const bool of_tool : {true, false}) {
    CAPTURE(of_tool);
    const auto error = [&](const Reading& r) {
      return bent(r, of_tool ? 0.0 : 12.0, of_tool ? 80.0 : 0.0) + 0.6 * normal(random);
    };
    laser::MeasurementSet set = by_axes(first_set(), made);
    for (Reading& r : set.readings) r.error = error(r);
    const Asked before = asked(set, made);
    const Candidate* named = first_named(before.found);
    REQUIRE(named != nullptr);
    CHECK(before.next.rivals.size() >= 2);
    CHECK(std::ranges::find(before.next.rivals, "head_bending") != before.next.rivals.end());
    CHECK(std::ranges::find(before.next.rivals, "tool_bending") != before.next.rivals.end());
    REQUIRE_FALSE(before.next.proposals.empty());
    const MeasurementProposal& proposal = before.next.proposals.front();
    check_holds(proposal.sentence,
                {"tool that is 100 mm longer", "B from -90 to 90 deg", "with C at 0, 90, 180 and 270"});
    CHECK(proposal.separation_sigma > kSeparates);
    CHECK(named->next_measurement == proposal.sentence);
    measure(set, proposal, error);
    const Asked after = asked(set, made);
    named = first_named(after.found);
    REQUIRE(named != nullptr);
    CHECK(to_text(named->effect) == (of_tool ? "tool_bending" : "head_bending"));
    for (const EffectInstance& rival : named->rivals)
      CHECK(to_text(rival) != (of_tool ? "head_bending" : "tool_bending"));
    CHECK(after.found.verdict == Verdict::missing_effect);
  }
}

TEST_CASE("every proposed set of a ball stays within the travels, follows the ball and holds +B beside -B") {
  const TurningMachine made = roomy_head();
  const laser::MeasurementSet set = by_axes(first_set(), made);
  const Observations data = observations_of(set, Model{}, made.machine);
  const auto options = ball_options(data, {});
  std::set<std::string> conditions;
  for (const MeasurementProposal& one : options) {
    CAPTURE(one.condition);
    conditions.insert(one.condition);
    const Observations rows = observations_of(target_set(one), Model{}, made.machine);
    CHECK(rows.not_followed == "");
    CHECK(rows.balls_mm.size() == 1);
    std::set<std::pair<double, double>> poses;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      poses.insert({rows.position_mm[k][1], rows.position_mm[k][2]});
      for (const double mm : rows.place_mm[k]) CHECK(std::abs(mm) <= 1500.0);
    }
    for (const auto& [b, c] : poses) CHECK(poses.contains({-b, c}));
    CHECK(one.minutes == 0.0);  // computed when a number of runs is chosen
  }
  CHECK(options.size() == 5);  // as now, another tool, three places
  CHECK(conditions.size() == 5);
}

TEST_CASE("the ball is moved along an axis as far as most poses stay within the travels") {
  TurningMachine made = roomy_head();
  const laser::MeasurementSet set = by_axes(first_set(), made);
  double low = 0.0, high = 0.0;
  for (const Reading& r : set.readings) {
    low = std::min(low, r.position_mm[1]);
    high = std::max(high, r.position_mm[1]);
  }
  const auto moved_along_y = [&](double room_mm) {
    made.machine.axes[1]->travel_mm = {low - 1.0, high + room_mm};
    for (const MeasurementProposal& one : ball_options(observations_of(set, Model{}, made.machine), {}))
      if (contains(one.condition, "along Y")) return one.condition;
    return std::string("none");
  };
  check_holds(moved_along_y(500.0), {"+400 mm along Y only"});
  check_holds(moved_along_y(120.0), {"+200 mm along Y only"});  // without some poses
}

TEST_CASE(
    "the list and the program of a proposed ball set give its poses in order, the tool and the way around the ball") {
  const TurningMachine made = roomy_head();
  const Observations data = observations_of(by_axes(first_set(), made), Model{}, made.machine);
  MeasurementProposal longer = ball_options(data, {}).at(1);
  longer.runs = 2;
  const laser::MeasurementSet rows = target_set(longer);
  CHECK(rows.readings.size() == 2 * longer.ball->readings.size());
  CHECK(rows.readings.back().run == rows.readings.front().run + 1);
  CHECK(rows.readings.front().extras.at("tool_z_mm") == Approx(-250.0));
  check_holds(target_list(longer), {"b_deg", "c_deg", "tool_z_mm", "EZ"});
  const std::string program = part_program(longer, made.machine);
  check_holds(program, {"$REP 2", "Z -250.0 mm", "> G90G00B-90.0C0.0", "M08"});
  CHECK(program.find("> G90G00Z") < program.find("> G90G00B"));
}

TEST_CASE("readings that do not follow a ball get no plan, and a note says that lines only are planned") {
  const TurningMachine made = roomy_head();
  const laser::MeasurementSet set = by_axes(first_set(), made);
  const Observations without_machine = observations_of(set, Model{}, std::nullopt);
  const NextMeasurement next = next_measurement(Model{}, without_machine, Diagnosis{});
  CHECK(next.proposals.empty());
  check_holds(only(next.notes), {"For readings of a ball give --machine"});
}

TEST_CASE("each tool in the spindle is off by a vector of its own, and two tools at one pose are not repeats") {
  const TurningMachine made = roomy_head();
  std::mt19937_64 random(32);
  NormalDraws normal;
  laser::MeasurementSet set = by_axes(first_set(), made);
  measure(set, ball_options(observations_of(set, Model{}, made.machine), {}).at(1), [](const Reading&) { return 0.0; });
  const Observations planned = observations_of(set, Model{}, made.machine);
  REQUIRE(planned.tools_mm.size() == 2);
  CHECK(planned.balls_mm.size() == 1);
  for (std::size_t k = 0; k < planned.size(); ++k) {
    const ThroughChain& chain = planned.through_chain[k];
    set.readings[planned.file_order[k]].error =
        (chain.tool == 2 ? 25.0 * chain.of_tool[2] : -30.0 * chain.of_tool[0]) + 0.5 * normal(random);
  }
  const Model model = usual_model(set, made.machine);
  CHECK(std::ranges::any_of(model.effects, [](const auto& one) { return to_text(one) == "ball_in_spindle:2"; }));
  const Observations data = observations_of(set, model, made.machine);
  const auto fitted = must(fit(model, data));
  CHECK(fitted.rms_um == Approx(0.5).epsilon(0.1));
  CHECK(fitted.noise.noise_um == Approx(0.5).epsilon(0.15));
  CHECK(must(diagnose(model, data)).verdict == Verdict::adequate);
}
