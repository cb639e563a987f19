#include "modules/lengths/plan_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "base/linear/decompositions.hpp"
#include "modules/lengths/shared_noise.hpp"

namespace ecs::model {
namespace {

constexpr double kWidePrior = 1e3;  ///< of every unknown before anything is measured [um, um/m]
constexpr double kWideZero_um = 1e5;
constexpr std::size_t kMostPathSteps = 400;
constexpr int kMostExchanges = 8;
constexpr double kExchanged = 0.25;  ///< share of the minutes of paths that one exchange takes out
constexpr double kWorthwhile_minutes = 0.05;

class PathChooser {
 public:
  PathChooser(const PlanTask& task, const std::vector<PlanStand>& stands)
      : task_(task), stands_(stands), open_(stands.size(), false) {
    const auto m = task.curves.size();
    Eigen::Index end = m + static_cast<Eigen::Index>(4 * stands.size());
    std::map<std::size_t, Eigen::Index> scale;  // of a set-up, whatever the tool
    for (std::size_t s = 0; s < stands.size(); ++s) {
      if (scale.emplace(stands[s].set_up, end).second) ++end;
      own_.push_back({m + static_cast<Eigen::Index>(4 * s), scale.at(stands[s].set_up)});
    }
    prior_ = Eigen::VectorXd::Constant(end, machine_precision());
    const Eigen::VectorXd precision = stand_precision(task);
    for (const auto& [first, scale_column] : own_) {
      prior_.segment(first, 4) = precision.head(4);
      prior_(scale_column) = precision(4);
    }
    for (std::size_t s = 0; s < stands.size(); ++s)
      for (std::size_t p = 0; p < stands[s].paths->size(); ++p) {
        const PlanPath& path = (*stands[s].paths)[p];
        const Eigen::MatrixXd compact = rows_of_path(task, stands[s], path);
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(compact.rows(), end);
        rows.leftCols(m) = compact.leftCols(m);
        rows.middleCols(own_[s].first, 4) = compact.middleCols(m, 4);
        rows.col(own_[s].second) = compact.col(m + 4);
        items_.push_back({s, &path, std::move(rows)});
      }
  }

  PlanChoice run() {
    update();
    for (std::size_t s = 0; s < stands_.size(); ++s)
      if (!other_is_open(s)) open(s);
    grow();
    prune();
    exchange();
    return choice();
  }

 private:
  struct Item {
    std::size_t stand = 0;
    const PlanPath* path = nullptr;
    Eigen::MatrixXd rows;
    int used = 0;
    double loss = 0.0;  ///< of the mean square without it, at least
  };
  /// A path more at an open stand, or a stand to open with its first paths.
  struct Option {
    std::size_t stand = 0;
    std::optional<std::size_t> item;
    double score = std::numeric_limits<double>::max();
  };
  using Used = std::vector<int>;

  [[nodiscard]] bool other_is_open(std::size_t stand) const {
    for (std::size_t s = 0; s < stands_.size(); ++s)
      if (open_[s] && s != stand && stands_[s].set_up == stands_[stand].set_up) return true;
    return false;
  }

  [[nodiscard]] double set_up_cost(std::size_t stand) const {
    if (other_is_open(stand)) return task_.settings.tool_minutes;
    return set_up_minutes(task_, {stands_[stand]});
  }

  [[nodiscard]] double all_set_up_minutes() const {
    std::vector<PlanStand> opened;
    for (std::size_t s = 0; s < stands_.size(); ++s)
      if (open_[s]) opened.push_back(stands_[s]);
    return set_up_minutes(task_, opened);
  }

  [[nodiscard]] double all_minutes() const {
    double minutes = all_set_up_minutes();
    for (const Item& item : items_) minutes += item.used * item.path->minutes;
    return minutes;
  }

  [[nodiscard]] Eigen::MatrixXd information(std::optional<std::size_t> without_stand = std::nullopt) const {
    Eigen::MatrixXd out = prior_.asDiagonal();
    for (const Item& item : items_)
      if (item.used > 0 && item.stand != without_stand) add_gram(out, item.rows, item.used);
    return out;
  }

  void update() {
    covariance_ = Cholesky(information()).inverse();
    measure();
  }

  void measure() {
    const auto m = task_.curves.size();
    mean_square_ = task_.weight.cwiseProduct(covariance_.topLeftCorner(m, m)).sum();
  }

  /// 1 ± rows·covariance·rowsᵀ, which Woodbury's identity inverts. @param through  rows·covariance
  [[nodiscard]] static Cholesky inner_of(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& through, double sign) {
    Eigen::MatrixXd inner = sign * through * rows.transpose();
    inner.diagonal().array() += 1.0;
    return Cholesky(inner);
  }

  /// What these rows take off the mean square (`sign` 1), or what it grows by without them (−1); nothing where what is
  /// left determines less.
  [[nodiscard]] std::optional<double> change(const Eigen::MatrixXd& rows, double sign) const {
    const Eigen::MatrixXd through = rows * covariance_;
    const Cholesky factor = inner_of(rows, through, sign);
    if (!factor.is_positive()) return std::nullopt;
    const Eigen::MatrixXd half = factor.by_l(through.leftCols(task_.curves.size()));
    return (half * task_.weight).cwiseProduct(half).sum();
  }

  /// Rows more, or less, by the identity of Sherman, Morrison and Woodbury.
  void apply(const Eigen::MatrixXd& rows, double sign) {
    const Eigen::MatrixXd through = rows * covariance_;
    const Eigen::MatrixXd half = inner_of(rows, through, sign).by_l(through);
    covariance_.noalias() -= sign * half.transpose() * half;
    measure();
  }

  [[nodiscard]] Eigen::MatrixXd bundle_rows(std::size_t stand) const {
    std::vector<const Eigen::MatrixXd*> parts;
    Eigen::Index count = 0;
    for (const Item& item : items_)
      if (item.stand == stand && item.path->in_bundle) parts.push_back(&item.rows), count += item.rows.rows();
    Eigen::MatrixXd rows(count, prior_.size());
    count = 0;
    for (const Eigen::MatrixXd* part : parts) rows.middleRows(count, part->rows()) = *part, count += part->rows();
    return rows;
  }

  [[nodiscard]] double score_of(const Option& option) const {
    if (option.item) {
      const Item& item = items_[*option.item];
      return item.used >= kMostPathRuns ? 0.0 : change(item.rows, 1.0).value_or(0.0) / item.path->minutes;
    }
    double minutes = set_up_cost(option.stand);
    for (const Item& item : items_)
      if (item.stand == option.stand && item.path->in_bundle) minutes += item.path->minutes;
    return change(bundle_rows(option.stand), 1.0).value_or(0.0) / minutes;
  }

  void open(std::size_t stand) {
    open_[stand] = true;
    for (Item& item : items_)
      if (item.stand == stand && item.path->in_bundle) ++item.used;
    update();
  }

  void grow() {
    std::vector<Option> options;
    for (std::size_t s = 0; s < stands_.size(); ++s)
      if (!open_[s]) options.push_back({s, std::nullopt});
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (open_[items_[i].stand]) options.push_back({items_[i].stand, i});
    const auto less = [](const Option& a, const Option& b) { return a.score < b.score; };
    for (std::size_t step = 0; step < kMostPathSteps && mean_square_ > task_.mean_square_um2; ++step) {
      std::set<std::size_t> fresh;
      std::size_t best = 0;
      for (;;) {
        best = static_cast<std::size_t>(std::ranges::max_element(options, less) - options.begin());
        if (!fresh.insert(best).second) break;
        options[best].score = score_of(options[best]);
      }
      const Option chosen = options[best];
      if (chosen.score <= 0.0) break;
      if (chosen.item) {
        ++items_[*chosen.item].used;
        apply(items_[*chosen.item].rows, 1.0);
        continue;
      }
      open(chosen.stand);
      options.erase(options.begin() + static_cast<std::ptrdiff_t>(best));
      for (std::size_t i = 0; i < items_.size(); ++i)
        if (items_[i].stand == chosen.stand) options.push_back({chosen.stand, i});
    }
    update();
    forget_losses();
  }

  /// Stands that are not needed first, then the path that costs least for a minute, as long as what is left is enough.
  void prune() {
    if (mean_square_ > task_.mean_square_um2) return;
    for (std::size_t s = 0; s < stands_.size(); ++s) {
      if (!open_[s]) continue;
      if (mean_square_of(task_, information(s)) > task_.mean_square_um2) continue;
      for (Item& item : items_)
        if (item.stand == s) item.used = 0;
      open_[s] = false;
      update();
    }
    while (Item* item = least_worth(task_.mean_square_um2 - mean_square_)) {
      --item->used;
      apply(item->rows, -1.0);
    }
    for (std::size_t s = 0; s < stands_.size(); ++s)
      open_[s] = std::ranges::any_of(items_, [&](const Item& i) { return i.stand == s && i.used > 0; });
    update();
  }

  /// The path used that costs least for a minute, and at most so much. Losses only grow as less is known, so that of
  /// before is a bound (`loss`, set to nothing where more was learnt).
  [[nodiscard]] Item* least_worth(double at_most) {
    const auto score = [](const Item* item) { return item->loss / item->path->minutes; };
    std::vector<Item*> items;
    for (Item& item : items_)
      if (item.used > 0) items.push_back(&item);
    while (!items.empty()) {
      const auto best =
          std::ranges::min_element(items, [&](const Item* a, const Item* b) { return score(a) < score(b); });
      Item* item = *best;
      const double before = item->loss;
      item->loss = change(item->rows, -1.0).value_or(std::numeric_limits<double>::max());
      if (item->loss > at_most)
        items.erase(best);
      else if (item->loss <= before ||
               std::ranges::none_of(items, [&](const Item* other) { return score(other) < score(item); }))
        return item;
    }
    return nullptr;
  }

  void forget_losses() {
    for (Item& item : items_) item.loss = 0.0;
  }

  [[nodiscard]] Used used() const {
    Used out;
    for (const Item& item : items_) out.push_back(item.used);
    return out;
  }

  void restore(const Used& used) {
    open_.assign(stands_.size(), false);
    for (std::size_t i = 0; i < items_.size(); ++i) {
      items_[i].used = used[i];
      if (used[i] > 0) open_[items_[i].stand] = true;
    }
    update();
    forget_losses();
  }

  /// Paths worth least are taken out and chosen again, as long as that saves minutes.
  void exchange() {
    if (mean_square_ > task_.mean_square_um2) return;
    for (int round = 0; round < kMostExchanges; ++round) {
      const Used before = used();
      const double minutes = all_minutes(), of_paths = minutes - all_set_up_minutes();
      for (double taken = 0.0; taken < kExchanged * of_paths;) {
        Item* item = least_worth(std::numeric_limits<double>::max());
        if (item == nullptr) break;
        taken += item->path->minutes;
        --item->used;
        apply(item->rows, -1.0);
      }
      grow();
      prune();
      if (mean_square_ <= task_.mean_square_um2 && all_minutes() < minutes - kWorthwhile_minutes) continue;
      restore(before);
      break;
    }
  }

  [[nodiscard]] PlanChoice choice() const {
    PlanChoice out;
    out.stands = stands_;
    out.used.resize(stands_.size());
    for (const Item& item : items_) out.used[item.stand].push_back(item.used);
    out.minutes = all_minutes();
    out.set_up_minutes = all_set_up_minutes();
    out.mean_square_um2 = mean_square_;
    out.reached = mean_square_ <= task_.mean_square_um2;
    const auto m = task_.curves.size();
    out.covariance = covariance_.topLeftCorner(m, m);
    return out;
  }

  const PlanTask& task_;
  const std::vector<PlanStand>& stands_;
  std::vector<bool> open_;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> own_;  ///< by stand: first of station and zero; scale
  std::vector<Item> items_;
  Eigen::VectorXd prior_;
  Eigen::MatrixXd covariance_;
  double mean_square_ = 0.0;
};

}  // namespace

Eigen::MatrixXd rows_of_path(const PlanTask& task, const PlanStand& stand, const PlanPath& path) {
  LengthTest test = task.head;
  test.readings = path.readings;
  for (LengthReading& reading : test.readings) reading.set_up = stand.set_up, reading.tool = stand.tool;
  const auto m = task.curves.size();
  const NuisanceColumns nuisance = nuisance_of(test, m);
  const Linearised linear = linearised(test, task.curves, nuisance, Eigen::VectorXd::Zero(nuisance.end));
  const auto square = [](double value) { return value * value; };
  const ScatterVariances variances{square(task.settings.instrument_um), square(task.settings.scatter_um),
                                   square(task.settings.scatter_um_per_m), 0.0, 0.0};
  const Eigen::MatrixXd white = SharedNoise(test, task.curves, linear.direction).whitened(linear.columns, variances);
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(white.rows(), m + kStandColumns);
  out.leftCols(m) = white.leftCols(m);
  for (const auto& [name, column] : nuisance.station) out.middleCols(m, 3) = white.middleCols(column, 3);
  for (const auto& [name, column] : nuisance.zero) out.col(m + 3) = white.col(column);
  for (const auto& [name, column] : nuisance.scale) out.col(m + 4) = white.col(column);
  return out;
}

Eigen::VectorXd stand_precision(const PlanTask& task) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(kStandColumns, 1.0 / (kWideZero_um * kWideZero_um));
  out(4) = 1.0 / std::pow(std::max(task.settings.scale_um_per_m, 1e-6), 2);
  return out;
}

double machine_precision() { return 1.0 / (kWidePrior * kWidePrior); }

double set_up_minutes(const PlanTask& task, const std::vector<PlanStand>& stands) {
  std::set<std::size_t> set_ups;
  double minutes = 0.0;
  for (const PlanStand& stand : stands)
    minutes += !set_ups.insert(stand.set_up).second                     ? task.settings.tool_minutes
               : task.settings.instrument == LengthInstrument::ball_bar ? task.settings.times.align_minutes
                                                                        : task.settings.times.line_minutes;
  return minutes;
}

PlanChoice chosen_paths(const PlanTask& task, const std::vector<PlanStand>& stands) {
  return PathChooser(task, stands).run();
}

namespace {

constexpr std::size_t kMostSetUpSteps = 200;
constexpr double kAsKnown = 1e9;     ///< precision of what no length shows [1/um²]
constexpr double kFreePart = 1e-10;  ///< of the greatest information of scaled unknowns: not determined

/// The block of the last `count` unknowns eliminated.
Eigen::MatrixXd without_last(const Eigen::MatrixXd& information, Eigen::Index count) {
  const auto m = information.rows() - count;
  const Eigen::MatrixXd cross = information.bottomLeftCorner(count, m);
  return information.topLeftCorner(m, m) -
         cross.transpose() * solved_symmetric(information.bottomRightCorner(count, count), cross);
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
        best = static_cast<std::size_t>(std::ranges::max_element(scores) - scores.begin());
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
    out.covariance = Cholesky(information_).inverse().topLeftCorner(m, m);
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
    add_gram(all, rows);
    minutes_ += path.minutes;
  }
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
  const Spectrum eigen = spectrum_of(scaled);
  Eigen::Index count = 0;
  while (count < scaled.rows() && eigen.values(count) < kFreePart * eigen.values.maxCoeff()) ++count;
  return PivotedQr(size.cwiseInverse().asDiagonal() * eigen.vectors.leftCols(count)).basis();
}

double mean_square_of(const PlanTask& task, const Eigen::MatrixXd& information) {
  const auto m = task.curves.size();
  const Cholesky factor(information);
  if (!factor.is_positive()) return std::numeric_limits<double>::max();
  return task.weight.cwiseProduct(factor.inverse().topLeftCorner(m, m)).sum();
}

PlanChoice chosen_set_ups(const PlanTask& task, const std::vector<PlanStand>& stands,
                          const std::vector<StandInformation>& known, const Eigen::MatrixXd& free) {
  return SetUpChooser(task, stands, known, free).run();
}

}  // namespace ecs::model
