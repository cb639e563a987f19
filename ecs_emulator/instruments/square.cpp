// An indicator that runs along a square.
#include "ecs_emulator/instruments/instruments.hpp"
#include "ecs_emulator/instruments/play.hpp"

namespace ecs::emulator {
namespace {

class IndicatorOnSquare final : public Instrument {
 public:
  IndicatorOnSquare(Sense sense, const LaserSettings& settings)
      : Instrument(settings.indicator_noise_um, settings.indicator_resolution_um),
        sense_(sense),
        own_um_per_m_(settings.square_error_um_per_m),
        plunger_(settings.indicator_hysteresis_um) {}

  void null_square(double slope_um_per_m) override { slope_um_per_m_ = slope_um_per_m; }

  void zero(const Sight& sight) override {
    zero_mm_ = sight.target_mm;
    zero_um_ = seen(sight.pose, sense_);
    plunger_.start_at(0.0);
  }

 protected:
  double shown(const Sight& sight, Random& /*random*/) override {
    const double along_m = (sight.target_mm - zero_mm_) * 1e-3;
    return plunger_.follow(seen(sight.pose, sense_) - zero_um_ + (slope_um_per_m_ + own_um_per_m_) * along_m);
  }

 private:
  Sense sense_;
  double own_um_per_m_;
  Play plunger_;
  double slope_um_per_m_ = 0.0;
  double zero_mm_ = 0.0;
  double zero_um_ = 0.0;
};

}  // namespace

std::unique_ptr<Instrument> indicator_on_square(Sense sense, const LaserSettings& settings) {
  return std::make_unique<IndicatorOnSquare>(sense, settings);
}

}  // namespace ecs::emulator
