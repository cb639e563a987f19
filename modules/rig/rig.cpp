#include "modules/rig/rig.hpp"

#include <map>
#include <numbers>

namespace ecs::emulator {
namespace {

constexpr double kLoop_s = 0.001;      ///< period of the prototype's loop
constexpr double kExchange_s = 0.05;   ///< between two exchanges of data with the registers of the control
constexpr double kCountsPerUm = 10.0;  ///< of the compensation's D/A converter
constexpr double kTravel_mm = 450.0;

UnitParameters unit_parameters(const ServoParameters& servo) {
  UnitParameters p;
  p.configuration = {'T', 'X', 0, 0, 0};
  p.axis_present = {true, false, false};
  p.scope = Scope::linear;
  p.interpolation = Interpolation::nearest;
  p.loop_period_us = kLoop_s * 1e6;
  AxisParameters& axis = p.axes[0];
  axis.position_scale_um_per_count = Rig::kPulse_um;
  axis.deadband_um = Rig::kPulse_um;  // "movement greater than two microns" (3.5.1)
  axis.output_scale_counts_per_um = kCountsPerUm;
  axis.output_slew_um_per_s = 1e6;  // the prototype has no slew limit
  axis.position_loop_gain_per_s = position_loop_gain_per_s(servo);
  return p;
}

std::vector<std::uint8_t> image_of(const UnitParameters& parameters, const RigTables& tables) {
  const std::array<std::pair<Approach, const std::vector<double>*>, 2> sides{
      {{Approach::forward, &tables.forward_um}, {Approach::reverse, &tables.reverse_um}}};
  ImagePlan plan;
  plan.table_count = 2;
  plan.value_count = static_cast<std::uint32_t>(tables.forward_um.size() + tables.reverse_um.size());
  std::vector<std::uint8_t> image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, parameters);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < 2; ++i) {
    const auto& [approach, values] = sides[i];
    const auto count = static_cast<std::uint32_t>(values->size());
    write_entry(image, i,
                {Component::EXX, approach, false, next, count, tables.start_mm, tables.increment_mm, Rig::kPulse_um});
    for (const double value : *values)
      write_value(image, next++, static_cast<std::int16_t>(std::lround(value / Rig::kPulse_um)));
  }
  seal_image(image);
  return image;
}

}  // namespace

double position_loop_gain_per_s(const ServoParameters& servo) {
  return servo.dac_V_per_pulse * servo.encoder_pulses_per_rad * servo.preamplifier / servo.tacho_V_s_per_rad;
}

double SlideErrors::forward_um(double nut_mm) const {
  const double away = (datum_mm - nut_mm) / kTravel_mm;
  return linear_um_per_mm * nut_mm + progressive_um * std::copysign(std::pow(std::abs(away), 1.2), away);
}

double SlideErrors::reverse_um(double nut_mm) const {
  const double away = (datum_mm - nut_mm) / kTravel_mm;
  const double lost_um = lost_motion_um + (lost_motion_end_um - lost_motion_um) * away;
  const double cyclic = cyclic_um * std::sin(2.0 * std::numbers::pi * nut_mm / cyclic_period_mm);
  return forward_um(nut_mm) + std::max(0.0, lost_um + cyclic);
}

SlideErrors rig_slide_errors() {
  SlideErrors errors;
  errors.progressive_um = 72.0;
  errors.lost_motion_um = 60.0;
  errors.lost_motion_end_um = 140.0;
  errors.cyclic_um = 29.0;
  errors.scatter_um = 2.3;
  return errors;
}

Rig::Rig(const ServoParameters& servo, const SlideErrors& errors, double start_mm, std::uint64_t seed)
    : drive_(servo), errors_(errors), random_(seed), start_mm_(start_mm), asked_mm_(start_mm) {
  slide_mm_ = start_mm + errors_.forward_um(start_mm) * 1e-3;
}

void Rig::compensate_with(const RigTables& tables, Approach approach, Injection injection, double loop_gain) {
  const UnitParameters parameters = unit_parameters(drive_.parameters());
  const auto image = image_of(parameters, tables);
  unit_ = std::make_unique<Unit>();
  (void)compile(ImageView(image), unit_->map);  // made a few lines above: sound
  unit_->added_V_per_count = drive_.parameters().dac_V_per_pulse / (Rig::kPulse_um * kCountsPerUm) / loop_gain;
  unit_->injection = injection;
  start(unit_->state, {drive_.encoder_pulses(), 0, 0}, {asked_mm_, 0.0, 0.0},
        {approach, Approach::forward, Approach::forward});
}

void Rig::move_slide() {
  const double nut = nut_mm();
  slide_mm_ = std::clamp(slide_mm_, nut + errors_.forward_um(nut) * 1e-3, nut + errors_.reverse_um(nut) * 1e-3);
}

bool Rig::begins_period(double period_s) const {
  const double step_s = drive_.parameters().step_s;
  return static_cast<std::uint64_t>(static_cast<double>(steps_) * step_s / period_s) !=
         static_cast<std::uint64_t>(static_cast<double>(steps_ + 1) * step_s / period_s);
}

void Rig::step() {
  const ServoParameters& p = drive_.parameters();
  double added_V = 0.0, added_pulses = 0.0;
  if (unit_) {
    if (begins_period(kLoop_s)) tick(unit_->map, unit_->state, {drive_.encoder_pulses(), 0, 0});
    if (unit_->injection == Injection::velocity_command)
      added_V = unit_->added_V_per_count * unit_->state.dac_counts[0];
    else if (unit_->injection == Injection::feedback || begins_period(kExchange_s))
      unit_->pulses = std::round(unit_->state.compensation_um[0] / kPulse_um);
    added_pulses = unit_->pulses;
  }
  drive_.step((asked_mm_ - start_mm_) / p.screw_mm_per_rad * p.encoder_pulses_per_rad + added_pulses, added_V);
  move_slide();
  ++steps_;
}

double Rig::reading_um(double target_mm) {
  return (slide_mm_ - target_mm) * 1e3 + errors_.scatter_um * random_.normal();
}

namespace {

std::size_t steps_of(const RigPlan& plan) {
  return static_cast<std::size_t>(std::floor(std::abs(plan.to_mm - plan.from_mm) / plan.step_mm + 1e-9));
}

double target_of(const RigPlan& plan, std::size_t k) {
  return plan.from_mm + std::copysign(plan.step_mm, plan.to_mm - plan.from_mm) * static_cast<double>(k);
}

}  // namespace

laser::MeasurementSet calibrated(Rig& rig, const RigPlan& plan, bool compensated) {
  laser::MeasurementSet set;
  set.metadata = {{"machine", "single-axis test rig"}, {"runs", std::to_string(plan.runs)}};
  const double onward = plan.to_mm > plan.from_mm ? 1.0 : -1.0;
  const std::size_t last = steps_of(plan);
  const auto read = [&](std::size_t k, double sign, int run) {
    laser::Reading reading;
    reading.position_mm[0] = target_of(plan, k);
    rig.move_to(reading.position_mm[0], plan.feed_mm_min, plan.dwell_s);
    reading.error = rig.reading_um(reading.position_mm[0]);
    reading.approach = sign > 0.0 ? Approach::forward : Approach::reverse;
    reading.run = run;
    reading.compensated = compensated;
    reading.time_s = rig.drive().time_s();
    set.readings.push_back(reading);
  };
  for (int run = 1; run <= plan.runs; ++run) {
    rig.move_to(plan.from_mm - onward * plan.overrun_mm, plan.feed_mm_min, plan.dwell_s);
    for (std::size_t k = 0; k <= last; ++k) read(k, onward, run);
    rig.move_to(target_of(plan, last) + onward * plan.overrun_mm, plan.feed_mm_min, plan.dwell_s);
    for (std::size_t k = last + 1; k-- > 0;) read(k, -onward, run);
  }
  return set;
}

RigBand band_of(const laser::MeasurementSet& set) {
  std::map<std::pair<int, double>, std::vector<double>> groups;
  for (const laser::Reading& r : set.readings)
    groups[{static_cast<int>(r.approach), r.position_mm[0]}].push_back(r.error);
  RigBand band;
  double top = -1e300, bottom = 1e300;
  for (const auto& [place, errors] : groups) {
    RigTarget target{place.second, static_cast<Approach>(place.first), 0.0, 0.0};
    const auto n = static_cast<double>(errors.size());
    for (const double e : errors) target.mean_um += e / n;
    double squares = 0.0;
    for (const double e : errors) squares += (e - target.mean_um) * (e - target.mean_um);
    target.sigma_um = n > 1.0 ? std::sqrt(squares / (n - 1.0)) : 0.0;
    top = std::max(top, target.mean_um + 3.0 * target.sigma_um);
    bottom = std::min(bottom, target.mean_um - 3.0 * target.sigma_um);
    band.non_repeatability_um = std::max(band.non_repeatability_um, 6.0 * target.sigma_um);
    for (const double e : errors) band.largest_reading_um = std::max(band.largest_reading_um, std::abs(e));
    band.targets.push_back(target);
  }
  band.error_band_um = band.targets.empty() ? 0.0 : top - bottom;
  return band;
}

RigTables tables_of(const RigBand& band, const RigPlan& plan) {
  RigTables tables;
  const std::size_t last = steps_of(plan);
  tables.increment_mm = plan.step_mm;
  tables.start_mm = std::min(target_of(plan, 0), target_of(plan, last));
  tables.forward_um.assign(last + 1, 0.0);
  tables.reverse_um.assign(last + 1, 0.0);
  for (const RigTarget& target : band.targets) {
    auto& side = target.approach == Approach::forward ? tables.forward_um : tables.reverse_um;
    side[static_cast<std::size_t>(std::lround((target.position_mm - tables.start_mm) / plan.step_mm))] =
        -target.mean_um;
  }
  return tables;
}

}  // namespace ecs::emulator
