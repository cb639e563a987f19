#include "ecs_emulator/laser.hpp"

#include <array>
#include <cmath>

namespace ecs::emulator {
namespace {

constexpr std::array<std::string_view, 5> kNames{"linear", "straightness", "angular", "level", "square"};

struct Fineness {
  double noise;
  double resolution;
};

Fineness fineness_of(InstrumentKind kind, const LaserSettings& s) {
  switch (kind) {
    case InstrumentKind::linear:
      return {s.linear_noise_um, s.linear_resolution_um};
    case InstrumentKind::straightness:
      return {s.straightness_noise_um, s.straightness_resolution_um};
    case InstrumentKind::angular:
      return {s.angular_noise_um_per_m, s.angular_resolution_um_per_m};
    case InstrumentKind::level:
      return {s.level_noise_um_per_m, s.level_resolution_um_per_m};
    case InstrumentKind::square:
      break;
  }
  return {s.indicator_noise_um, s.indicator_resolution_um};
}

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

Instrument::Instrument(InstrumentKind kind, Sense sense, const LaserSettings& settings, Random& random)
    : kind_(kind), sense_(sense) {
  const Fineness fineness = fineness_of(kind, settings);
  noise_ = fineness.noise;
  resolution_ = fineness.resolution;
  if (kind != InstrumentKind::straightness) return;
  slope_um_per_m_ = settings.setup_slope_um_per_m * random.normal();
  offset_ = settings.setup_offset_um * random.normal();
}

double Instrument::seen(const ToolPose& pose) const {
  const std::size_t direction = index_of(direction_of(sense_));
  return is_rotation(sense_) ? pose.rotation_um_per_m[direction] : pose.error_um[direction];
}

double Instrument::value(const ToolPose& pose, double position_mm) const {
  return seen(pose) + offset_ + slope_um_per_m_ * (position_mm - zero_mm_) * 1e-3;
}

void Instrument::zero(const ToolPose& pose, double position_mm) {
  zero_mm_ = position_mm;
  if (kind_ != InstrumentKind::straightness) offset_ = -seen(pose);
}

double Instrument::read(const ToolPose& pose, double position_mm, Random& random) const {
  const double shown = value(pose, position_mm) + noise_ * random.normal();
  if (resolution_ <= 0.0) return shown;
  const double steps = std::round(shown / resolution_);
  const double per_unit = std::round(1.0 / resolution_);  // 0.01: dividing gives the shortest decimal, multiplying not
  if (steps == 0.0) return 0.0;                           // never −0
  return per_unit >= 1.0 && std::abs(per_unit * resolution_ - 1.0) < 1e-9 ? steps / per_unit : steps * resolution_;
}

}  // namespace ecs::emulator
