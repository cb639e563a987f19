// The loop of an investigation, against a machine of one axis whose errors are known: the runs it begins with, its
// readings; stopped and gone on with, and its ledger as rows of a screen.
#include "modules/investigation/investigation.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "model/fit/fit.hpp"
#include "modules/investigation/tests/made_workshop.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

TEST_CASE("the first look keeps inside the travel, ascending, on steps that differ by a tenth and more") {
  const auto look = first_look({Axis::X, Sense::EX}, one_axis_machine(), workshop_times());
  const double overrun = look.overrun_mm;
  REQUIRE(look.targets_mm.size() >= 5);
  const double step = 1000.0 / static_cast<double>(look.targets_mm.size() - 1);
  double shortest = 1000.0, longest = 0.0;
  for (std::size_t i = 1; i < look.targets_mm.size(); ++i) {
    const double gap = look.targets_mm[i] - look.targets_mm[i - 1];
    shortest = std::min(shortest, gap);
    longest = std::max(longest, gap);
  }
  CHECK(look.targets_mm.front() >= overrun);
  CHECK(look.targets_mm.back() <= 1000.0 - overrun);
  CHECK(shortest > 0.0);
  CHECK(longest - shortest > 0.1 * step);
}

TEST_CASE("the programme of ISO 230-2 is five runs both ways over 25 targets, set-up included") {
  const IsoProgramme programme = iso_programme({{Axis::X, Sense::EX}}, one_axis_machine(), workshop_times());
  CHECK(programme.targets == 25);
  CHECK(programme.set_up_minutes == Approx(3.0));
  // 250 readings of 3 s, ten passes of 990 mm at 2000 mm/min, and the ways to the overruns
  CHECK(programme.minutes == Approx(3.0 + 250 * 3.0 / 60.0 + 10 * 0.99 / 2.0).epsilon(0.02));
}

TEST_CASE("a model names its lines; positioning of the axes that it does not speak of comes last") {
  params::Machine machine = one_axis_machine();
  machine.axes[1] = machine.axes[0];
  model::Model model = usual_model();
  const auto lines = lines_of_model(model, machine);
  CHECK(only(lines) == InvestigatedLine{Axis::X, Sense::EX});
  CHECK(other_lines(lines, machine) == std::vector<InvestigatedLine>{{Axis::Y, Sense::EY}});
  CHECK(lines_of_model({}, machine).size() == 2);
}

TEST_CASE("a squareness is looked at along its second axis, against a square; the artefact lies as it was first") {
  params::Machine machine = one_axis_machine();
  machine.axes[1] = machine.axes[0];
  model::EffectInstance squareness;
  squareness.id = model::effect_named("squareness");
  squareness.code = Component::C0Y;
  squareness.axis = Axis::Y;
  model::Model model;
  model.effects = {squareness};
  const auto lines = lines_of_model(model, machine);
  CHECK(only(lines) == InvestigatedLine{Axis::Y, Sense::EX, true});
  const auto look = first_look(lines.front(), machine, workshop_times());
  CHECK(look.reversed == false);
  CHECK(look.sentence.find("Measure EX along Y against a square, first look") == 0);
  CHECK_FALSE(first_look({Axis::X, Sense::EX}, machine, workshop_times()).reversed.has_value());
  const auto turned = look_turned_over(look, workshop_times());
  CHECK(turned.reversed == true);
  CHECK(turned.set_up_minutes == Approx(4.0));
}

TEST_CASE("a machine with a head is looked at with a ball from +B and -B; one without rotary axes is not") {
  params::Machine machine = one_axis_machine();
  CHECK_FALSE(first_look_at_ball(machine, workshop_times()));
  for (auto& axis : machine.axes) axis = params::MachineAxis{.travel_mm = {-900.0, 900.0}};
  CHECK_FALSE(first_look_at_ball(machine, workshop_times()));
  machine.configuration = "TXYZ";
  machine.rotary_configuration = "TXYZCB";
  machine.rotary[1] = {{-95.0, 95.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 250.0}};
  machine.rotary[2] = {{0.0, 360.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 500.0}};
  const auto look = first_look_at_ball(machine, workshop_times());
  REQUIRE(look);
  REQUIRE(look->ball);
  CHECK(look->runs == 2);
  double least = 0.0, greatest = 0.0;
  for (const laser::Reading& reading : look->ball->readings) {
    least = std::min(least, reading.angle_deg[1]);
    greatest = std::max(greatest, reading.angle_deg[1]);
    for (const double mm : reading.position_mm) CHECK(std::abs(mm) <= 900.0);
  }
  CHECK(greatest == Approx(90.0));
  CHECK(least == Approx(-90.0));
  const double of_poses = 2.0 * look->ball->readings.back().time_s.value() / 60.0;
  CHECK(look->minutes == Approx(workshop_times().ball_minutes + of_poses));
}

model::MeasurementProposal a_run() {
  model::MeasurementProposal run;
  run.targets_mm = {10.0, 200.0, 410.0, 600.0, 790.0, 990.0};
  return run;
}
double slope_only(double x_mm, int) { return 0.01 * x_mm; }

TEST_CASE("a second run of a line has a zero of its own, which is no part of the model that is kept") {
  InvestigationReadings readings(usual_model());
  readings.add(made_readings(a_run(), slope_only, 0.01, 1, 0.0), 0.0);
  CHECK(readings.model_with_zeros().effects.size() == 3);
  laser::MeasurementSet shifted = made_readings(a_run(), slope_only, 0.01, 2, 0.0);
  for (laser::Reading& reading : shifted.readings) reading.error += 7.0;
  readings.add(shifted, 5.0);
  const model::Model with = readings.model_with_zeros();
  REQUIRE(with.effects.size() == 4);
  CHECK(is_zero_of_run(to_text(with.effects.back())));
  CHECK(must(model::fit(with, readings.observations(one_axis_machine()))).rms_um < 0.05);
  CHECK(without_zeros(with).effects == usual_model().effects);
}

TEST_CASE("a straight edge has a slope of its own in each run, a square only a zero") {
  model::MeasurementProposal run = a_run();
  run.sense = Sense::EY;
  const auto zero_of_second = [&](bool against_square) {
    InvestigationReadings readings(model::Model{});
    for (const unsigned seed : {1U, 2U}) {
      readings.add(made_readings(run, slope_only, 0.01, seed, 0.0), 5.0, against_square);
    }
    return readings.model_with_zeros().effects.back().user.size();
  };
  CHECK(zero_of_second(false) == 2);
  CHECK(zero_of_second(true) == 1);
}

TEST_CASE("rows, runs and times of a later run are numbered on") {
  InvestigationReadings readings(usual_model());
  readings.add(made_readings(a_run(), slope_only, 0.0, 1, 0.0), 0.0);
  const double end_s = *readings.all().readings.back().time_s;
  readings.add(made_readings(a_run(), slope_only, 0.0, 2, 0.0), 5.0);
  const laser::Reading& last = readings.all().readings.back();
  CHECK(last.row == 24);
  CHECK(last.run == 2);
  CHECK(*last.time_s == Approx(2.0 * end_s + 300.0 - *readings.all().readings.front().time_s));
}

TEST_CASE("a run of another line begins with run 1") {
  InvestigationReadings readings(usual_model());
  readings.add(made_readings(a_run(), slope_only, 0.0, 1, 0.0), 0.0);
  model::MeasurementProposal other = a_run();
  other.parked_mm[1] = 300.0;
  readings.add(made_readings(other, slope_only, 0.0, 2, 1000.0), 5.0);
  CHECK(readings.all().readings.back().run == 1);
}

double usual_error(double x_mm, int approach) { return 0.012 * x_mm + 1.5 * approach; }
double waving_error(double x_mm, int approach) {
  return usual_error(x_mm, approach) + 3.0 * std::sin(2.0 * std::numbers::pi * x_mm / 10.0 + 0.4);
}

Investigation investigated(MadeWorkshop& workshop, double minutes) {
  InvestigationOptions options{.minutes = minutes, .times = workshop_times()};
  return must(investigate(usual_model(), one_axis_machine(), workshop, options));
}

TEST_CASE("an investigation names the hidden period, adds it, and measures the line again with the new map") {
  MadeWorkshop workshop(waving_error);
  const Investigation found = investigated(workshop, 200.0);
  CHECK(found.verdict == model::Verdict::missing_effect);
  CHECK(only(found.causes).name == "cyclic:X:EX");
  CHECK(found.causes.front().probability == Approx(1.0));
  CHECK(found.steps.back().set.size() == 1);
  CHECK(workshop.active.effects.size() == 4);  // zeros of runs are no part of it
  CHECK(workshop.asked.back().with_new_map);
  CHECK(*found.rms_before_um > 3.0);
  CHECK(*found.rms_compensated_um < 0.6);
}

TEST_CASE("minutes are those of the steps, and less than the programme of ISO 230-2 on the same line") {
  MadeWorkshop workshop(waving_error);
  const Investigation found = investigated(workshop, 200.0);
  double sum = 0.0;
  for (const InvestigationStep& step : found.steps) sum += step.minutes;
  CHECK(found.minutes == Approx(sum));
  CHECK(found.minutes < found.programme.minutes);
  CHECK(workshop.steps.size() == found.steps.size());
}

TEST_CASE("a step states the runs that were measured, not those that were asked for") {
  MadeWorkshop workshop(usual_error);
  workshop.only_first_run = true;
  const Investigation found = investigated(workshop, 10.0);
  REQUIRE_FALSE(found.steps.empty());
  CHECK(workshop.asked.front().proposal.runs == 2);
  CHECK_MESSAGE(contains(found.steps.front().measured, "1 run both ways"), found.steps.front().measured);
}

TEST_CASE("where nothing is missing nothing is named") {
  MadeWorkshop workshop(usual_error);
  const Investigation found = investigated(workshop, 60.0);
  CHECK(found.verdict == model::Verdict::adequate);
  CHECK(found.causes.empty());
  CHECK(found.steps.back().set.empty());
}

TEST_CASE("a cause that shows only under a load is found: each line is looked at with one") {
  MadeWorkshop workshop(usual_error);
  workshop.um_per_kg_m = 0.1;
  const Investigation found = investigated(workshop, 60.0);
  CHECK(found.verdict == model::Verdict::missing_effect);
  CHECK(only(found.causes).name == "load:X:EX");
  CHECK(found.minutes < found.programme.minutes);
}

TEST_CASE("the load is taken off before the lines are measured with the new map") {
  MadeWorkshop workshop(usual_error);
  workshop.um_per_kg_m = 0.1;
  investigated(workshop, 60.0);
  REQUIRE(workshop.asked.back().with_new_map);
  CHECK(workshop.asked.back().proposal.load_kg == 0.0);
}

TEST_CASE("no run begins that would take more than the minutes that remain") {
  MadeWorkshop workshop(waving_error);
  const Investigation found = investigated(workshop, 3.0);
  CHECK(found.steps.empty());
  CHECK_FALSE(found.verdict);
  CHECK(workshop.asked.empty());
  REQUIRE_FALSE(found.notes.empty());
  CHECK(contains(found.notes.front(), "3 minutes"));
}

TEST_CASE("a run that cannot be made is noted, and another is taken in its place") {
  MadeWorkshop workshop(usual_error);
  workshop.refuse = [](const RequestedRun& run) { return run.number == 2 && !run.with_new_map; };
  const Investigation found = investigated(workshop, 2000.0);
  CHECK(found.verdict == model::Verdict::adequate);
  CHECK(std::any_of(found.notes.begin(), found.notes.end(),
                    [](const std::string& note) { return contains(note, "no load is at hand"); }));
}

TEST_CASE("a first run that cannot be made ends the investigation with the reason") {
  MadeWorkshop workshop(usual_error);
  workshop.refuse = [](const RequestedRun&) { return true; };
  const auto found =
      must_fail(investigate(usual_model(), one_axis_machine(), workshop, {60.0, workshop_times(), nullptr}));
  CHECK(found.message == "no load is at hand");
}

TEST_CASE("an investigation that is cancelled asks for nothing more") {
  MadeWorkshop workshop(usual_error);
  const std::atomic<bool> cancelled{true};
  const auto found =
      must_fail(investigate(usual_model(), one_axis_machine(), workshop, {60.0, workshop_times(), &cancelled}));
  CHECK(found.kind == ProblemKind::refused);
  CHECK(workshop.asked.empty());
}

double wave_of_ten(double x_mm, int approach) {
  return 0.012 * x_mm + 1.5 * approach + 3.0 * std::sin(2.0 * std::numbers::pi * x_mm / 10.0 + 0.4);
}

/// X, Y and Z whose scales expand and a spindle that grows; warm and cool as they are asked to. The unit has both
/// sensors.
class WarmWorkshop final : public Workshop {
 public:
  static constexpr double kBed_s = 2700.0, kColumn_s = 2710.0, kSpindle_s = 900.0, kRise_degC = 8.0, kNoise_um = 0.2;

  static params::Machine machine() {
    params::Machine machine = one_axis_machine();
    machine.configuration = "TXYZ";
    machine.axes[1] = machine.axes[2] = machine.axes[0];
    machine.inputs[0] = "t_material_degC";
    machine.inputs[1] = "t_spindle_degC";
    return machine;
  }

  Result<RunReadings> measure(const RequestedRun& run) override {
    asked.push_back(run);
    const model::MeasurementProposal& plan = run.proposal;
    laser::MeasurementSet set;
    double zero_um = 0.0, now_s = 0.0;
    rest(model::kSecondsAMinute * plan.set_up_minutes);
    for (const model::Stop& stop : model::stops_of(plan)) {
      const bool next_run = !set.readings.empty() && set.readings.back().run != stop.run;
      warms_ = next_run && plan.warming && stop.run <= plan.first_run + plan.warming->runs;
      rest(stop.after_s - std::exchange(now_s, stop.after_s));
      laser::Reading reading{.axis = plan.axis, .position_mm = plan.parked_mm, .sense = plan.sense};
      reading.position_mm[index_of(plan.axis)] = stop.target_mm;
      reading.approach = static_cast<Approach>(stop.approach);
      reading.run = stop.run;
      reading.time_s = time_s_;
      reading.sensors_degC = {{"t_material_degC", 20.0 + bed_degC_}, {"t_spindle_degC", 20.0 + spindle_degC_}};
      double um = 0.01 * stop.target_mm + um_per_m_degC[index_of(plan.axis)] * stop.target_mm / 1000.0 * bed_degC_;
      if (plan.axis == Axis::Z) um -= 2.0 * spindle_degC_;
      if (column_um_per_degC != 0.0) reading.sensors_degC["t_column_degC"] = 20.0 + column_degC_;
      if (plan.axis == Axis::Y) um += column_um_per_degC * column_degC_;
      um = (run.with_new_map ? 0.0 : um) + kNoise_um * normal_(random_);
      if (set.readings.empty()) zero_um = um;
      reading.error = um - zero_um;
      set.readings.push_back(std::move(reading));
    }
    return RunReadings{std::move(set), plan.minutes};
  }
  Result<void> activate(const model::Model& found) override {
    active = found;
    return {};
  }
  void keep(const InvestigationStep&) override {}

  Vector3 um_per_m_degC{11.0, 9.0, 7.0};
  double column_um_per_degC = 0.0;  ///< shift of Y; 0: no sensor at the column
  std::vector<RequestedRun> asked;
  model::Model active;

 private:
  void rest(double seconds) {
    time_s_ += seconds;
    bed_degC_ += -bed_degC_ * -std::expm1(-seconds / kBed_s);
    column_degC_ += -column_degC_ * -std::expm1(-seconds / kColumn_s);
    spindle_degC_ += ((warms_ ? kRise_degC : 0.0) - spindle_degC_) * -std::expm1(-seconds / kSpindle_s);
  }

  std::mt19937_64 random_{5};
  NormalDraws normal_;
  double time_s_ = 0.0, bed_degC_ = -6.0, column_degC_ = -6.0, spindle_degC_ = 0.0;
  bool warms_ = false;
};

model::Model usual_model_of_three_axes() {
  model::Model model;
  for (const Axis axis : kAllAxes)
    for (const char* id : {"offset", "scale"})
      model.effects.push_back(
          {.id = model::effect_named(id), .axis = axis, .sense = static_cast<Sense>(index_of(axis))});
  return model;
}

TEST_CASE("where the unit follows temperatures, lines are measured cold and warm, and all that heat does is named") {
  WarmWorkshop workshop;
  InvestigationOptions options{.minutes = 240.0, .times = workshop_times()};
  const Investigation found =
      must(investigate(usual_model_of_three_axes(), WarmWorkshop::machine(), workshop, options));
  std::vector<std::string> names;
  for (const InvestigatedCause& cause : found.causes) names.push_back(cause.name);
  std::sort(names.begin(), names.end());
  std::string causes;
  for (const std::string& name : names) causes += name + " ";
  CHECK(causes == "thermal_drift:Z:EZ thermal_scale:X:EX thermal_scale:Y:EY thermal_scale:Z:EZ ");
  CHECK(found.verdict == model::Verdict::missing_effect);
  CHECK(found.minutes <= 240.0);
  CHECK(workshop.asked.front().proposal.warming.has_value());
  CHECK(workshop.asked.back().with_new_map);
  CHECK(workshop.asked.back().proposal.warming.has_value());
  CHECK(*found.rms_compensated_um < 0.1 * *found.rms_before_um);
  REQUIRE(workshop.active.origin.has_value());  // from which the drift counts
  CHECK(workshop.active.origin->sensors_degC.contains("t_spindle_degC"));
  for (const model::EffectInstance& effect : workshop.active.effects) {  // what follows at once goes on doing so
    CHECK(given_or_fitted(effect, "lag_s").value_or(0.0) == 0.0);
    if (to_text(effect).starts_with("thermal_drift"))
      CHECK(effect.fitted.at("um_per_degC") == Approx(-2.0).epsilon(0.02));
  }
}

TEST_CASE("where two bodies warm alike, one sensor is taken, and the answer says that the other would do as well") {
  WarmWorkshop workshop;
  workshop.column_um_per_degC = 3.0;
  params::Machine machine = WarmWorkshop::machine();
  machine.inputs[2] = "t_column_degC";
  InvestigationOptions options{.minutes = 240.0, .times = workshop_times()};
  const Investigation found = must(investigate(usual_model_of_three_axes(), machine, workshop, options));
  const auto shift = std::find_if(found.causes.begin(), found.causes.end(),
                                  [](const InvestigatedCause& cause) { return cause.name == "thermal_drift:Y:EY"; });
  REQUIRE(shift != found.causes.end());
  REQUIRE(shift->set.size() == 2);
  CHECK(shift->set[0].name == shift->set[1].name);
  CHECK(contains(shift->set[0].place + shift->set[1].place, "t_column_degC"));
  CHECK(contains(shift->set[0].place + shift->set[1].place, "t_material_degC"));
  CHECK(contains(summary_text(found), "one of thermal_drift:Y:EY with "));
  CHECK(*found.rms_compensated_um < 0.1 * *found.rms_before_um);
}

TEST_CASE("a machine that warms is looked at for bending first: the differences of temperature vanish with the day") {
  WarmWorkshop workshop;
  model::Model model = usual_model_of_three_axes();
  model.effects.push_back({.id = model::effect_named("offset"), .axis = Axis::Z, .sense = Sense::EX});
  InvestigationOptions options{.minutes = 240.0, .times = workshop_times()};
  must(investigate(model, WarmWorkshop::machine(), workshop, options));
  CHECK(workshop.asked.front().proposal.axis == Axis::Z);
  CHECK(workshop.asked.front().proposal.sense == Sense::EX);
  CHECK(workshop.asked[1].proposal.sense == Sense::EX);
  CHECK(workshop.asked[1].proposal.axis == Axis::X);
}

TEST_CASE("too few minutes for the warm machine are said; a unit without sensors is not measured warm") {
  WarmWorkshop workshop;
  params::Machine machine = WarmWorkshop::machine();
  InvestigationOptions options{.minutes = 30.0, .times = workshop_times()};
  const Investigation short_one = must(investigate(usual_model(), machine, workshop, options));
  CHECK_FALSE(workshop.asked.front().proposal.warming.has_value());
  CHECK(std::any_of(short_one.notes.begin(), short_one.notes.end(),
                    [](const std::string& note) { return contains(note, "was not measured warm"); }));
  machine.inputs = {};
  options.minutes = 240.0;
  must(investigate(usual_model(), machine, workshop, options));
  for (const RequestedRun& run : workshop.asked) CHECK_FALSE(run.proposal.warming.has_value());
}

InvestigationOptions options_with(const std::atomic<bool>& cancelled) {
  constexpr double kMinutes = 200.0;
  return {kMinutes, workshop_times(), &cancelled};
}

TEST_CASE("what was measured before a stop is not measured again") {
  FollowedInvestigation followed;
  MadeWorkshop machine(wave_of_ten);
  std::atomic<bool> cancelled{false};
  {
    FollowedWorkshop workshop(followed, machine, [&] { cancelled = !followed.progress().steps.empty(); });
    CHECK_FALSE(investigate(usual_model(), one_axis_machine(), workshop, options_with(cancelled)).has_value());
  }
  const std::size_t asked = machine.asked.size();
  CHECK(asked == 1);
  CHECK(followed.progress().steps.size() == 1);
  cancelled = false;
  FollowedWorkshop workshop(followed, machine);
  const auto found = must(investigate(usual_model(), one_axis_machine(), workshop, options_with(cancelled)));
  CHECK(found.causes.size() == 1);
  CHECK(followed.progress().steps.size() == found.steps.size());
  for (std::size_t k = asked; k < machine.asked.size(); ++k) CHECK(machine.asked[k].number != 1);
}

TEST_CASE("the ledger has a row a run, the members of the last set, and what is being done") {
  InvestigationProgress progress;
  InvestigationStep step{.minutes = 8.0,
                         .measured = "EX along X, first look: 13 targets, 2 runs both ways",
                         .verdict = model::Verdict::missing_effect,
                         .set = {{"sag:X:EX", 0.9}, {"progressive:X:EX", 0.1}},
                         .rms_um = 1.5};
  progress.steps.push_back(step);
  step.minutes = 4.5;
  step.set = {{"sag:X:EX", 1.0}};
  progress.steps.push_back(step);
  progress.doing = "run 3";
  const LedgerView view = view_of(progress);
  REQUIRE(view.rows.size() == 2);
  CHECK(view.rows[0].members == 2);
  CHECK_FALSE(view.rows[0].settled);
  CHECK(view.rows[1].settled);
  CHECK(view.rows[1].numbers == " 2   4.5   12.5   1.500      1");
  CHECK(view.set == "sag:X:EX 1.00");
  constexpr std::size_t kColumns = 60;
  const auto lines = lines_of(view, kColumns);
  CHECK(lines.size() == 5);
  CHECK(contains(lines[1], "##"));
  for (const std::string& line : lines) CHECK(line.size() <= kColumns);
}

}  // namespace
}  // namespace ecs::commissioning
