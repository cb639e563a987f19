// What least squares that knows the hidden effects makes of a case, and how well it determines their parameters.
#include <algorithm>
#include <cmath>

#include "bench/foreign/case.hpp"
#include "bench/foreign/rivals.hpp"

namespace foreign {
namespace {

bool among(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

}  // namespace

// An informed least-squares check: is every hidden effect the best beside the others, and how sure is it?
void ask_oracle(Case& drawn) {
  Column um = drawn.readings_um;
  for (const Term& term : drawn.base) add_scaled(um, contribution(drawn.setup, term), -1.0);
  drawn.oracle_p = 0.0;
  for (std::size_t k = 0; k < drawn.hidden.size(); ++k) {
    std::vector<Term> known = drawn.base;
    Column others = um;
    for (std::size_t j = 0; j < drawn.hidden.size(); ++j) {
      if (j == k) continue;
      known.push_back(drawn.hidden[j]);
      add_scaled(others, contribution(drawn.setup, drawn.hidden[j]), -1.0);
    }
    const Projector projector(drawn.setup, drawn.noise, known);
    const Column rest = projector.rest_of(others);
    const std::vector<Reproduction> ranked = projector.ranked(rest);
    const std::string best = name_of(ranked.front().term);
    const bool right = best == name_of(drawn.hidden[k]) || among(drawn.required, best) || among(drawn.allowed, best);
    drawn.oracle_right = drawn.oracle_right && right;
    const Reproduction own = projector.of(drawn.hidden[k], rest);
    const double p = chi2_exceeds(dot(rest, rest) - own.excess, std::max(1, own.parameters));
    drawn.oracle_p = std::max(drawn.oracle_p, p);
  }
}

std::map<std::string, double> parameter_sigmas(const Case& drawn, std::size_t index) {
  const Term& term = drawn.hidden[index];
  std::vector<Column> jacobian;
  const auto add = [&](const std::vector<Column>& columns) {
    for (const Column& column : columns) jacobian.push_back(whitened(drawn.setup, drawn.noise, column));
  };
  const auto add_hidden = [&](const Term& hidden) {
    add(columns_of(drawn.setup, hidden));
    if (has_nonlinear(hidden.id) && hidden.id != "step") add({nonlinear_derivative(drawn.setup, hidden)});
  };
  add_hidden(term);
  const std::size_t own = jacobian.size();
  for (const Term& other : drawn.base)
    if (!other.given) add(free_columns_of(drawn.setup, other));
  for (std::size_t k = 0; k < drawn.hidden.size(); ++k)
    if (k != index) add_hidden(drawn.hidden[k]);
  const std::vector<Column> covariance = inverse_normal(jacobian);
  // Gradient of each named parameter, by differences in the coefficients and the nonlinear parameter.
  std::map<std::string, double> sigmas;
  for (const auto& [name, value] : parameters_of(drawn.setup, term)) {
    if (term.id == "step" && name == "position_mm") continue;
    Column gradient(own, 0.0);
    for (std::size_t k = 0; k < own; ++k) {
      Term moved = term;
      double& at = k < term.coefficients.size() ? moved.coefficients[k] : moved.nonlinear;
      const double step = 1e-6 * std::max(1e-6, std::abs(at));
      at += step;
      gradient[k] = (parameters_of(drawn.setup, moved).at(name) - value) / step;
    }
    double variance = 0.0;
    for (std::size_t i = 0; i < own; ++i)
      for (std::size_t j = 0; j < own; ++j) variance += gradient[i] * covariance[i][j] * gradient[j];
    if (variance > 0.0) sigmas[name] = std::sqrt(variance);  // else rounding: these readings do not determine it
  }
  return sigmas;
}

}  // namespace foreign
