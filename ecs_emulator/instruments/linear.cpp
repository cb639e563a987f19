// Linear optics: an interferometer along the moving axis.
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/instruments/correlated_noise.hpp"
#include "ecs_emulator/instruments/instruments.hpp"
#include "ecs_emulator/instruments/interferometer.hpp"

namespace ecs::emulator {
namespace {

constexpr double kMoved_mm = 1e-2;  ///< from here on it is clear which way the reflector goes

/// The interferometer stands where the reflector goes away from it: on the side that the first motion leaves.
class LinearOptics final : public Instrument {
 public:
  LinearOptics(Axis moving, const LaserSettings& settings)
      : Instrument(settings.linear_noise_um, settings.linear_resolution_um),
        along_(index_of(moving)),
        across_((along_ + 1) % kAxes),
        settings_(settings),
        interferometer_(settings),
        turbulence_(settings.turbulence_time_s) {}

  void zero(const Sight& sight) override {
    zero_ = sight;
    away_ = 0.0;
    interferometer_.reset(sight.air);
  }

 protected:
  double shown(const Sight& sight, Random& random) override {
    const double commanded_mm = sight.target_mm - zero_.target_mm;
    const double moved_mm = commanded_mm + moved_um(sight, along_) / kUmPerMm;
    if (away_ == 0.0 && std::abs(moved_mm) > kMoved_mm) away_ = std::copysign(1.0, moved_mm);
    const double side = away_ < 0.0 ? -1.0 : 1.0;
    const double display_mm = side * interferometer_.displayed_mm(side * moved_mm, moved_um(sight, across_) / kUmPerMm,
                                                                  sight.air, sight.material_degC);
    const double drift_um = settings_.head_drift_um_per_h * (sight.time_s - zero_.time_s) / kSecondsPerHour;
    return (display_mm - commanded_mm) * kUmPerMm + drift_um + turbulence_um(side * moved_mm, sight.time_s, random);
  }

 private:
  [[nodiscard]] double moved_um(const Sight& sight, std::size_t direction) const {
    return sight.pose.error_um[direction] - zero_.pose.error_um[direction];
  }
  [[nodiscard]] double turbulence_um(double distance_mm, double time_s, Random& random) {
    if (settings_.turbulence_um_per_sqrt_m <= 0.0) return 0.0;
    const double path_m = std::max(0.0, settings_.dead_path_m + distance_mm / 1e3);
    return settings_.turbulence_um_per_sqrt_m * std::sqrt(path_m) * turbulence_.at(time_s, random);
  }

  std::size_t along_;
  std::size_t across_;
  LaserSettings settings_;
  Interferometer interferometer_;
  CorrelatedNoise turbulence_;
  Sight zero_;
  double away_ = 0.0;  ///< direction of the axis in which the reflector goes away; 0: not known yet
};

}  // namespace

std::unique_ptr<Instrument> linear_optics(Axis moving, const LaserSettings& settings) {
  return std::make_unique<LinearOptics>(moving, settings);
}

}  // namespace ecs::emulator
