// Scores the diagnosis on data sets with a known hidden cause and prints the table of rates with their intervals.
#include <chrono>
#include <cstdio>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/file.hpp"
#include "diagnose_cases.hpp"
#include "diagnose_rival.hpp"
#include "model/diagnose.hpp"
#include "model/statistics.hpp"

namespace {

using namespace ecs;

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

/// The rival names no group: right is the very effect first, none for a blank, both for a pair.
bool rival_right(const bench::Case& one, const std::vector<std::string>& names) {
  switch (one.kind) {
    case bench::CaseKind::blank:
      return names.empty();
    case bench::CaseKind::out_of_library:
      return names.empty();
    case bench::CaseKind::pair:
      return std::all_of(one.truth.effects.begin(), one.truth.effects.end(), [&](const std::string& truth) {
        return std::find(names.begin(), names.end(), truth) != names.end();
      });
    default:
      return !names.empty() && names.front() == one.truth.effects.front();
  }
}

/// Rates of one kind of case.
struct Tally {
  unsigned cases = 0, hits = 0, rival_hits = 0, first_right = 0;
  unsigned parameters = 0, within = 0, added = 0, added_well = 0;
  double seconds = 0.0, slowest = 0.0;
  std::map<std::string, std::pair<unsigned, unsigned>> by_effect;
};

void score(const bench::Case& one, std::uint64_t seed, bool verbose, bool rival, Tally& tally) {
  const auto data = model::observations_of(one.data, one.model, one.machine);
  const auto begin = std::chrono::steady_clock::now();
  const auto d = model::diagnose(one.model, data);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  tally.seconds += seconds;
  tally.slowest = std::max(tally.slowest, seconds);
  ++tally.cases;
  if (!d) {
    fmt::print("  seed {} FAILED {}\n", seed, to_text(d.error()));
    return;
  }
  const bool good = right(one, *d);
  tally.hits += good ? 1U : 0U;
  if (rival) tally.rival_hits += rival_right(one, bench::stepwise_bic(one.model, data)) ? 1U : 0U;
  if (!one.truth.effects.empty() && !d->candidates.empty() && named(d->candidates.front(), one.truth.effects.front()))
    ++tally.first_right;
  auto& effect = tally.by_effect[one.name.substr(0, one.name.find(':'))];
  effect.first += good ? 1U : 0U;
  ++effect.second;
  if (one.kind == bench::CaseKind::single && good &&
      to_text(d->candidates.front().effect) == one.truth.effects.front()) {
    const model::Candidate& first = d->candidates.front();
    if (one.truth.parameter && first.indistinguishable_from.empty())
      for (const auto& parameter : first.parameters)
        if (parameter.name == one.truth.parameter_name && parameter.sigma) {
          ++tally.parameters;
          tally.within += std::abs(parameter.value - *one.truth.parameter) < 3.0 * *parameter.sigma ? 1U : 0U;
        }
    ++tally.added;
    tally.added_well += d->rms_after_um <= 1.05 * one.truth.true_rms_um ? 1U : 0U;
  }
  if (verbose || !good) tell(one, *d, seed);
  std::fflush(stdout);
}

std::string rate(unsigned hits, unsigned cases) {
  const auto interval = model::clopper_pearson(hits, cases);
  return fmt::format("{}/{} = {:.1f} % ({:.1f} ... {:.1f})", hits, cases, cases == 0 ? 0.0 : 100.0 * hits / cases,
                     100.0 * interval.low, 100.0 * interval.high);
}

void print(const std::string& name, const Tally& tally, bool rival) {
  fmt::print("{}: {}", name, rate(tally.hits, tally.cases));
  if (rival) fmt::print("; stepwise BIC -6: {}", rate(tally.rival_hits, tally.cases));
  fmt::print("\n");
  if (tally.first_right > 0)
    fmt::print("    right effect (or group) first whatever the verdict: {}\n", rate(tally.first_right, tally.cases));
  if (tally.added > 0)
    fmt::print("    after adding, rms at most 1.05 of the true model's: {}\n", rate(tally.added_well, tally.added));
  if (tally.parameters > 0)
    fmt::print("    scalar parameters within 3 sigma: {}\n", rate(tally.within, tally.parameters));
  for (const auto& [effect, one] : tally.by_effect)
    if (one.first < one.second) fmt::print("    {} {}/{}\n", effect, one.first, one.second);
  fmt::print("    seconds: mean {:.2f}, slowest {:.2f}\n", tally.seconds / std::max(1U, tally.cases), tally.slowest);
  std::fflush(stdout);
}

std::vector<std::string> words(const nlohmann::json& object, const char* key) {
  return object.value(key, std::vector<std::string>{});
}

/// A case from a folder: machine.toml, model.toml, data.csv, truth.json {"kind", "effects", "group", "variables"}.
Result<bench::Case> read_case(const std::filesystem::path& folder) {
  auto machine = params::read_machine(folder / "machine.toml");
  if (!machine) return tl::unexpected(machine.error());
  auto model = model::read_model(folder / "model.toml");
  if (!model) return tl::unexpected(model.error());
  auto data = laser::read_measurement_set(folder / "data.csv");
  if (!data) return tl::unexpected(data.error());
  const auto text = read_file(folder / "truth.json");
  if (!text) return tl::unexpected(text.error());
  const auto truth = nlohmann::json::parse(*text, nullptr, false);
  if (!truth.is_object())
    return problem(ProblemKind::bad_input, fmt::format("{}: expected a JSON object", (folder / "truth.json").string()));
  bench::Case one;
  one.machine = std::move(machine->machine);
  one.model = std::move(*model);
  one.data = std::move(*data);
  one.truth.effects = words(truth, "effects");
  one.truth.group = words(truth, "group");
  one.truth.variables = words(truth, "variables");
  one.name =
      one.truth.effects.empty() ? truth.value("kind", "blank") : fmt::format("{}", fmt::join(one.truth.effects, " + "));
  const std::string kind = truth.value("kind", "");
  if (kind == "out_of_library")
    one.kind = bench::CaseKind::out_of_library;
  else if (kind == "confounded" || !one.truth.group.empty())
    one.kind = bench::CaseKind::confounded;
  else
    one.kind = one.truth.effects.empty()       ? bench::CaseKind::blank
               : one.truth.effects.size() == 1 ? bench::CaseKind::single
                                               : bench::CaseKind::pair;
  return one;
}

int score_folders(const std::string& root, bool verbose, bool rival) {
  std::map<bench::CaseKind, Tally> tallies;
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(root))
    if (std::filesystem::exists(entry.path() / "truth.json")) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const auto one = read_case(folders[i]);
    if (!one) {
      fmt::print("  {}: {}\n", folders[i].string(), to_text(one.error()));
      continue;
    }
    score(*one, i, verbose, rival, tallies[one->kind]);
  }
  for (const auto& [kind, tally] : tallies) print(fmt::format("kind {}", static_cast<int>(kind)), tally, rival);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The proving table of the diagnosis"};
  std::uint64_t first = 1;
  unsigned count = 24;
  std::vector<double> ratios{3.0, 1.5};
  std::string kinds = "single,pair,blank,out,confounded";
  std::string folder;
  bool verbose = false, rival = false;
  app.add_option("--first", first, "first seed");
  app.add_option("--count", count, "cases of each kind and ratio");
  app.add_option("--snr", ratios, "signal to noise ratios");
  app.add_option("--kinds", kinds, "of single,pair,blank,out,confounded");
  app.add_option("--cases", folder,
                 "score the cases of this folder instead: machine.toml, model.toml, data.csv, truth.json each");
  app.add_flag("--verbose", verbose, "tell every case");
  app.add_flag("--rival", rival, "beside it the stepwise search by BIC");
  CLI11_PARSE(app, argc, argv);
  if (!folder.empty()) return score_folders(folder, verbose, rival);
  const std::vector<std::pair<std::string, bench::CaseKind>> all{{"single", bench::CaseKind::single},
                                                                 {"pair", bench::CaseKind::pair},
                                                                 {"blank", bench::CaseKind::blank},
                                                                 {"out", bench::CaseKind::out_of_library},
                                                                 {"confounded", bench::CaseKind::confounded}};
  for (const auto& [name, kind] : all) {
    if (kinds.find(name) == std::string::npos) continue;
    for (const double snr : ratios) {
      if (kind == bench::CaseKind::blank && snr != ratios.front()) continue;
      Tally tally;
      for (std::uint64_t seed = first; seed < first + count; ++seed)
        score(bench::make_case(kind, snr, seed), seed, verbose, rival, tally);
      print(fmt::format("{} SNR {}", name, snr), tally, rival);
    }
  }
  return 0;
}
