// `ecs-world`: worlds under seeds. Does not live here: what happens in one (world.hpp).
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "tests/world/world.hpp"

namespace {

using namespace ecs::world;

constexpr const char* kUsage =
    "ecs-world [--seeds A..B]    runs these worlds (1..1000 if left out) and counts\n"
    "ecs-world --verbose SEED    runs one and tells what happens\n";

std::uint64_t number_in(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

int one(std::uint64_t seed) {
  const Report report = run_world(seed, {}, [](const std::string& line) { fmt::print("{}\n", line); });
  fmt::print("{} frames, {} faults, {:.1f} s of the world, trace {:016x}\n", report.frames, report.faults,
             report.virtual_s, report.trace);
  return report.violations.empty() ? 0 : 1;
}

int many(std::uint64_t first, std::uint64_t last) {
  Report sum;
  std::size_t violations = 0;
  double longest_calm_s = 0.0;
  const auto begun = std::chrono::steady_clock::now();
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Report report = run_world(seed);
    for (const std::string& violation : report.violations) {
      ++violations;
      fmt::print("seed {}: {}\n", seed, violation);
      std::fflush(stdout);
    }
    for (std::size_t i = 0; i < kSometimes.size(); ++i) sum.reached[i] += report.reached[i];
    for (const auto& [ending, count] : report.endings) sum.endings[ending] += count;
    sum.frames += report.frames;
    sum.faults += report.faults;
    sum.virtual_s += report.virtual_s;
    longest_calm_s = std::max(longest_calm_s, report.calm_s);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  const auto worlds = static_cast<double>(last - first + 1);
  fmt::print("{} worlds, {} frames, {} faults, {:.1f} h of the worlds in {:.1f} s: {:.0f} worlds a second\n", worlds,
             sum.frames, sum.faults, sum.virtual_s / 3600.0, seconds, worlds / seconds);
  fmt::print("sent again when the faults had stopped: active within {:.1f} s\n\nendings of uploads\n", longest_calm_s);
  for (const auto& [ending, count] : sum.endings) fmt::print("{:10} {}\n", count, ending);
  fmt::print("\nsometimes\n");
  std::size_t never = 0;
  for (std::size_t i = 0; i < kSometimes.size(); ++i) {
    fmt::print("{:10} {}\n", sum.reached[i], kSometimes[i]);
    if (sum.reached[i] == 0) ++never;
  }
  fmt::print("\n{} violations, {} states never reached\n", violations, never);
  return violations > 0 || never > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t first = 1, last = 1000;
  if (argc == 3 && std::strcmp(argv[1], "--verbose") == 0) return one(number_in(argv[2]));
  if (argc == 3 && std::strcmp(argv[1], "--seeds") == 0) {
    const std::string_view range = argv[2];
    const auto dots = range.find("..");
    first = number_in(range);
    last = dots == std::string_view::npos ? first : number_in(range.substr(dots + 2));
  } else if (argc != 1) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  return many(first, last);
}
