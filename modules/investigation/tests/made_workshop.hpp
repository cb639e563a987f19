// A machine of one axis that measures itself: errors from a function, normal noise, a zero of its own for each run.
#pragma once

#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "base/random.hpp"
#include "model/planning/run.hpp"
#include "modules/investigation/investigation.hpp"
#include "params/machine.hpp"

namespace ecs {

/// Error at a position for an approach [um].
using ErrorAlongAxis = std::function<double(double x_mm, int approach)>;

inline laser::MeasurementSet made_readings(const model::MeasurementProposal& proposal, const ErrorAlongAxis& error,
                                           double noise_um, unsigned seed, double begins_s) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  laser::MeasurementSet set;
  double zero = 0.0;
  for (const model::Stop& stop : model::stops_of(proposal)) {
    laser::Reading reading{.axis = proposal.axis, .position_mm = proposal.parked_mm, .sense = proposal.sense};
    reading.position_mm[index_of(proposal.axis)] = stop.target_mm;
    reading.approach = static_cast<Approach>(stop.approach);
    reading.run = 1 + stop.run - proposal.first_run;
    reading.time_s = begins_s + stop.after_s;
    const double shown = error(stop.target_mm, stop.approach) + noise_um * normal(random);
    if (set.readings.empty()) zero = shown;
    reading.error = shown - zero;
    set.readings.push_back(reading);
  }
  return set;
}

class MadeWorkshop final : public commissioning::Workshop {
 public:
  explicit MadeWorkshop(ErrorAlongAxis error) : error_(std::move(error)) {}

  Result<commissioning::RunReadings> measure(const commissioning::RequestedRun& run) override {
    asked.push_back(run);
    if (refuse && refuse(run)) return problem(ProblemKind::usage, "no load is at hand");
    seconds_ += model::kSecondsAMinute * run.proposal.minutes;
    load_kg_ = run.proposal.load_kg.value_or(load_kg_);
    const ErrorAlongAxis left = [](double, int) { return 0.0; };
    const ErrorAlongAxis loaded = [&](double x_mm, int approach) {
      return error_(x_mm, approach) + um_per_kg_m * load_kg_ * x_mm / 1000.0;
    };
    laser::MeasurementSet set =
        made_readings(run.proposal, run.with_new_map ? left : loaded, noise_um, seed_++, seconds_);
    for (laser::Reading& reading : set.readings) reading.load_kg = load_kg_;
    if (only_first_run) std::erase_if(set.readings, [](const laser::Reading& reading) { return reading.run > 1; });
    return commissioning::RunReadings{std::move(set), run.proposal.minutes};
  }
  Result<void> activate(const model::Model& found) override {
    active = found;
    return {};
  }
  void keep(const commissioning::InvestigationStep& step) override { steps.push_back(step); }

  double noise_um = 0.2;
  double um_per_kg_m = 0.0;     ///< what a load does to the slope
  bool only_first_run = false;  ///< whatever number of runs is asked for
  std::function<bool(const commissioning::RequestedRun&)> refuse;
  std::vector<commissioning::RequestedRun> asked;
  std::vector<commissioning::InvestigationStep> steps;
  model::Model active;  ///< the model that activate() was given

 private:
  ErrorAlongAxis error_;
  unsigned seed_ = 1;
  double seconds_ = 0.0;
  double load_kg_ = 0.0;
};

/// X of 1000 mm alone.
inline params::Machine one_axis_machine() {
  params::Machine machine{.name = "one axis", .configuration = "TX"};
  params::MachineAxis axis{.travel_mm = {0.0, 1000.0}, .screw_pitch_mm = 10.0};
  machine.axes[0] = axis;
  return machine;
}

/// Offset, slope and backlash of X.
inline model::Model usual_model() {
  model::Model model;
  for (const char* id : {"offset", "scale", "backlash"}) {
    model::EffectInstance effect{.id = model::effect_named(id), .axis = Axis::X, .sense = Sense::EX};
    model.effects.push_back(effect);
  }
  return model;
}

}  // namespace ecs
