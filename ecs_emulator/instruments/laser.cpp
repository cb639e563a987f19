#include "ecs_emulator/instruments/laser.hpp"

#include <array>
#include <cmath>

#include "ecs_emulator/instruments/instruments.hpp"

namespace ecs::emulator {
namespace {

constexpr std::array<std::string_view, 5> kNames{"linear", "straightness", "angular", "level", "square"};

}  // namespace

std::string_view name_of(InstrumentKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<InstrumentKind> instrument_named(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<InstrumentKind>(i);
  return std::nullopt;
}

InstrumentKind instrument_for(Sense sense, Axis moving) {
  const bool along = direction_of(sense) == moving;
  if (is_rotation(sense)) return along ? InstrumentKind::level : InstrumentKind::angular;
  return along ? InstrumentKind::linear : InstrumentKind::straightness;
}

std::string_view refusal(InstrumentKind kind, Sense sense, Axis moving) {
  const bool along = direction_of(sense) == moving;
  switch (kind) {
    case InstrumentKind::linear:
      return is_rotation(sense) || !along ? "linear optics measure the error along the moving axis" : "";
    case InstrumentKind::straightness:
    case InstrumentKind::square:
      return is_rotation(sense) || along ? "straightness optics and squares measure across the moving axis" : "";
    case InstrumentKind::angular:
      return !is_rotation(sense) || along ? "angular optics measure pitch and yaw" : "";
    case InstrumentKind::level:
      break;
  }
  return is_rotation(sense) ? "" : "a level measures rotations";
}

std::unique_ptr<Instrument> set_up(InstrumentKind kind, Sense sense, Axis moving, const LaserSettings& settings,
                                   Random& random) {
  switch (kind) {
    case InstrumentKind::linear:
      return linear_optics(moving, settings);
    case InstrumentKind::straightness:
      return straightness_optics(sense, settings, random);
    case InstrumentKind::angular:
      return angular_optics(sense, settings);
    case InstrumentKind::level:
      return electronic_level(sense, settings);
    case InstrumentKind::square:
      break;
  }
  return indicator_on_square(sense, settings);
}

double Instrument::read(const Sight& sight, Random& random) {
  const double clean = shown(sight, random);
  const double noisy = clean + noise(sight) * random.normal();
  if (resolution_ <= 0.0) return noisy;
  const double steps = std::round(noisy / resolution_);
  const double per_unit = std::round(1.0 / resolution_);  // 0.01: dividing gives the shortest decimal, multiplying not
  if (steps == 0.0) return 0.0;                           // never −0
  return per_unit >= 1.0 && std::abs(per_unit * resolution_ - 1.0) < 1e-9 ? steps / per_unit : steps * resolution_;
}

}  // namespace ecs::emulator
