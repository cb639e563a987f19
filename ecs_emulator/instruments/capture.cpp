#include "ecs_emulator/instruments/capture.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "ecs_emulator/instruments/instruments.hpp"

namespace ecs::emulator {
namespace {

constexpr double kStill_mm = 1e-5;  ///< less than this in one period is no motion

InstrumentKind kind_of(const CapturePlan& plan) {
  return plan.instrument.value_or(instrument_for(plan.sense, plan.axis));
}

Result<void> checked(const Simulation& simulation, const CapturePlan& plan) {
  if (auto fit = MeasuringPost::fits(simulation, plan.axis, plan.sense, kind_of(plan)); !fit) return fit;
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
