// Between linear coefficients of columns and the parameters that people read.
#include <cmath>
#include <limits>

#include "model/regression/regressors.hpp"

namespace ecs::model {
namespace {

std::optional<double> given(const EffectInstance& effect, std::string_view name) {
  const auto found = effect.parameters.find(std::string(name));
  return found == effect.parameters.end() ? std::nullopt : std::optional(found->second);
}

/// Coefficients that a parameter stands for.
std::size_t coefficients_of(Coding coding) {
  if (coding == Coding::amplitude) return 2;
  return coding == Coding::coefficient || coding == Coding::square_root ? 1 : 0;
}

/// A parameter with its coefficients.
struct Coded {
  std::size_t parameter = 0;    ///< place among the parameters of the definition
  std::size_t coefficient = 0;  ///< its first
};
std::vector<Coded> coded(const EffectDefinition& definition) {
  std::vector<Coded> all;
  std::size_t coefficient = 0;
  for (std::size_t i = 0; i < definition.parameters.size(); ++i) {
    const std::size_t count = coefficients_of(definition.parameters[i].coding);
    if (count > 0) all.push_back({i, coefficient});
    coefficient += count;
  }
  return all;
}

/// Amplitude and phase of a·sin + b·cos, with sigmas by propagation.
void add_harmonic(const EffectInstance& effect, std::vector<ParameterEstimate>& out, const Eigen::VectorXd& c,
                  const Eigen::MatrixXd& covariance, Eigen::Index at, std::span<const ParameterDefinition, 2> names) {
  if (at + 1 >= c.size()) return;
  const double a = c(at), b = c(at + 1);
  const double size = std::hypot(a, b);
  ParameterEstimate amplitude{std::string(names[0].name), unit_of(effect, names[0]), size, {}, false, false};
  ParameterEstimate phase{std::string(names[1].name), std::string(names[1].unit), std::atan2(b, a), {}, false, false};
  if (covariance.rows() > at + 1 && size > 0.0) {
    const double vaa = covariance(at, at), vbb = covariance(at + 1, at + 1), vab = covariance(at, at + 1);
    amplitude.sigma = std::sqrt(std::max(0.0, (a * a * vaa + b * b * vbb + 2.0 * a * b * vab))) / size;
    phase.sigma = std::sqrt(std::max(0.0, (b * b * vaa + a * a * vbb - 2.0 * a * b * vab))) / (size * size);
  }
  out.push_back(amplitude);
  out.push_back(phase);
}

/// Coefficient `within` (0 sine, 1 cosine) of a wave that amplitude and phase give; nothing: to be fitted. A harmonic
/// that is not given beside a wave that is given whole is 0.
std::optional<double> held_in_wave(const EffectInstance& effect, std::size_t parameter, std::size_t within) {
  const auto& parameters = effect.definition().parameters;
  const auto amplitude = given(effect, parameters[parameter].name);
  const auto phase = given(effect, parameters[parameter + 1].name);
  if (amplitude && *amplitude == 0.0) return 0.0;
  const bool harmonic = parameter >= 2 && parameters[parameter - 2].coding == Coding::amplitude;
  if (harmonic && !amplitude && given(effect, parameters[parameter - 2].name) &&
      given(effect, parameters[parameter - 1].name))
    return 0.0;
  if (!amplitude || !phase) return std::nullopt;
  return *amplitude * (within == 0 ? std::cos(*phase) : std::sin(*phase));
}

}  // namespace

std::size_t EffectDefinition::column_count() const {
  std::size_t count = 0;
  for (const ParameterDefinition& parameter : parameters) count += coefficients_of(parameter.coding);
  return count;
}

std::vector<ParameterEstimate> parameters_from(const EffectInstance& effect, const Eigen::VectorXd& linear,
                                               const Eigen::MatrixXd& covariance, std::optional<double> searched,
                                               std::optional<double> searched_sigma) {
  const EffectDefinition& definition = effect.definition();
  std::vector<ParameterEstimate> out;
  const auto add = [&](const ParameterDefinition& parameter, double value, std::optional<double> sigma, bool held) {
    out.push_back(
        {std::string(parameter.name), unit_of(effect, parameter), value, sigma, held, false, is_direction(effect)});
  };
  for (const ParameterDefinition& parameter : definition.parameters) {
    const bool is_whole_fraction = effect.rotary && definition.traits.periodic;  // of a turn: exact
    if (parameter.coding == Coding::searched && searched)
      add(parameter, *searched, is_whole_fraction ? std::nullopt : searched_sigma,
          given(effect, parameter.name).has_value());
    if (parameter.coding == Coding::fixed) add(parameter, 1.0, {}, false);
  }
  for (const auto& [place, first] : coded(definition)) {
    const ParameterDefinition& parameter = definition.parameters[place];
    const auto j = static_cast<Eigen::Index>(first);
    if (j >= linear.size()) break;
    if (parameter.coding == Coding::amplitude) {
      add_harmonic(effect, out, linear, covariance, j, std::span<const ParameterDefinition, 2>(&parameter, 2));
      continue;
    }
    std::optional<double> sigma;
    if (covariance.rows() > j) sigma = std::sqrt(std::max(0.0, covariance(j, j)));
    if (parameter.coding == Coding::square_root) {
      const double root = std::sqrt(std::max(0.0, linear(j)));
      if (sigma) sigma = *sigma / (2.0 * std::max(root, std::sqrt(*sigma)));
      add(parameter, root, sigma, false);
    } else {
      add(parameter, parameter.neutral + linear(j), sigma, false);
    }
  }
  return out;
}

std::optional<double> held_coefficient(const EffectInstance& effect, std::size_t j) {
  for (const auto& [place, first] : coded(effect.definition())) {
    const ParameterDefinition& parameter = effect.definition().parameters[place];
    if (j < first || j >= first + coefficients_of(parameter.coding)) continue;
    if (parameter.coding == Coding::amplitude) return held_in_wave(effect, place, j - first);
    const auto value = given(effect, parameter.name);
    if (!value) return std::nullopt;
    return parameter.coding == Coding::square_root ? *value * *value : *value - parameter.neutral;
  }
  return std::nullopt;
}

std::optional<ValueRange> EffectDefinition::coefficient_range(std::size_t j) const {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  for (const auto& [number, first] : coded(*this)) {
    const ParameterDefinition& parameter = parameters[number];
    if (j != first) continue;
    if (parameter.coding == Coding::square_root) {
      const double most = parameter.limits ? parameter.limits->greatest : kAny;
      return ValueRange{0.0, most * most};
    }
    if (parameter.coding == Coding::coefficient && parameter.limits)
      return ValueRange{parameter.limits->least - parameter.neutral, parameter.limits->greatest - parameter.neutral};
  }
  return std::nullopt;
}

std::string parameter_of_coefficient(const EffectDefinition& definition, std::size_t j) {
  for (const auto& [place, first] : coded(definition))
    if (j >= first && j < first + coefficients_of(definition.parameters[place].coding))
      return std::string(definition.parameters[place].name);
  return "";
}

}  // namespace ecs::model
