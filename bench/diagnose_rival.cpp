// Forward selection by the criterion of Schwarz (1978) on ordinary least squares (Efroymson 1960).
#include "diagnose_rival.hpp"

#include <cmath>

#include "model/fit/core.hpp"
#include "model/fit/search.hpp"
#include "model/regression/candidates.hpp"

namespace ecs::bench {

std::vector<std::string> stepwise_bic(const model::Model& model, const model::Observations& data) {
  const model::Regressors regressors(data);
  auto assembly = model::Assembly::of(model, regressors);
  std::vector<std::string> names;
  if (!assembly) return names;
  static_cast<void>(fitted(*assembly, regressors, {true, true}));
  const model::Whitener whitener(data, model::plain_noise(data, 1.0), std::vector<bool>(data.size(), false));
  const Eigen::VectorXd y =
      Eigen::Map<const Eigen::VectorXd>(data.reading.data(), static_cast<Eigen::Index>(data.size()));
  const model::Search search(regressors, whitener, assembly->columns(), y - assembly->fixed(data.size()),
                             candidate_instances(data));
  const double n = static_cast<double>(data.size());
  std::vector<model::Choice> chosen;
  for (int step = 0; step < 6; ++step) {
    const model::Solution now = search.solution(chosen);
    const double chi2 = now.space.chi2();
    double least = 0.0;
    const model::Choice* best = nullptr;
    const auto list = search.expand(now.space, 8);
    for (const model::Choice& choice : list) {
      const double change = n * std::log(std::max(1e-12, 1.0 - choice.gain / chi2)) +
                            static_cast<double>(choice.parameters) * std::log(n);
      if (change < least) {
        least = change;
        best = &choice;
      }
    }
    if (best == nullptr || least > -6.0) break;
    chosen.push_back(*best);
    names.push_back(to_text(search.families()[best->family].effect));
  }
  return names;
}

}  // namespace ecs::bench
