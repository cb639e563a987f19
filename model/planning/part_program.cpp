// A part program in the dialect of thesis appendix B, written block by block; no method of its own.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "laser/writers/writers.hpp"
#include "model/planning/questions.hpp"
#include "model/planning/run.hpp"

namespace ecs::model {
namespace {

/// As a control takes it: three decimals at most, one at least.
std::string word(double mm) {
  const double rounded = to_micrometre(mm);
  std::string text = fmt::format("{:.3f}", rounded == 0.0 ? 0.0 : rounded);
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  return text;
}

/// Steps that differ by less [mm] are equal: a thousandth of what a control takes.
constexpr double kSameStep_mm = 1e-6;
/// Times in a target list are given to a tenth of a second.
constexpr double kTenths = 10.0;

class ProgramWriter {
 public:
  ProgramWriter(const MeasurementProposal& plan, const params::Machine& machine) : plan_(plan), machine_(machine) {
    for (const double target : plan.targets_mm)
      (to_micrometre(target) == limited(to_micrometre(target)) ? targets_ : left_out_).push_back(to_micrometre(target));
  }

  std::string text() {
    note("Every block begins with >; $REP n ... $END is a loop, G04H a dwell in s, M08 a reading.");
    note("Translate these words for another control: at most controls M08 switches the coolant on.");
    if (plan_.ball) {
      ball(*plan_.ball);
      return text_;
    }
    if (plan_.circle) {
      circle(*plan_.circle);
      return text_;
    }
    head();
    if (targets_.empty()) {
      note("no target inside the travel");
      return text_;
    }
    park();
    runs(plan_.feed_mm_min);
    if (plan_.second_feed_mm_min) runs(*plan_.second_feed_mm_min);
    return text_;
  }

 private:
  void line(const std::string& code, const std::string& remark = "") {
    text_ += remark.empty() ? code + "\n" : fmt::format("{:<22};{}\n", code, remark);
  }
  void block(const std::string& code, const std::string& remark = "") { line("> " + code, remark); }
  void note(const std::string& remark) { text_ += "; " + remark + "\n"; }

  [[nodiscard]] double limited(double mm) const {
    const auto& axis = machine_.axes[index_of(plan_.axis)];
    return axis ? std::clamp(mm, axis->travel_mm[0], axis->travel_mm[1]) : mm;
  }
  [[nodiscard]] std::string to(double mm) const { return letter_of(plan_.axis) + word(mm); }

  [[nodiscard]] std::string at_angle(const Path& circle, double angle_deg) const {
    const Vector3 point = point_on_circle(circle, angle_deg);
    std::string code;
    for (const Axis axis : circle.plane) code += letter_of(axis) + word(point[index_of(axis)]);
    return code;
  }

  /// Arc from one angle to another; of a plane in the other order of its axes the control sees the other sense.
  void arc(const Path& circle, double from_deg, double to_deg, const std::string& remark) {
    constexpr std::array kCentre{'I', 'J', 'K'};
    const bool turned = (index_of(circle.plane[0]) + 1) % kAxes != index_of(circle.plane[1]);
    const Vector3 from = point_on_circle(circle, from_deg);
    std::string code = fmt::format("G0{}{}", (to_deg > from_deg) != turned ? 3 : 2, at_angle(circle, to_deg));
    for (const Axis axis : circle.plane)
      code += kCentre[index_of(axis)] + word(circle.from_mm[index_of(axis)] - from[index_of(axis)]);
    block(code + fmt::format("F{:g}", plan_.feed_mm_min), remark);
  }

  void circle(const Path& circle) {
    constexpr std::array kPlaneWords{19, 18, 17};  // by the axis that the plane lacks
    const std::size_t aside = kAxes - index_of(circle.plane[0]) - index_of(circle.plane[1]);
    note(plan_.sentence.empty() ? plan_.condition : plan_.sentence);
    note("read by the ball bar while the axes move");
    note(fmt::format("about {:.0f} min in all", plan_.minutes));
    note("check that the ball bar clears every motion before starting");
    block(fmt::format("G90G{}", kPlaneWords[aside]));
    if (machine_.axes[aside])
      block(fmt::format("G00{}{}", letter_of(kAllAxes[aside]), word(circle.from_mm[aside])), "PARK THE OTHER AXIS");
    if (plan_.runs > 1) line(fmt::format("$REP {}", plan_.runs), fmt::format("REPEAT {} TIMES", plan_.runs));
    block("G00" + at_angle(circle, -kOverlap_deg));
    block("G04H2");
    arc(circle, -kOverlap_deg, 0.0, "RUN IN");
    arc(circle, 0.0, kTurn_deg, "ONCE ROUND COUNTER-CLOCKWISE");
    arc(circle, 0.0, kOverlap_deg, "RUN OUT");
    block("G04H2");
    arc(circle, kOverlap_deg, 0.0, "RUN IN");
    arc(circle, 0.0, -kTurn_deg, "ONCE ROUND CLOCKWISE");
    arc(circle, 0.0, -kOverlap_deg, "RUN OUT");
    if (plan_.runs > 1) line("$END", "END OF RUNS");
  }

  /// Off the first pose, to the side from which every rotary axis comes to it.
  void come_from_sides(const BallSet& set, double away_mm) {
    constexpr double kOff_deg = 5.0;  // a choice: beyond any lost motion
    block("G90G00Z" + word(away_mm));
    std::string angles;
    for (std::size_t a = 0; a < kAxes; ++a) {
      if (!machine_.rotary[a]) continue;
      const auto [low, high] = machine_.rotary[a]->travel_deg;
      angles += "ABC"[a] + word(std::clamp(set.readings.front().angle_deg[a] - set.side[a] * kOff_deg, low, high));
    }
    block("G90G00" + angles, "REMOVE BACKLASH BEFORE FIRST READING");
  }

  /// Pose by pose: away along Z, the rotary axes, X and Y, back to the ball.
  void ball(const BallSet& set) {
    constexpr double kAway_mm = 50.0;  // a choice: clear of a ball and its stem
    note(plan_.sentence.empty() ? plan_.condition : plan_.sentence);
    note(fmt::format("tool from the reference point: X {} Y {} Z {} mm", word(set.tool_mm[0]), word(set.tool_mm[1]),
                     word(set.tool_mm[2])));
    note(fmt::format("about {:.0f} min in all", plan_.minutes));
    note("check that head, probe, ball and workpiece clear every motion before starting");
    double highest_mm = set.place_mm[2];
    for (const laser::Reading& one : set.readings) highest_mm = std::max(highest_mm, one.position_mm[2]);
    const auto& z = machine_.axes[index_of(Axis::Z)];
    const double away_mm = z ? std::min(highest_mm + kAway_mm, z->travel_mm[1]) : highest_mm + kAway_mm;
    if (!set.readings.empty()) come_from_sides(set, away_mm);
    if (plan_.runs > 1) line(fmt::format("$REP {}", plan_.runs), fmt::format("REPEAT {} TIMES", plan_.runs));
    std::optional<double> before_s;
    for (const laser::Reading& one : set.readings) {
      if (one.time_s == before_s) continue;  // another sense of the same pose
      before_s = one.time_s;
      block("G90G00Z" + word(away_mm));
      std::string angles;
      for (std::size_t a = 0; a < kAxes; ++a)
        if (machine_.rotary[a]) angles += "ABC"[a] + word(one.angle_deg[a]);
      block("G90G00" + angles);
      block(fmt::format("G90G00X{}Y{}", word(one.position_mm[0]), word(one.position_mm[1])));
      block(fmt::format("G90G01Z{}F{:g}", word(one.position_mm[2]), plan_.feed_mm_min));
      reading();
    }
    if (plan_.runs > 1) line("$END", "END OF RUNS");
  }

  void conditions() {
    for (const auto& [sensor, degC] : plan_.temperatures_degC)
      note(fmt::format("  {} at about {:.1f} degC, to be recorded with every reading", sensor, degC));
    if (plan_.pressure_hPa) note(fmt::format("  air pressure about {:.0f} hPa, to be recorded", *plan_.pressure_hPa));
    if (plan_.load_kg) note(fmt::format("  load on the machine: {:.0f} kg", *plan_.load_kg));
    if (plan_.compensated) note(*plan_.compensated ? "  compensation on" : "  COMPENSATION OFF");
    if (plan_.wait_minutes > 0.0)
      note(fmt::format("  about {:.0f} min until these conditions are reached", plan_.wait_minutes));
  }

  void head() {
    note(fmt::format("{} along {}, {}", name_of(plan_.sense), letter_of(plan_.axis), plan_.condition));
    note("Set up:");
    std::string where;
    for (const Axis a : kAllAxes)
      if (a != plan_.axis && machine_.axes[index_of(a)])
        where += fmt::format(" {} {} mm", letter_of(a), word(plan_.parked_mm[index_of(a)]));
    const std::string instrument = plan_.against_square
                                       ? fmt::format("indicator for {} against a square nulled along {},",
                                                     name_of(plan_.sense), letter_of(direction_of(plan_.sense)))
                                       : fmt::format("optics for {}", name_of(plan_.sense));
    note(fmt::format("  {} on the line with{}", instrument, where.empty() ? " the other axes as now" : where));
    if (plan_.new_set_up)
      note(fmt::format("  align the beam, set the readout to zero with the optics close together; write set_up = {}",
                       plan_.set_up));
    if (plan_.reversed)
      note(fmt::format("  write reversed = {}: 1 with the square or straight edge turned over",
                       *plan_.reversed ? 1 : 0));
    conditions();
    note(fmt::format("{} targets, {} {}, {}", targets_.size(), plan_.runs, plan_.runs == 1 ? "run" : "runs",
                     plan_.bidirectional  ? "both ways"
                     : plan_.approach < 0 ? "in negative direction only"
                                          : "in positive direction only"));
    if (plan_.dwell_s <= 0.0) note("readings on the fly: no dwell before the trigger");
    note(fmt::format("about {:.0f} min in all", plan_.minutes));
    for (const int d : pass_senses(plan_)) {
      if (targets_.empty()) break;
      const double first = d > 0 ? targets_.front() : targets_.back();
      if (limited(first - d * plan_.overrun_mm) == first)
        note(fmt::format("no room before {}: its first reading has the approach of the way there", word(first)));
    }
    for (const double target : left_out_) note(fmt::format("target {} omitted: beyond the travel", word(target)));
    note("check that the optics clear every motion before starting");
  }

  void park() {
    std::string code;
    for (const Axis a : kAllAxes) {
      const auto& axis = machine_.axes[index_of(a)];
      if (a == plan_.axis || !axis) continue;
      const double mm = std::clamp(plan_.parked_mm[index_of(a)], axis->travel_mm[0], axis->travel_mm[1]);
      code += letter_of(a) + word(mm);
    }
    if (!code.empty()) block("G90G00" + code, "PARK THE OTHER AXES");
  }

  void reading() {
    if (plan_.dwell_s > 0.0) block(fmt::format("G04H{:g}", plan_.dwell_s), "DELAY FOR AXIS POSITION TO SETTLE");
    block("M08", "TRIGGER MEASUREMENT SYSTEM TO TAKE READING");
    block(fmt::format("G04H{:g}", plan_.trigger_s));
    block("M09");
  }

  void runs(double feed_mm_min) {
    if (plan_.warming) {
      for (int i = 0; i < plan_.runs; ++i) {
        if (i > 0) change_temperature(*plan_.warming, i <= plan_.warming->runs);
        one_run(feed_mm_min);
      }
      return;
    }
    if (plan_.runs > 1) line(fmt::format("$REP {}", plan_.runs), fmt::format("REPEAT {} TIMES", plan_.runs));
    one_run(feed_mm_min);
    if (plan_.runs > 1) line("$END", "END OF RUNS");
  }

  /// To and fro over the targets with the spindle turning, or at rest for as long.
  void change_temperature(const Warming& warming, bool warmer) {
    const double low_mm = targets_.front(), high_mm = targets_.back();
    if (!warmer) return block(fmt::format("G04H{:.0f}", kSecondsAMinute * warming.minutes), "LET THE MACHINE COOL");
    const double strokes = warming.minutes * warming.feed_mm_min / (2.0 * std::max(high_mm - low_mm, 1.0));
    block(fmt::format("M03S{:g}", warming.spindle_rpm), "WARM THE MACHINE");
    block(fmt::format("G90G01{}F{:g}", to(low_mm), warming.feed_mm_min));
    line(fmt::format("$REP {}", std::max(1, static_cast<int>(std::round(strokes)))));
    block("G90G01" + to(high_mm));
    block("G90G01" + to(low_mm));
    line("$END");
    block("M05");
  }

  void one_run(double feed_mm_min) {
    for (const int d : pass_senses(plan_)) {
      std::vector<double> targets = targets_;
      if (d < 0) std::ranges::reverse(targets);
      block("G90G00" + to(limited(targets.front() - d * plan_.overrun_mm)), "REMOVE BACKLASH BEFORE FIRST READING");
      pass(targets, d, feed_mm_min);
    }
  }

  /// Number of equal steps from place i on.
  static std::size_t equal_steps(const std::vector<double>& targets, std::size_t i) {
    if (i + 1 >= targets.size()) return 0;
    const double step = to_micrometre(targets[i + 1] - targets[i]);
    std::size_t count = 0;
    while (i + count + 1 < targets.size() &&
           std::abs(targets[i + count + 1] - targets[i] - step * static_cast<double>(count + 1)) < kSameStep_mm)
      ++count;
    return count;
  }

  void pass(const std::vector<double>& targets, int d, double feed_mm_min) {
    absolute(targets.front(), d, feed_mm_min);
    std::size_t i = 0;
    while (i + 1 < targets.size()) {
      constexpr std::size_t kWorthALoop = 3;
      const std::size_t steps = equal_steps(targets, i);
      if (steps < kWorthALoop || plan_.short_overrun) {
        absolute(targets[++i], d, feed_mm_min);
        continue;
      }
      const double step = to_micrometre(targets[i + 1] - targets[i]);
      line(fmt::format("$REP {}", steps));
      block(to(step) + "G91", fmt::format("MOVE INCREMENTALLY {} mm", word(step)));
      reading();
      line("$END");
      i += steps;
    }
  }

  void absolute(double target, int d, double feed_mm_min) {
    if (plan_.short_overrun) {
      block("G90G00" + to(limited(target + d * plan_.overrun_mm)));
      block("G90G00" + to(limited(target - d * plan_.overrun_mm)), "REVERSE SHORTLY BEFORE THE TARGET");
    }
    block(fmt::format("G90G01{}F{:g}", to(target), feed_mm_min));
    reading();
  }

  const MeasurementProposal& plan_;
  const params::Machine& machine_;
  std::vector<double> targets_, left_out_;
  std::string text_;
};

laser::Reading row_of(const MeasurementProposal& plan, const Stop& stop) {
  laser::Reading row;
  row.axis = plan.axis;
  row.sense = plan.sense;
  row.position_mm = plan.parked_mm;
  row.position_mm[index_of(plan.axis)] = stop.target_mm;
  if (plan.circle) {
    row.position_mm = point_on_circle(*plan.circle, stop.target_mm);
    row.text_extras[std::string(kPathColumn)] = to_text(*plan.circle);
  }
  row.approach = static_cast<Approach>(stop.approach);
  row.run = stop.run;
  row.time_s = std::round(stop.after_s * kTenths) / kTenths;
  row.feed_mm_min = stop.feed_mm_min;
  if (!plan.circle) row.travel_since_reversal_mm = stop.since_reversal_mm;
  row.load_kg = plan.load_kg;
  row.pressure_hPa = plan.pressure_hPa;
  row.humidity_pct = plan.humidity_pct;
  row.compensated = plan.compensated;
  row.sensors_degC = plan.temperatures_degC;
  if (plan.set_up != 1) row.extras["set_up"] = plan.set_up;
  if (plan.reversed) row.extras["reversed"] = *plan.reversed ? 1.0 : 0.0;
  return row;
}

}  // namespace

std::string part_program(const MeasurementProposal& proposal, const params::Machine& machine) {
  return ProgramWriter(proposal, machine).text();
}

laser::MeasurementSet target_set(const MeasurementProposal& proposal) {
  laser::MeasurementSet set;
  set.metadata = {{"content", "target list to be measured; every reading is 0 until then"},
                  {"condition", proposal.condition}};
  for (const Stop& stop : stops_of(proposal)) set.readings.push_back(row_of(proposal, stop));
  if (proposal.ball)
    for (int run = 0; run < proposal.runs; ++run)
      for (laser::Reading row : proposal.ball->readings) {
        row.run += run;
        row.time_s = *row.time_s + run * proposal.ball->readings.back().time_s.value_or(0.0);
        set.readings.push_back(std::move(row));
      }
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  return set;
}

std::string target_list(const MeasurementProposal& proposal) { return laser::to_csv(target_set(proposal)); }

}  // namespace ecs::model
