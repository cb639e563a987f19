// Straightness optics: a Wollaston prism and a bisector mirror.
#include <cmath>

#include "ecs_emulator/instruments/correlated_noise.hpp"
#include "ecs_emulator/instruments/instruments.hpp"
#include "ecs_emulator/instruments/refraction.hpp"

namespace ecs::emulator {
namespace {

/// Two beams that diverge over the axial range L see the air's index on either side of their middle: a gradient dn/dy
/// shows as a deviation of L²/2·dn/dy.
class StraightnessOptics final : public Instrument {
 public:
  StraightnessOptics(Sense sense, const LaserSettings& settings, Random& random)
      : Instrument(settings.straightness_noise_um, settings.straightness_resolution_um),
        sense_(sense),
        settings_(settings),
        turbulence_(settings.turbulence_time_s) {
    slope_um_per_m_ = settings.setup_slope_um_per_m * random.normal();
    offset_um_ = settings.setup_offset_um * random.normal();
  }

  void zero(const Sight& sight) override { zero_mm_ = sight.target_mm; }

 protected:
  double shown(const Sight& sight, Random& random) override {
    const double range = range_m(sight);
    const double set_up_um = offset_um_ + slope_um_per_m_ * (sight.target_mm - zero_mm_) * 1e-3;
    double air_um = 0.0;
    if (settings_.air_gradient_degC_per_m != 0.0)
      air_um = 0.5 * range * range * index_per_degC(sight.air) * settings_.air_gradient_degC_per_m * 1e6;
    if (settings_.straightness_turbulence_um_per_m > 0.0)
      air_um += settings_.straightness_turbulence_um_per_m * range * turbulence_.at(sight.time_s, random);
    return seen(sight.pose, sense_) + set_up_um + air_um;
  }

  double noise(const Sight& sight) const override {
    return std::hypot(settings_.straightness_noise_um, settings_.straightness_noise_um_per_m * range_m(sight));
  }

 private:
  /// Between prism and mirror.
  [[nodiscard]] double range_m(const Sight& sight) const {
    return settings_.dead_path_m + std::abs(sight.target_mm - zero_mm_) * 1e-3;
  }
  [[nodiscard]] double index_per_degC(Air air) const {
    const double here = refractive_index(air, settings_.wavelength_nm);
    air.temperature_degC += 1.0;
    return refractive_index(air, settings_.wavelength_nm) - here;
  }

  Sense sense_;
  LaserSettings settings_;
  CorrelatedNoise turbulence_;
  double slope_um_per_m_ = 0.0;
  double offset_um_ = 0.0;
  double zero_mm_ = 0.0;
};

}  // namespace

std::unique_ptr<Instrument> straightness_optics(Sense sense, const LaserSettings& settings, Random& random) {
  return std::make_unique<StraightnessOptics>(sense, settings, random);
}

}  // namespace ecs::emulator
