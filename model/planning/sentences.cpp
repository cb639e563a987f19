// Sentences from numbers; no method of its own.
#include "model/planning/sentences.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ecs::model {
namespace {

std::string ways_of(const MeasurementProposal& p) {
  if (p.bidirectional) return "both ways";
  return p.approach < 0 ? "downwards only" : "upwards only";
}

/// The first of many, and how many more.
std::string listed(const std::vector<std::string>& parts) {
  constexpr std::size_t kMost = 4;
  if (parts.size() <= kMost) return fmt::format("{}", fmt::join(parts, ", "));
  return fmt::format("{} and {} more", fmt::join(parts.begin(), parts.begin() + kMost, ", "), parts.size() - kMost);
}

std::string what_it_tells(const MeasurementProposal& p, Question question) {
  std::vector<std::string> apart, together;
  for (const PairSeparation& pair : p.pairs) {
    if (question == Question::separate && pair.truth > pair.rival) continue;  // reported once
    double sigma = pair.sigma;
    for (const PairSeparation& back : p.pairs)
      if (back.truth == pair.rival && back.rival == pair.truth) sigma = std::min(sigma, back.sigma);
    const bool enough = sigma >= std::min(kSeparates, p.separation_sigma);
    if (question != Question::separate) {
      if (enough) apart.push_back(fmt::format("{} by {:.1f} sigma", pair.truth, sigma));
    } else if (enough) {
      apart.push_back(fmt::format("{} from {} by {:.1f} sigma", pair.truth, pair.rival, sigma));
    } else {
      together.push_back(fmt::format("{} from {}", pair.truth, pair.rival));
    }
  }
  if (question == Question::see) return "; as large as the noise it would show " + listed(apart);
  if (question == Question::repeat) return "; it shows whether what is left comes back";
  if (question == Question::confirm) return "; it confirms " + listed(apart);
  std::string text = apart.empty() ? fmt::format("; by {:.1f} sigma one of the group falls", p.separation_sigma)
                                   : "; it separates " + listed(apart);
  if (!together.empty()) text += ", but not " + listed(together);
  return text;
}

}  // namespace

std::string sentence_of(const MeasurementProposal& p, Question question) {
  std::string text =
      fmt::format("Measure {} along {} {}: {} targets from {:g} to {:g} mm, {}, {} {}, feed {:g} mm/min",
                  name_of(p.sense), letter_of(p.axis), p.condition, p.targets_mm.size(), p.targets_mm.front(),
                  p.targets_mm.back(), ways_of(p), p.runs, p.runs == 1 ? "run" : "runs", p.feed_mm_min);
  if (p.second_feed_mm_min) text += fmt::format(" and {:g} mm/min", *p.second_feed_mm_min);
  text += p.dwell_s > 0.0 ? fmt::format(", {:g} s dwell", p.dwell_s) : ", readings on the fly";
  text += fmt::format("; about {:.0f} min", p.minutes);
  return text + what_it_tells(p, question) + ".";
}

}  // namespace ecs::model
