// Each kind of instrument with its own physics.
#include "ecs_emulator/instruments/laser.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/result.hpp"
#include "base/units.hpp"
#include "ecs_emulator/instruments/interferometer.hpp"

namespace ecs::emulator {
namespace {

/// Noise that remembers itself for a while (Ornstein-Uhlenbeck): moving air in a beam, standard deviation 1.
class CorrelatedNoise {
 public:
  /// @param time_s  correlation time: after it, e⁻¹ of a deviation is left
  explicit CorrelatedNoise(double time_s) : time_s_(time_s) {}

  /// @pre calls in the order of time
  [[nodiscard]] double at(double now_s, Random& random) {
    const double kept = last_s_ ? std::exp(-(now_s - *last_s_) / time_s_) : 0.0;
    last_s_ = now_s;
    value_ = kept * value_ + std::sqrt(1.0 - kept * kept) * random.normal();
    return value_;
  }

 private:
  double time_s_;
  std::optional<double> last_s_;
  double value_ = 0.0;
};

/// Hysteresis of a pivot or a plunger: what is shown stays until the input has taken up the play.
class Play {
 public:
  /// @param width  between what is shown going up and going down
  explicit Play(double width) : half_(0.5 * width) {}

  void start_at(double value) { shown_ = value; }
  [[nodiscard]] double follow(double value) {
    shown_ = std::clamp(shown_, value - half_, value + half_);
    return shown_;
  }

 private:
  double half_;
  double shown_ = 0.0;
};

/// Angular optics, pitch and yaw: two retro-reflectors at a distance S: the interferometer sees S·sin θ, the display
/// divides by the S that it knows.
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

/// A damped pendulum, for roll. While the machine moves it is held by what it showed; when it stands it settles with
/// its time constant.
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

constexpr double kMoved_mm = 1e-2;  ///< from here on it is clear which way the reflector goes

/// An interferometer along the moving axis. It stands where the reflector goes away from it: on the side that the first
/// motion leaves.
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

/// An indicator that runs along a square.
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

/// A Wollaston prism and a bisector mirror: two beams that diverge over the axial range L see the air's index on either
/// side of their middle: a gradient dn/dy shows as a deviation of L²/2·dn/dy.
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
      return std::make_unique<LinearOptics>(moving, settings);
    case InstrumentKind::straightness:
      return std::make_unique<StraightnessOptics>(sense, settings, random);
    case InstrumentKind::angular:
      return std::make_unique<AngularOptics>(sense, settings);
    case InstrumentKind::level:
      return std::make_unique<ElectronicLevel>(sense, settings);
    case InstrumentKind::square:
      break;
  }
  return std::make_unique<IndicatorOnSquare>(sense, settings);
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
