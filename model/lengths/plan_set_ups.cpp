#include "model/lengths/plan_set_ups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace ecs::model {
namespace {

constexpr std::size_t kMostSetUpSteps = 200;
constexpr double kAsKnown = 1e9;     ///< precision of what no length shows [1/um²]
constexpr double kFreePart = 1e-10;  ///< of the greatest information of scaled unknowns: not determined

/// The block of the last `count` unknowns eliminated.
Eigen::MatrixXd without_last(const Eigen::MatrixXd& information, Eigen::Index count) {
  const auto m = information.rows() - count;
  const Eigen::MatrixXd cross = information.bottomLeftCorner(count, m);
  return information.topLeftCorner(m, m) -
         cross.transpose() * information.bottomRightCorner(count, count).ldlt().solve(cross);
}

class SetUpChooser {
 public:
  SetUpChooser(const PlanTask& task, const std::vector<PlanStand>& stands, const std::vector<StandInformation>& known,
               const Eigen::MatrixXd& free)
      : task_(task),
        stands_(stands),
        known_(known),
        runs_(stands.size(), 0),
        information_(first_information(task, free)) {}

  PlanChoice run() {
    mean_square_ = mean_square_of(task_, information_);
    std::vector<double> scores(stands_.size(), std::numeric_limits<double>::max());
    for (std::size_t step = 0; step < kMostSetUpSteps && mean_square_ > task_.mean_square_um2; ++step) {
      std::set<std::size_t> fresh;
      std::size_t best = 0;
      for (;;) {
        best = static_cast<std::size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
        if (!fresh.insert(best).second) break;
        scores[best] = score(best);
      }
      if (scores[best] <= 0.0) break;
      information_ += another_run(best);
      ++runs_[best];
      mean_square_ = mean_square_of(task_, information_);
      for (std::size_t s = 0; s < stands_.size(); ++s)  // another tool there costs less now, another run no set-up
        if (stands_[s].set_up == stands_[best].set_up) scores[s] = std::numeric_limits<double>::max();
    }
    prune();
    return choice();
  }

 private:
  [[nodiscard]] Eigen::MatrixXd another_run(std::size_t s) const {
    const Eigen::MatrixXd now = known_[s].of_runs(runs_[s] + 1);
    return runs_[s] == 0 ? now : Eigen::MatrixXd(now - known_[s].of_runs(runs_[s]));
  }

  [[nodiscard]] double minutes() const {
    std::vector<PlanStand> open;
    double sum = 0.0;
    for (std::size_t s = 0; s < stands_.size(); ++s) {
      if (runs_[s] > 0) open.push_back(stands_[s]);
      sum += runs_[s] * known_[s].minutes();
    }
    return sum + set_up_minutes(task_, open);
  }

  [[nodiscard]] double score(std::size_t s) {
    if (runs_[s] >= kMostPathRuns) return 0.0;
    const double before = minutes();
    ++runs_[s];
    const double cost = minutes() - before;
    --runs_[s];
    return (mean_square_ - mean_square_of(task_, information_ + another_run(s))) / cost;
  }

  void prune() {
    if (mean_square_ > task_.mean_square_um2) return;
    for (std::size_t s = 0; s < stands_.size(); ++s)
      while (runs_[s] > 0) {
        --runs_[s];
        const Eigen::MatrixXd less = information_ - another_run(s);
        const double left = mean_square_of(task_, less);
        if (left > task_.mean_square_um2) {
          ++runs_[s];
          break;
        }
        information_ = less;
        mean_square_ = left;
      }
  }

  [[nodiscard]] PlanChoice choice() const {
    PlanChoice out;
    out.stands = stands_;
    std::vector<PlanStand> open;
    for (std::size_t s = 0; s < stands_.size(); ++s) {
      out.used.emplace_back(stands_[s].paths->size(), runs_[s]);
      if (runs_[s] > 0) open.push_back(stands_[s]);
    }
    out.minutes = minutes();
    out.set_up_minutes = set_up_minutes(task_, open);
    out.mean_square_um2 = mean_square_;
    out.reached = mean_square_ <= task_.mean_square_um2;
    const auto m = task_.curves.size();
    const Eigen::LLT<Eigen::MatrixXd> factor(information_);
    out.covariance = factor.solve(Eigen::MatrixXd::Identity(m + 1, m + 1)).topLeftCorner(m, m);
    return out;
  }

  const PlanTask& task_;
  const std::vector<PlanStand>& stands_;
  const std::vector<StandInformation>& known_;
  std::vector<int> runs_;
  Eigen::MatrixXd information_;
  double mean_square_ = 0.0;
};

}  // namespace

StandInformation::StandInformation(const PlanTask& task, const PlanStand& stand) {
  const auto m = task.curves.size();
  const bool known_bar = task.settings.instrument == LengthInstrument::ball_bar && task.settings.bar_um > 0.0;
  const Eigen::VectorXd precision = stand_precision(task);
  // machine, bar, station, scale, zero
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(m + 6, m + 6);
  for (const PlanPath& path : *stand.paths) {
    const Eigen::MatrixXd compact = rows_of_path(task, stand, path);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(compact.rows(), m + 6);
    rows.leftCols(m) = compact.leftCols(m);
    rows.middleCols(m + 1, 3) = compact.middleCols(m, 3);
    rows.col(m + 4) = compact.col(m + 4);
    rows.col(known_bar ? m : m + 5) = compact.col(m + 3);
    all.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    minutes_ += path.minutes;
  }
  all.triangularView<Eigen::StrictlyUpper>() = all.transpose();
  all(m + 5, m + 5) += precision(3);
  a_run_ = without_last(all, 1);
  scale_precision_ = precision(4);
}

Eigen::MatrixXd StandInformation::of_runs(int runs) const {
  Eigen::MatrixXd all = runs * a_run_;
  constexpr double kNoStation = 1e-12;  // an interferometer has none
  all.diagonal().tail(4).head(3).array() += kNoStation;
  all(all.rows() - 1, all.rows() - 1) += scale_precision_;
  return without_last(all, 4);
}

Eigen::MatrixXd first_information(const PlanTask& task, const Eigen::MatrixXd& free) {
  const auto m = task.curves.size();
  Eigen::MatrixXd out = machine_precision() * Eigen::MatrixXd::Identity(m + 1, m + 1);
  const double bar_um = task.settings.bar_um > 0.0 ? task.settings.bar_um : 1.0;
  out(m, m) = 1.0 / (bar_um * bar_um);
  if (free.cols() > 0) out += kAsKnown * free * free.transpose();
  return out;
}

Eigen::MatrixXd directions_left_free(const Eigen::MatrixXd& information, const Eigen::MatrixXd& first) {
  const Eigen::MatrixXd all = information + first;
  const Eigen::VectorXd size = all.diagonal().cwiseSqrt();
  const Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * information * size.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  Eigen::Index count = 0;
  while (count < scaled.rows() && eigen.eigenvalues()(count) < kFreePart * eigen.eigenvalues().maxCoeff()) ++count;
  Eigen::MatrixXd out = size.cwiseInverse().asDiagonal() * eigen.eigenvectors().leftCols(count);
  if (count > 0)
    out = Eigen::HouseholderQR<Eigen::MatrixXd>(out).householderQ() * Eigen::MatrixXd::Identity(out.rows(), count);
  return out;
}

double mean_square_of(const PlanTask& task, const Eigen::MatrixXd& information) {
  const auto m = task.curves.size();
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::max();
  return task.weight.cwiseProduct(factor.solve(Eigen::MatrixXd::Identity(m + 1, m + 1)).topLeftCorner(m, m)).sum();
}

PlanChoice chosen_set_ups(const PlanTask& task, const std::vector<PlanStand>& stands,
                          const std::vector<StandInformation>& known, const Eigen::MatrixXd& free) {
  return SetUpChooser(task, stands, known, free).run();
}

}  // namespace ecs::model
