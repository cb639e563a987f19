// How much processor time a volume takes, and what shrinking gains: over 200 seeds, squared error at the targets of
// shrunk means against plain ones. Run: volume_bench [PLACES]   (1,000,000 if not given)
#include <cstdlib>
#include <functional>

#include <fmt/format.h>

#include "tests/support/shrinking_forms.hpp"
#include "tests/support/volume_machine.hpp"
#include "volume/uncertainty.hpp"

namespace {

using namespace ecs;

/// Of this processor, so that other programs do not count.
double seconds_of(const std::function<void()>& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

bool time_volume(std::size_t places) {
  bool all = true;
  for (const char* chain : {"TXYZ", "XTYZ", "XYTZ", "XYZT"}) {
    const volume::CompensatedMachine machine = volume::stated_machine(chain);
    std::size_t found = 0;
    const double whole_s = seconds_of([&] { found = evaluated(machine, places)->grid.places(); });
    volume::UncertaintySettings settings;
    const double bound_s = seconds_of(
        [&] { all = uncertainty_of(machine, budget_of(machine, settings), settings, places).has_value() && all; });
    fmt::print("{}: {} places, both sides, before and after {:.3f} s; {} maps drawn {:.3f} s\n", chain, found, whole_s,
               settings.draws, bound_s);
    all = all && found > places / 2;
  }
  for (const char* chain : {"TXYZCB", "XYACTZ", "XYCTZB"}) {
    const volume::CompensatedMachine machine = volume::stated_rotary_machine(chain);
    std::size_t found = 0;
    const double whole_s = seconds_of([&] {
      const auto answer = evaluated(machine, places);
      found = answer->before.all.places;
    });
    fmt::print("{}: {} places with angles, both sides, before and after {:.3f} s\n", chain, found, whole_s);
    all = all && found > places / 2;
  }
  return all;
}

/// @return no form is worse shrunk than plain, on average
bool compare_shrunk() {
  bool none_worse = true;
  fmt::print("\nshrunk means, 200 seeds each: mean squared error against plain means\n");
  for (const auto& [name, form] : laser::shrinking_forms()) {
    double plain = 0.0, less = 0.0;
    int better = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      const laser::ShrinkingTrial trial = laser::shrinking_trial(form, seed);
      plain += trial.plain;
      less += trial.shrunk;
      if (trial.shrunk <= trial.plain) ++better;
    }
    fmt::print("  {:<28} ratio {:.3f}, better in {} of 200\n", name, less / plain, better);
    none_worse = none_worse && less <= plain;
  }
  return none_worse;
}

}  // namespace

int main(int count, char** words) {
  const bool whole = time_volume(count > 1 ? std::strtoul(words[1], nullptr, 10) : 1'000'000);
  return compare_shrunk() && whole ? 0 : 1;
}
