#include "model/search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/candidates.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;
using Eigen::VectorXf;

/// A column of which less than this share (of its square) is left is taken as absorbed.
constexpr double kAbsorbed = 1e-8;
constexpr double kAbsorbedScreening = 1e-5;
constexpr std::size_t kFewestCurveFunctions = 4;
constexpr std::size_t kMostBankColumns = 10'000;

MatrixXd without(const MatrixXd& q, MatrixXd columns) {
  if (q.cols() == 0) return columns;
  columns.noalias() -= q * (q.transpose() * columns);
  columns.noalias() -= q * (q.transpose() * columns);
  return columns;
}

/// Gain of the first 1, 2, … columns in this order, from products; columns that add nothing gain nothing.
struct Gains {
  std::vector<double> gain;        ///< cumulative
  std::vector<std::size_t> free;   ///< independent columns so far
  double first_coefficient = 0.0;  ///< of a single column
  double first_square = 0.0;
};

template <class Matrix, class Vector>
Gains gains_in_order(const Matrix& gram, const Vector& z, const std::vector<Index>& order,
                     const Eigen::VectorXd& original_square, double absorbed) {
  // Cholesky column by column
  const std::size_t k = order.size();
  MatrixXd l = MatrixXd::Zero(static_cast<Index>(k), static_cast<Index>(k));
  VectorXd u = VectorXd::Zero(static_cast<Index>(k));
  Gains gains;
  double sum = 0.0;
  std::size_t free = 0;
  for (std::size_t i = 0; i < k; ++i) {
    const auto ii = static_cast<Index>(i);
    double square = static_cast<double>(gram(order[i], order[i]));
    double right = static_cast<double>(z(order[i]));
    for (Index j = 0; j < ii; ++j) {
      double v = static_cast<double>(gram(order[i], order[static_cast<std::size_t>(j)]));
      for (Index m = 0; m < j; ++m) v -= l(ii, m) * l(j, m);
      l(ii, j) = l(j, j) > 0.0 ? v / l(j, j) : 0.0;
      square -= l(ii, j) * l(ii, j);
      right -= l(ii, j) * u(j);
    }
    if (square > absorbed * original_square(order[i]) && square > 0.0) {
      l(ii, ii) = std::sqrt(square);
      u(ii) = right / l(ii, ii);
      sum += u(ii) * u(ii);
      ++free;
    }
    if (i == 0 && square > absorbed * original_square(order[i]) && square > 0.0) {
      gains.first_coefficient = right / square;
      gains.first_square = square;
    }
    gains.gain.push_back(sum);
    gains.free.push_back(free);
  }
  return gains;
}

}  // namespace

void absorb(Space& space, const MatrixXd& white_columns) {
  const VectorXd before = white_columns.colwise().squaredNorm();
  const MatrixXd left = without(space.q, white_columns);
  std::vector<VectorXd> fresh;
  for (Index j = 0; j < left.cols(); ++j) {
    VectorXd v = left.col(j);
    for (int twice = 0; twice < 2; ++twice)
      for (const VectorXd& q : fresh) v -= q * q.dot(v);
    const double square = v.squaredNorm();
    if (square <= kAbsorbed * before(j) || square <= 0.0) continue;
    v /= std::sqrt(square);
    fresh.push_back(v);
    space.y -= v * v.dot(space.y);
  }
  const Index had = space.q.cols();
  MatrixXd q(space.y.size(), had + static_cast<Index>(fresh.size()));
  if (had > 0) q.leftCols(had) = space.q;
  for (std::size_t j = 0; j < fresh.size(); ++j) q.col(had + static_cast<Index>(j)) = fresh[j];
  space.q = std::move(q);
}

std::vector<std::vector<Index>> variants_of(const EffectInstance& effect, const Columns& columns, bool natural) {
  const Index count = columns.of.cols();
  std::vector<Index> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), Index{0});
  if (effect.id == EffectId::cyclic) return {{0, 1}, {0, 1, 2, 3}};
  if (effect.id == EffectId::sag) return {{0}, {1}, {0, 1}};
  if (effect.id == EffectId::warm_up || effect.id == EffectId::load)
    return natural ? std::vector<std::vector<Index>>{{0}, {1}, {0, 1}} : std::vector<std::vector<Index>>{{1}, {1, 0}};
  if (!is_curve(effect.id)) return {all};
  std::vector<std::vector<Index>> orders;
  const auto leading = static_cast<Index>(columns.leading);
  for (Index j = 1; j <= leading; ++j) orders.emplace_back(all.begin(), all.begin() + j);
  const Index fewest = std::min<Index>(static_cast<Index>(kFewestCurveFunctions), count - leading);
  for (Index j = leading + std::max<Index>(fewest, 1); j <= count; ++j)
    orders.emplace_back(all.begin(), all.begin() + j);
  return orders;
}

Search::Search(const Regressors& regressors, const Whitener& whitener, const MatrixXd& base, const VectorXd& residual,
               const std::vector<EffectInstance>& candidates)
    : regressors_(regressors), whitener_(whitener) {
  base_.y = whitener(residual);
  base_.q.resize(base_.y.size(), 0);
  absorb(base_, whitener(base));
  const Observations& data = regressors.data();
  for (const Axis a : kAllAxes) {
    std::vector<double> p;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.axis[k] == a) p.push_back(data.p_mm(k, a));
    targets_[index_of(a)] = distinct(std::move(p), 1e-4).size();
  }
  build_families(candidates);
  build_bank();
}

void Search::build_families(const std::vector<EffectInstance>& candidates) {
  std::size_t scans = 0;
  for (const EffectInstance& effect : candidates) scans += effect.id == EffectId::cyclic ? 1 : 0;
  const std::size_t most = kMostBankColumns / 2 / std::max<std::size_t>(scans, 1);
  std::vector<VectorXd> signatures;  // of effects without a nonlinear parameter, to drop doubles of one effect
  std::vector<EffectId> signature_ids;
  for (const EffectInstance& effect : candidates) {
    Family family;
    family.effect = effect;
    family.acting = regressors_.acting(effect);
    if (family.acting.rows.size() < 2) continue;
    const Grid grid = grid_of(regressors_, effect, family.acting, std::min<std::size_t>(most, 1500));
    family.grid = grid.values;
    family.facts = grid.facts;
    if (family.grid.empty() && family.facts.empty()) continue;
    const bool searched = !nonlinear_parameter_of(effect.id).empty();
    family.search_cost = searched ? 2.0 * std::log(std::max(2.0, grid.independent)) : 0.0;
    family.fact_cost = searched ? 2.0 * std::log(1.0 + static_cast<double>(grid.facts.size())) : 0.0;
    family.ln_readings = std::log(std::max(8.0, static_cast<double>(family.acting.rows.size())));
    if (effect.id == EffectId::cosine) family.least = 0.0;
    if (effect.id == EffectId::air_refraction) {
      family.least = -0.2;
      family.greatest = 2.2;
    }
    if (effect.id == EffectId::dead_path) {
      family.least = -11.0;
      family.greatest = 11.0;
    }
    // the same fault of the map named twice (one component, or all of which only that one acts)
    if (effect.id >= EffectId::map_polarity && effect.id <= EffectId::map_direction_swap) {
      const Columns columns = regressors_.columns(effect, family.grid.front(), family.acting);
      const VectorXd signature = columns.fixed.size() > 0 ? columns.fixed : VectorXd(columns.of.col(0));
      bool twice = signature.squaredNorm() <= 0.0;
      for (std::size_t i = 0; i < signatures.size() && !twice; ++i)
        twice = signature_ids[i] == effect.id &&
                (signatures[i] - signature).squaredNorm() < 1e-12 * signature.squaredNorm();
      if (twice) continue;
      signatures.push_back(signature);
      signature_ids.push_back(effect.id);
    }
    families_.push_back(std::move(family));
  }
}

void Search::build_bank() {
  const Index n = base_.y.size();
  std::vector<MatrixXd> parts;
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
      parts.push_back(std::move(part));
    };
    for (const bool coarse : {true, false})  // the blanks' thinner grid stands together
      for (std::size_t i = 0; i < family.grid.size(); ++i)
        if (coarse == (!cyclic || i % 3 == 0)) add(family.grid[i], false, coarse);
    for (const double value : family.facts) add(value, true, false);
  }
  bank_.resize(n, total);
  const MatrixXf q = base_.q.cast<float>();
  constexpr std::size_t kBatch = 256;
  for (std::size_t from = 0; from < items_.size(); from += kBatch) {
    const std::size_t to = std::min(from + kBatch, items_.size());
    for (std::size_t i = from; i < to; ++i)
      bank_.middleCols(items_[i].start, items_[i].count) = whitener_(parts[i]).cast<float>();
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

double Search::cost_of(const Family& family, double nonlinear, std::size_t linear) const {
  double cost = family.ln_readings * static_cast<double>(linear);
  if (family.grid.size() + family.facts.size() <= 1) return cost;
  bool fact = false;
  for (const double value : family.facts) fact = fact || std::abs(nonlinear - value) < 5e-3 * value;
  return cost + (fact ? std::min(family.fact_cost, family.search_cost) : family.search_cost);
}

namespace {

/// Best set of columns by score, with the coefficient of a single one kept inside its physical range.
template <class Matrix, class Vector, class Cost>
Choice best_variant(const Family& family, const std::vector<std::vector<Index>>& variants, const Matrix& gram,
                    const Vector& z, const VectorXd& original, double absorbed, const Cost& cost) {
  Choice best;
  best.gain = -1.0;
  double best_score = -1e300;
  for (const std::vector<Index>& variant : variants) {
    if (variant.empty() || variant.back() >= static_cast<Index>(z.size())) continue;
    const Gains gains = gains_in_order(gram, z, variant, original, absorbed);
    double gain = gains.gain.back();
    const std::size_t free = gains.free.back();
    if (free == 0) continue;
    if (variant.size() == 1 && (family.least || family.greatest)) {
      double c = gains.first_coefficient;
      if (family.least) c = std::max(c, *family.least);
      if (family.greatest) c = std::min(c, *family.greatest);
      gain = c * gains.first_square * (2.0 * gains.first_coefficient - c);
    }
    const double score = gain - cost(free);
    if (score > best_score) {
      best_score = score;
      best.columns = variant;
      best.gain = gain;
      best.cost = cost(free);
      best.parameters = free;
    }
  }
  return best;
}

/// Curves: all leading sets from one pass.
template <class Matrix, class Vector, class Cost>
Choice best_curve(const std::vector<std::vector<Index>>& variants, const Matrix& gram, const Vector& z,
                  const VectorXd& original, double absorbed, const Cost& cost) {
  Choice best;
  best.gain = -1.0;
  if (variants.empty()) return best;
  const Gains gains = gains_in_order(gram, z, variants.back(), original, absorbed);
  double best_score = -1e300;
  for (const std::vector<Index>& variant : variants) {
    const std::size_t last = variant.size() - 1;
    if (gains.free[last] == 0) continue;
    const double score = gains.gain[last] - cost(gains.free[last]);
    if (score <= best_score) continue;
    best_score = score;
    best.columns = variant;
    best.gain = gains.gain[last];
    best.cost = cost(gains.free[last]);
    best.parameters = gains.free[last];
  }
  return best;
}

}  // namespace

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
    choice = is_curve(family.effect.id) ? best_curve(variants, gram, z, original, kAbsorbedScreening, cost)
                                        : best_variant(family, variants, gram, z, original, kAbsorbedScreening, cost);
  }
  choice.family = item.family;
  choice.nonlinear = item.nonlinear;
  if (family.grid.size() + family.facts.size() > 1) ++choice.parameters;
  return choice;
}

Choice Search::choice_at(const Space& space, std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  const Columns columns = regressors_.columns(family.effect, nonlinear, family.acting);
  const auto cost = [&](std::size_t linear) { return cost_of(family, nonlinear, linear); };
  Choice choice;
  if (columns.fixed.size() > 0) {
    const VectorXd white = whitener_(columns.fixed);
    const VectorXd left = without(space.q, white);
    choice.gain =
        left.squaredNorm() <= kAbsorbed * white.squaredNorm() ? -1.0 : 2.0 * left.dot(space.y) - left.squaredNorm();
    choice.cost = cost(0);
  } else {
    const MatrixXd white = whitener_(columns.of);
    const VectorXd original = white.colwise().squaredNorm();
    const MatrixXd left = without(space.q, white);
    const MatrixXd gram = left.transpose() * left;
    const VectorXd z = left.transpose() * space.y;
    const bool natural =
        !family.effect.sense || natural_axis(regressors_.data(), *family.effect.sense) == family.effect.axis;
    const auto variants = variants_of(family.effect, columns, natural);
    choice = is_curve(family.effect.id) ? best_curve(variants, gram, z, original, kAbsorbed, cost)
                                        : best_variant(family, variants, gram, z, original, kAbsorbed, cost);
  }
  choice.family = f;
  choice.nonlinear = nonlinear;
  if (family.grid.size() + family.facts.size() > 1) ++choice.parameters;
  return choice;
}

Choice Search::refined_choice(const Space& space, std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  Choice best = choice_at(space, f, nonlinear);
  if (nonlinear_parameter_of(family.effect.id).empty() || family.grid.size() + family.facts.size() <= 1 ||
      family.effect.id == EffectId::step)
    return best;
  // neighbours on the grid bound the search; periods are searched in frequency
  const bool inverse = family.effect.id == EffectId::cyclic;
  const auto to = [&](double v) { return inverse ? 1.0 / v : v; };
  double width = 0.0;
  if (inverse) {
    double least = 1e300, greatest = -1e300;
    for (const std::size_t k : family.acting.rows) {
      const double p = regressors_.data().p_mm(k, *family.effect.axis);
      least = std::min(least, p);
      greatest = std::max(greatest, p);
    }
    width = 0.4 / std::max(greatest - least, 1e-9);
  } else {
    width = 1e300;
    for (const double value : family.grid)
      if (value != nonlinear) width = std::min(width, std::abs(value - nonlinear));
    width *= 1.2;
  }
  const double centre = to(nonlinear);
  // shorter time constants than those tried pass for a constant
  const double shortest = family.grid.empty() ? 0.0 : *std::min_element(family.grid.begin(), family.grid.end());
  const double floor = inverse ? 0.05 * centre : shortest;
  const auto at = [&](double v) { return choice_at(space, f, to(v)); };
  constexpr double kGolden = 0.6180339887498949;
  double low = std::max(floor, centre - width), high = centre + width;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  Choice at_a = at(a), at_b = at(b);
  for (int i = 0; i < 14; ++i) {
    if (at_a.gain > at_b.gain) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = at(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = at(b);
    }
    for (const Choice* c : {&at_a, &at_b})
      if (c->score() > best.score()) best = *c;
  }
  return best;
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

Columns Search::columns_of(const Choice& choice) const {
  const Family& family = families_[choice.family];
  Columns all = regressors_.columns(family.effect, choice.nonlinear, family.acting);
  if (all.fixed.size() > 0) return all;
  Columns chosen;
  chosen.of.resize(all.of.rows(), static_cast<Index>(choice.columns.size()));
  for (std::size_t j = 0; j < choice.columns.size(); ++j)
    chosen.of.col(static_cast<Index>(j)) = all.of.col(choice.columns[j]);
  return chosen;
}

Solution Search::solution(const std::vector<Choice>& chosen) const {
  Solution solution;
  solution.chosen = chosen;
  solution.space = base_;
  solution.chi2_before = base_.chi2();
  for (Choice& choice : solution.chosen) {
    const Columns columns = columns_of(choice);
    const double before = solution.space.chi2();
    if (columns.fixed.size() > 0) {
      const VectorXd white = whitener_(columns.fixed);
      solution.space.y -= without(solution.space.q, white);
    } else {
      absorb(solution.space, whitener_(columns.of));
    }
    choice.gain = before - solution.space.chi2();
    solution.cost += choice.cost;
  }
  return solution;
}

Solution Search::refined(const std::vector<Choice>& chosen) const {
  Solution best = solution(chosen);
  const bool nonlinear = std::any_of(chosen.begin(), chosen.end(), [&](const Choice& c) {
    return !nonlinear_parameter_of(families_[c.family].effect.id).empty();
  });
  if (chosen.size() < 2 || !nonlinear) return best;
  for (int round = 0; round < 3; ++round) {
    const double before = best.score();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      std::vector<Choice> others = best.chosen;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const Solution rest = solution(others);
      Choice again = refined_choice(rest.space, best.chosen[i].family, best.chosen[i].nonlinear);
      if (again.gain <= 0.0) continue;
      std::vector<Choice> all = others;
      all.insert(all.begin() + static_cast<std::ptrdiff_t>(i), again);
      Solution tried = solution(all);
      if (tried.score() > best.score()) best = std::move(tried);
    }
    if (best.score() - before < 0.5) break;
  }
  return best;
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
      if (square > kAbsorbedScreening * original(variant[static_cast<std::size_t>(i)]) && square > 0.0) {
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

EffectInstance effect_of(EffectInstance effect, const Choice& choice) {
  const std::string nonlinear(nonlinear_parameter_of(effect.id));
  if (!nonlinear.empty()) effect.fitted[nonlinear] = choice.nonlinear;
  const auto uses = [&](Index column) {
    return std::find(choice.columns.begin(), choice.columns.end(), column) != choice.columns.end();
  };
  if (effect.id == EffectId::cyclic && !uses(2)) effect.parameters["amplitude2_um"] = 0.0;
  const auto hold = [&](Index column, const char* name) {
    if (!uses(column)) effect.parameters[name] = 0.0;
  };
  if (effect.id == EffectId::sag) {
    hold(0, "k2");
    hold(1, "k3");
  }
  if (effect.id == EffectId::warm_up) {
    hold(0, "c_um");
    hold(1, "c_um_per_m");
  }
  if (effect.id == EffectId::load) {
    hold(0, "um_per_kg");
    hold(1, "um_per_kg_m");
  }
  return effect;
}

}  // namespace ecs::model
