#include "model/diagnosis/bad_run_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "model/diagnosis/bad_run.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A run whose mean residual is twice as far from the median of the runs as that of any other; three runs or more.
std::optional<OddPass> farthest_run(const Observations& data, const VectorXd& residual) {
  constexpr double kAlone = 2.0;
  std::map<int, std::pair<double, double>> sums;  // by run: residual, readings
  for (std::size_t k = 0; k < data.size(); ++k) {
    sums[data.run[k]].first += residual(static_cast<Index>(k));
    sums[data.run[k]].second += 1.0;
  }
  if (sums.size() < 3) return std::nullopt;
  std::vector<double> means;
  for (const auto& [run, sum] : sums) means.push_back(sum.first / sum.second);
  std::nth_element(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2), means.end());
  const double median = means[means.size() / 2];
  OddPass farthest;
  double next = 0.0;
  for (const auto& [run, sum] : sums) {
    const double off = sum.first / sum.second - median;
    if (std::abs(off) > std::abs(farthest.off_um)) {
      next = std::abs(farthest.off_um);
      farthest = {run, off};
    } else {
      next = std::max(next, std::abs(off));
    }
  }
  if (std::abs(farthest.off_um) <= kAlone * next) return std::nullopt;
  return farthest;
}

}  // namespace

std::string bad_run_text(const Found& found, const Diagnosis& diagnosis, const Observations& data,
                         const VectorXd& residual) {
  const auto first = [](const std::string& what) { return what + ". Look at that run first."; };
  if (found.noisy) {
    std::string words = words_for(*found.noisy, diagnosis.noise.unit);
    words.front() = 'R';
    return first(words);
  }
  const auto of_step = [&](const StepOfRuns& step) {
    return fmt::format(
        "All readings {} by {:.2g} {} between runs {} and {}: another zero, or something slipped. Look at what "
        "happened "
        "between these runs first.",
        step.height_um > 0.0 ? "rise" : "fall", std::abs(step.height_um), diagnosis.noise.unit, step.before,
        step.after);
  };
  if (found.step) return of_step(*found.step);
  if (found.odd_pass)
    return first(fmt::format("Run {} differs from the other runs by {:.3g} in one approach", found.odd_pass->run,
                             found.odd_pass->off_um));
  if (found.bad_run)
    return first(fmt::format("Run {} differs from the other runs: its offset explains as much as any effect does",
                             found.bad_run->run));
  if (diagnosis.verdict == Verdict::unexplained_structure && !diagnosis.where.empty() &&
      diagnosis.where.front().variable == "run") {
    if (const auto step = step_of_runs(data, residual, std::vector<bool>(data.size()))) return of_step(*step);
    if (const auto run = farthest_run(data, residual))
      return first(fmt::format("Run {} differs from the other runs by {:.2g} on average", run->run, run->off_um));
  }
  if (found.run_note.empty()) return "";
  std::string note = found.run_note;
  note.front() = 'A';  // "an offset of run 3 …"
  return note + ".";
}

void put_run_first(std::vector<Dependence>& where, const Observations& data, const Found& found,
                   const VectorXd& residual, double chance) {
  const auto is_run = [](const Dependence& one) { return one.variable == "run"; };
  if (std::none_of(where.begin(), where.end(), is_run)) {
    const int run = found.noisy      ? found.noisy->run
                    : found.odd_pass ? found.odd_pass->run
                    : found.step     ? found.step->after
                                     : found.bad_run->run;
    double of_run = 0.0;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.run[k] == run) of_run += residual(static_cast<Index>(k)) * residual(static_cast<Index>(k));
    where.push_back({"run", of_run / std::max(residual.squaredNorm(), kLeastDivisor), chance, {}, {}});
  }
  std::stable_partition(where.begin(), where.end(), is_run);
}

}  // namespace ecs::model
