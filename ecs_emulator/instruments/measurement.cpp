#include "ecs_emulator/instruments/measurement.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::emulator {
namespace {

tl::unexpected<Problem> stopped_early() { return problem(ProblemKind::refused, "measurement: stopped before its end"); }

/// One measurement under way.
class Measuring {
 public:
  Measuring(Simulation& simulation, const MeasurementPlan& plan,
            const std::function<void(const MeasurementProgress&)>& report)
      : simulation_(simulation),
        plan_(plan),
        report_(report),
        kind_(plan.instrument.value_or(instrument_for(plan.sense, plan.axis))),
        axis_(index_of(plan.axis)) {}

  Result<laser::MeasurementSet> run() {
    ECS_DO(check());
    parked_mm_ = parking_place(simulation_.description(), plan_);
    MeasuringPost post(simulation_, plan_.axis, plan_.sense, kind_, plan_.setting);
    if (plan_.beam_broken_at) post.interrupt_beam_at(*plan_.beam_broken_at);
    post_ = &post;
    if (kind_ == InstrumentKind::square && !post.null_square(at(plan_.targets_mm.front()))) return stopped_early();
    total_ = plan_.targets_mm.size() * static_cast<std::size_t>(plan_.runs) * (plan_.bidirectional ? 2 : 1);
    auto back = plan_.targets_mm;
    std::reverse(back.begin(), back.end());
    for (run_ = 1; run_ <= plan_.runs; ++run_) {
      if (!pass(plan_.targets_mm)) return stopped();
      if (plan_.bidirectional && !pass(back)) return stopped();
    }
    describe();
    return post.finished();
  }

 private:
  Result<void> check() const {
    const auto& targets = plan_.targets_mm;
    ECS_DO(MeasuringPost::fits(simulation_, plan_.axis, plan_.sense, kind_, plan_.setting));
    if (targets.size() < 2) return refused("targets: expected at least 2");
    for (std::size_t i = 1; i < targets.size(); ++i)
      if ((targets[i] - targets[i - 1]) * (targets[1] - targets[0]) <= 0.0)
        return refused(fmt::format("targets: expected one direction, {} mm turns back", targets[i]));
    if (plan_.runs < 1 || plan_.runs > 1000) return refused("runs: expected 1 to 1000");
    if (!(plan_.feed_mm_min >= kSlowestFeed_mm_min))
      return refused(fmt::format("feed: expected {} mm/min or more", kSlowestFeed_mm_min));
    if (!(plan_.dwell_s >= 0.0 && plan_.dwell_s <= 86'400.0)) return refused("dwell: expected 0 to 86400 s");
    if (!(plan_.overrun_mm >= 0.0 && plan_.overrun_mm <= kOvertravel_mm))
      return refused(fmt::format("overrun: expected 0 to {} mm", kOvertravel_mm));
    return within_travel(plan_.axis, {targets.front(), targets.back()});
  }

  Result<void> within_travel(Axis axis, std::array<double, 2> range_mm) const {
    const auto [low_mm, high_mm] = simulation_.machine().axis(axis).facts().travel_mm;
    for (const double at_mm : range_mm)
      if (at_mm < low_mm - kOvertravel_mm || at_mm > high_mm + kOvertravel_mm)
        return refused(
            fmt::format("{}: expected within its travel {} … {} mm, got {}", letter_of(axis), low_mm, high_mm, at_mm));
    return {};
  }

  Vector3 at(double target_mm) const {
    Vector3 place = parked_mm_;
    place[axis_] = target_mm;
    return place;
  }

  /// Why a pass did not come to its end.
  tl::unexpected<Problem> stopped() const {
    return post_->lost() ? problem(ProblemKind::refused, *post_->lost()) : stopped_early();
  }

  bool pass(const std::vector<double>& targets) {
    const double onward = targets[1] > targets[0] ? 1.0 : -1.0;
    approach_ = onward > 0.0 ? Approach::forward : Approach::reverse;
    if (!simulation_.move_to(at(targets.front() - onward * plan_.overrun_mm), plan_.feed_mm_min)) return false;
    if (plan_.on_the_fly) return pass_on_the_fly(targets, onward);
    for (const double target_mm : targets) {
      if (!simulation_.move_to(at(target_mm), plan_.feed_mm_min) || !simulation_.dwell(plan_.dwell_s)) return false;
      const MachineState state = simulation_.machine().state();
      take(state, target_mm, simulation_.tool_at(state, at(target_mm), true));
      if (post_->lost()) return false;
    }
    return true;
  }

  bool pass_on_the_fly(const std::vector<double>& targets, double onward) {
    std::size_t next = 0;
    MachineState before = simulation_.machine().state();
    double from_mm = simulation_.machine().axis(plan_.axis).servo_mm();
    const auto watch = [&] {
      const MachineState now = simulation_.machine().state();
      const double to_mm = simulation_.machine().axis(plan_.axis).servo_mm();
      while (next < targets.size() && (to_mm - targets[next]) * onward >= 0.0 && to_mm != from_mm) {
        take_passing(before, now, (targets[next] - from_mm) / (to_mm - from_mm), targets[next], onward);
        ++next;
      }
      before = now;
      from_mm = to_mm;
    };
    return simulation_.move_to(at(targets.back() + onward * plan_.overrun_mm), plan_.feed_mm_min, watch) &&
           next == targets.size() && !post_->lost();
  }

  /// A reading between two ticks, where the axis passes the target.
  void take_passing(const MachineState& before, const MachineState& now, double part, double target_mm, double onward) {
    MachineState state = now;
    for (std::size_t a = 0; a < kAxes; ++a)
      state.position_mm[a] = std::lerp(before.position_mm[a], now.position_mm[a], part);
    const double period_s = now.time_s - before.time_s;
    const double passing_s = std::lerp(before.time_s, now.time_s, part);
    const double late_s = read_at_s(passing_s) - passing_s;
    state.position_mm[axis_] += (now.position_mm[axis_] - before.position_mm[axis_]) * (late_s / period_s);
    state.time_s = passing_s + late_s;
    ToolPose pose = simulation_.tool_at(state, at(target_mm), true);
    const double lag = simulation_.machine().axis(plan_.axis).settings().servo_lag_um_per_m_min;
    pose.error_um[axis_] += lag * plan_.feed_mm_min * 1e-3 * onward;
    take(state, target_mm, pose);
  }

  /// When the instrument reads after a position pulse: its latency later, at the next tick of its own clock.
  double read_at_s(double pulse_s) const {
    const LaserSettings& laser = post_->settings();
    const double due_s = pulse_s + laser.trigger_latency_s;
    return laser.trigger_rate_Hz > 0.0 ? std::ceil(due_s * laser.trigger_rate_Hz) / laser.trigger_rate_Hz : due_s;
  }

  void take(const MachineState& state, double target_mm, const ToolPose& pose) {
    ReadingPlace place{at(target_mm), approach_, run_, {}, plan_.dwell_s};
    if (plan_.on_the_fly) {
      place.passing_mm_min = plan_.feed_mm_min;
      place.stood_s = 0.0;
    }
    post_->take(state, place, pose);
    if (report_) report_({post_->set().readings.size(), total_});
  }

  void describe() {
    post_->describe("date", plan_.date);
    post_->describe("engineer", plan_.engineer);
    post_->describe("plan", plan_.name);
    std::string parked;
    for (const Axis a : kAllAxes)
      if (a != plan_.axis && simulation_.machine().has(a))
        parked += fmt::format("{}{} {}", parked.empty() ? "" : ", ", letter_of(a), shortest(parked_mm_[index_of(a)]));
    post_->describe("parked", parked);
    post_->describe("readings", plan_.on_the_fly ? "on the fly" : "at standstill");
  }

  Simulation& simulation_;
  const MeasurementPlan& plan_;
  const std::function<void(const MeasurementProgress&)>& report_;
  InstrumentKind kind_;
  std::size_t axis_;
  Vector3 parked_mm_{};
  MeasuringPost* post_ = nullptr;
  Approach approach_ = Approach::forward;
  int run_ = 1;
  std::size_t total_ = 0;
};

}  // namespace

std::vector<double> targets_between(double from_mm, double to_mm, double step_mm) {
  const double length_mm = std::abs(to_mm - from_mm);
  const double step = std::abs(step_mm);
  if (!(step > 0.0) || length_mm / step > 1e6) return {};
  const double onward = to_mm >= from_mm ? 1.0 : -1.0;
  std::vector<double> targets;
  for (int i = 0; i * step < length_mm - 1e-6 * step; ++i) targets.push_back(from_mm + onward * i * step);
  targets.push_back(to_mm);
  return targets;
}

Vector3 parking_place(const WorkshopMachine& description, const MeasurementPlan& plan) {
  const auto& axes = description.machine.axes;
  Vector3 place{};
  for (std::size_t i = 0; i < kAxes; ++i) {
    if (!axes[i]) continue;
    const auto& moving = axes[index_of(plan.axis)];
    const auto line = moving ? moving->measurement_line_mm[i] : std::nullopt;
    place[i] = plan.parked_mm[i].value_or(line.value_or(axes[i]->datum_mm));
  }
  return place;
}

Result<laser::MeasurementSet> measure(Simulation& simulation, const MeasurementPlan& plan,
                                      const std::function<void(const MeasurementProgress&)>& report) {
  return Measuring(simulation, plan, report).run();
}

namespace {

constexpr double kStill_mm = 1e-5;  ///< less than this in one period is no motion

InstrumentKind kind_of(const CapturePlan& plan) {
  return plan.instrument.value_or(instrument_for(plan.sense, plan.axis));
}

Result<void> checked(const Simulation& simulation, const CapturePlan& plan) {
  ECS_DO(MeasuringPost::fits(simulation, plan.axis, plan.sense, kind_of(plan)));
  const double most_Hz = 1.0 / simulation.period_s();
  if (!(plan.rate_Hz > 0.0 && plan.rate_Hz <= most_Hz + 1e-9))
    return refused(fmt::format("rate: expected above 0 to {} Hz, got {}", shortest(most_Hz), plan.rate_Hz));
  if (!(plan.seconds > 0.0)) return refused("seconds: expected above 0");
  if (plan.rate_Hz * plan.seconds > static_cast<double>(kMostSamples))
    return refused(fmt::format("rate times seconds: expected up to {} samples, got {:.0f}", kMostSamples,
                               plan.rate_Hz * plan.seconds));
  if (!(plan.feed_mm_min >= kSlowestFeed_mm_min))
    return refused(fmt::format("feed: expected {} mm/min or more", kSlowestFeed_mm_min));
  const auto [low_mm, high_mm] = simulation.machine().axis(plan.axis).facts().travel_mm;
  if (plan.to_mm && !(*plan.to_mm >= low_mm && *plan.to_mm <= high_mm))
    return refused(fmt::format("to: expected within the travel {} … {} mm, got {}", low_mm, high_mm, *plan.to_mm));
  return {};
}

/// One capture under way.
class Capturing {
 public:
  Capturing(Simulation& simulation, const CapturePlan& plan)
      : simulation_(simulation),
        plan_(plan),
        instrument_(set_up(kind_of(plan), plan.sense, plan.axis,
                           with(simulation.description().settings.laser, plan.setting), simulation.random())),
        origin_(simulation.machine().command_mm()),
        before_(simulation.machine().state()),
        start_s_(before_.time_s),
        moved_s_(start_s_) {}

  Result<laser::MeasurementSet> run() {
    instrument_->zero(sight_of(before_));
    sample(before_);
    if (plan_.to_mm) {
      Vector3 target = origin_;
      target[index_of(plan_.axis)] = *plan_.to_mm;
      simulation_.machine().move_to(target, plan_.feed_mm_min);
    }
    const auto count = static_cast<std::size_t>(std::floor(plan_.rate_Hz * plan_.seconds + 1e-9));
    const bool whole = simulation_.run_while([&] { return set_.readings.size() < count; }, [&] { watch(count); });
    if (!whole) return problem(ProblemKind::refused, "capture: stopped before its end");
    simulation_.machine().stop();
    describe();
    return std::move(set_);
  }

 private:
  [[nodiscard]] double due_s() const { return start_s_ + static_cast<double>(set_.readings.size()) / plan_.rate_Hz; }

  /// Samples that fall between the last two ticks; carriages go straight from one to the other.
  void watch(std::size_t count) {
    const MachineState now = simulation_.machine().state();
    const std::size_t a = index_of(plan_.axis);
    if (std::abs(now.position_mm[a] - before_.position_mm[a]) > kStill_mm) moved_s_ = now.time_s;
    while (set_.readings.size() < count && due_s() <= now.time_s + 1e-9) {
      MachineState then = now;
      const double part = (due_s() - before_.time_s) / (now.time_s - before_.time_s);
      for (std::size_t i = 0; i < kAxes; ++i)
        then.position_mm[i] = std::lerp(before_.position_mm[i], now.position_mm[i], part);
      then.time_s = due_s();
      sample(then);
    }
    before_ = now;
  }

  [[nodiscard]] Sight sight_of(const MachineState& state) {
    return {simulation_.tool_at(state, origin_, true),
            origin_[index_of(plan_.axis)],
            state.time_s,
            std::max(0.0, state.time_s - moved_s_),
            simulation_.air(),
            simulation_.material_degC()};
  }

  void sample(const MachineState& state) {
    laser::Reading reading;
    reading.axis = plan_.axis;
    reading.sense = plan_.sense;
    reading.position_mm = origin_;
    reading.time_s = static_cast<double>(set_.readings.size()) / plan_.rate_Hz;
    reading.error = instrument_->read(sight_of(state), simulation_.random());
    set_.readings.push_back(std::move(reading));
  }

  void describe() {
    const auto add = [&](const char* key, const std::string& value) {
      if (!value.empty()) set_.metadata.push_back({key, value});
    };
    add("machine", simulation_.description().machine.name);
    add("serial_number", simulation_.description().settings.serial_number);
    add("instrument", fmt::format("virtual {}", name_of(kind_of(plan_))));
    add("date", plan_.date);
    add("engineer", plan_.engineer);
    add("readings", "displacements from the first sample, at a constant rate");
    add("rate_Hz", shortest(plan_.rate_Hz));
    if (plan_.to_mm) add("feed_mm_min", shortest(plan_.feed_mm_min));
    set_.columns = {"axis", "x_mm", "y_mm", "z_mm", "sense", "reading", "time_s"};
  }

  Simulation& simulation_;
  const CapturePlan& plan_;
  std::unique_ptr<Instrument> instrument_;
  Vector3 origin_;
  MachineState before_;
  double start_s_;
  double moved_s_;  ///< when the axis last moved
  laser::MeasurementSet set_;
};

}  // namespace

Result<laser::MeasurementSet> capture(Simulation& simulation, const CapturePlan& plan) {
  ECS_DO(checked(simulation, plan));
  return Capturing(simulation, plan).run();
}

}  // namespace ecs::emulator
