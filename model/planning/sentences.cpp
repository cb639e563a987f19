// Sentences from numbers; no method of its own.
#include "model/planning/sentences.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/diagnosis/words.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

std::string ways_of(const MeasurementProposal& p) {
  if (p.bidirectional) return "both ways";
  return p.approach < 0 ? "reverse only" : "forward only";
}

/// The first of many, and how many more.
std::string listed(const std::vector<std::string>& parts) {
  constexpr std::size_t kMost = 4;
  if (parts.size() <= kMost) return fmt::format("{}", fmt::join(parts, ", "));
  return fmt::format("{} and {} more", fmt::join(parts.begin(), parts.begin() + kMost, ", "), parts.size() - kMost);
}

/// How far the targets lie from equal steps at the utmost [mm].
double off_equal_steps_mm(const std::vector<double>& targets_mm) {
  double most_mm = 0.0;
  const double last = static_cast<double>(targets_mm.size()) - 1.0;
  for (std::size_t i = 0; i < targets_mm.size(); ++i)
    most_mm = std::max(most_mm, std::abs(targets_mm[i] - std::lerp(targets_mm.front(), targets_mm.back(),
                                                                   static_cast<double>(i) / std::max(last, 1.0))));
  return most_mm;
}

/// A pair that a run separates by so many sigmas, whichever of the two is true.
struct Apart {
  std::string first, second;
  double sigma = 0.0;
};

std::vector<Apart> pairs_once(const MeasurementProposal& p) {
  std::vector<Apart> list;
  for (const PairSeparation& pair : p.pairs) {
    const auto back = std::find_if(list.begin(), list.end(), [&](const Apart& one) {
      return one.first == pair.rival && one.second == pair.truth;
    });
    if (back == list.end())
      list.push_back({pair.truth, pair.rival, pair.sigma});
    else
      back->sigma = std::min(back->sigma, pair.sigma);
  }
  std::stable_sort(list.begin(), list.end(), [](const Apart& a, const Apart& b) { return a.sigma > b.sigma; });
  return list;
}

}  // namespace

std::string what_it_tells(const MeasurementProposal& p, Question question) {
  const std::string minutes = fmt::format("{:.0f} min", p.minutes);
  if (question == Question::repeat) return "tells whether what is left comes back: " + minutes;
  std::vector<std::string> apart, together;
  double least = kBeyondAll;
  for (const Apart& pair : pairs_once(p)) {
    const std::string names = pair.second.empty() ? pair.first : fmt::format("{} from {}", pair.first, pair.second);
    if (pair.sigma < std::min(kSeparates, p.separation_sigma)) {
      together.push_back(names);
      continue;
    }
    apart.push_back(names);
    least = std::min(least, pair.sigma);
  }
  if (question == Question::see)
    return fmt::format("shows {}, as large as the noise: {:.1f} sigma, {}", listed(apart), p.separation_sigma, minutes);
  if (question == Question::confirm) return fmt::format("confirms {}: {:.1f} sigma, {}", listed(apart), least, minutes);
  if (apart.empty()) return fmt::format("rules out one of the group: {:.1f} sigma, {}", p.separation_sigma, minutes);
  std::string text = fmt::format("tells {}: {:.1f} sigma, {}", listed(apart), least, minutes);
  if (!together.empty()) text += fmt::format("; not {}", listed(together));
  return text;
}

namespace {

std::string sentence_of_circle(const MeasurementProposal& p) {
  const Path& circle = *p.circle;
  std::string centre;
  for (const Axis axis : circle.plane)
    centre += fmt::format(" {}{:g}", letter_of(axis), circle.from_mm[index_of(axis)]);
  return fmt::format(
      "Measure {}, by a ball bar: radius {:g} mm about{}, {} {} counter-clockwise and clockwise, a reading every {:g} "
      "degrees, feed {:g} mm/min.",
      p.condition, circle.radius_mm, centre, p.runs, p.runs == 1 ? "turn" : "turns", p.circle_step_deg, p.feed_mm_min);
}

}  // namespace

std::string sentence_of(const MeasurementProposal& p) {
  if (p.circle) return sentence_of_circle(p);
  std::string what = readings_word(p.sense, p.axis);
  if (what.starts_with("Angles")) what.front() = 'a';
  std::string text = fmt::format("Measure {} {}: {} targets from {:g} to {:g} mm, {}, {} {}, feed {:g} mm/min", what,
                                 p.condition, p.targets_mm.size(), p.targets_mm.front(), p.targets_mm.back(),
                                 ways_of(p), p.runs, p.runs == 1 ? "run" : "runs", p.feed_mm_min);
  if (p.second_feed_mm_min) text += fmt::format(" and {:g} mm/min", *p.second_feed_mm_min);
  text += p.dwell_s > 0.0 ? fmt::format(", {:g} s dwell", p.dwell_s) : ", readings on the fly";
  constexpr double kWorthSaying_mm = 0.1;
  if (const double off_mm = off_equal_steps_mm(p.targets_mm); off_mm > kWorthSaying_mm)
    text += fmt::format(
        "; the targets lie up to {:.1f} mm off equal steps, so that no short period passes for a long one", off_mm);
  return text + ".";
}

}  // namespace ecs::model
