#include "ecs_emulator/drive/transducer.hpp"

#include <cmath>

#include "base/units.hpp"

namespace ecs::emulator {
namespace {

bool uneven(const TransducerSettings& s) {
  return s.period_mm > 0.0 && (s.offset != 0.0 || s.imbalance != 0.0 || s.quadrature_mrad != 0.0);
}

}  // namespace

PositionTransducer::PositionTransducer(const TransducerSettings& settings, Transducer kind, double resolution_um,
                                       double start_mm, std::uint64_t seed)
    : settings_(settings),
      carrier_(kind == Transducer::resolver && settings.excitation == Excitation::stator),
      counts_per_mm_(1000.0 / resolution_um),
      position_mm_(start_mm),
      random_(seed) {
  since_carrier_s_ = carrier_ ? 1.0 / settings_.carrier_Hz : 0.0;
  follow(start_mm, 0.0);
}

double PositionTransducer::shown_mm(double position_mm) const {
  if (!uneven(settings_)) return position_mm;
  const double angle = kTurn * position_mm / settings_.period_mm;
  const double sine = (1.0 + 0.5 * settings_.imbalance) * std::sin(angle) + settings_.offset;
  const double cosine = (1.0 - 0.5 * settings_.imbalance) * std::cos(angle + settings_.quadrature_mrad * 1e-3);
  const double error = std::remainder(std::atan2(sine, cosine) - angle, kTurn);
  return position_mm + error / kTurn * settings_.period_mm;
}

void PositionTransducer::lose(double moved_mm, double seconds) {
  const double fastest_mm = settings_.fastest_mm_min / 60.0 * seconds;
  if (settings_.fastest_mm_min > 0.0 && seconds > 0.0 && std::abs(moved_mm) > fastest_mm) {
    losing_ += (moved_mm - std::copysign(fastest_mm, moved_mm)) * counts_per_mm_;
    const double whole = std::trunc(losing_);
    lost_ += static_cast<std::int64_t>(whole);
    losing_ -= whole;
  }
  const double before_mm = position_mm_ - settings_.dirt_mm;
  const double after_mm = before_mm + moved_mm;
  if (settings_.dirt_counts == 0 || (before_mm < 0.0) == (after_mm < 0.0)) return;
  const auto count = static_cast<std::int64_t>(random_.uniform() * static_cast<double>(settings_.dirt_counts + 1));
  lost_ += moved_mm > 0.0 ? count : -count;
}

void PositionTransducer::follow(double position_mm, double seconds) {
  lose(position_mm - position_mm_, seconds);
  position_mm_ = position_mm;
  if (carrier_) {
    since_carrier_s_ += seconds;
    if (since_carrier_s_ < 1.0 / settings_.carrier_Hz) return;
    since_carrier_s_ = 0.0;
  }
  const double noise_mm = settings_.noise_um > 0.0 ? settings_.noise_um * 1e-3 * random_.normal() : 0.0;
  counts_ = counts_at(position_mm + noise_mm);
}

std::int64_t PositionTransducer::counts_at(double position_mm) const {
  return static_cast<std::int64_t>(std::floor(shown_mm(position_mm) * counts_per_mm_ + 0.5)) - lost_;
}

}  // namespace ecs::emulator
