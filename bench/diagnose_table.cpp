// Scores the diagnosis on data sets with a known hidden cause and prints the table of rates with their intervals.
#include <cstdio>
#include <ctime>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "diagnose_case.hpp"
#include "diagnose_cases.hpp"
#include "diagnose_rival.hpp"
#include "diagnose_tally.hpp"

namespace {

using namespace ecs;

struct Options {
  bool verbose = false;
  bool rival = false;
};

/// All that is printed: rates by kind and ratio, times, memory.
struct Table {
  std::map<std::pair<bench::CaseKind, std::string>, bench::Tally> tallies;
  bench::Times times;
};

std::string ratio_class(const bench::Case& one) {
  if (one.truth.snr <= 0.0 || one.kind == bench::CaseKind::blank) return "";
  return one.truth.snr >= 2.9 ? "SNR 3 and more" : one.truth.snr >= 1.4 ? "SNR 1.5 to 3" : "SNR below 1.5";
}

double seconds_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void score(const std::string& where, const bench::Case& one, const Options& options, Table& table) {
  const auto data = model::observations_of(one.data, one.model, one.machine);
  const double begin = seconds_now();
  auto diagnosis = model::diagnose(one.model, data);
  bench::Answer answer;
  answer.seconds = seconds_now() - begin;
  table.times.each.emplace_back(answer.seconds, data.size());
  if (!diagnosis) {
    fmt::print("  {} FAILED {}\n", where, to_text(diagnosis.error()));
    ++table.tallies[{one.kind, ratio_class(one)}].cases;
    return;
  }
  answer.diagnosis = std::move(*diagnosis);
  answer.has_rival = options.rival;
  if (options.rival) answer.rival = bench::stepwise_bic(one.model, data);
  const bool good = bench::count(one, answer, table.tallies[{one.kind, ratio_class(one)}]);
  if (options.verbose || !good) fmt::print("{}\n", bench::told(where, one, answer));
  std::fflush(stdout);
}

void print(const Table& table, const Options& options) {
  for (const auto& [key, tally] : table.tallies)
    bench::print(fmt::format("{} {}", bench::name_of(key.first), key.second), tally, options.rival);
  bench::print(table.times);
}

int score_folders(const std::string& root, const Options& options, unsigned most) {
  Table table;
  std::map<std::filesystem::path, unsigned> taken;
  for (const auto& folder : bench::case_folders(root)) {
    if (most > 0 && ++taken[folder.parent_path()] > most) continue;
    const auto one = bench::read_case(folder);
    if (!one)
      fmt::print("  {}: {}\n", folder.string(), to_text(one.error()));
    else
      score(std::filesystem::relative(folder, root).string(), *one, options, table);
  }
  print(table, options);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The proving table of the diagnosis"};
  Options options;
  std::uint64_t first = 1;
  unsigned count = 24, most = 0;
  std::vector<double> ratios{3.0, 1.5};
  std::string kinds = "single,pair,blank,out,confounded";
  std::string folder;
  app.add_option("--first", first, "first seed");
  app.add_option("--count", count, "cases of each kind and ratio");
  app.add_option("--snr", ratios, "signal to noise ratios");
  app.add_option("--kinds", kinds, "of single,pair,blank,out,confounded");
  app.add_option(
      "--cases", folder,
      "score the cases below this folder: machine.toml, model.toml, data.csv and truth.sealed or truth.json");
  app.add_option("--most", most, "of each folder of cases at most so many; 0: all");
  app.add_flag("--verbose", options.verbose, "tell every case");
  app.add_flag("--rival", options.rival, "beside it the stepwise search by BIC");
  CLI11_PARSE(app, argc, argv);
  if (!folder.empty()) return score_folders(folder, options, most);
  const std::vector<std::pair<std::string, bench::CaseKind>> all{{"single", bench::CaseKind::single},
                                                                 {"pair", bench::CaseKind::pair},
                                                                 {"blank", bench::CaseKind::blank},
                                                                 {"out", bench::CaseKind::out_of_library},
                                                                 {"confounded", bench::CaseKind::confounded}};
  Table table;
  for (const auto& [name, kind] : all) {
    if (kinds.find(name) == std::string::npos) continue;
    for (const double snr : ratios) {
      if (kind == bench::CaseKind::blank && snr != ratios.front()) continue;
      for (std::uint64_t seed = first; seed < first + count; ++seed)
        score(fmt::format("seed {}", seed), bench::make_case(kind, snr, seed), options, table);
    }
  }
  print(table, options);
  return 0;
}
