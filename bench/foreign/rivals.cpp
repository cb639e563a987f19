// Projections of what is hidden onto the columns of every effect of the library.
#include "bench/foreign/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace foreign {
namespace {

constexpr int kRefinements = 3;
constexpr double kNoCandidate = 1e300;
constexpr double kSameFreedom = 0.1;  // of a nonlinear parameter, in the logarithm

// Of an effect that is no candidate here, or that the base model holds whole.
bool shows_nothing(const Reproduction& found) {
  return found.score >= kNoCandidate || (found.parameters == 0 && found.term.id != "map_direction_swap");
}

}  // namespace

Projector::Projector(const Setup& setup, const Noise& noise, const std::vector<Term>& fixed_base)
    : setup_(setup), noise_(noise), library_(library_of(setup)) {
  for (const Term& term : fixed_base) {
    if (term.given) continue;
    for (const Column& column : free_columns_of(setup, term)) base_.add(whitened(setup, noise, column));
  }
}

Column Projector::rest_of(const Column& um) const { return base_.residual(whitened(setup_, noise_, um)); }

Reproduction Projector::at(const Term& candidate, const Column& rest) const {
  Reproduction found{candidate, 0.0, has_nonlinear(candidate.id) ? 1 : 0, 0.0};
  std::vector<Column> columns = columns_of(setup_, candidate);
  const auto log_n = std::log(static_cast<double>(rest.size()));
  if (candidate.id == "map_shift" || candidate.id == "map_direction_swap") {
    Column left = rest;
    add_scaled(left, base_.residual(whitened(setup_, noise_, columns.front())), -1.0);
    found.excess = dot(left, left);
    found.score = found.excess + found.parameters * log_n;
    return found;
  }
  Basis own;
  Column left = rest;
  for (Column& column : columns) {
    const Column raw = whitened(setup_, noise_, column);
    column = base_.residual(base_.residual(raw));
    if (std::sqrt(dot(column, column)) < 1e-6 * std::sqrt(dot(raw, raw))) continue;
    own.add(column);
  }
  const auto [low, high] = coefficient_limits(candidate.id);
  if (columns.size() == 1 && own.rank() == 1) {
    const double coefficient = std::clamp(dot(rest, columns[0]) / dot(columns[0], columns[0]), low, high);
    add_scaled(left, columns[0], -coefficient);
  } else {
    left = own.residual(rest);
  }
  found.excess = dot(left, left);
  found.parameters += own.rank();
  found.score = found.excess + found.parameters * log_n;
  return found;
}

Reproduction Projector::of(const Term& candidate, const Column& rest) const {
  const std::vector<double> grid = nonlinear_grid(setup_, candidate);
  Reproduction best;
  best.score = kNoCandidate;
  best.excess = kNoCandidate;
  if (grid.empty() || !may_be_candidate(setup_, candidate)) return best;
  std::size_t place = 0;
  Term term = candidate;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    term.nonlinear = grid[k];
    const Reproduction now = at(term, rest);
    if (now.score < best.score) {
      best = now;
      place = k;
    }
  }
  if (grid.size() < 2 || candidate.id == "step") return best;
  double low = grid[place > 0 ? place - 1 : 0];
  double high = grid[std::min(place + 1, grid.size() - 1)];
  for (int round = 0; round < kRefinements; ++round) {
    const double width = (high - low) / 6.0;
    for (int k = 1; k < 6; ++k) {
      term.nonlinear = low + width * k;
      if (term.nonlinear == 0.0) continue;
      const Reproduction now = at(term, rest);
      if (now.score < best.score) best = now;
    }
    low = std::max(std::min(low, high), best.term.nonlinear - std::abs(width));
    high = best.term.nonlinear + std::abs(width);
    high = std::min(high, *std::max_element(grid.begin(), grid.end()));
  }
  return best;
}

int Projector::parameters_of(const Term& term) const {
  return at(term, Column(setup_.readings.size(), 0.0)).parameters;
}

std::vector<Reproduction> Projector::ranked(const Column& rest, bool waves) const {
  std::map<std::string, Reproduction> best;
  for (const Term& candidate : library_) {
    if (!waves && candidate.id == "cyclic") continue;
    const Reproduction now = of(candidate, rest);
    if (shows_nothing(now)) continue;
    const auto [at, fresh] = best.try_emplace(name_of(candidate), now);
    if (!fresh && now.score < at->second.score) at->second = now;
  }
  std::vector<Reproduction> ranked;
  for (const auto& [name, found] : best) ranked.push_back(found);
  std::sort(ranked.begin(), ranked.end(),
            [](const Reproduction& a, const Reproduction& b) { return a.score < b.score; });
  return ranked;
}

Rivals rivals_of(const Projector& projector, const Term& truth, const Column& hidden_um) {
  const Column rest = projector.rest_of(hidden_um);
  const auto n = static_cast<double>(rest.size());
  const int own = projector.parameters_of(truth);
  Rivals rivals;
  std::set<std::string> seen;
  for (const Term& candidate : projector.library()) {
    const std::string name = name_of(candidate);
    if (name == name_of(truth)) continue;
    const Reproduction other = projector.of(candidate, rest);
    if (shows_nothing(other)) continue;
    const bool same = other.excess < n * kSameShare * kSameShare;
    if (!same) {
      rivals.clear = other.excess + (other.parameters - own) * std::log(n) > kClearMargin;
      if (!rivals.clear) return rivals;
      continue;
    }
    const bool curve =
        candidate.id == "angular";  // of any shape, even where an axis that is parked shows one value only
    if (other.parameters < own && !curve) rivals.simplest = false;
    if (seen.insert(name).second)
      (other.parameters <= own && !curve ? rivals.required : rivals.allowed).push_back(name);
  }
  return rivals;
}

bool clear_of_free_base(const Setup& setup, const Noise& noise, const std::vector<Term>& base, const Term& truth,
                        const Rivals& known, const Column& um) {
  const Term& free_term = base.back();
  if (free_term.id != "warm_up" && free_term.id != "reversal_spike") return true;
  const int own = Projector(setup, noise, base).parameters_of(truth);
  const double log_n = std::log(static_cast<double>(um.size()));
  std::set<std::string> same(known.required.begin(), known.required.end());
  same.insert(known.allowed.begin(), known.allowed.end());
  same.insert(name_of(truth));
  for (const double place : nonlinear_grid(setup, free_term)) {
    if (std::abs(std::log(place / free_term.nonlinear)) < kSameFreedom) continue;
    std::vector<Term> moved = base;
    moved.back().nonlinear = place;
    const Projector projector(setup, noise, moved);
    const Column rest = projector.rest_of(um);
    for (const Term& candidate : projector.library()) {
      if (candidate.id == "cyclic" || same.contains(name_of(candidate))) continue;
      const Reproduction other = projector.of(candidate, rest);
      if (!shows_nothing(other) && other.excess + (other.parameters - own) * log_n < kClearMargin) return false;
    }
  }
  return true;
}

}  // namespace foreign
