// Electronic level: a damped pendulum, for roll.
#include <algorithm>
#include <cmath>

#include "ecs_emulator/instruments/instruments.hpp"
#include "ecs_emulator/instruments/play.hpp"

namespace ecs::emulator {
namespace {

/// While the machine moves the pendulum is held by what it showed; when it stands it settles with its time constant.
class ElectronicLevel final : public Instrument {
 public:
  ElectronicLevel(Sense sense, const LaserSettings& settings)
      : Instrument(settings.level_noise_um_per_m, settings.level_resolution_um_per_m),
        sense_(sense),
        settling_s_(settings.level_settling_s),
        zero_shown_(settings.level_zero_um_per_m),
        pivot_(settings.level_hysteresis_um_per_m) {}

  void zero(const Sight& sight) override {
    zero_ = pendulum_ = seen(sight.pose, sense_);
    pivot_.start_at(zero_);
    last_s_ = sight.time_s;
  }

 protected:
  double shown(const Sight& sight, Random& /*random*/) override {
    const double tilt = pivot_.follow(seen(sight.pose, sense_));
    const double settled_s = std::min(sight.stood_s, sight.time_s - last_s_);
    const double left = settling_s_ > 0.0 ? std::exp(-settled_s / settling_s_) : 0.0;
    last_s_ = sight.time_s;
    pendulum_ = tilt + (pendulum_ - tilt) * left;
    return pendulum_ - zero_ + zero_shown_;
  }

 private:
  Sense sense_;
  double settling_s_;
  double zero_shown_;
  Play pivot_;
  double zero_ = 0.0;
  double pendulum_ = 0.0;
  double last_s_ = 0.0;  ///< of the last reading
};

}  // namespace

std::unique_ptr<Instrument> electronic_level(Sense sense, const LaserSettings& settings) {
  return std::make_unique<ElectronicLevel>(sense, settings);
}

}  // namespace ecs::emulator
