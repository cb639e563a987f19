// Scores the diagnosis on data sets with a known hidden cause and prints the table of rates with their intervals.
#include <chrono>
#include <cstdio>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "diagnose_cases.hpp"
#include "model/diagnose.hpp"
#include "model/statistics.hpp"

namespace {

using namespace ecs;

struct Score {
  bool right = false;
  double seconds = 0.0;
};

bool named(const model::Candidate& candidate, const std::string& truth) {
  if (to_text(candidate.effect) == truth) return true;
  const auto& list = candidate.indistinguishable_from;
  return std::find(list.begin(), list.end(), truth) != list.end();
}

bool right(const bench::Case& one, const model::Diagnosis& d) {
  switch (one.kind) {
    case bench::CaseKind::blank:
      return d.verdict == model::Verdict::adequate;
    case bench::CaseKind::out_of_library:
      return d.verdict == model::Verdict::unexplained_structure;
    case bench::CaseKind::single:
      return d.verdict == model::Verdict::missing_effect && !d.candidates.empty() &&
             named(d.candidates.front(), one.truth.effects.front());
    case bench::CaseKind::pair: {
      if (d.verdict != model::Verdict::missing_effect) return false;
      for (const std::string& truth : one.truth.effects) {
        bool found = false;
        for (const model::Candidate& c : d.candidates) found = found || (c.named && named(c, truth));
        if (!found) return false;
      }
      return true;
    }
    case bench::CaseKind::confounded: {
      if (d.candidates.empty()) return false;
      std::vector<std::string> group = d.candidates.front().indistinguishable_from;
      group.push_back(to_text(d.candidates.front().effect));
      std::sort(group.begin(), group.end());
      std::vector<std::string> truth = one.truth.group;
      std::sort(truth.begin(), truth.end());
      return std::includes(group.begin(), group.end(), truth.begin(), truth.end());
    }
  }
  return false;
}

void tell(const bench::Case& one, const model::Diagnosis& d, std::uint64_t seed) {
  fmt::print("  seed {} n {} truth {} ({}) -> {}", seed, one.data.readings.size(), one.name, one.truth.noise,
             name_of(d.verdict));
  for (const model::Candidate& c : d.candidates)
    if (c.named || &c == &d.candidates.front())
      fmt::print(" [{}{} {:.2f}->{:.3f} {}]", to_text(c.effect),
                 c.effect.approach == model::ApproachMode::both ? "" : "/one way", d.rms_um, c.rms_after_um,
                 fmt::join(c.indistinguishable_from, " "));
  if (!d.where.empty()) fmt::print(" where {} {:.2f}", d.where.front().variable, d.where.front().strength);
  fmt::print(" rms {:.3f} after {:.3f} noise {:.3f} (true {:.3f})\n", d.rms_um, d.rms_after_um, d.noise.noise_um,
             one.truth.sigma_um);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The proving table of the diagnosis"};
  std::uint64_t first = 1;
  unsigned count = 24;
  std::vector<double> ratios{3.0, 1.5};
  std::string kinds = "single,pair,blank,out,confounded";
  bool verbose = false;
  app.add_option("--first", first, "first seed");
  app.add_option("--count", count, "cases of each kind and ratio");
  app.add_option("--snr", ratios, "signal to noise ratios");
  app.add_option("--kinds", kinds, "of single,pair,blank,out,confounded");
  app.add_flag("--verbose", verbose, "tell every case");
  CLI11_PARSE(app, argc, argv);
  const std::vector<std::pair<std::string, bench::CaseKind>> all{{"single", bench::CaseKind::single},
                                                                 {"pair", bench::CaseKind::pair},
                                                                 {"blank", bench::CaseKind::blank},
                                                                 {"out", bench::CaseKind::out_of_library},
                                                                 {"confounded", bench::CaseKind::confounded}};
  double slowest = 0.0, total = 0.0;
  for (const auto& [name, kind] : all) {
    if (kinds.find(name) == std::string::npos) continue;
    for (const double snr : ratios) {
      if (kind == bench::CaseKind::blank && snr != ratios.front()) continue;
      unsigned hits = 0;
      std::map<std::string, std::pair<unsigned, unsigned>> by_effect;
      for (std::uint64_t seed = first; seed < first + count; ++seed) {
        const bench::Case one = bench::make_case(kind, snr, seed);
        const auto data = model::observations_of(one.data, one.model, one.machine);
        const auto begin = std::chrono::steady_clock::now();
        const auto d = model::diagnose(one.model, data);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        slowest = std::max(slowest, seconds);
        total += seconds;
        const bool good = d && right(one, *d);
        hits += good ? 1 : 0;
        auto& tally = by_effect[one.name.substr(0, one.name.find(':'))];
        tally.first += good ? 1 : 0;
        ++tally.second;
        if (d && (verbose || !good)) tell(one, *d, seed);
        if (!d) fmt::print("  seed {} FAILED {}\n", seed, to_text(d.error()));
        std::fflush(stdout);
      }
      const auto interval = model::clopper_pearson(hits, count);
      fmt::print("{} SNR {}: {}/{} = {:.1f} % ({:.1f} … {:.1f})\n", name, snr, hits, count, 100.0 * hits / count,
                 100.0 * interval.low, 100.0 * interval.high);
      if (verbose || kind == bench::CaseKind::single)
        for (const auto& [effect, tally] : by_effect)
          if (tally.first < tally.second) fmt::print("    {} {}/{}\n", effect, tally.first, tally.second);
    }
  }
  fmt::print("seconds per case: mean over all {:.2f}, slowest {:.2f}\n", total, slowest);
  return 0;
}
