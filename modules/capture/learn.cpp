#include "modules/capture/learn.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace ecs::devices {
namespace {

constexpr double kBounce_s = 0.06;  ///< two changes closer than this are one contact bouncing
constexpr int kLeastDebounce_ms = 20;

struct BitPlace {
  std::uint8_t number = 0;
  std::size_t byte = 0;
  int bit = 0;
  friend auto operator<=>(const BitPlace&, const BitPlace&) = default;
};

struct Step {
  double time_s = 0.0;
  bool level = false;
};

/// What one bit did: its steps with the bounces taken out, and the longest bounce.
struct Behaviour {
  bool rest = false;  ///< its last level
  std::vector<Step> steps;
  double bounce_s = 0.0;
};

std::string text_of(const BitPlace& at) {
  return at.number == 0 ? fmt::format("bit {} of byte {}", at.bit, at.byte)
                        : fmt::format("bit {} of byte {} of report {}", at.bit, at.byte, at.number);
}

std::vector<Step> raw_steps(const std::vector<Step>& levels, bool rest) {
  std::vector<Step> steps;
  bool level = rest;
  for (const Step& each : levels) {
    if (each.level == level) continue;
    level = each.level;
    steps.push_back(each);
  }
  return steps;
}

/// A burst of close steps counts by where it began and ended: an odd number is one step, an even number none.
Behaviour behaviour_of(const std::vector<Step>& levels) {
  Behaviour out;
  out.rest = levels.back().level;
  const std::vector<Step> raw = raw_steps(levels, out.rest);
  for (std::size_t begin = 0; begin < raw.size();) {
    std::size_t end = begin + 1;
    while (end < raw.size() && raw[end].time_s - raw[end - 1].time_s < kBounce_s) ++end;
    if (end - begin > 1) out.bounce_s = std::max(out.bounce_s, raw[end - 1].time_s - raw[begin].time_s);
    if ((end - begin) % 2 == 1) out.steps.push_back({raw[begin].time_s, raw[end - 1].level});
    begin = end;
  }
  return out;
}

using Bits = std::map<BitPlace, Behaviour>;

/// Every bit that ever changed.
Bits changing_bits(const std::vector<TimedReport>& reports, bool numbered) {
  std::map<BitPlace, std::vector<Step>> levels;
  for (const TimedReport& report : reports) {
    if (report.bytes.empty()) continue;
    const std::uint8_t number = numbered ? report.bytes[0] : std::uint8_t{0};
    for (std::size_t byte = numbered ? 1 : 0; byte < report.bytes.size(); ++byte)
      for (int bit = 0; bit < 8; ++bit)
        levels[{number, byte, bit}].push_back({report.time_s, (report.bytes[byte] >> bit & 1) != 0});
  }
  Bits bits;
  for (const auto& [place, steps] : levels) {
    const bool first = steps.front().level;
    if (std::ranges::all_of(steps, [&](const Step& s) { return s.level == first; })) continue;
    bits.emplace(place, behaviour_of(steps));
  }
  return bits;
}

/// The same steps at the same moments, whichever way round.
bool move_together(const Behaviour& a, const Behaviour& b) {
  if (a.steps.size() != b.steps.size()) return false;
  for (std::size_t k = 0; k < a.steps.size(); ++k)
    if (std::abs(a.steps[k].time_s - b.steps[k].time_s) > kBounce_s) return false;
  return true;
}

std::string what_changed(const Bits& bits) {
  constexpr std::size_t kMost = 8;
  std::string text;
  std::size_t shown = 0;
  for (const auto& [place, behaviour] : bits) {
    if (++shown > kMost) return text + fmt::format(", and {} more", bits.size() - kMost);
    text += fmt::format("{}{} {} times", text.empty() ? "" : ", ", text_of(place), behaviour.steps.size());
  }
  return text;
}

Result<Learned> layout_of(const std::vector<std::pair<BitPlace, Behaviour>>& found,
                          const std::vector<TimedReport>& reports, bool numbered) {
  Learned out;
  const BitPlace& first = found.front().first;
  out.report_number = first.number;
  out.trigger.byte = first.byte;
  out.trigger.active_high = !found.front().second.rest;
  out.trigger.mask = 0;
  for (const auto& [place, behaviour] : found) {
    out.bounce_ms = std::max(out.bounce_ms, behaviour.bounce_s * 1e3);
    if (behaviour.rest != out.trigger.active_high)
      out.trigger.mask = static_cast<std::uint8_t>(out.trigger.mask | 1U << place.bit);
  }
  for (const TimedReport& report : reports)
    if (!report.bytes.empty() && (!numbered || report.bytes[0] == first.number))
      out.report_bytes = std::max(out.report_bytes, report.bytes.size());
  out.trigger.debounce_ms = std::max(kLeastDebounce_ms, static_cast<int>(std::lround(2.0 * out.bounce_ms)));
  return out;
}

}  // namespace

int presses_seen(const std::vector<TimedReport>& reports, bool numbered) {
  std::size_t most = 0;
  for (const auto& entry : changing_bits(reports, numbered)) most = std::max(most, entry.second.steps.size());
  return static_cast<int>(most / 2);
}

Result<Learned> learned(const std::vector<TimedReport>& reports, int presses, bool numbered) {
  const Bits bits = changing_bits(reports, numbered);
  const auto wanted = static_cast<std::size_t>(2 * presses);
  if (reports.empty())
    return problem(ProblemKind::refused,
                   "nothing came from the device: is it the right one, and is it pressed hard enough?");
  std::vector<std::pair<BitPlace, Behaviour>> found;
  for (const auto& entry : bits)
    if (entry.second.steps.size() == wanted) found.emplace_back(entry);
  if (found.empty())
    return problem(ProblemKind::refused,
                   bits.empty()
                       ? fmt::format("{} reports came and not one bit of them changed", reports.size())
                       : fmt::format("no bit changed {} times, as {} presses and releases do; seen: {}. Press and "
                                     "release exactly {} times, with half a second between",
                                     wanted, presses, what_changed(bits), presses));
  const BitPlace& first = found.front().first;
  for (const auto& [place, behaviour] : found) {
    if (!move_together(behaviour, found.front().second))
      return problem(ProblemKind::refused,
                     fmt::format("{} and {} both changed {} times, but not together: it is not clear which one is the "
                                 "button. Touch nothing else on the device, and learn again",
                                 text_of(first), text_of(place), wanted));
    if (place.number != first.number || place.byte != first.byte)
      return problem(
          ProblemKind::refused,
          fmt::format("{} and {} changed together with every press: it is not clear which one is the button. "
                      "Write the one that you mean into a description by hand",
                      text_of(first), text_of(place)));
  }
  return layout_of(found, reports, numbered);
}

}  // namespace ecs::devices
