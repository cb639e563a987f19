// The bank of whitened columns of every candidate at every value tried, in single precision: one product with what is
// left screens them all; products with simulated noise say what chance can do.
#include <algorithm>
#include <cmath>

#include "model/candidates.hpp"
#include "model/gains.hpp"
#include "model/search.hpp"

namespace ecs::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;
using Eigen::VectorXf;

void Search::build_bank() {
  const Index n = base_.y.size();
  std::vector<MatrixXf> parts;
  Index total = 0;
  for (std::size_t f = 0; f < families_.size(); ++f) {
    const Family& family = families_[f];
    const bool cyclic = family.effect.id == EffectId::cyclic;
    const auto add = [&](double value, bool fact, bool coarse) {
      Columns columns = regressors_.columns(family.effect, value, family.acting);
      MatrixXd part = columns.fixed.size() > 0 ? MatrixXd(columns.fixed) : columns.of;
      if (cyclic && !fact) part.conservativeResize(Eigen::NoChange, 2);
      items_.push_back({f, value, total, part.cols(), coarse});
      total += part.cols();
      parts.push_back(whitener_(part).cast<float>());
    };
    for (const bool coarse : {true, false})  // the blanks' thinner grid stands together
      for (std::size_t i = 0; i < family.grid.size(); ++i)
        if (coarse == (!cyclic || i % 2 == 0)) add(family.grid[i], false, coarse);
    for (const double value : family.facts) add(value, true, false);
  }
  bank_.resize(n, total);
  const MatrixXf q = base_.q.cast<float>();
  for (std::size_t i = 0; i < items_.size(); ++i) {
    bank_.middleCols(items_[i].start, items_[i].count) = parts[i];
    parts[i].resize(0, 0);
  }
  grams_.reserve(items_.size());
  for (const Item& item : items_) {
    // original squares are kept on an extra row so that absorbed columns are recognised
    MatrixXf gram(item.count + 1, item.count);
    gram.row(item.count) = bank_.middleCols(item.start, item.count).colwise().squaredNorm();
    grams_.push_back(std::move(gram));
  }
  constexpr Index kColumns = 512;
  for (Index from = 0; from < total; from += kColumns) {
    auto part = bank_.middleCols(from, std::min(kColumns, total - from));
    const MatrixXf products = q.transpose() * part;
    part.noalias() -= q * products;
  }
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const auto part = bank_.middleCols(items_[i].start, items_[i].count);
    grams_[i].topRows(items_[i].count) = part.transpose() * part;
  }
}

Choice Search::screened(const Item& item, const MatrixXf& gram, const VectorXf& z) const {
  const Family& family = families_[item.family];
  const VectorXd original = grams_[static_cast<std::size_t>(&item - items_.data())].row(item.count).cast<double>();
  const auto cost = [&](std::size_t linear) { return cost_of(family, item.nonlinear, linear); };
  Choice choice;
  if (has_fixed_size(family.effect.id)) {
    if (static_cast<double>(gram(0, 0)) <= kAbsorbedScreening * original(0)) {
      choice.gain = -1.0;
    } else {
      choice.gain = static_cast<double>(2.0F * z(0) - gram(0, 0));
      choice.cost = cost(0);
    }
  } else {
    Columns shape;
    shape.of.resize(0, item.count);
    shape.leading = family.effect.id == EffectId::angular ? 2 : 0;
    const bool natural =
        !family.effect.sense || natural_axis(regressors_.data(), *family.effect.sense) == family.effect.axis;
    const auto variants = variants_of(family.effect, shape, natural);
    choice = best_choice(family, variants, gram.cast<double>(), z.cast<double>(), original, kAbsorbedScreening, cost);
  }
  choice.family = item.family;
  choice.nonlinear = item.nonlinear;
  if (family.grid.size() + family.facts.size() > 1) ++choice.parameters;
  return choice;
}

std::vector<Choice> Search::expand(const Space& space, std::size_t exact) const {
  const Index more = space.q.cols() - base_.q.cols();
  const MatrixXf q = space.q.rightCols(more).cast<float>();
  const VectorXf y = space.y.cast<float>();
  const VectorXf z = bank_.transpose() * y;
  MatrixXf products;
  if (more > 0) products.noalias() = q.transpose() * bank_;
  std::vector<Choice> best(families_.size());
  std::vector<std::vector<Choice>> peaks(families_.size());
  for (Choice& choice : best) choice.gain = -1.0;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const Item& item = items_[i];
    MatrixXf gram = grams_[i].topRows(item.count);
    if (more > 0) {
      const auto part = products.middleCols(item.start, item.count);
      gram.noalias() -= part.transpose() * part;
    }
    const Choice choice = screened(item, gram, z.segment(item.start, item.count));
    if (choice.gain > 0.0) peaks[item.family].push_back(choice);
  }
  std::vector<Choice> list;
  for (auto& of_family : peaks) {
    if (of_family.empty()) continue;
    std::stable_sort(of_family.begin(), of_family.end(),
                     [](const Choice& a, const Choice& b) { return a.score() > b.score(); });
    list.push_back(of_family.front());
  }
  const auto by_score = [](const Choice& a, const Choice& b) { return a.score() > b.score(); };
  std::stable_sort(list.begin(), list.end(), by_score);
  for (std::size_t i = 0; i < std::min(exact, list.size()); ++i) {
    const std::size_t f = list[i].family;
    Choice exactly = refined_choice(space, f, list[i].nonlinear);
    if (families_[f].effect.id == EffectId::cyclic) {
      // the period may be twice the one found (its second harmonic stronger), or another peak
      std::vector<double> tries{2.0 * exactly.nonlinear};
      for (std::size_t j = 1; j < std::min<std::size_t>(peaks[f].size(), 6) && tries.size() < 3; ++j) {
        const double ratio = peaks[f][j].nonlinear / exactly.nonlinear;
        if (std::abs(ratio - 1.0) > 0.02) tries.push_back(peaks[f][j].nonlinear);
      }
      for (const double value : tries) {
        const Choice other = refined_choice(space, f, value);
        if (other.score() > exactly.score()) exactly = other;
      }
    }
    list[i] = exactly;
  }
  std::stable_sort(list.begin(), list.end(), by_score);
  return list;
}

void Search::raise_by(const Item& item, const MatrixXf& gram, const Eigen::Ref<const MatrixXf>& z,
                      std::vector<double>& top) const {
  const Family& family = families_[item.family];
  const auto raise = [&](Index b, double score) {
    double& best = top[static_cast<std::size_t>(b)];
    best = std::max(best, score);
  };
  if (has_fixed_size(family.effect.id)) {
    const double cost = cost_of(family, item.nonlinear, 0);
    for (Index b = 0; b < z.cols(); ++b) raise(b, static_cast<double>(2.0F * z(0, b) - gram(0, 0)) - cost);
    return;
  }
  Columns shape;
  shape.of.resize(0, item.count);
  shape.leading = family.effect.id == EffectId::angular ? 2 : 0;
  auto variants = variants_of(family.effect, shape, true);
  std::vector<bool> allowed(static_cast<std::size_t>(item.count) + 1, !is_curve(family.effect.id));
  if (is_curve(family.effect.id) && !variants.empty()) {
    for (const auto& variant : variants) allowed[variant.size()] = true;
    variants = {variants.back()};
  }
  const double absorbed = family.effect.id == EffectId::cyclic ? kAbsorbedPeriod : kAbsorbedScreening;
  for (const std::vector<Index>& variant : variants) {
    const auto k = static_cast<Index>(variant.size());
    if (variant.back() >= item.count) continue;
    MatrixXd g(k, k), right(k, z.cols());
    for (Index i = 0; i < k; ++i) {
      right.row(i) = z.row(variant[static_cast<std::size_t>(i)]).cast<double>();
      for (Index j = 0; j < k; ++j)
        g(i, j) = static_cast<double>(gram(variant[static_cast<std::size_t>(i)], variant[static_cast<std::size_t>(j)]));
    }
    const VectorXd original = grams_[static_cast<std::size_t>(&item - items_.data())].row(item.count).cast<double>();
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(z.cols());
    std::size_t free = 0;
    for (Index i = 0; i < k; ++i) {  // Gram-Schmidt on the products
      const double square = g(i, i);
      if (square > absorbed * original(variant[static_cast<std::size_t>(i)]) && square > 0.0) {
        ++free;
        sum += right.row(i).cwiseAbs2() / square;
        for (Index j = i + 1; j < k; ++j) {
          const double share = g(j, i) / square;
          right.row(j) -= share * right.row(i);
          for (Index m = j; m < k; ++m) g(m, j) -= share * g(m, i);
        }
      }
      const bool complete = is_curve(family.effect.id) ? allowed[static_cast<std::size_t>(i) + 1] : i + 1 == k;
      if (free == 0 || !complete) continue;
      const double cost = cost_of(family, item.nonlinear, free);
      for (Index b = 0; b < z.cols(); ++b) raise(b, sum(b) - cost);
    }
  }
}

std::vector<double> Search::best_scores(const MatrixXf& blanks) const {
  std::vector<double> best(static_cast<std::size_t>(blanks.cols()), -1e300);
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (!items_[i].coarse) continue;
    // neighbouring narrow items are taken together so that the product is one of matrices
    std::size_t last = i;
    Index width = items_[i].count;
    while (last + 1 < items_.size() && width < 64 && items_[last + 1].coarse &&
           items_[last + 1].start == items_[last].start + items_[last].count) {
      ++last;
      width += items_[last].count;
    }
    const MatrixXf z = bank_.middleCols(items_[i].start, width).transpose() * blanks;
    for (std::size_t j = i; j <= last; ++j)
      raise_by(items_[j], grams_[j].topRows(items_[j].count),
               z.middleRows(items_[j].start - items_[i].start, items_[j].count), best);
    i = last;
  }
  return best;
}

}  // namespace ecs::model
