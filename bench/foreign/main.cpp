// foreign_cases: cases made from the documents alone, and how well `ecs model diagnose` answers them.
//   foreign_cases write OUT --row ROW --seeds A..B     ROW: a row's name or `all`
//   foreign_cases score OUT --ecs PATH [--jobs N]
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/text.hpp"
#include "bench/foreign/case_files.hpp"
#include "bench/foreign/score.hpp"

namespace {

constexpr int kUsage = 2;

int usage() {
  fmt::print(stderr,
             "Usage: foreign_cases write OUT --row ROW|all --seeds A..B\n"
             "       foreign_cases score OUT --ecs PATH [--jobs N]\n");
  return kUsage;
}

std::string option(const std::vector<std::string>& words, const std::string& name) {
  const auto at = std::find(words.begin(), words.end(), name);
  return at == words.end() || at + 1 == words.end() ? std::string() : *(at + 1);
}

int failed(const ecs::Problem& problem) {
  fmt::print(stderr, "{}\n", ecs::to_text(problem));
  return 1;
}

int write(const std::vector<std::string>& words) {
  const std::string row = option(words, "--row");
  const std::string seeds = option(words, "--seeds");
  const std::size_t dots = seeds.find("..");
  if (dots == std::string::npos) return usage();
  const auto first = ecs::integer_in(seeds.substr(0, dots));
  const auto last = ecs::integer_in(seeds.substr(dots + 2));
  std::vector<std::string> rows = foreign::row_names();
  if (row != "all") rows = {row};
  if (!first || !last || *first < 1) return usage();
  for (const std::string& name : rows) {
    const auto& known = foreign::row_names();
    if (std::find(known.begin(), known.end(), name) == known.end()) return usage();
    for (long long seed = *first; seed <= *last; ++seed) {
      const foreign::Case drawn = foreign::draw_case(name, static_cast<std::uint64_t>(seed));
      if (drawn.row.empty()) {
        fmt::print(stderr, "{} {}: no case found\n", name, seed);
        continue;
      }
      const std::filesystem::path folder = std::filesystem::path(words[1]) / fmt::format("{}-{:07}", name, seed);
      if (const auto written = foreign::write_case(folder, drawn); !written) return failed(written.error());
    }
  }
  return 0;
}

int score(const std::vector<std::string>& words) {
  const std::string program = option(words, "--ecs");
  const std::string jobs = option(words, "--jobs");
  if (program.empty()) return usage();
  const auto threads = jobs.empty() ? 1 : ecs::integer_in(jobs).value_or(1);
  const auto table = foreign::score_folder(words[1], program, static_cast<int>(threads));
  if (!table) return failed(table.error());
  fmt::print("{}", *table);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 2) return usage();
  if (words[0] == "write") return write(words);
  if (words[0] == "score") return score(words);
  return usage();
}
