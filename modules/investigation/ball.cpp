// The part of an investigation that a machine with rotary axes has beside its lines: sets of a ball on the table
// (R-test, ISO 10791-6), each the one that separates best what the readings of the ball so far leave open.
#include <algorithm>
#include <array>
#include <utility>

#include "model/diagnosis/ladder.hpp"
#include "model/planning/questions.hpp"
#include "model/planning/run.hpp"
#include "model/regression/candidates.hpp"
#include "modules/investigation/investigation.hpp"

namespace ecs::commissioning {
namespace {

using model::MeasurementProposal;

/// Length of the tool with the ball or probe, and where the ball lies, as shares of the travels of X and Y from their
/// middle: off the axis of a table, which then shows its errors by a lever. Choices.
constexpr double kBallTool_mm = 150.0;
constexpr std::array<double, 3> kOffMiddle{0.1, 0.2, 0.0};
/// Two runs: repeats show the noise.
constexpr int kBallRuns = 2;

/// Observations of a ball touched once there, angles at 0: what sets of a ball are planned from.
model::Observations touched_at(const params::Machine& machine, const Vector3& place_mm) {
  laser::MeasurementSet set;
  for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ}) {
    laser::Reading reading;
    reading.rotary = true;
    for (const Axis axis : kAllAxes)
      if (machine.rotary[index_of(axis)]) reading.axis = axis;
    reading.position_mm = place_mm;
    reading.sense = sense;
    reading.run = 0;
    reading.row = static_cast<int>(set.readings.size()) + 1;
    reading.extras["tool_z_mm"] = -kBallTool_mm;
    set.readings.push_back(reading);
  }
  return model::observations_of(set, model::Model{}, machine);
}

}  // namespace

std::optional<MeasurementProposal> first_look_at_ball(const params::Machine& machine,
                                                      const model::MeasuringTimes& times) {
  if (machine.rotary_configuration.empty() ||
      !std::ranges::all_of(kAllAxes, [&](Axis axis) { return machine.axes[index_of(axis)].has_value(); }))
    return std::nullopt;
  std::optional<MeasurementProposal> best;
  for (const double share : kOffMiddle) {
    Vector3 place_mm{};
    for (const Axis axis : kAllAxes) {
      const auto [low_mm, high_mm] = machine.axes[index_of(axis)]->travel_mm;
      place_mm[index_of(axis)] =
          model::to_micrometre(0.5 * (low_mm + high_mm) + (axis == Axis::Z ? 0.0 : 0.5 * share * (high_mm - low_mm)));
    }
    const auto options = model::ball_options(touched_at(machine, place_mm), times);
    if (options.empty()) continue;
    const auto readings = [](const MeasurementProposal& one) { return one.ball->readings.size(); };
    if (!best || readings(options.front()) > readings(*best)) best = options.front();
  }
  if (!best) return std::nullopt;
  best->condition = "on the table";
  best->runs = kBallRuns;
  best->set_up_minutes = times.ball_minutes;
  best->minutes = minutes_of(*best, times);
  best->sentence = model::sentence_of(*best);
  return best;
}

BallInvestigation::BallInvestigation(const params::Machine& machine, const model::MeasuringTimes& times)
    : machine_(machine), times_(times), first_(first_look_at_ball(machine, times)) {}

std::optional<MeasurementProposal> BallInvestigation::next(double minutes) {
  if (is_over_) return std::nullopt;
  if (!diagnosis_) return first_ && first_->minutes <= minutes ? first_ : std::nullopt;
  if (diagnosis_->verdict == model::Verdict::adequate) return std::nullopt;
  const model::NextMeasurement next = model::planned_next(model_, observations(), *diagnosis_, times_);
  for (const MeasurementProposal& one : next.proposals)
    if (one.ball && one.separation_sigma >= model::kSeparates && one.minutes <= minutes) return one;
  return std::nullopt;
}

Result<void> BallInvestigation::add(const laser::MeasurementSet& set, const model::DiagnoseOptions& options) {
  const int runs = all_.readings.empty() ? 0 : std::ranges::max_element(all_.readings, {}, &laser::Reading::run)->run;
  const double last_s = all_.readings.empty() ? 0.0 : all_.readings.back().time_s.value_or(0.0);
  for (laser::Reading reading : set.readings) {
    reading.run += runs;
    if (reading.time_s) *reading.time_s += last_s;
    reading.row = static_cast<int>(all_.readings.size()) + 1;
    all_.readings.push_back(std::move(reading));
  }
  model_.effects = model::usual_effects(model::observations_of(all_, model::Model{}, machine_));
  ECS_TRY(diagnosis, model::diagnose(model_, observations(), options));
  diagnosis_ = std::move(diagnosis);
  return {};
}

model::Observations BallInvestigation::observations() const { return model::observations_of(all_, model_, machine_); }

Result<BallInvestigation::Causes> BallInvestigation::causes() const {
  const model::Observations data = observations();
  Causes causes{model_, {}};
  std::vector<std::pair<model::EffectInstance, double>> added;
  for (const model::Candidate& candidate : diagnosis_->candidates) {
    if (!candidate.in_answer()) continue;
    ECS_TRY(with, model::add_effect(causes.model, data, model::request_of(candidate.effect), "ball"));
    causes.model = std::move(with.model);
    added.emplace_back(candidate.effect, candidate.probability);
  }
  ECS_TRY(fit, model::fit(causes.model, data));
  for (const auto& [effect, probability] : added)
    for (const model::EffectFit& one : fit.effects)
      if (same_candidate(one.effect, effect))
        causes.found.push_back({to_text(effect), one.parameters, probability, one.rms_um});
  causes.model = model::with_values(std::move(causes.model), fit);
  return causes;
}

}  // namespace ecs::commissioning
