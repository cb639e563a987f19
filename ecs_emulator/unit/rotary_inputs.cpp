#include "ecs_emulator/unit/rotary_inputs.hpp"

#include <cmath>
#include <utility>

namespace ecs::emulator {
namespace {

constexpr double kFastest_deg_s = 3600.0;  ///< 600 turns a minute: faster is a fault of the transducer

std::size_t index_of_rotary(char letter) { return static_cast<std::size_t>(letter - 'A'); }

}  // namespace

const std::optional<RotarySignals>& RotaryInputs::wire_of(char letter) const { return wires_[index_of_rotary(letter)]; }

void RotaryInputs::take(const RotaryWires& wires) { wires_before_ = std::exchange(wires_, wires); }

void RotaryInputs::use(const std::optional<RotarySetup>& map, const RotaryWorking& working) {
  axes_ = {};
  if (!map) return;
  for (std::size_t p = 0; p < kRotaryInputs; ++p)
    for (const RotaryAxis& axis : map->axes)
      if (axis.letter == working.axes[p].letter) axes_[p] = axis;
}

std::optional<char> RotaryInputs::lacking(const RotarySetup& map) const {
  for (const RotaryAxis& axis : map.axes)
    if (axis.letter != '\0' && !wire_of(axis.letter)) return axis.letter;
  return std::nullopt;
}

std::optional<RotaryInputFault> RotaryInputs::fault(double period_s) const {
  for (const RotaryAxis& axis : axes_) {
    if (axis.letter == '\0') continue;
    const auto& now = wire_of(axis.letter);
    if (!now || !now->transducer_ok) return RotaryInputFault{Fault::axis_module, axis.letter};
    const auto& before = wires_before_[index_of_rotary(axis.letter)];
    const double step_deg = before ? static_cast<double>(now->counts - before->counts) * axis.deg_per_count : 0.0;
    if (std::abs(step_deg) > kFastest_deg_s * period_s) return RotaryInputFault{Fault::position_jump, axis.letter};
  }
  return std::nullopt;
}

std::optional<double> RotaryInputs::angle_deg(const RotaryAxis& axis) const {
  const auto& wire = wire_of(axis.letter);
  if (!wire || !wire->transducer_ok) return std::nullopt;
  return static_cast<double>(wire->counts) * axis.deg_per_count + axis.zero_deg;
}

PerRotary<std::int64_t> RotaryInputs::counts() const {
  PerRotary<std::int64_t> counts{};
  for (std::size_t p = 0; p < kRotaryInputs; ++p)
    if (axes_[p].letter != '\0') counts[p] = wire_of(axes_[p].letter)->counts;
  return counts;
}

PerRotary<double> RotaryInputs::angles_deg() const {
  PerRotary<double> angles_deg{};
  for (std::size_t p = 0; p < kRotaryInputs; ++p)
    if (axes_[p].letter != '\0') angles_deg[p] = *angle_deg(axes_[p]);
  return angles_deg;
}

}  // namespace ecs::emulator
