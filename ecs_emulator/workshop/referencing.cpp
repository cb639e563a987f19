#include <algorithm>

#include "ecs_emulator/workshop/procedures.hpp"

namespace ecs::emulator {
namespace {

constexpr double kSearch_mm = 120.0;  ///< how far the control seeks the end of its switch, or a marker

tl::unexpected<Problem> stopped_early() { return problem(ProblemKind::refused, "reference: stopped before its end"); }

/// One axis on its way to its reference.
class ReferenceCycle {
 public:
  ReferenceCycle(Simulation& simulation, Axis axis)
      : simulation_(simulation), machine_(simulation.machine()), name_(axis), axis_(machine_.axis(axis)) {}

  Result<void> run() {
    const AxisSettings& s = axis_.settings();
    if (!go(start_position_mm(axis_.facts(), s), 0.0)) return stopped_early();
    ECS_DO(seek(
        onward(), kAnywhere_mm, s.reference_speed_mm_min, [this] { return axis_.on_switch(); },
        "the reference switch was not met before the end of travel"));
    auto marked = s.reference_kind == DatumKind::siemens ? marker_on_switch() : marker_after_switch();
    if (!marked) return marked;
    if (!go(machine_.command_mm()[index_of(name_)], 0.0)) return stopped_early();
    axis_.referenced();
    if (!go(axis_.facts().datum_mm, s.reference_speed_mm_min)) return stopped_early();
    return {};
  }

 private:
  static constexpr double kAnywhere_mm = 1e9;

  [[nodiscard]] double onward() const {
    return static_cast<double>(static_cast<std::int8_t>(axis_.settings().reference_direction));
  }

  /// A move of this axis to its end, until it stands.
  [[nodiscard]] bool go(double to_mm, double feed_mm_min) {
    Vector3 target_mm = machine_.command_mm();
    target_mm[index_of(name_)] = to_mm;
    return simulation_.move_to(target_mm, feed_mm_min);
  }

  /// Moves until `found`, at most so far and to the limit switch.
  template <class Found>
  [[nodiscard]] Result<void> seek(double direction, double most_mm, double feed_mm_min, const Found& found,
                                  const char* alarm) {
    Vector3 target_mm = machine_.command_mm();
    const auto [low_mm, high_mm] = axis_.facts().travel_mm;
    double& to_mm = target_mm[index_of(name_)];
    to_mm = std::clamp(to_mm + direction * most_mm, std::min(to_mm, low_mm - kOvertravel_mm),
                       std::max(to_mm, high_mm + kOvertravel_mm));
    machine_.move_to(target_mm, feed_mm_min);
    bool met = found();
    const bool whole = simulation_.run_while([&] { return !met && !machine_.arrived(); }, [&] { met = found(); });
    machine_.stop();
    if (!whole) return stopped_early();
    if (met) return {};
    return problem(ProblemKind::refused, "{}: alarm of the control: {}", letter_of(name_), alarm);
  }

  [[nodiscard]] Result<void> seek_marker(double direction) {
    return seek(
        direction, kSearch_mm, axis_.settings().creep_speed_mm_min, [this] { return axis_.marker_mm().has_value(); },
        "no marker within 120 mm of the switch");
  }

  /// Fanuc: on through the switch; Allen-Bradley: back off it.
  [[nodiscard]] Result<void> marker_after_switch() {
    const bool back = axis_.settings().reference_kind == DatumKind::allen_bradley;
    const double direction = back ? -onward() : onward();
    if (back && !go(machine_.command_mm()[index_of(name_)], 0.0)) return stopped_early();
    auto left = seek(
        direction, kSearch_mm, axis_.settings().creep_speed_mm_min, [this] { return !axis_.on_switch(); },
        "the reference switch did not open within 120 mm");
    return left ? seek_marker(direction) : left;
  }

  [[nodiscard]] Result<void> marker_on_switch() {
    bool left = false;
    auto marked = seek(
        onward(), kSearch_mm, axis_.settings().creep_speed_mm_min,
        [&] {
          left = !axis_.on_switch();
          return left || axis_.marker_mm().has_value();
        },
        "no marker within 120 mm of the switch");
    if (marked && left)
      return problem(ProblemKind::refused, "{}: alarm of the control: the switch opened before a marker came",
                     letter_of(name_));
    return marked;
  }

  Simulation& simulation_;
  MachineTool& machine_;
  Axis name_;
  AxisOfMachine& axis_;
};

}  // namespace

Result<void> reference(Simulation& simulation, const std::vector<Axis>& axes) {
  for (const Axis axis : axes) ECS_DO(ReferenceCycle(simulation, axis).run());
  return {};
}

}  // namespace ecs::emulator
