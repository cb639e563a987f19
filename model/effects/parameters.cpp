// Between linear coefficients of columns and the parameters that people read.
#include <cmath>

#include "model/effects/regressors.hpp"

namespace ecs::model {
namespace {

using enum EffectId;

std::optional<double> given(const EffectInstance& effect, std::string_view name) {
  const auto found = effect.parameters.find(std::string(name));
  return found == effect.parameters.end() ? std::nullopt : std::optional(found->second);
}

/// Amplitude and phase of a·sin + b·cos, with sigmas by propagation.
void add_harmonic(std::vector<ParameterEstimate>& out, const Eigen::VectorXd& c, const Eigen::MatrixXd& covariance,
                  Eigen::Index at, const std::string& amplitude, const std::string& phase) {
  if (at + 1 >= c.size()) return;
  const double a = c(at), b = c(at + 1);
  const double size = std::hypot(a, b);
  ParameterEstimate amplitude_of{amplitude, "um", size, {}, false, false};
  ParameterEstimate phase_of{phase, "rad", std::atan2(b, a), {}, false, false};
  if (covariance.rows() > at + 1 && size > 0.0) {
    const double vaa = covariance(at, at), vbb = covariance(at + 1, at + 1), vab = covariance(at, at + 1);
    amplitude_of.sigma = std::sqrt(std::max(0.0, (a * a * vaa + b * b * vbb + 2.0 * a * b * vab))) / size;
    phase_of.sigma = std::sqrt(std::max(0.0, (b * b * vaa + a * a * vbb - 2.0 * a * b * vab))) / (size * size);
  }
  out.push_back(amplitude_of);
  out.push_back(phase_of);
}

}  // namespace

std::vector<ParameterEstimate> parameters_from(const EffectInstance& effect, const Eigen::VectorXd& linear,
                                               const Eigen::MatrixXd& covariance, std::optional<double> nonlinear,
                                               std::optional<double> nonlinear_sigma) {
  std::vector<ParameterEstimate> out;
  const auto sigma_of = [&](Eigen::Index j) -> std::optional<double> {
    if (covariance.rows() <= j) return std::nullopt;
    return std::sqrt(std::max(0.0, covariance(j, j)));
  };
  if (nonlinear) {
    for (const ParameterInfo& info : info_of(effect.id).parameters)
      if (info.nonlinear)
        out.push_back({std::string(info.name), std::string(info.unit), *nonlinear, nonlinear_sigma,
                       given(effect, info.name).has_value(), false});
  }
  if (effect.id == cyclic) {
    add_harmonic(out, linear, covariance, 0, "amplitude_um", "phase_rad");
    add_harmonic(out, linear, covariance, 2, "amplitude2_um", "phase2_rad");
    return out;
  }
  if (effect.id == cosine && linear.size() > 0) {
    const double angle = std::sqrt(std::max(0.0, linear(0)));
    std::optional<double> sigma = sigma_of(0);
    if (sigma) sigma = *sigma / (2.0 * std::max(angle, std::sqrt(*sigma)));
    out.push_back({"angle_mrad", "mrad", angle, sigma, false, false});
    return out;
  }
  if (effect.id == map_polarity) {
    out.push_back({"fraction", "", 1.0, {}, false, false});
    return out;
  }
  if (is_curve(effect.id)) return out;
  Eigen::Index j = 0;
  for (const ParameterInfo& info : info_of(effect.id).parameters) {
    if (info.nonlinear) continue;
    if (j >= linear.size()) break;
    const double value = effect.id == map_gain ? 1.0 + linear(j) : linear(j);
    out.push_back({std::string(info.name), std::string(info.unit), value, sigma_of(j), false, false});
    ++j;
  }
  return out;
}

std::optional<double> held_coefficient(const EffectInstance& effect, std::size_t j) {
  if (effect.id == cyclic) {
    const bool first = j < 2;
    const auto amplitude = given(effect, first ? "amplitude_um" : "amplitude2_um");
    const auto phase = given(effect, first ? "phase_rad" : "phase2_rad");
    if (amplitude && *amplitude == 0.0) return 0.0;
    if (!first && !amplitude && given(effect, "amplitude_um") && given(effect, "phase_rad")) return 0.0;
    if (!amplitude || !phase) return std::nullopt;
    return *amplitude * (j % 2 == 0 ? std::cos(*phase) : std::sin(*phase));
  }
  if (effect.id == cosine) {
    const auto angle = given(effect, "angle_mrad");
    return angle ? std::optional(*angle * *angle) : std::nullopt;
  }
  std::size_t k = 0;
  for (const ParameterInfo& info : info_of(effect.id).parameters) {
    if (info.nonlinear) continue;
    if (k++ != j) continue;
    auto value = given(effect, info.name);
    if (value && effect.id == map_gain) *value -= 1.0;
    return value;
  }
  return std::nullopt;
}

}  // namespace ecs::model
