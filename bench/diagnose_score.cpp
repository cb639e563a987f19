// Scoring by the rules of docs/model.md; parameters count within three of their sigmas.
#include "diagnose_score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace ecs::bench {
namespace {

/// The same place; a truth without an axis ("offset::EX") holds for whichever axis the answer files it under.
bool same_name(const std::string& name, const std::string& truth) {
  const std::size_t gap = truth.find("::");
  if (gap == std::string::npos) return name == truth;
  return name.starts_with(truth.substr(0, gap + 1)) && name.ends_with(truth.substr(gap + 1)) &&
         name.size() <= truth.size() + 1;
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::any_of(list.begin(), list.end(), [&](const std::string& truth) { return same_name(name, truth); });
}

bool same_effect(const model::Candidate& candidate, const HiddenEffect& truth) {
  if (!same_name(to_text(candidate.effect), truth.name)) return false;
  if (!truth.approach.empty() && model::name_of(candidate.effect.approach) != truth.approach) return false;
  return truth.sensor.empty() || candidate.effect.sensor == truth.sensor;
}

/// The first candidate and its rivals are the group and nothing else.
bool is_group(const model::Candidate& candidate, const Truth& truth) {
  std::vector<std::string> found = candidate.indistinguishable_from;
  found.push_back(to_text(candidate.effect));
  const bool nothing_else = std::all_of(found.begin(), found.end(), [&](const std::string& name) {
    return contains(truth.group, name) || contains(truth.group_optional, name);
  });
  return nothing_else && std::all_of(truth.group.begin(), truth.group.end(), [&](const std::string& member) {
           return std::any_of(found.begin(), found.end(),
                              [&](const std::string& name) { return same_name(name, member); });
         });
}

/// Distance of an estimate from the truth; phases around the circle.
double distance(const std::string& name, double value, double truth) {
  if (!name.starts_with("phase")) return std::abs(value - truth);
  return std::abs(std::remainder(value - truth, 2.0 * std::numbers::pi));
}

}  // namespace

bool matches(const model::Candidate& candidate, const HiddenEffect& truth) {
  const auto& rivals = candidate.indistinguishable_from;
  return same_effect(candidate, truth) || std::any_of(rivals.begin(), rivals.end(), [&](const std::string& name) {
           return same_name(name, truth.name);
         });
}

/// Causes are said, proved or likely.
static bool says_causes(const model::Diagnosis& answer) {
  return !answer.candidates.empty() &&
         (answer.verdict == model::Verdict::missing_effect || answer.verdict == model::Verdict::likely_effect);
}

bool right(const Case& one, const model::Diagnosis& answer) {
  const auto& candidates = answer.candidates;
  switch (one.kind) {
    case CaseKind::blank:
      return answer.verdict == model::Verdict::adequate;
    case CaseKind::out_of_library:
      return answer.verdict == model::Verdict::unexplained_structure;
    case CaseKind::single:
      return says_causes(answer) && matches(candidates.front(), one.truth.effects.front());
    case CaseKind::pair:
      return says_causes(answer) &&
             std::all_of(one.truth.effects.begin(), one.truth.effects.end(), [&](const HiddenEffect& truth) {
               return std::any_of(candidates.begin(), candidates.end(),
                                  [&](const model::Candidate& c) { return c.in_answer() && matches(c, truth); });
             });
    default:
      return says_causes(answer) && is_group(candidates.front(), one.truth);
  }
}

bool rival_right(const Case& one, const std::vector<std::string>& names) {
  if (one.kind == CaseKind::blank || one.kind == CaseKind::out_of_library) return names.empty();
  if (one.kind == CaseKind::pair)
    return std::all_of(one.truth.effects.begin(), one.truth.effects.end(), [&](const HiddenEffect& truth) {
      return std::any_of(names.begin(), names.end(),
                         [&](const std::string& name) { return same_name(name, truth.name); });
    });
  return !names.empty() && same_name(names.front(), one.truth.effects.front().name);
}

ParameterCount count_parameters(const Case& one, const model::Diagnosis& answer) {
  ParameterCount count;
  for (const model::Candidate& candidate : answer.candidates) {
    if (!candidate.in_answer() || !candidate.indistinguishable_from.empty()) continue;
    for (const HiddenEffect& truth : one.truth.effects) {
      if (!same_effect(candidate, truth)) continue;
      for (const model::ParameterEstimate& estimate : candidate.parameters) {
        const auto value = truth.parameters.find(estimate.name);
        if (value == truth.parameters.end() || !estimate.sigma || *estimate.sigma <= 0.0) continue;
        ++count.counted;
        const double sigmas = distance(estimate.name, estimate.value, value->second) / *estimate.sigma;
        if (sigmas < 3.0)
          ++count.within;
        else
          count.missed.push_back(fmt::format("{} {} {:.5g} for {:.5g}: {:.1f} sigma", truth.name, estimate.name,
                                             estimate.value, value->second, sigmas));
      }
    }
  }
  return count;
}

}  // namespace ecs::bench
