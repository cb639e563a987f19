// What every answer of a diagnosis owes to its reader: no sentence contradicts its own numbers.
#pragma once

#include <regex>
#include <set>
#include <string>

#include "model/diagnosis/words.hpp"
#include "tests/support/test.hpp"

namespace ecs::model::test {

/// Every pair of numbers that a sentence calls a fall.
inline void check_falls(const std::string& because) {
  static const std::regex fall(R"((?:falls|fitted to|residual) from (\S+) to (\S+) um)");
  for (std::sregex_iterator one(because.begin(), because.end(), fall), end; one != end; ++one)
    CHECK_MESSAGE(std::stod((*one)[1]) > std::stod((*one)[2]), because);
}

inline void check_sentences(const Diagnosis& found) {
  CHECK(!found.headline.empty());
  std::set<std::string> named;
  for (const Candidate& candidate : found.candidates) {
    const std::string& because = candidate.because;
    const double before = candidate.kept_rms_before_um, after = candidate.kept_rms_after_um;
    check_falls(because);
    if (contains(because, "none of ")) CHECK_MESSAGE(1.0 - after * after / (before * before) >= 0.01, because);
    if (contains(because, "Together with")) CHECK(candidate.in_answer());
    if (!candidate.named) continue;
    const std::string place = place_text(candidate.effect);
    CHECK_MESSAGE(contains(found.headline, "(" + place), found.headline);
    const auto period = candidate.effect.fitted.find("period_mm");
    const double value = period == candidate.effect.fitted.end() ? 0.0 : period->second;
    CHECK_MESSAGE(named.insert(place + std::to_string(value)).second, found.headline);
    for (const EffectInstance& rival : candidate.rivals) CHECK_FALSE(same_candidate(rival, candidate.effect));
  }
  if (found.verdict == Verdict::adequate && !found.reservation.empty())
    CHECK_FALSE(contains(found.headline, "The model explains the readings"));
}

}  // namespace ecs::model::test
