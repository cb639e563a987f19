#include "commissioning/investigation/credible_set.hpp"

#include <algorithm>

#include "commissioning/investigation/readings.hpp"

namespace ecs::commissioning {

std::vector<SetMember> credible_set_of(const model::Candidate& candidate) {
  std::vector<SetMember> set = candidate.set;
  std::erase_if(set, [](const SetMember& member) { return is_zero_of_run(member.name); });
  if (set.empty()) set.push_back({to_text(candidate.effect), candidate.probability});
  return set;
}

std::vector<SetMember> members_left(const model::Diagnosis& diagnosis) {
  std::vector<SetMember> left;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    for (SetMember& member : credible_set_of(candidate))
      if (std::none_of(left.begin(), left.end(), [&](const SetMember& m) { return m.name == member.name; }))
        left.push_back(std::move(member));
  }
  return left;
}

bool causes_are_single(const model::Diagnosis& diagnosis) {
  bool any = false;
  for (const model::Candidate& candidate : diagnosis.candidates) {
    if (!candidate.in_answer()) continue;
    any = true;
    if (credible_set_of(candidate).size() > 1) return false;
  }
  return any;
}

}  // namespace ecs::commissioning
