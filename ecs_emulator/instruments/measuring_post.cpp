#include "ecs_emulator/instruments/measuring_post.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "ecs_emulator/instruments/interferometer.hpp"

namespace ecs::emulator {
namespace {

constexpr int kNullingStops = 101;  ///< along the first leg of a square

}  // namespace

Result<void> MeasuringPost::fits(const Simulation& simulation, Axis axis, Sense sense, InstrumentKind kind,
                                 const InstrumentSetting& setting) {
  if (!simulation.machine().has(axis)) return refused(fmt::format("axis: this machine has no {}", letter_of(axis)));
  if (const auto why = refusal(kind, sense, axis); !why.empty())
    return refused(fmt::format("instrument {}: {}", name_of(kind), why));
  if (kind == InstrumentKind::square && !simulation.machine().has(direction_of(sense)))
    return refused(fmt::format("square: this machine has no {} to null it along", letter_of(direction_of(sense))));
  if (setting.reversed && !has_artefact(kind))
    return refused(
        fmt::format("reversed: expected straightness or square; {} has no artefact to turn over", name_of(kind)));
  return {};
}

MeasuringPost::MeasuringPost(Simulation& simulation, Axis axis, Sense sense, InstrumentKind kind,
                             const InstrumentSetting& setting)
    : simulation_(simulation),
      axis_(axis),
      sense_(sense),
      kind_(kind),
      settings_(with(simulation.description().settings.laser, setting)),
      reversed_(setting.reversed),
      instrument_(set_up(kind, sense, axis, settings_, simulation.random())) {
  set_.columns = {"axis", "x_mm", "y_mm", "z_mm", "sense", "reading", "approach", "run", "time_s"};
  describe("machine", simulation_.description().machine.name);
  describe("serial_number", simulation_.description().settings.serial_number);
  describe("instrument", fmt::format("virtual {}", name_of(kind_)));
}

bool MeasuringPost::null_square(const Vector3& place_mm) {
  const Axis first = direction_of(sense_);
  const std::size_t f = index_of(first);
  const auto [low_mm, high_mm] = simulation_.machine().axis(first).facts().travel_mm;
  const double middle_mm = 0.5 * (low_mm + high_mm);
  double moment = 0.0;
  double inertia = 0.0;
  for (int stop = 0; stop < kNullingStops; ++stop) {
    Vector3 place = place_mm;
    place[f] = std::lerp(low_mm, high_mm, stop / (kNullingStops - 1.0));
    if (!simulation_.move_to(place, 0.0)) return false;
    const double arm_m = (place[f] - middle_mm) * 1e-3;
    moment += arm_m * simulation_.tool_now(true).error_um[index_of(axis_)];
    inertia += arm_m * arm_m;
  }
  // The first leg follows the axis; the second, at a right angle to it, turns by the same angle the other way.
  instrument_->null_square(moment / inertia);
  return true;
}

void MeasuringPost::take(const MachineState& state, const ReadingPlace& place, const ToolPose& pose) {
  if (interrupted_at_ == set_.readings.size() + 1) lose_beam(place);
  if (lost_) return;
  const std::size_t a = index_of(axis_);
  const double target_mm = place.target_mm[a];
  const Sight sight{against_artefact(pose, target_mm), target_mm, state.time_s, place.stood_s, simulation_.air(),
                    simulation_.material_degC()};
  if (set_.readings.empty()) instrument_->zero(sight);
  laser::Reading reading;
  reading.axis = axis_;
  reading.position_mm = place.target_mm;
  reading.sense = sense_;
  reading.error = instrument_->read(sight, simulation_.random());
  reading.approach = place.approach;
  reading.run = place.run;
  reading.time_s = std::round(state.time_s * 1e3) / 1e3;
  reading.feed_mm_min = place.passing_mm_min;
  if (state.load_kg > 0.0) reading.load_kg = state.load_kg;
  reading.travel_since_reversal_mm = std::round(state.travel_since_reversal_mm[a] * 1e3) / 1e3;
  reading.compensated = compensated();
  if (reversed_) reading.extras["reversed"] = *reversed_ ? 1.0 : 0.0;
  for (const auto& [sensor, degC] : simulation_.sensors_degC(state.time_s))
    reading.sensors_degC.emplace(fmt::format("t_{}_degC", sensor), degC);
  add_weather(reading, sight);
  set_.readings.push_back(std::move(reading));
}

ToolPose MeasuringPost::against_artefact(ToolPose pose, double target_mm) const {
  if (!has_artefact(kind_)) return pose;
  const double side = reversed_.value_or(false) ? -1.0 : 1.0;
  pose.error_um[index_of(direction_of(sense_))] += side * simulation_.errors().artefact_um(axis_, sense_, target_mm);
  return pose;
}

void MeasuringPost::lose_beam(const ReadingPlace& place) {
  if (kind_ == InstrumentKind::level || kind_ == InstrumentKind::square) return;
  lost_ = fmt::format(
      "beam interrupted before reading {} ({} {} mm, run {}, {}): the counter has lost its position; set the display "
      "to zero and measure again",
      set_.readings.size() + 1, letter_of(axis_), shortest(place.target_mm[index_of(axis_)]), place.run,
      place.approach == Approach::forward ? "forward" : "reverse");
}

void MeasuringPost::add_weather(laser::Reading& reading, const Sight& sight) const {
  if (!simulation_.heat().has_air()) return;
  const auto rounded = [](double value) { return std::round(value * 100.0) / 100.0; };
  const Air air = sensed(sight.air, settings_);
  reading.pressure_hPa = rounded(air.pressure_hPa);
  reading.humidity_pct = rounded(air.humidity_pct);
  reading.sensors_degC.emplace("t_air_degC", rounded(air.temperature_degC));
  reading.sensors_degC.emplace("t_material_degC", rounded(sight.material_degC + settings_.material_sensor_error_degC));
}

void MeasuringPost::describe(std::string key, std::string value) {
  if (!value.empty()) set_.metadata.push_back({std::move(key), std::move(value)});
}

bool MeasuringPost::compensated() const {
  for (const Axis a : kAllAxes)
    if (simulation_.machine().has(a) && simulation_.drives()[index_of(a)].relay_closed) return true;
  return false;
}

}  // namespace ecs::emulator
