// The bank of shapes of every candidate at every value tried: their products among themselves, with what is left and
// with simulated noise. Shapes of position are kept once per place, however often it was measured.
// Does not live here: what the products gain, screening (search_screen.cpp), refining (search.cpp).
#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include "base/linear/decompositions.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/search.hpp"
#include "model/regression/candidates.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

/// With more places than that, products over the readings are cheaper than products over the places, unless the noise
/// is white: then each place has its weight alone.
constexpr Index kMostNodes = 300;
/// A few columns are weighed over the readings where the places have more pairs than this many times the readings: to
/// spread, whiten and gather a value takes about so many steps.
constexpr Index kDearPlaces = 16;
/// Columns handled at once, so that a piece stays in the cache.
constexpr Index kPiece = 256;
/// Families in their views of which answers are kept, about a kilobyte each.
constexpr std::size_t kMostAnswers = 10'000;

std::size_t hash_of(const MatrixXd& values) {
  const auto bytes = static_cast<std::size_t>(values.size()) * sizeof(double);
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(values.data()), bytes});
}

/// The first `count` columns of an effect that depends on the position of its axis alone.
MatrixXd place_columns(const EffectDefinition& definition, const std::vector<double>& place_mm, double searched,
                       Index count) {
  MatrixXd columns(static_cast<Index>(place_mm.size()), count);
  Eigen::RowVectorXd row(count);
  for (std::size_t i = 0; i < place_mm.size(); ++i) {
    definition.columns_of_place(place_mm[i], searched, {row.data(), static_cast<std::size_t>(count)});
    columns.row(static_cast<Index>(i)) = row;
  }
  return columns;
}

/// In single precision; 0 where a product with it might be subnormal, for which processors take a hundred times as
/// long.
MatrixXf in_single_precision(const MatrixXd& values) {
  constexpr double kNearlySubnormal = 1e-30;
  return (values.array().abs() < kNearlySubnormal).select(0.0, values).cast<float>();
}

/// @param weight  of places (places × places), or of each alone (places × 1)
template <class Matrix>
Matrix weighted(const Matrix& weight, const Matrix& columns) {
  if (weight.cols() == 1) return weight.col(0).asDiagonal() * columns;
  return weight * columns;
}

}  // namespace

MatrixXd Search::at_motions(const MatrixXd& white) const {
  return regressors_.motions_from(whitener_.transposed(white));
}

void Search::look_at(const Space& space) const {
  const auto more = space.q.rightCols(space.q.cols() - base_.q.cols());
  const bool is_known =
      seen_.y.size() == space.y.size() && seen_.q.cols() == more.cols() && seen_.y == space.y && seen_.q == more;
  if (is_known) return;
  seen_ = {more, space.y};
  seen_at_motions_ = {at_motions(seen_.q), at_motions(MatrixXd(space.y))};
  views_.clear();
}

MatrixXd Search::gathered(std::size_t f, const MatrixXd& rows) const {
  const FamilyBank& bank = banks_[f];
  const std::vector<std::size_t>& acting = families_[f].acting.rows;
  MatrixXd sums = MatrixXd::Zero(bank.nodes, rows.cols());
  for (Index j = 0; j < rows.cols(); ++j) {
    const double* from = rows.col(j).data();
    double* to = sums.col(j).data();
    for (std::size_t i = 0; i < acting.size(); ++i) to[bank.node_of[i]] += from[acting[i]];
  }
  return sums;
}

MatrixXd Search::white_of(std::size_t f, const MatrixXd& shapes) const {
  const std::vector<std::size_t>& acting = families_[f].acting.rows;
  MatrixXd rows = MatrixXd::Zero(static_cast<Index>(regressors_.motions().size()), shapes.cols());
  for (Index j = 0; j < shapes.cols(); ++j)
    for (std::size_t i = 0; i < acting.size(); ++i)
      rows(static_cast<Index>(acting[i]), j) = shapes(banks_[f].node_of[i], j);
  return whitener_(regressors_.readings_from(std::move(rows)));
}

/// Items of a family, their shapes at the nodes.
void Search::build_shapes(std::size_t f) {
  const Family& family = families_[f];
  FamilyBank& bank = banks_[f];
  const EffectDefinition& definition = family.effect.definition();
  const bool of_place = definition.columns_of_place != nullptr && regressors_.data().through_chain.empty();
  Shapes shapes{family.effect, family.grid, family.facts, {}, {}};
  const std::vector<std::size_t>& rows = family.acting.rows;
  if (of_place) {
    std::vector<double> p;
    for (const std::size_t k : rows) p.push_back(regressors_.motions().p_mm(k, *family.effect.axis));
    shapes.place_mm = distinct(p, 1e-9);
    for (const double at : p)
      bank.node_of.push_back(std::ranges::upper_bound(shapes.place_mm, at) - shapes.place_mm.begin() - 1);
    bank.nodes = static_cast<Index>(shapes.place_mm.size());
  } else {
    for (std::size_t i = 0; i < rows.size(); ++i) bank.node_of.push_back(static_cast<Index>(i));
    bank.nodes = static_cast<Index>(rows.size());
  }

  const bool periodic = definition.traits.periodic;
  const auto kept = std::ranges::find_if(regressors_.shapes(), [&](const auto& one) {
    return one->grid == shapes.grid && one->facts == shapes.facts && one->place_mm == shapes.place_mm &&
           (of_place ? one->effect.id == shapes.effect.id : !periodic && one->effect == shapes.effect);
  });
  if (kept != regressors_.shapes().end()) bank.shapes = *kept;
  Index total = 0;
  bank.first = items_.size();
  const auto add = [&](double value, Index count, bool coarse) {
    items_.push_back({f, value, total, count, 0, coarse, price_of(family, value)});
    total += count;
  };
  Index count = periodic ? 2 : 1;
  if (bank.shapes && !of_place)
    count = bank.shapes->columns.cols() / static_cast<Index>(shapes.grid.size() + shapes.facts.size());
  const bool by_part = !of_place && !bank.shapes;
  std::vector<MatrixXd> parts;
  const auto part_at = [&](double value) {
    const Columns columns = regressors_.motion_columns(family.effect, value, family.acting);
    const MatrixXd all = columns.fixed.size() > 0 ? MatrixXd(columns.fixed) : columns.of;
    MatrixXd part(bank.nodes, all.cols());
    for (std::size_t i = 0; i < rows.size(); ++i)
      part.row(static_cast<Index>(i)) = all.row(static_cast<Index>(rows[i]));
    return part;
  };
  for (const bool coarse : {true, false})  // the thinner grid for simulated noise comes first, in one piece
    for (std::size_t i = 0; i < family.grid.size(); ++i) {
      if (coarse != (!periodic || i % 2 == 0)) continue;
      if (by_part) {
        parts.push_back(part_at(family.grid[i]));
        if (periodic) parts.back().conservativeResize(Eigen::NoChange, count);  // the fundamental
        count = parts.back().cols();
      }
      add(family.grid[i], count, coarse);
    }
  for (const double value : family.facts) {
    if (by_part) parts.push_back(part_at(value));
    add(value, periodic ? static_cast<Index>(definition.column_count()) : count, false);
  }
  bank.last = items_.size();

  if (bank.shapes) return;
  shapes.columns.resize(bank.nodes, total);
  for (std::size_t i = bank.first; i < bank.last; ++i) {
    const Item& item = items_[i];
    shapes.columns.middleCols(item.start, item.count) =
        of_place ? place_columns(definition, shapes.place_mm, item.nonlinear, item.count).cast<float>()
                 : parts[i - bank.first].cast<float>();
  }
  bank.shapes = std::make_shared<const Shapes>(std::move(shapes));
  regressors_.keep(bank.shapes);
}

void Search::store_grams(const FamilyBank& bank, Index from, const MatrixXf& left, const MatrixXf& right,
                         const MatrixXf& absorbed) {
  for (std::size_t i = bank.first; i < bank.last; ++i) {
    Item& item = items_[i];
    if (item.start < from || item.start + item.count > from + right.cols()) continue;
    const Index at = item.start - from;
    item.gram = grams_.size();
    grams_.resize(grams_.size() + static_cast<std::size_t>(item.count * (item.count + 1)));
    Eigen::Map<MatrixXd> gram(grams_.data() + item.gram, item.count, item.count);
    Eigen::Map<VectorXd> original(grams_.data() + item.gram + item.count * item.count, item.count);
    const auto of_item = [&](const MatrixXf& columns) { return columns.middleCols(at, item.count); };
    gram = of_item(left).transpose().lazyProduct(of_item(right)).cast<double>();
    original = gram.diagonal();
    gram -= of_item(absorbed).transpose().lazyProduct(of_item(absorbed)).cast<double>();
  }
}

/// The same in double precision, for columns that vary by little beside what the base takes, such as the time at a line
/// that was measured a day after the first one: they count as absorbed only by what the base leaves of them.
void Search::store_own_grams(const FamilyBank& bank, Index from, const MatrixXd& white) {
  const MatrixXd own = white - base_.q * (base_.q.transpose() * white);
  for (std::size_t i = bank.first; i < bank.last; ++i) {
    Item& item = items_[i];
    if (item.start < from || item.start + item.count > from + white.cols()) continue;
    item.gram = grams_.size();
    grams_.resize(grams_.size() + static_cast<std::size_t>(item.count * (item.count + 1)));
    Eigen::Map<MatrixXd> gram(grams_.data() + item.gram, item.count, item.count);
    Eigen::Map<VectorXd> original(grams_.data() + item.gram + item.count * item.count, item.count);
    const auto columns = own.middleCols(item.start - from, item.count);
    gram = columns.transpose().lazyProduct(columns);
    const VectorXd whole = white.middleCols(item.start - from, item.count).colwise().squaredNorm().transpose();
    for (Index j = 0; j < item.count; ++j) original(j) = gram(j, j) > kAbsorbed * whole(j) ? gram(j, j) : whole(j);
  }
}

/// Products of the shapes of each item, whitened, base removed.
void Search::build_grams(std::size_t f) {
  FamilyBank& bank = banks_[f];
  const Shapes& shapes = *bank.shapes;
  MatrixXf weight, base_q;
  FamilyBank& like = banks_[bank.like];
  const bool is_white = whitener_.is_white() && !regressors_.data().moved;
  if (!shapes.place_mm.empty() && (is_white || bank.nodes <= kMostNodes) && like.weight.size() == 0) {
    if (is_white) {
      like.weight = gathered(f, whitener_(MatrixXd(MatrixXd::Ones(base_.y.size(), 1))).cwiseAbs2());
    } else {
      const MatrixXd white = white_of(f, MatrixXd::Identity(bank.nodes, bank.nodes));
      like.weight = MatrixXd::Zero(bank.nodes, bank.nodes);
      like.weight.selfadjointView<Eigen::Lower>().rankUpdate(white.transpose());
      like.weight.triangularView<Eigen::StrictlyUpper>() = like.weight.transpose();
    }
    like.base_q = gathered(f, at_motions(base_.q));
  }
  if (has_places(f)) {
    weight = in_single_precision(like.weight);
    base_q = like.base_q.cast<float>();
  }
  for (Index from = 0; from < shapes.columns.cols();) {
    Index end = from;  // whole items only
    for (std::size_t i = bank.first; i < bank.last; ++i)
      if (items_[i].start == end && (end == from || end + items_[i].count - from <= kPiece)) end += items_[i].count;
    const MatrixXf piece = shapes.columns.middleCols(from, end - from);
    if (weight.size() > 0) {
      store_grams(bank, from, piece, weighted(weight, piece), base_q.transpose() * piece);
    } else {
      store_own_grams(bank, from, white_of(f, piece.cast<double>()));
    }
    from = end;
  }
}

void Search::build_bank() {
  banks_.resize(families_.size());
  for (std::size_t f = 0; f < families_.size(); ++f) {
    heed_cancel();
    build_shapes(f);
    const auto same_nodes = [&](std::size_t other) {
      return banks_[other].node_of == banks_[f].node_of && families_[other].acting.rows == families_[f].acting.rows;
    };
    while (!same_nodes(banks_[f].like)) ++banks_[f].like;
    build_grams(f);
    const EffectInstance& effect = families_[f].effect;
    const bool natural = !effect.sense || natural_axis(regressors_.data(), *effect.sense) == effect.axis;
    Columns shape;
    for (std::size_t i = banks_[f].first; i < banks_[f].last; ++i)
      shape.of.resize(0, std::max(shape.of.cols(), items_[i].count));
    if (effect.traits().periodic) shape.of.resize(0, static_cast<Index>(effect.definition().column_count()));
    shape.leading = effect.definition().leading_columns();
    banks_[f].variants = variants_of(effect, shape, natural);
  }
}

const Search::View& Search::latest_view(std::size_t f) const {
  const auto [at, is_new] = views_.try_emplace(banks_[f].like);
  View& view = at->second;
  if (!is_new) return view;
  view = {gathered(f, seen_at_motions_.q), gathered(f, seen_at_motions_.y), {}};
  Index seen = 0;
  for (Index j = 0; j < view.q.cols(); ++j)
    if (!view.q.col(j).isZero(0.0)) view.q.col(seen++) = view.q.col(j);
  view.q.conservativeResize(Eigen::NoChange, seen);
  view.hash = {hash_of(view.q), hash_of(view.y)};
  return view;
}

Search::Answers& Search::answers_in(const View& view, std::size_t f) const {
  if (answers_.size() >= kMostAnswers) answers_.clear();
  return answers_[{f, view.hash.first, view.hash.second}];
}

const Search::View& Search::view_of(const Space& space, std::size_t f) const {
  look_at(space);
  return latest_view(f);
}

Choice Search::choice_in(const View& view, std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  const FamilyBank& bank = banks_[f];
  const EffectDefinition& definition = family.effect.definition();
  const MatrixXd columns =
      place_columns(definition, bank.shapes->place_mm, nonlinear, static_cast<Index>(definition.column_count()));
  const MatrixXd& weight = banks_[bank.like].weight;
  const bool by_places = weight.size() < kDearPlaces * base_.y.size();
  const MatrixXd by_weight = by_places ? weighted(weight, columns) : gathered(f, at_motions(white_of(f, columns)));
  MatrixXd gram = columns.transpose() * by_weight;
  const VectorXd original = gram.diagonal();
  for (const MatrixXd* q : {&banks_[bank.like].base_q, &view.q}) {
    const MatrixXd absorbed = q->transpose() * columns;
    gram.noalias() -= absorbed.transpose() * absorbed;
  }
  const Gain best = best_gain(family, bank.variants, gram, columns.transpose() * view.y, original, kExact,
                              price_of(family, nonlinear));
  return completed(choice_of(best, bank.variants), f, nonlinear);
}

}  // namespace ecs::model
