// Angular optics: pitch and yaw.
#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/instruments/instruments.hpp"

namespace ecs::emulator {
namespace {

/// Two retro-reflectors at a distance S: the interferometer sees S·sin θ, the display divides by the S that it knows.
class AngularOptics final : public Instrument {
 public:
  AngularOptics(Sense sense, const LaserSettings& settings)
      : Instrument(settings.angular_noise_um_per_m, settings.angular_resolution_um_per_m),
        sense_(sense),
        scale_(1.0 + settings.angular_scale_error_pct / 100.0),
        drift_um_per_m_h_(settings.angular_drift_um_per_m_h) {}

  void zero(const Sight& sight) override {
    zero_ = sine_um_per_m(sight);
    zero_s_ = sight.time_s;
  }

 protected:
  double shown(const Sight& sight, Random& /*random*/) override {
    return scale_ * (sine_um_per_m(sight) - zero_) + drift_um_per_m_h_ * (sight.time_s - zero_s_) / kSecondsPerHour;
  }

 private:
  [[nodiscard]] double sine_um_per_m(const Sight& sight) const {
    return 1e6 * std::sin(1e-6 * seen(sight.pose, sense_));
  }

  Sense sense_;
  double scale_;
  double drift_um_per_m_h_;
  double zero_ = 0.0;
  double zero_s_ = 0.0;
};

}  // namespace

std::unique_ptr<Instrument> angular_optics(Sense sense, const LaserSettings& settings) {
  return std::make_unique<AngularOptics>(sense, settings);
}

}  // namespace ecs::emulator
