// Scores the diagnosis on cases with a known hidden cause (bench/hidden_table makes them) and prints the table of rates
// with their intervals.
#include <cstdio>
#include <ctime>
#include <exception>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "diagnose_case.hpp"
#include "diagnose_rival.hpp"
#include "diagnose_tally.hpp"

namespace {

using namespace ecs;

struct Options {
  bool verbose = false;
  bool rival = false;
  std::size_t noise_replicates = model::DiagnoseOptions{}.noise_replicates;
};

/// All that is printed: rates by kind, ratio and law of the noise, and again by what the base leaves free; times,
/// memory.
struct Table {
  using Row = std::pair<bench::CaseKind, std::string>;
  std::map<Row, bench::Tally> tallies, by_free;
  bench::Times times;
};

std::string ratio_class(const bench::Case& one) {
  if (!one.truth.noise_law.empty()) return one.truth.noise_law + " noise";
  if (one.truth.snr <= 0.0 || one.kind == bench::CaseKind::blank) return "";
  return one.truth.snr >= 2.9 ? "SNR 3 and more" : one.truth.snr >= 1.4 ? "SNR 1.5 to 3" : "SNR below 1.5";
}

double seconds_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void score(const std::string& where, const bench::Case& one, const Options& options, Table& table) {
  const auto data = model::observations_of(one.data, one.model, one.machine);
  const double begin = seconds_now();
  model::DiagnoseOptions diagnose;
  diagnose.noise_replicates = options.noise_replicates;
  auto diagnosis = model::diagnose(one.model, data, diagnose);
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
  for (const std::string& effect : bench::free_in_base(one))
    bench::count(one, answer, table.by_free[{one.kind, "base with a free " + effect}]);
  if (options.verbose || !good) fmt::print("{}\n", bench::report_line(where, one, answer));
  std::fflush(stdout);
}

void print(const Table& table, const Options& options) {
  for (const auto& [key, tally] : table.tallies)
    bench::print(fmt::format("{} {}", bench::name_of(key.first), key.second), tally, options.rival);
  for (const auto& [key, tally] : table.by_free)
    bench::print(fmt::format("{} {}", bench::name_of(key.first), key.second), tally, false);
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

int run(int argc, char** argv) {
  CLI::App app{"The proving table of the diagnosis"};
  Options options;
  unsigned most = 0;
  std::string folder;
  app.add_option("--cases", folder,
                 "score the cases below this folder: machine.toml, model.toml, data.csv and truth.sealed or truth.json")
      ->required();
  app.add_option("--most", most, "of each folder of cases at most so many; 0: all");
  app.add_option("--noise-replicates", options.noise_replicates,
                 "of each diagnosis; few make quick, rough thresholds, e-values need none");
  app.add_flag("--verbose", options.verbose, "print every case");
  app.add_flag("--rival", options.rival, "beside it the stepwise search by BIC");
  CLI11_PARSE(app, argc, argv);
  return score_folders(folder, options, most);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& failed) {
    std::fputs(failed.what(), stderr);
    return 1;
  }
}
