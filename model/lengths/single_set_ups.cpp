// What the usual way takes: one component after the other, each with its own set-up (thesis 6.3).
#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "model/lengths/plan_lengths.hpp"
#include "model/planning/run.hpp"

namespace ecs::model {
namespace {

constexpr int kMostSingleRuns = 50;
constexpr double kCoverageOfSingle = 2.0;
constexpr int kTargetsBeyondCurve = 4;

/// Noise of one reading with the instrument for a sense, as the emulated instruments have it (docs/emulator.md).
double instrument_noise(Component component) {
  constexpr double kLinear_um = 0.1, kStraightness_um = 0.5, kAngular_um_per_m = 0.5, kLevel_um_per_m = 1.0;
  if (is_positioning(component)) return kLinear_um;
  if (!is_angular(component)) return kStraightness_um;
  return direction_of(sense_of(component)) == moving_axis(component) ? kLevel_um_per_m : kAngular_um_per_m;
}

/// One component as the usual set-up measures it.
struct SingleComponent {
  MeasurementProposal proposal;
  Eigen::MatrixXd covariance;  ///< of its unknowns
};

/// Even targets over the travel, both ways, with the zero of the readout.
SingleComponent single_component(const MachineCurves& curves, const LengthPlanSettings& settings, Component component,
                                 int targets) {
  SingleComponent out;
  const auto size = curves.block(component).size();
  Axis axis = is_squareness(component) ? Axis::Y : moving_axis(component);
  for (const Term& term : curves.terms())
    if (is_squareness(component) && term.component == component) axis = term.lever;
  const auto [low, high] = curves.machine().travel_mm[index_of(axis)];
  Eigen::MatrixXd rows(2 * targets, size + 1);
  for (int i = 0; i < targets; ++i) {
    const double p = std::lerp(low, high, i / (targets - 1.0));
    out.proposal.targets_mm.push_back(p);
    for (const int side : {1, -1}) {
      const int row = 2 * i + (side > 0 ? 0 : 1);
      rows.row(row).head(size) = curves.value_row(component, p, side).transpose();
      rows(row, size) = 1.0;
    }
  }
  const double scatter = is_angular(component) ? settings.scatter_um_per_m : settings.scatter_um;
  if (is_squareness(component)) {
    constexpr double kIndicator_um = 0.5;
    constexpr double kEvenPlaces = 12.0;  // variance of even places over a span: span² / 12
    const double span_m = (high - low) / kMmPerM;
    out.covariance = Eigen::MatrixXd::Constant(
        1, 1, (scatter * scatter + kIndicator_um * kIndicator_um) * kEvenPlaces / (2.0 * targets * span_m * span_m));
  } else {
    const double noise = instrument_noise(component);
    const Eigen::MatrixXd normal = rows.transpose() * rows;
    const Eigen::MatrixXd inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
    out.covariance = (scatter * scatter + noise * noise) * inverse.topLeftCorner(size, size);
  }
  out.proposal.set_up_minutes = settings.times.line_minutes;
  out.proposal.feed_mm_min = settings.feed_mm_min;
  out.proposal.dwell_s = settings.dwell_s;
  out.proposal.trigger_s = settings.trigger_s;
  return out;
}

/// With so many targets a line, and as many runs as it takes.
SingleSetUps with_targets(const MachineCurves& curves, const LengthPlanSettings& settings,
                          const std::vector<Component>& components, const Eigen::MatrixXd& weight, double volume_U_um,
                          int targets) {
  SingleSetUps out;
  out.targets = targets;
  double square = 0.0;
  std::vector<MeasurementProposal> proposals;
  for (const Component component : components) {
    const auto& block = curves.block(component);
    SingleComponent one = single_component(curves, settings, component, targets);
    square += weight.block(block.first, block.first, block.size(), block.size()).cwiseProduct(one.covariance).sum();
    proposals.push_back(std::move(one.proposal));
  }
  const double wanted = std::pow(volume_U_um / kCoverageOfSingle, 2);
  out.set_ups = static_cast<int>(proposals.size());
  out.runs = std::clamp(static_cast<int>(std::ceil(square / wanted)), 1, kMostSingleRuns);
  out.volume_U_um = kCoverageOfSingle * std::sqrt(square / out.runs);
  constexpr double kRounding = 1.000001;
  out.reached = out.volume_U_um <= volume_U_um * kRounding;
  for (MeasurementProposal& proposal : proposals) {
    proposal.runs = out.runs;
    out.minutes += minutes_of(proposal, settings.times);
  }
  return out;
}

}  // namespace

SingleSetUps single_set_ups(const MachineCurves& curves, const LengthPlanSettings& settings,
                            const std::vector<Vector3>& tools_mm, double volume_U_um) {
  std::array<bool, kComponents> acts{};
  for (const Term& term : curves.terms())
    for (const Vector3& tool_mm : tools_mm)
      if (!term.has_lever || term.uses_coordinate || tool_mm[index_of(term.lever)] != 0.0)
        acts[index_of(term.component)] = true;
  std::vector<Component> components;
  for (std::size_t c = 0; c < kComponents; ++c)
    if (acts[c] && curves.block(static_cast<Component>(c)).size() > 0) components.push_back(static_cast<Component>(c));
  const Eigen::MatrixXd weight = volume_weight(curves, tools_mm, kPlanPlaces);
  constexpr int kMostTargets = 25;
  int fewest = 0;
  for (const Axis axis : kAllAxes) fewest = std::max(fewest, curves.intervals(axis) + kTargetsBeyondCurve);
  SingleSetUps best;
  for (int targets = std::min(fewest, kMostTargets); targets <= kMostTargets; ++targets) {
    const SingleSetUps now = with_targets(curves, settings, components, weight, volume_U_um, targets);
    if (best.set_ups == 0 || (now.reached && (!best.reached || now.minutes < best.minutes))) best = now;
  }
  return best;
}

}  // namespace ecs::model
