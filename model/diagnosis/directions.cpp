// Effects along directions of a machine, such as bending of a head, scale and squareness of the axes that follow it:
// their columns nearly or exactly cancel each other, so that steps from one effect to the next miss the best set. All
// sets are compared (regression on all subsets: Furnival and Wilson 1974), on the products of the columns alone.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/stepwise.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Every choice of columns of every set of some families; the best choice of each set is kept.
class AllSubsets {
 public:
  AllSubsets(const Search& search, const Space& beside, std::size_t most) : search_(search), most_(most) {
    MatrixXd columns(beside.q.rows(), 0);
    for (std::size_t f = 0; f < search.candidates(); ++f) {
      if (!has_directions(search.families()[f].effect)) continue;
      Choice whole;
      whole.family = f;
      for (Index j = 0; j < static_cast<Index>(search.families()[f].effect.definition().column_count()); ++j)
        whole.columns.push_back(j);
      members_.push_back({f, columns.cols()});
      columns = ecs::beside(std::move(columns), search.white_columns_of(whole));
    }
    squares_ = columns.colwise().squaredNorm();
    columns = without(beside.q, std::move(columns));
    products_ = columns.transpose() * columns;
    with_readings_ = columns.transpose() * beside.y;
  }

  std::vector<DirectionSet> best_of_each() && {
    extend(0);
    std::vector<DirectionSet> sets;
    for (auto& [families, set] : best_) sets.push_back(std::move(set));
    sort_greatest_first(sets, [](const DirectionSet& set) { return set.score(); });
    return sets;
  }

 private:
  struct Member {
    std::size_t family = 0;
    Index first = 0;  ///< of its columns
  };
  /// One more direction absorbed: its products with all columns and with the readings.
  struct Absorbed {
    RowVectorXd with_columns;
    double with_readings = 0.0;
  };

  /// What these columns explain beside those absorbed already.
  double absorb(Index first, const std::vector<Index>& columns) {
    double gain = 0.0;
    for (const Index own : columns) {
      const Index j = first + own;
      RowVectorXd left = products_.row(j);
      double y = with_readings_(j);
      for (const Absorbed& one : absorbed_) {
        left -= one.with_columns(j) * one.with_columns;
        y -= one.with_columns(j) * one.with_readings;
      }
      if (left(j) <= kAbsorbed * squares_(j)) continue;
      const double size = std::sqrt(left(j));
      absorbed_.push_back({left / size, y / size});
      gain += y * y / left(j);
    }
    return gain;
  }

  void extend(std::size_t member) {
    if (member == members_.size()) return keep();
    extend(member + 1);
    if (now_.chosen.size() == most_) return;
    const auto [f, first] = members_[member];
    const Family& family = search_.families()[f];
    for (const std::vector<Index>& columns : family.effect.definition().column_sets) {
      const std::size_t had = absorbed_.size();
      const double gain = absorb(first, columns);
      const std::size_t fresh = absorbed_.size() - had;
      if (fresh > 0) {
        const double cost = family.ln_readings * static_cast<double>(fresh) + family.shape_cost;
        now_.chosen.push_back({f, 0.0, columns, gain, cost, fresh});
        now_.gain += gain;
        now_.cost += cost;
        extend(member + 1);
        now_.gain -= gain;
        now_.cost -= cost;
        now_.chosen.pop_back();
      }
      absorbed_.resize(had);
    }
  }

  void keep() {
    std::vector<std::size_t> families;
    for (const Choice& choice : now_.chosen) families.push_back(choice.family);
    const auto [at, is_new] = best_.try_emplace(families, now_);
    if (!is_new && now_.score() > at->second.score()) at->second = now_;
  }

  const Search& search_;
  std::size_t most_;
  std::vector<Member> members_;
  MatrixXd products_;
  RowVectorXd squares_;  ///< before anything was absorbed
  VectorXd with_readings_;
  std::vector<Absorbed> absorbed_;
  DirectionSet now_;
  std::map<std::vector<std::size_t>, DirectionSet> best_;
};

}  // namespace

bool has_directions(const EffectInstance& effect) {
  return effect.definition().place == Place::artefact && effect.definition().column_sets.size() > 1;
}

std::vector<DirectionSet> direction_sets(const Search& search, const Space& beside, std::size_t most) {
  return AllSubsets(search, beside, most).best_of_each();
}

}  // namespace ecs::model
