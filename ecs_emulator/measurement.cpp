#include "ecs_emulator/measurement.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::emulator {
namespace {

constexpr double kOvertravel_mm = 25.0;  ///< how far beyond its travel an axis can go before its buffers
constexpr int kNullingStops = 101;        ///< along the first leg of a square

tl::unexpected<Problem> refused(std::string message) { return problem(ProblemKind::usage, std::move(message)); }

tl::unexpected<Problem> given_up() { return problem(ProblemKind::refused, "measurement: given up before its end"); }

/// One measurement under way.
class Measuring {
 public:
  Measuring(Simulation& simulation, const MeasurementPlan& plan,
            const std::function<void(const MeasurementProgress&)>& told)
      : simulation_(simulation),
        plan_(plan),
        told_(told),
        kind_(plan.instrument.value_or(instrument_for(plan.sense, plan.axis))),
        axis_(index_of(plan.axis)) {}

  Result<laser::MeasurementSet> run() {
    if (auto fit = check(); !fit) return tl::unexpected(fit.error());
    parked_mm_ = parking_place();
    Instrument instrument(kind_, plan_.sense, simulation_.description().settings.laser, simulation_.random());
    instrument_ = &instrument;
    if (kind_ == InstrumentKind::square && !null_square()) return given_up();
    total_ = plan_.targets_mm.size() * static_cast<std::size_t>(plan_.runs) * (plan_.bidirectional ? 2 : 1);
    auto back = plan_.targets_mm;
    std::reverse(back.begin(), back.end());
    for (run_ = 1; run_ <= plan_.runs; ++run_) {
      if (!pass(plan_.targets_mm)) return given_up();
      if (plan_.bidirectional && !pass(back)) return given_up();
    }
    describe();
    return std::move(set_);
  }

 private:
  Result<void> check() const {
    const auto& targets = plan_.targets_mm;
    if (!simulation_.machine().has(plan_.axis))
      return refused(fmt::format("axis: this machine has no {}", letter_of(plan_.axis)));
    if (targets.size() < 2) return refused("targets: expected at least 2");
    for (std::size_t i = 1; i < targets.size(); ++i)
      if ((targets[i] - targets[i - 1]) * (targets[1] - targets[0]) <= 0.0)
        return refused(fmt::format("targets: expected one direction, {} mm turns back", targets[i]));
    if (plan_.runs < 1 || plan_.runs > 1000) return refused("runs: expected 1 to 1000");
    if (!(plan_.feed_mm_min > 0.0)) return refused("feed: expected above 0 mm/min");
    if (!(plan_.dwell_s >= 0.0)) return refused("dwell: expected 0 s or more");
    if (!(plan_.overrun_mm >= 0.0 && plan_.overrun_mm <= kOvertravel_mm))
      return refused(fmt::format("overrun: expected 0 to {} mm", kOvertravel_mm));
    if (const auto why = refusal(kind_, plan_.sense, plan_.axis); !why.empty())
      return refused(fmt::format("instrument {}: {}", name_of(kind_), why));
    if (kind_ == InstrumentKind::square && !simulation_.machine().has(direction_of(plan_.sense)))
      return refused(
          fmt::format("square: this machine has no {} to null it along", letter_of(direction_of(plan_.sense))));
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

  Vector3 parking_place() const {
    Vector3 place{};
    for (const Axis a : kAllAxes) {
      if (!simulation_.machine().has(a)) continue;
      const std::size_t i = index_of(a);
      const auto& line = simulation_.description().machine.axes[axis_]->measurement_line_mm[i];
      place[i] = plan_.parked_mm[i].value_or(line.value_or(simulation_.machine().axis(a).facts().datum_mm));
    }
    return place;
  }

  Vector3 at(double target_mm) const {
    Vector3 place = parked_mm_;
    place[axis_] = target_mm;
    return place;
  }

  /// The person turns the square until the indicator shows the same at both ends of the first leg (least squares).
  bool null_square() {
    const Axis first = direction_of(plan_.sense);
    const std::size_t f = index_of(first);
    const auto [low_mm, high_mm] = simulation_.machine().axis(first).facts().travel_mm;
    const double middle_mm = 0.5 * (low_mm + high_mm);
    double moment = 0.0;
    double inertia = 0.0;
    for (int stop = 0; stop < kNullingStops; ++stop) {
      Vector3 place = at(plan_.targets_mm.front());
      place[f] = std::lerp(low_mm, high_mm, stop / (kNullingStops - 1.0));
      if (!simulation_.move_to(place, 0.0)) return false;
      const double arm_m = (place[f] - middle_mm) * 1e-3;
      moment += arm_m * simulation_.tool_now(true).error_um[axis_];
      inertia += arm_m * arm_m;
    }
    // The first leg follows the axis; the second, at a right angle to it, turns by the same angle the other way.
    instrument_->null_square(moment / inertia);
    return true;
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
           next == targets.size();
  }

  /// A reading between two ticks, where the axis passes the target.
  void take_passing(const MachineState& before, const MachineState& now, double part, double target_mm, double onward) {
    MachineState state = now;
    for (std::size_t a = 0; a < kAxes; ++a)
      state.position_mm[a] = std::lerp(before.position_mm[a], now.position_mm[a], part);
    state.time_s = std::lerp(before.time_s, now.time_s, part);
    ToolPose pose = simulation_.tool_at(state, at(target_mm), true);
    const double lag = simulation_.machine().axis(plan_.axis).settings().servo_lag_um_per_m_min;
    pose.error_um[axis_] += lag * plan_.feed_mm_min * 1e-3 * onward;
    take(state, target_mm, pose);
  }

  void take(const MachineState& state, double target_mm, const ToolPose& pose) {
    if (set_.readings.empty()) instrument_->zero(pose, target_mm);
    laser::Reading reading;
    reading.axis = plan_.axis;
    reading.position_mm = at(target_mm);
    reading.sense = plan_.sense;
    reading.error = instrument_->read(pose, target_mm, simulation_.random());
    reading.approach = approach_;
    reading.run = run_;
    reading.time_s = std::round(state.time_s * 1e3) / 1e3;
    if (plan_.on_the_fly) reading.feed_mm_min = plan_.feed_mm_min;
    if (state.load_kg > 0.0) reading.load_kg = state.load_kg;
    reading.travel_since_reversal_mm = std::round(state.travel_since_reversal_mm[axis_] * 1e3) / 1e3;
    reading.compensated = compensated();
    for (const auto& [sensor, degC] : simulation_.errors().temperatures(state.time_s))
      reading.sensors_degC.emplace(fmt::format("t_{}_degC", sensor), std::round(degC * 100.0) / 100.0);
    set_.readings.push_back(std::move(reading));
    if (told_) told_({set_.readings.size(), total_});
  }

  bool compensated() const {
    for (const Axis a : kAllAxes)
      if (simulation_.machine().has(a) && simulation_.drives()[index_of(a)].relay_closed) return true;
    return false;
  }

  void describe() {
    const auto add = [&](std::string key, std::string value) {
      if (!value.empty()) set_.metadata.push_back({std::move(key), std::move(value)});
    };
    add("machine", simulation_.description().machine.name);
    add("serial_number", simulation_.description().settings.serial_number);
    add("instrument", fmt::format("virtual {}", name_of(kind_)));
    add("date", plan_.date);
    add("engineer", plan_.engineer);
    add("plan", plan_.name);
    std::string parked;
    for (const Axis a : kAllAxes)
      if (a != plan_.axis && simulation_.machine().has(a))
        parked += fmt::format("{}{} {}", parked.empty() ? "" : ", ", letter_of(a), shortest(parked_mm_[index_of(a)]));
    add("parked", parked);
    add("readings", plan_.on_the_fly ? "on the fly" : "at standstill");
    set_.columns = {"axis", "x_mm", "y_mm", "z_mm", "sense", "reading", "approach", "run", "time_s"};
  }

  Simulation& simulation_;
  const MeasurementPlan& plan_;
  const std::function<void(const MeasurementProgress&)>& told_;
  InstrumentKind kind_;
  std::size_t axis_;
  Vector3 parked_mm_{};
  Instrument* instrument_ = nullptr;
  laser::MeasurementSet set_;
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

Result<laser::MeasurementSet> measure(Simulation& simulation, const MeasurementPlan& plan,
                                      const std::function<void(const MeasurementProgress&)>& told) {
  return Measuring(simulation, plan, told).run();
}

}  // namespace ecs::emulator
